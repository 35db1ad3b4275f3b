// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Between which times a ray is in the box of a triangle, in floats, as it would be found in a box of the tree. A
// triangle a cycle, 14 cycles; it never waits.
// Must be given: finite numbers, of which no difference is infinite.
`default_nettype none
module rp_triangle_interval (
  input  wire         clk_i,
  input  wire [287:0] corners_i,      // corner 0 first, x first
  input  wire [95:0]  padded_lower_i, // what is subtracted from lower planes, x first
  input  wire [95:0]  padded_upper_i,
  input  wire [95:0]  inverse_i,      // of the direction
  output wire [30:0]  near_o,         // not negative
  output wire [30:0]  far_o,          // 0 also where it is negative
  output wire         met_o           // near is not behind far
);
  localparam [31:0] NEAR_SCALE = 32'h3f7ffff8;   // 1 - 2^-21
  localparam [31:0] FAR_SCALE = 32'h3f800004;    // 1 + 2^-21

  // Floats as numbers that compare like integers; -0 lies below 0, which changes no time but the sign of a zero.
  function below(input [31:0] a, input [31:0] b);
    below = {!a[31], a[30:0] ^ {31{a[31]}}} < {!b[31], b[30:0] ^ {31{b[31]}}};
  endfunction

  // ---- 1, 2: the planes that the ray meets first and last, and what is subtracted from them; 3 .. 5: distances
  reg [95:0] first_2, last_2, near_padding_2, far_padding_2;
  wire [95:0] inverse_1, padded_lower_1, padded_upper_1;
  rp_steady_delay #(.WIDTH(288)) ray_delay (.clk_i(clk_i), .data_i({inverse_i, padded_lower_i, padded_upper_i}),
    .data_o({inverse_1, padded_lower_1, padded_upper_1}));
  genvar a;
  generate
    for (a = 0; a < 3; a = a + 1) begin : gen_axis
      reg [31:0] corner_0, corner_1, corner_2;
      reg below_01, below_02, below_12;
      wire [31:0] lower = below_01 ? (below_02 ? corner_0 : corner_2) : (below_12 ? corner_1 : corner_2);
      wire [31:0] upper = below_01 ? (below_12 ? corner_2 : corner_1) : (below_02 ? corner_2 : corner_0);
      wire backwards = inverse_1[32*a+31];
      always @(posedge clk_i) begin
        corner_0 <= corners_i[32*a+:32];
        corner_1 <= corners_i[32*a+96+:32];
        corner_2 <= corners_i[32*a+192+:32];
        below_01 <= below(corners_i[32*a+:32], corners_i[32*a+96+:32]);
        below_02 <= below(corners_i[32*a+:32], corners_i[32*a+192+:32]);
        below_12 <= below(corners_i[32*a+96+:32], corners_i[32*a+192+:32]);
        first_2[32*a+:32] <= backwards ? upper : lower;
        last_2[32*a+:32] <= backwards ? lower : upper;
        near_padding_2[32*a+:32] <= backwards ? padded_upper_1[32*a+:32] : padded_lower_1[32*a+:32];
        far_padding_2[32*a+:32] <= backwards ? padded_lower_1[32*a+:32] : padded_upper_1[32*a+:32];
      end
    end
  endgenerate
  wire [191:0] distance_5, time_8;
  rp_float_sums #(.COUNT(6), .SUBTRACT(1)) distances (.clk_i(clk_i), .a_i({last_2, first_2}),
    .b_i({far_padding_2, near_padding_2}), .sum_o(distance_5));

  // ---- 6 .. 8: times
  wire [95:0] inverse_5;
  rp_steady_delay #(.WIDTH(96), .CYCLES(4)) inverse_delay (.clk_i(clk_i), .data_i(inverse_1), .data_o(inverse_5));
  rp_float_products #(.COUNT(6)) times (.clk_i(clk_i), .a_i(distance_5), .b_i({2{inverse_5}}), .product_o(time_8));

  // ---- 9, 10: the last of the times of entry, the first of those of exit. What lies behind the origin counts as if it
  // were there.
  reg [30:0] near_10, far_10;
  reg [92:0] near_9, far_9;
  reg [2:0] above_9, before_9;        // of 0 and 1, 0 and 2, 1 and 2
  function [30:0] at_origin_or_later(input [31:0] x);
    at_origin_or_later = x[31] ? 31'd0 : x[30:0];
  endfunction
  wire [30:0] near_x = at_origin_or_later(time_8[31:0]), near_y = at_origin_or_later(time_8[63:32]);
  wire [30:0] near_z = at_origin_or_later(time_8[95:64]), far_x = at_origin_or_later(time_8[127:96]);
  wire [30:0] far_y = at_origin_or_later(time_8[159:128]), far_z = at_origin_or_later(time_8[191:160]);
  always @(posedge clk_i) begin
    near_9 <= {near_z, near_y, near_x};
    far_9 <= {far_z, far_y, far_x};
    above_9 <= {near_y > near_z, near_x > near_z, near_x > near_y};
    before_9 <= {far_y < far_z, far_x < far_z, far_x < far_y};
    near_10 <= (above_9[0] ? above_9[1] : above_9[2]) ? (above_9[0] ? near_9[30:0] : near_9[61:31]) : near_9[92:62];
    far_10 <= (before_9[0] ? before_9[1] : before_9[2]) ? (before_9[0] ? far_9[30:0] : far_9[61:31]) : far_9[92:62];
  end

  // ---- 11 .. 13: with room for the roundings of a slab's times; 14: whether one is left
  wire [63:0] scaled_13;
  rp_float_products #(.COUNT(2)) scaled (
    .clk_i(clk_i), .a_i({1'b0, far_10, 1'b0, near_10}), .b_i({FAR_SCALE, NEAR_SCALE}),
    .product_o(scaled_13));
  reg [30:0] near_14, far_14;
  reg met_14;
  wire unused = &{1'b0, scaled_13[63], scaled_13[31]};   // their signs
  always @(posedge clk_i) begin
    near_14 <= scaled_13[30:0];
    far_14 <= scaled_13[62:32];
    met_14 <= scaled_13[30:0] <= scaled_13[62:32];
  end
  assign near_o = near_14;
  assign far_o = far_14;
  assign met_o = met_14;
endmodule
`default_nettype wire
