// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// By how much a ray's origin is padded against what rounding loses: for a triangle's own box, as the floats next to
// origin and padding, and for the boxes of nodes, as an exponent. An axis a cycle, x first, its results 23 cycles
// later; a register's name ends with the stage that loads it, and first_i marks the stage that holds a ray's first
// axis.
`default_nettype none
module rp_ray_padding (
  input  wire        clk_i,
  input  wire [24:1] first_i,         // bit n: stage n holds x
  input  wire [31:0] origin_1_i,
  input  wire [95:0] lower_i,         // of the scene's box, x first
  input  wire [95:0] upper_i,
  output wire        near_10_o,       // the scene is not too far away; for three cycles from the tenth stage on
  output wire [31:0] origin_24_o,
  output wire [31:0] padded_lower_24_o,
  output wire [31:0] padded_upper_24_o,
  output wire [9:0]  padding_24_o     // signed
);
  localparam [30:0] LARGEST = 31'h5d5e0b6b;      // a distance, 1e18
  wire unused = &{1'b0, first_i[24:11], first_i[5:3]};

  function [31:0] above(input [31:0] x);         // the next float
    above = (x[30:0] == 31'd0) ? 32'h00000001 : {x[31], x[31] ? x[30:0] - 31'd1 : x[30:0] + 31'd1};
  endfunction
  function [31:0] below(input [31:0] x);
    below = (x[30:0] == 31'd0) ? 32'h80000001 : {x[31], x[31] ? x[30:0] + 31'd1 : x[30:0] - 31'd1};
  endfunction

  wire [31:0] origin_2, origin_11, origin_15;
  rp_steady_delay #(.WIDTH(32)) origin_delay_2 (.clk_i(clk_i), .data_i(origin_1_i), .data_o(origin_2));
  rp_steady_delay #(.WIDTH(32), .CYCLES(9)) origin_delay_11 (.clk_i(clk_i), .data_i(origin_2), .data_o(origin_11));
  rp_steady_delay #(.WIDTH(32), .CYCLES(4)) origin_delay_15 (.clk_i(clk_i), .data_i(origin_11), .data_o(origin_15));
  rp_steady_delay #(.WIDTH(32), .CYCLES(9)) origin_delay_24 (.clk_i(clk_i), .data_i(origin_15), .data_o(origin_24_o));

  // ---- 2: the faces on this axis; 3 .. 5: their distances; 6, 7: the largest on any axis
  reg [31:0] lower_2, upper_2;
  wire [63:0] distances_5;
  reg [30:0] distance_6, reach_7;
  rp_float_sums #(.COUNT(2), .SUBTRACT(1)) distances (.clk_i(clk_i), .a_i({upper_2, lower_2}), .b_i({2{origin_2}}),
    .sum_o(distances_5));
  always @(posedge clk_i) begin
    lower_2 <= first_i[1] ? lower_i[31:0] : first_i[2] ? lower_i[63:32] : lower_i[95:64];
    upper_2 <= first_i[1] ? upper_i[31:0] : first_i[2] ? upper_i[63:32] : upper_i[95:64];
    distance_6 <= (distances_5[30:0] > distances_5[62:32]) ? distances_5[30:0] : distances_5[62:32];
    if (first_i[6] || distance_6 > reach_7) reach_7 <= distance_6;
  end
  wire unused_signs = &{1'b0, distances_5[63], distances_5[31]};

  // ---- 8, 9: the largest coordinate on this axis. Until 11: the ray's padding, and a share of that
  reg [30:0] lower_8, upper_8, largest_9;
  reg near_10;
  wire [30:0] padding_11, share_11;
  assign near_10_o = near_10;
  always @(posedge clk_i) begin
    lower_8 <= first_i[7] ? lower_i[30:0] : first_i[8] ? lower_i[62:32] : lower_i[94:64];
    upper_8 <= first_i[7] ? upper_i[30:0] : first_i[8] ? upper_i[62:32] : upper_i[94:64];
    largest_9 <= (lower_8 > upper_8) ? lower_8 : upper_8;
    if (first_i[9]) near_10 <= reach_7 <= LARGEST;
  end
  rp_float_share #(.PLACES(20)) padding_share (.clk_i(clk_i), .take_i(first_i[10]), .float_i(reach_7),
    .share_o(padding_11));
  rp_float_share #(.PLACES(24)) largest_share (.clk_i(clk_i), .take_i(1'b1), .float_i(largest_9), .share_o(share_11));

  // ---- 12 .. 14: origin and padding, 15: the floats next to them; padding and share
  wire [31:0] sum_14, difference_14, rest_14, rest_19;
  reg [31:0] padded_lower_15, padded_upper_15;
  rp_float_sums sums (.clk_i(clk_i), .a_i(origin_11), .b_i({1'b0, padding_11}), .sum_o(sum_14));
  rp_float_sums #(.SUBTRACT(1)) differences (.clk_i(clk_i), .a_i(origin_11), .b_i({1'b0, padding_11}),
    .sum_o(difference_14));
  rp_float_sums rests (.clk_i(clk_i), .a_i({1'b0, padding_11}), .b_i({1'b0, share_11}), .sum_o(rest_14));
  always @(posedge clk_i) begin
    padded_lower_15 <= above(sum_14);
    padded_upper_15 <= below(difference_14);
  end
  rp_steady_delay #(.WIDTH(64), .CYCLES(9)) padded_delay (.clk_i(clk_i), .data_i({padded_upper_15, padded_lower_15}),
    .data_o({padded_upper_24_o, padded_lower_24_o}));
  rp_steady_delay #(.WIDTH(32), .CYCLES(5)) rest_delay (.clk_i(clk_i), .data_i(rest_14), .data_o(rest_19));

  // ---- 16 .. 18: by how much a box is widened, 19: at most; 20 .. 22: all that is padded
  wire [63:0] widened_18;
  reg [30:0] widened_19;
  wire [31:0] least_22;
  rp_float_sums #(.COUNT(2), .SUBTRACT(1)) widths (.clk_i(clk_i), .a_i({origin_15, padded_lower_15}),
    .b_i({padded_upper_15, origin_15}), .sum_o(widened_18));
  always @(posedge clk_i)
    widened_19 <= (widened_18[30:0] > widened_18[62:32]) ? widened_18[30:0] : widened_18[62:32];
  rp_float_sums leasts (.clk_i(clk_i), .a_i({1'b0, widened_19}), .b_i(rest_19), .sum_o(least_22));
  wire unused_widths = &{1'b0, widened_18[63], widened_18[31], least_22[31]};

  // ---- 23: the float 32 places above, which makes up for what the sums have lost; 24: the power of two above that
  reg [30:0] above_23;
  reg [9:0] padding_24;
  reg [4:0] leading;
  integer bit_number;
  always @* begin
    leading = 5'd0;
    for (bit_number = 0; bit_number < 23; bit_number = bit_number + 1)
      if (above_23[bit_number]) leading = bit_number[4:0];
  end
  always @(posedge clk_i) begin
    above_23 <= least_22[30:0] + 31'd32;
    padding_24 <= (above_23[30:23] != 8'd0) ? {2'b00, above_23[30:23]} - 10'd126 : {5'd0, leading} - 10'd148;
  end
  assign padding_24_o = padding_24;
endmodule
`default_nettype wire
