// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What is computed of a ray's direction: for boxes reciprocals of BITS bits, rounded down, and for triangles the
// direction scaled by a power of two, its inverses, and what it goes aside for each step along its main axis. An axis a
// cycle, x first, its results 23 cycles later; a register's name ends with the stage that loads it, and first_i marks
// the stage that holds a ray's first axis. A direction that is infinite, not a number or all zero makes no ray.
`default_nettype none
module rp_ray_direction #(
  parameter integer BITS = 12
) (
  input  wire            clk_i,
  input  wire [24:1]     first_i,        // bit n: stage n holds x
  input  wire [31:0]     direction_1_i,
  // for three cycles from the sixth stage on
  output wire            moves_6_o,      // it is not all zero
  output wire [1:0]      main_axis_6_o,
  output wire [8:0]      exponent_6_o,   // of the main axis' component, as float_parts has it
  output reg             backwards_24_o, // it is below zero
  output reg             still_24_o,
  output reg  [BITS-1:0] reciprocal_24_o,
  output reg  [9:0]      exponent_24_o,  // of the reciprocal's last bit
  output reg  [31:0]     inverse_24_o,
  output reg  [34:0]     direction_24_o, // sign, 11 bits of exponent, 23 of fraction
  output reg  [31:0]     aside_24_o      // of this component, for one of the main axis'
);
  localparam [9:0] PLACES = BITS[9:0];
  wire unused = &{1'b0, first_i[24:9], first_i[7:6], first_i[4], first_i[1]};

  // ---- 2: significand and exponent; 3: the main axis so far, the first one of the largest
  wire sign_2, zero_2;
  wire signed [8:0] exponent_2;
  wire [22:0] fraction_2;
  rp_float_parts parts (
    .clk_i(clk_i),
    .float_i(direction_1_i),
    .sign_o(sign_2),
    .zero_o(zero_2),
    .exponent_o(exponent_2),
    .fraction_o(fraction_2)
  );
  reg [30:0] size_2, main_size_3;
  reg [1:0] main_axis_3;
  reg main_sign_3;
  reg signed [8:0] main_exponent_3;
  reg [22:0] main_fraction_3;
  always @(posedge clk_i) begin
    size_2 <= direction_1_i[30:0];
    if (first_i[2] || size_2 > main_size_3) begin
      main_size_3 <= size_2;
      main_axis_3 <= first_i[2] ? 2'd0 : first_i[3] ? 2'd1 : 2'd2;
      main_sign_3 <= sign_2;
      main_exponent_3 <= exponent_2;
      main_fraction_3 <= fraction_2;
    end
  end

  // ---- 6, and 9 again: what is known when all axes are, in registers for three cycles
  wire main_sign_6, main_sign_9;
  wire [8:0] main_exponent_6, main_exponent_9;
  wire [22:0] main_fraction_6, main_fraction_9;
  rp_ray_delay #(.WIDTH(36)) main_delay_6 (.clk_i(clk_i), .move_i(first_i[5]),
    .data_i({main_size_3 != 31'd0, main_axis_3, main_sign_3, main_exponent_3, main_fraction_3}),
    .data_o({moves_6_o, main_axis_6_o, main_sign_6, main_exponent_6, main_fraction_6}));
  rp_ray_delay #(.WIDTH(33)) main_delay_9 (.clk_i(clk_i), .move_i(first_i[8]),
    .data_i({main_sign_6, main_exponent_6, main_fraction_6}),
    .data_o({main_sign_9, main_exponent_9, main_fraction_9}));
  assign exponent_6_o = main_exponent_6;
  wire sign_9, zero_9;
  wire signed [8:0] exponent_9;
  wire [22:0] fraction_9;
  rp_steady_delay #(.WIDTH(34), .CYCLES(7)) parts_delay (.clk_i(clk_i),
    .data_i({sign_2, zero_2, exponent_2, fraction_2}), .data_o({sign_9, zero_9, exponent_9, fraction_9}));

  // ---- 10 .. 22: the digits of 1 / significand, and of significand / the main axis'
  wire [8:0] places_9 = main_exponent_9 - exponent_9;    // so much smaller than that of the main axis
  wire less_9, sign_22, zero_22, less_22;
  wire [8:0] exponent_22, places_22;
  wire [22:0] fraction_22;
  wire [23:0] digits_22;
  wire rest_22;
  rp_quotient_digits #(.BITS(24), .WAITING(44)) inverse_digits (
    .clk_i(clk_i),
    .a_i(24'h800000),
    .b_i({1'b1, fraction_9}),
    .less_o(less_9),
    .waiting_i({sign_9, zero_9, less_9, exponent_9, places_9, fraction_9}),
    .digits_o(digits_22),
    .rest_o(rest_22),
    .waiting_o({sign_22, zero_22, less_22, exponent_22, places_22, fraction_22})
  );
  wire aside_less_9, main_sign_22, aside_less_22, aside_rest_22;
  wire [23:0] aside_digits_22;
  rp_quotient_digits #(.BITS(24), .WAITING(2)) aside_digits (
    .clk_i(clk_i),
    .a_i({1'b1, fraction_9}),
    .b_i({1'b1, main_fraction_9}),
    .less_o(aside_less_9),
    .waiting_i({main_sign_9, aside_less_9}),
    .digits_o(aside_digits_22),
    .rest_o(aside_rest_22),
    .waiting_o({main_sign_22, aside_less_22})
  );

  // ---- 23: floats of them. Along an axis that is 2^-100 of the main one, or less, a ray does not move at all.
  wire [9:0] exponent_23 = {exponent_22[8], exponent_22};
  wire [7:0] aside_exponent = 8'd127 - places_22[7:0] - {7'd0, aside_less_22};   // as it is stored, if normal
  wire signed [9:0] below = $signed({1'b0, places_22}) + $signed({9'd0, aside_less_22}) - 10'sd126;
  wire subnormal = below > 10'sd0;
  wire [4:0] distance = !subnormal ? 5'd0 : (below[8:5] != 4'd0) ? 5'd31 : below[4:0];
  wire [54:0] moved = {1'b1, aside_digits_22[23:1], 31'd0} >> distance;
  wire unused_22 = &{1'b0, rest_22, moved[54]};
  reg backwards_23, still_23, clamped_23, sign_23, aside_sign_23, guard_23, rest_23;
  reg [BITS-1:0] reciprocal_23;
  reg [9:0] reciprocal_exponent_23;
  reg [7:0] inverse_exponent_23;
  reg [22:0] inverse_fraction_23;
  reg [33:0] direction_23;
  reg [30:0] aside_23;
  always @(posedge clk_i) begin
    sign_23 <= sign_22;
    backwards_23 <= sign_22 && !zero_22;
    still_23 <= zero_22;
    reciprocal_23 <= zero_22 ? {1'b1, {BITS-1{1'b0}}} : {1'b1, digits_22[23-:BITS-1]};
    reciprocal_exponent_23 <= zero_22 ? 10'd1 - PLACES : 10'd128 - PLACES - exponent_23 - {9'd0, less_22};
    clamped_23 <= zero_22 || places_22 > 9'd100;
    inverse_exponent_23 <= 8'd127 + places_22[7:0] - {7'd0, less_22};
    inverse_fraction_23 <= digits_22[23:1] + {22'd0, digits_22[0]};
    direction_23 <= zero_22 ? 34'd0 : {11'd1023 - {2'd0, places_22}, fraction_22};
    aside_sign_23 <= sign_22 ^ main_sign_22;
    aside_23 <= zero_22 ? 31'd0 : {subnormal ? 8'd0 : aside_exponent, moved[53:31]};
    guard_23 <= !zero_22 && (subnormal ? moved[30] : aside_digits_22[0]);
    rest_23 <= moved[29:0] != 30'd0 || aside_digits_22[0] || aside_rest_22;
  end

  // ---- 24
  always @(posedge clk_i) begin
    backwards_24_o <= backwards_23;
    still_24_o <= still_23;
    reciprocal_24_o <= reciprocal_23;
    exponent_24_o <= reciprocal_exponent_23;
    inverse_24_o <= {sign_23, clamped_23 ? {8'd227, 23'd0} : {inverse_exponent_23, inverse_fraction_23}};
    direction_24_o <= {sign_23, direction_23};
    aside_24_o <= {aside_sign_23, aside_23 + {30'd0, guard_23 && (rest_23 || aside_23[0])}};
  end
endmodule
`default_nettype wire
