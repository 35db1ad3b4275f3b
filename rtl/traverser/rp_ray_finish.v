// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a ray carries on of its hit, without double: the time, where in the triangle, and the triangle's normal.
// docs/machine/ray-finish.md defines what is computed. A ray's corners, axes and quotients follow each other through
// the units, and its results are there together 66 cycles after it came; it never waits. A name ends with the stage
// that holds what is of the first of three then. Promises: valid_o, and all that goes with it, for one cycle. Must be
// given: rays three cycles apart or more; a hit's internal t, neither below zero nor infinite; finite coordinates, of
// which no two are further apart than 1e18 along an axis.
`default_nettype none
module rp_ray_finish #(
  parameter integer TAG_BITS = 16
) (
  input  wire                clk_i,
  input  wire                rst_ni,
  input  wire                valid_i,
  input  wire [TAG_BITS-1:0] tag_i,
  input  wire [287:0]        corners_i,       // of the triangle: corner 0 first, x first
  input  wire [95:0]         origin_i,        // of the ray
  input  wire [1:0]          main_axis_i,     // 0 .. 2
  input  wire [63:0]         shear_i,         // along the next axis, and the one after that
  input  wire [31:0]         t_i,             // internal
  input  wire [8:0]          scale_i,         // signed: the ray's t is internal t x 2^scale
  output wire                valid_o,
  output wire [TAG_BITS-1:0] tag_o,
  output wire [31:0]         t_o,
  output wire [31:0]         u_o,             // shares of corners 1 and 2
  output wire [31:0]         v_o,
  output wire [95:0]         normal_o         // x first
);
  localparam integer END = 66;

  // ---- 1: the ray, for three cycles; 2: a corner of it, and an axis, in turn
  reg [END:1] first_q;                        // bit n: stage n holds the first of three
  reg [287:0] corners_1;
  reg [95:0] origin_1, origin_2, corner_2, along_2;
  reg [1:0] main_axis_1, main_axis_2;
  reg [63:0] shear_1, shear_2;
  always @(posedge clk_i) begin
    if (!rst_ni) first_q <= {END{1'b0}};
    else first_q <= {first_q[END-1:1], valid_i};
    if (valid_i) {corners_1, origin_1, main_axis_1, shear_1} <= {corners_i, origin_i, main_axis_i, shear_i};
    corner_2 <= first_q[1] ? corners_1[95:0] : first_q[2] ? corners_1[191:96] : corners_1[287:192];
    {origin_2, main_axis_2, shear_2} <= {origin_1, main_axis_1, shear_1};
  end
  genvar c;
  generate
    for (c = 0; c < 3; c = c + 1) begin : gen_corner
      wire [95:0] corner = corners_1[96*c+:96];
      always @(posedge clk_i)
        along_2[32*c+:32] <= first_q[1] ? corner[31:0] : first_q[2] ? corner[63:32] : corner[95:64];
    end
  endgenerate
  assign valid_o = first_q[END];

  // ---- What waits: t, to 57, and the tag. When a ray comes 18 others, three cycles apart, are before 57
  wire waits;
  wire [TAG_BITS+40:0] oldest;
  wire [31:0] t_57;
  wire [8:0] scale_57;
  wire [TAG_BITS-1:0] tag_57;
  rp_ram_queue #(.WIDTH(TAG_BITS+41), .DEPTH(19)) waiting (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(valid_i),
    .data_i({tag_i, t_i, scale_i}),
    .valid_o(waits),
    .ready_i(first_q[56]),
    .data_o(oldest)
  );
  rp_ray_delay #(.WIDTH(TAG_BITS+41)) waited_delay (.clk_i(clk_i), .move_i(first_q[56]), .data_i(oldest),
    .data_o({tag_57, t_57, scale_57}));
  rp_ray_delay #(.WIDTH(TAG_BITS), .MOVES(3)) tag_delay (
    .clk_i(clk_i), .move_i({first_q[65], first_q[62], first_q[59]}),
    .data_i(tag_57), .data_o(tag_o));

  // ---- The parts
  wire [42:0] weight_39, sum_39, length_40, normal_59;
  rp_triangle_shares shares (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .first_i(first_q[38:1]),
    .corner_2_i(corner_2),
    .origin_2_i(origin_2),
    .main_axis_2_i(main_axis_2),
    .shear_2_i(shear_2),
    .weight_39_o(weight_39),
    .sum_39_o(sum_39)
  );
  rp_triangle_normal normal (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .first_i(first_q[58:1]),
    .corners_2_i(along_2),
    .length_40_o(length_40),
    .normal_59_o(normal_59)
  );

  // ---- 40 .. 57: three quotients: the share of corner 2, 1 / the normal's length, the share of corner 1
  reg [41:0] a_40, b_40;                      // without signs
  always @(posedge clk_i) begin
    a_40 <= first_q[40] ? {11'd1023, 31'd0} : weight_39[41:0];
    b_40 <= first_q[40] ? length_40[41:0] : sum_39[41:0];
  end
  wire less_40, zero_57, rest_57;
  wire [10:0] exponent_40 = a_40[41:31] - b_40[41:31] + 11'd1023 - {10'd0, less_40};
  wire [10:0] exponent_57;
  wire [31:0] digits_57;
  rp_quotient_digits #(.BITS(32), .WAITING(12)) quotients (
    .clk_i(clk_i),
    .a_i({1'b1, a_40[30:0]}),
    .b_i({1'b1, b_40[30:0]}),
    .less_o(less_40),
    .waiting_i({a_40[41:31] == 11'd0, exponent_40}),
    .digits_o(digits_57),
    .rest_o(rest_57),
    .waiting_o({zero_57, exponent_57})
  );

  // ---- 58 .. 60: floats of the shares, and of t in between; 66: they wait for the normal
  wire t_sign_58, t_zero_58;
  wire signed [8:0] t_exponent_58;
  wire [22:0] t_fraction_58;
  rp_float_parts t_parts (
    .clk_i(clk_i),
    .float_i(t_57),
    .sign_o(t_sign_58),
    .zero_o(t_zero_58),
    .exponent_o(t_exponent_58),
    .fraction_o(t_fraction_58)
  );
  wire [10:0] t_exponent = 11'd896 + {{2{t_exponent_58[8]}}, t_exponent_58} + {{2{scale_57[8]}}, scale_57};
  reg [44:0] number_58;
  always @(posedge clk_i)
    number_58 <= first_q[58] ? {1'b0, t_zero_58 ? 11'd0 : t_exponent, t_fraction_58, 10'd0} :
                 {1'b0, zero_57 ? 11'd0 : exponent_57, digits_57, rest_57};
  wire [31:0] float_60;
  reg [31:0] float_61, float_62;
  rp_float_shorten #(.MANTISSA_BITS(33)) shorten (.clk_i(clk_i), .number_i(number_58), .float_o(float_60));
  always @(posedge clk_i) {float_62, float_61} <= {float_61, float_60};
  rp_ray_delay #(.WIDTH(96), .MOVES(2)) share_delay (.clk_i(clk_i), .move_i({first_q[65], first_q[62]}),
    .data_i({float_60, float_61, float_62}), .data_o({u_o, t_o, v_o}));

  // ---- 59: the length's reciprocal, cut off; 61: the normal times it; 62: what is behind 33 bits as one; 64: floats
  reg [30:0] digits_59;
  reg [10:0] exponent_59;
  always @(posedge clk_i) if (first_q[58]) {digits_59, exponent_59} <= {digits_57[31:1], exponent_57};
  wire [63:0] sum_59, carry_59;
  wire zero_59 = normal_59[41:31] == 11'd0;
  rp_multiply_tree #(.A_BITS(32), .B_BITS(32), .OUT_BITS(64)) tree (.a_i({1'b1, normal_59[30:0]}),
    .b_i({1'b1, digits_59}), .c_i(64'd0), .sum_o(sum_59), .carry_o(carry_59));
  reg [63:0] sum_60, carry_60, product_61;
  reg sign_60, sign_61, zero_60, zero_61;
  reg [10:0] exponent_60, exponent_61;
  reg [44:0] number_62;
  always @(posedge clk_i) begin
    {sum_60, carry_60} <= {sum_59, carry_59};
    exponent_60 <= normal_59[41:31] + exponent_59 - 11'd1023;
    product_61 <= sum_60 + carry_60;
    {sign_61, sign_60, zero_61, zero_60, exponent_61} <= {sign_60, normal_59[42], zero_60, zero_59, exponent_60};
    number_62 <= {sign_61, zero_61 ? 11'd0 : exponent_61 + {10'd0, product_61[63]},
                  product_61[63] ? {product_61[62:31], product_61[30:0] != 31'd0} :
                                   {product_61[61:30], product_61[29:0] != 30'd0}};
  end
  wire [31:0] normal_64;                      // z, x and y in turn
  reg [31:0] normal_65, normal_66;
  rp_float_shorten #(.MANTISSA_BITS(33)) shorten_normal (.clk_i(clk_i), .number_i(number_62), .float_o(normal_64));
  always @(posedge clk_i) {normal_66, normal_65} <= {normal_65, normal_64};
  assign normal_o = {normal_66, normal_64, normal_65};

  wire unused = &{1'b0, waits, t_sign_58, weight_39[42], sum_39[42], length_40[42]};
endmodule
`default_nettype wire
