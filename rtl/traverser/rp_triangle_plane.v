// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where a ray meets the plane of a triangle: t = n . a / n . d, of the plane's normal n, a corner a as seen from the
// ray's origin and the direction d, in numbers of BITS bits with exponents of 11, which no step leaves. A triangle a
// cycle, 23 + BITS / 2 cycles; it never waits.
// Promises: each operation is rounded once, to nearest even, sums from left to right, and t once more, to a float; it
// is infinite, or not a number, where n . d is zero.
// Must be given: finite floats, of which no difference is infinite; a direction with a largest component of 1 .. 2.
`default_nettype none
module rp_triangle_plane #(
  parameter integer BITS = 32
) (
  input  wire         clk_i,
  input  wire [287:0] corners_i,      // corner 0 first, x first
  input  wire [95:0]  origin_i,       // of the ray
  input  wire [104:0] direction_i,    // sign, 11 bits of exponent, 23 of fraction; x first
  output wire [31:0]  t_o
);
  generate
    if (BITS < 26 || BITS > 32 || BITS % 2 != 0) begin : gen_bad_bits
      triangle_plane_BITS_must_be_26_28_30_or_32 illegal ();
    end
  endgenerate
  localparam integer M = BITS - 1;    // stored bits
  localparam integer N = 12 + M;      // a number
  localparam integer F = 9 + M;       // a float with so many bits, subnormal ones included
  genvar k;

  // ---- 1 .. 3: corner 0 as seen from the origin, the other corners as seen from it
  wire [9*F-1:0] to, from, difference_3;
  wire [287:0] origins = {{2{corners_i[95:0]}}, origin_i};
  generate
    for (k = 0; k < 9; k = k + 1) begin : gen_difference
      assign to[k*F+:F] = {corners_i[32*k+:32], {BITS-24{1'b0}}};
      assign from[k*F+:F] = {origins[32*k+:32], {BITS-24{1'b0}}};
    end
  endgenerate
  rp_float_sums #(.COUNT(9), .SUBTRACT(1), .MANTISSA_BITS(M)) differences (.clk_i(clk_i), .a_i(to), .b_i(from),
    .sum_o(difference_3));

  // ---- 4: with an exponent of 11 bits. A difference of floats is a multiple of 2^-149.
  wire [9*N-1:0] number_4;
  generate
    for (k = 0; k < 9; k = k + 1) begin : gen_number
      rp_float_widen #(.MANTISSA_BITS(M)) widen (.clk_i(clk_i), .float_i(difference_3[k*F+:F]),
        .number_o(number_4[k*N+:N]));
    end
  endgenerate

  // ---- 5 .. 7: products of the sides; 8 .. 10: the normal
  wire [6*N-1:0] product_7;
  wire [3*N-1:0] normal_10;
  wire [3*N-1:0] side_1 = number_4[3*N+:3*N], side_2 = number_4[6*N+:3*N];
  // x comes of y z and z y, and so on.
  wire [3*N-1:0] next_1 = {side_1[0+:N], side_1[N+:2*N]}, next_2 = {side_2[0+:N], side_2[N+:2*N]};
  wire [3*N-1:0] last_1 = {side_1[0+:2*N], side_1[2*N+:N]}, last_2 = {side_2[0+:2*N], side_2[2*N+:N]};
  rp_float_products #(.COUNT(6), .EXPONENT_BITS(11), .MANTISSA_BITS(M), .SUBNORMALS(1)) side_products (
    .clk_i(clk_i), .a_i({last_1, next_1}), .b_i({next_2, last_2}), .product_o(product_7));
  rp_float_sums #(.COUNT(3), .SUBTRACT(1), .EXPONENT_BITS(11), .MANTISSA_BITS(M), .SUBNORMALS(1)) normal (
    .clk_i(clk_i), .a_i(product_7[0+:3*N]), .b_i(product_7[3*N+:3*N]), .sum_o(normal_10));

  // ---- 11 .. 13: of the normal with corner 0, and with the direction; 14 .. 19: their sums
  wire [3*N-1:0] corner_10, direction;
  wire [104:0] direction_10;
  rp_steady_delay #(.WIDTH(3*N), .CYCLES(6)) corner_delay (
    .clk_i(clk_i), .data_i(number_4[0+:3*N]), .data_o(corner_10));
  rp_steady_delay #(.WIDTH(105), .CYCLES(10)) direction_delay (.clk_i(clk_i), .data_i(direction_i),
    .data_o(direction_10));
  generate
    for (k = 0; k < 3; k = k + 1) begin : gen_direction
      assign direction[k*N+:N] = {direction_10[35*k+:35], {BITS-24{1'b0}}};
    end
  endgenerate
  wire [6*N-1:0] product_13;
  rp_float_products #(.COUNT(6), .EXPONENT_BITS(11), .MANTISSA_BITS(M), .SUBNORMALS(1)) dot_products (
    .clk_i(clk_i), .a_i({2{normal_10}}), .b_i({direction, corner_10}), .product_o(product_13));
  wire [2*N-1:0] first_16, third_16, sum_19;
  rp_float_sums #(.COUNT(2), .EXPONENT_BITS(11), .MANTISSA_BITS(M), .SUBNORMALS(1)) first_sums (
    .clk_i(clk_i), .a_i({product_13[3*N+:N], product_13[0+:N]}), .b_i({product_13[4*N+:N], product_13[N+:N]}),
    .sum_o(first_16));
  rp_steady_delay #(.WIDTH(2*N), .CYCLES(3)) third_delay (.clk_i(clk_i),
    .data_i({product_13[5*N+:N], product_13[2*N+:N]}), .data_o(third_16));
  rp_float_sums #(.COUNT(2), .EXPONENT_BITS(11), .MANTISSA_BITS(M), .SUBNORMALS(1)) sums (
    .clk_i(clk_i), .a_i(first_16), .b_i(third_16), .sum_o(sum_19));

  // ---- 20 and on: t
  wire [N-1:0] t;
  rp_float_quotient #(.EXPONENT_BITS(11), .MANTISSA_BITS(M)) quotient (.clk_i(clk_i), .a_i(sum_19[0+:N]),
    .b_i(sum_19[N+:N]), .quotient_o(t));
  rp_float_shorten #(.MANTISSA_BITS(M)) shorten (.clk_i(clk_i), .number_i(t), .float_o(t_o));
endmodule
`default_nettype wire
