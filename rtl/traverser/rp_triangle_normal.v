// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The normal of a triangle, (1 - 0) x (2 - 0) of its corners, and its length. An axis a cycle, x first; a name ends
// with the stage that holds what is of the first one then, and first_i marks that stage. Numbers have a sign, 11 bits
// of exponent and so many behind the first one; none is subnormal.
// Must be given: finite floats, of which no difference is infinite.
`default_nettype none
module rp_triangle_normal #(
  parameter integer SIDE_BITS = 36     // of a side's significand
) (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire [58:1] first_i,          // bit n: stage n holds x
  input  wire [95:0] corners_2_i,      // of each corner this axis, corner 0 first
  output wire [42:0] length_40_o,      // cut off, for one cycle; whatever it is, if there is none
  output wire [42:0] normal_59_o       // z, x and y in turn
);
  localparam integer M = SIDE_BITS - 1, F = 9 + M, N = 12 + M;

  // ---- 5: sides, rounded; 14: the normal
  wire [2*F-1:0] side_5;
  wire [F-1:0] corner_2 = {corners_2_i[31:0], {M-23{1'b0}}};
  rp_float_sums #(.COUNT(2), .SUBTRACT(1), .MANTISSA_BITS(M)) sides (.clk_i(clk_i),
    .a_i({corners_2_i[95:64], {M-23{1'b0}}, corners_2_i[63:32], {M-23{1'b0}}}), .b_i({2{corner_2}}), .sum_o(side_5));
  wire [N-1:0] side_1_6, side_2_6;
  wire [42:0] normal_14;
  rp_float_widen #(.MANTISSA_BITS(M)) widen_1 (.clk_i(clk_i), .float_i(side_5[0+:F]), .number_o(side_1_6));
  rp_float_widen #(.MANTISSA_BITS(M)) widen_2 (.clk_i(clk_i), .float_i(side_5[F+:F]), .number_o(side_2_6));
  rp_cross_products #(.MANTISSA_BITS(M)) normals (.clk_i(clk_i), .wrap_i(first_i[9]), .x_i(side_2_6), .y_i(side_1_6),
    .product_o(normal_14));

  // ---- 18: the largest exponent; 19: of 31 bits at its place, the rest cut off; 21: squares; 24: their sum
  wire [42:0] normal_18;
  wire [10:0] largest_18, largest_24;
  rp_largest_exponent largest (
    .clk_i(clk_i),
    .first_i(first_i[14]),
    .all_i(first_i[17]),
    .number_i(normal_14),
    .number_o(normal_18),
    .largest_o(largest_18)
  );
  rp_ray_delay #(.WIDTH(11), .MOVES(2)) largest_delay (.clk_i(clk_i), .move_i({first_i[23], first_i[20]}),
    .data_i(largest_18), .data_o(largest_24));
  wire [10:0] places_18 = largest_18 - normal_18[41:31];
  reg [30:0] units_19;
  wire [61:0] sum_19, carry_19;
  rp_multiply_tree #(.A_BITS(31), .B_BITS(31), .OUT_BITS(62)) tree (.a_i(units_19), .b_i(units_19), .c_i(62'd0),
    .sum_o(sum_19), .carry_o(carry_19));
  reg [61:0] sum_20, carry_20, square_21;
  reg [63:0] sum_22;                   // so far; all of it two cycles later
  always @(posedge clk_i) begin
    // A zero is so far below that nothing of it is left, unless all are zeros.
    units_19 <= (places_18[10:5] != 6'd0) ? 31'd0 : {1'b1, normal_18[30:1]} >> places_18[4:0];
    {sum_20, carry_20} <= {sum_19, carry_19};
    square_21 <= sum_20 + carry_20;
    sum_22 <= {2'b00, square_21} + (first_i[21] ? 64'd0 : sum_22);
  end

  // ---- 25: of 62 bits, the first one among the first two; 40: its root, of 31
  wire more = sum_22[63:62] != 2'd0;
  reg [61:0] sum_25;
  reg [10:0] exponent_25;
  wire [10:0] exponent_40;
  wire [30:0] root_40;
  always @(posedge clk_i) begin
    sum_25 <= more ? sum_22[63:2] : sum_22[61:0];
    if (first_i[24]) exponent_25 <= largest_24 + {10'd0, more};
  end
  rp_root_digits digits (.clk_i(clk_i), .take_i({first_i[37], first_i[34], first_i[31], first_i[28], first_i[25]}),
    .value_i(sum_25), .root_o(root_40));
  rp_ray_delay #(.WIDTH(11), .MOVES(5)) exponent_delay (.clk_i(clk_i),
    .move_i({first_i[39], first_i[36], first_i[33], first_i[30], first_i[27]}), .data_i(exponent_25),
    .data_o(exponent_40));
  assign length_40_o = {1'b0, exponent_40, root_40[29:0], 1'b0};

  // ---- 59: the normal once more, beside what its length has become
  wire [42:0] normal_58;
  rp_ram_delay #(.WIDTH(43), .CYCLES(40)) normal_delay (.clk_i(clk_i), .rst_ni(rst_ni), .data_i(normal_18),
    .data_o(normal_58));
  rp_steady_delay #(.WIDTH(43)) last_delay (.clk_i(clk_i), .data_i(normal_58), .data_o(normal_59_o));
  wire unused = &{1'b0, root_40[30], first_i};
endmodule
`default_nettype wire
