// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Of the point in which a ray hits a triangle, the shares of the corners, as numerators and their sum: each corner's
// weight is the cross product of the other two, as the ray sees them. Of a hit all weights have one sign, so sizes do.
// A corner a cycle, 0 first; a name ends with the stage that holds what is of the first corner then, and first_i marks
// that stage. Numbers have a sign, 11 bits of exponent and 31 behind the first one; none is subnormal.
// Must be given: numbers of which no difference or product is too large for a float.
`default_nettype none
module rp_triangle_shares (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire [38:1] first_i,          // bit n: stage n holds corner 0
  input  wire [95:0] corner_2_i,       // x first
  input  wire [95:0] origin_2_i,       // of the ray
  input  wire [1:0]  main_axis_2_i,
  input  wire [63:0] shear_2_i,
  output wire [42:0] weight_39_o,      // of corners 2, 0 and 1 in turn; not below zero
  output wire [42:0] sum_39_o          // for three cycles
);
  // ---- 12: the corner as the ray sees it; 21: weights
  wire [31:0] x_12, y_12;
  wire in_front_12;
  rp_triangle_view #(.CORNERS(1)) view (
    .clk_i(clk_i),
    .corners_i(corner_2_i),
    .origin_i(origin_2_i),
    .main_axis_i(main_axis_2_i),
    .backwards_i(1'b0),
    .shear_i(shear_2_i),
    .x_o(x_12),
    .y_o(y_12),
    .in_front_o(in_front_12)
  );
  wire [34:0] x_13, y_13;
  rp_float_widen #(.MANTISSA_BITS(23)) widen_x (.clk_i(clk_i), .float_i(x_12), .number_o(x_13));
  rp_float_widen #(.MANTISSA_BITS(23)) widen_y (.clk_i(clk_i), .float_i(y_12), .number_o(y_13));
  wire [42:0] weight_21;
  rp_cross_products #(.MANTISSA_BITS(23)) weights (.clk_i(clk_i), .wrap_i(first_i[16]), .x_i(x_13), .y_i(y_13),
    .product_o(weight_21));
  wire unused = &{1'b0, in_front_12, weight_21, first_i};

  // ---- 25: the largest exponent; 26: units of its last place, the rest cut off; 29: the sum, of 34 bits at most
  wire [42:0] weight_25;
  wire [10:0] largest_25, largest_28;
  rp_largest_exponent largest (
    .clk_i(clk_i),
    .first_i(first_i[21]),
    .all_i(first_i[24]),
    .number_i({1'b0, weight_21[41:0]}),
    .number_o(weight_25),
    .largest_o(largest_25)
  );
  rp_ray_delay #(.WIDTH(11)) largest_delay (.clk_i(clk_i), .move_i(first_i[27]), .data_i(largest_25),
    .data_o(largest_28));
  wire [10:0] places_25 = largest_25 - weight_25[41:31];
  reg [31:0] units_26;
  reg [33:0] sum_27;                   // so far; all of it two cycles later
  always @(posedge clk_i) begin
    // A zero is so far below that nothing of it is left, unless all are zeros.
    units_26 <= (places_25[10:5] != 6'd0) ? 32'd0 : {1'b1, weight_25[30:0]} >> places_25[4:0];
    sum_27 <= {2'b00, units_26} + (first_i[26] ? 34'd0 : sum_27);
  end

  // ---- 30: the sum as a number, cut off; 39: beside the weights
  reg [42:0] sum_30;
  always @(posedge clk_i)
    if (first_i[29])
      sum_30 <= {1'b0, sum_27[33] ? {largest_28 + 11'd2, sum_27[32:2]} :
                       sum_27[32] ? {largest_28 + 11'd1, sum_27[31:1]} : {largest_28, sum_27[30:0]}};
  rp_ray_delay #(.WIDTH(43), .MOVES(3)) sum_delay (.clk_i(clk_i), .move_i({first_i[38], first_i[35], first_i[32]}),
    .data_i(sum_30), .data_o(sum_39_o));
  wire [42:0] weight_38;
  rp_ram_delay #(.WIDTH(43), .CYCLES(13)) weight_delay (.clk_i(clk_i), .rst_ni(rst_ni), .data_i(weight_25),
    .data_o(weight_38));
  rp_steady_delay #(.WIDTH(43)) last_delay (.clk_i(clk_i), .data_i(weight_38), .data_o(weight_39_o));
endmodule
`default_nettype wire
