// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The corners of a triangle as the ray sees them, in floats: their places across it, from the ray's origin and along
// its direction, and whether they lie in front of it. A triangle a cycle, or one of its corners, ten cycles; it never
// waits.
// Must be given: numbers of which no difference or product is too large for a float.
`default_nettype none
module rp_triangle_view #(
  parameter integer CORNERS = 3
) (
  input  wire                  clk_i,
  input  wire [96*CORNERS-1:0] corners_i,     // corner 0 first, x first
  input  wire [95:0]           origin_i,      // of the ray
  input  wire [1:0]            main_axis_i,   // 0 .. 2
  input  wire                  backwards_i,   // the direction is negative along it
  input  wire [63:0]           shear_i,       // along the next axis, and the one after that
  output wire [32*CORNERS-1:0] x_o,           // corner 0 first
  output wire [32*CORNERS-1:0] y_o,
  output wire [CORNERS-1:0]    in_front_o
);
  // ---- 1 .. 3: distances from the origin
  wire [96*CORNERS-1:0] distance_3;
  rp_float_sums #(.COUNT(3*CORNERS), .SUBTRACT(1)) distances (.clk_i(clk_i), .a_i(corners_i), .b_i({CORNERS{origin_i}}),
    .sum_o(distance_3));
  wire [1:0] main_axis_3;
  wire backwards_3;
  wire [63:0] shear_3;
  rp_steady_delay #(.WIDTH(67), .CYCLES(3)) ray_delay (.clk_i(clk_i), .data_i({main_axis_i, backwards_i, shear_i}),
    .data_o({main_axis_3, backwards_3, shear_3}));

  // ---- 4: axes in the order in which the ray sees them
  reg [32*CORNERS-1:0] x_4, y_4, z_4;
  reg [63:0] shear_4;
  reg [CORNERS-1:0] in_front_4;
  wire [32*CORNERS-1:0] z;
  genvar c;
  generate
    for (c = 0; c < CORNERS; c = c + 1) begin : gen_corner
      wire [31:0] along_x = distance_3[96*c+:32], along_y = distance_3[96*c+32+:32], along_z = distance_3[96*c+64+:32];
      assign z[32*c+:32] = main_axis_3[1] ? along_z : main_axis_3[0] ? along_y : along_x;
      always @(posedge clk_i) begin
        x_4[32*c+:32] <= main_axis_3[1] ? along_x : main_axis_3[0] ? along_z : along_y;
        y_4[32*c+:32] <= main_axis_3[1] ? along_y : main_axis_3[0] ? along_x : along_z;
        in_front_4[c] <= z[32*c+:31] != 31'd0 && z[32*c+31] == backwards_3;
      end
    end
  endgenerate
  always @(posedge clk_i) begin
    z_4 <= z;
    shear_4 <= shear_3;
  end

  // ---- 5 .. 7: what the direction adds on the way; 8 .. 10: without it
  wire [64*CORNERS-1:0] product_7, across_7;
  rp_float_products #(.COUNT(2*CORNERS)) products (.clk_i(clk_i),
    .a_i({{CORNERS{shear_4[63:32]}}, {CORNERS{shear_4[31:0]}}}), .b_i({2{z_4}}), .product_o(product_7));
  rp_steady_delay #(.WIDTH(64*CORNERS), .CYCLES(3)) across_delay (
    .clk_i(clk_i), .data_i({y_4, x_4}), .data_o(across_7));
  rp_float_sums #(.COUNT(2*CORNERS), .SUBTRACT(1)) places (.clk_i(clk_i), .a_i(across_7), .b_i(product_7),
    .sum_o({y_o, x_o}));
  rp_steady_delay #(.WIDTH(CORNERS), .CYCLES(6)) front_delay (.clk_i(clk_i), .data_i(in_front_4), .data_o(in_front_o));
endmodule
`default_nettype wire
