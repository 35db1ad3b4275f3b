// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What is computed once of a ray, for box_pipe and triangle_pipe: docs/machine/ray-setup.md defines it and shows why it
// is exact. A ray's axes follow each other through the units, x first, and leave side by side, 27 cycles after the ray
// came; it never waits. A register's name ends with the stage that loads its first axis. Promises: valid_o, and all
// that goes with it, for one cycle. Must be given: rays three cycles apart or more; a box of the scene that stands
// still, lower bounds not above upper ones.
`default_nettype none
module rp_ray_setup #(
  parameter integer BITS = 12,                // of the box test
  parameter integer TAG_BITS = 8,
  parameter integer KEY_BITS = BITS + 9
) (
  input  wire                clk_i,
  input  wire                rst_ni,
  input  wire                valid_i,
  input  wire [TAG_BITS-1:0] tag_i,
  input  wire [95:0]         origin_i,        // floats, x first
  input  wire [95:0]         direction_i,
  input  wire [31:0]         limit_i,
  input  wire [95:0]         lower_i,         // of the scene's box
  input  wire [95:0]         upper_i,
  output wire                valid_o,
  output wire [TAG_BITS-1:0] tag_o,
  output wire                hits_o,          // low: the ray hits nothing, and what follows is nothing
  output reg  [95:0]         origin_o,
  output wire [31:0]         limit_o,
  output wire [8:0]          scale_o,         // signed: the ray's t is internal t x 2^scale
  // for boxes
  output reg  [2:0]          backwards_o,
  output reg  [2:0]          still_o,
  output reg  [3*BITS-1:0]   reciprocal_o,
  output reg  [29:0]         exponent_o,
  output reg  [29:0]         padding_o,
  output reg  [KEY_BITS-1:0] key_o,           // of the limit
  // for triangles
  output reg  [95:0]         padded_lower_o,
  output reg  [95:0]         padded_upper_o,
  output reg  [95:0]         inverse_o,
  output wire [1:0]          main_axis_o,
  output reg  [63:0]         shear_o,
  output reg  [104:0]        direction_o
);
  generate
    if (BITS < 6 || BITS > 16) begin : gen_bad_bits
      ray_setup_BITS_must_be_from_6_to_16 illegal ();
    end
  endgenerate
  localparam integer END = 27;

  // ---- 1: a ray's axes, one after the other
  reg [END:1] first_q;                         // bit n: stage n holds x
  reg [95:0] origins_q, directions_q;
  wire [31:0] origin_1 = origins_q[31:0], direction_1 = directions_q[31:0];
  always @(posedge clk_i) begin
    if (!rst_ni) first_q <= {END{1'b0}};
    else first_q <= {first_q[END-1:1], valid_i};
    origins_q <= valid_i ? origin_i : {32'd0, origins_q[95:32]};
    directions_q <= valid_i ? direction_i : {32'd0, directions_q[95:32]};
  end
  assign valid_o = first_q[END];

  // ---- What is an axis'
  wire moves_6, near_10;
  wire [1:0] main_axis_6;
  wire [8:0] exponent_6;
  wire [31:0] origin_24, padded_lower_24, padded_upper_24, inverse_24, aside_24;
  wire [9:0] padding_24, exponent_24;
  wire backwards_24, still_24;
  wire [BITS-1:0] reciprocal_24;
  wire [34:0] direction_24;
  rp_ray_padding padding (
    .clk_i(clk_i),
    .first_i(first_q[24:1]),
    .origin_1_i(origin_1),
    .lower_i(lower_i),
    .upper_i(upper_i),
    .near_10_o(near_10),
    .origin_24_o(origin_24),
    .padded_lower_24_o(padded_lower_24),
    .padded_upper_24_o(padded_upper_24),
    .padding_24_o(padding_24)
  );
  rp_ray_direction #(.BITS(BITS)) direction (
    .clk_i(clk_i),
    .first_i(first_q[24:1]),
    .direction_1_i(direction_1),
    .moves_6_o(moves_6),
    .main_axis_6_o(main_axis_6),
    .exponent_6_o(exponent_6),
    .backwards_24_o(backwards_24),
    .still_24_o(still_24),
    .reciprocal_24_o(reciprocal_24),
    .exponent_24_o(exponent_24),
    .inverse_24_o(inverse_24),
    .direction_24_o(direction_24),
    .aside_24_o(aside_24)
  );

  // ---- What is the ray's, in registers for three cycles: limit and tag, with their last one at 22 and 25
  wire [31:0] limit_4, limit_22;
  wire [TAG_BITS-1:0] tag_4, tag_22;
  reg [31:0] limit_1;
  reg [TAG_BITS-1:0] tag_1;
  always @(posedge clk_i) if (valid_i) {tag_1, limit_1} <= {tag_i, limit_i};
  rp_ray_delay #(.WIDTH(TAG_BITS + 32)) limit_delay_4 (.clk_i(clk_i), .move_i(first_q[3]), .data_i({tag_1, limit_1}),
    .data_o({tag_4, limit_4}));
  rp_ray_delay #(.WIDTH(TAG_BITS + 32), .MOVES(6)) limit_delay_22 (.clk_i(clk_i),
    .move_i({first_q[21], first_q[18], first_q[15], first_q[12], first_q[9], first_q[6]}), .data_i({tag_4, limit_4}),
    .data_o({tag_22, limit_22}));
  rp_ray_delay #(.WIDTH(TAG_BITS + 32)) limit_delay_25 (
    .clk_i(clk_i), .move_i(first_q[24]), .data_i({tag_22, limit_22}),
    .data_o({tag_o, limit_o}));

  // ---- 2 .. 13: whether it can hit anything
  reg infinite_2, counts_5, counts_7, counts_13;
  wire counts_10;
  wire infinite = &origin_1[30:23] || &direction_1[30:23];   // or not a number
  wire positive = !limit_4[31] && limit_4[30:0] != 31'd0 && limit_4[30:0] <= 31'h7f800000;
  always @(posedge clk_i) begin
    infinite_2 <= infinite || (infinite_2 && !first_q[1]);
    if (first_q[4]) counts_5 <= !infinite_2 && positive;
    if (first_q[6]) counts_7 <= counts_5 && moves_6;
    if (first_q[12]) counts_13 <= counts_10 && near_10;
  end
  rp_ray_delay #(.WIDTH(1)) counts_delay (.clk_i(clk_i), .move_i(first_q[9]), .data_i(counts_7), .data_o(counts_10));

  // ---- 7 .. 25: main axis and exponent
  wire [1:0] main_axis_13, main_axis_22;
  wire [8:0] exponent_13, exponent_22;
  wire counts_22;
  rp_ray_delay #(.WIDTH(11), .MOVES(3)) main_delay_13 (.clk_i(clk_i), .move_i({first_q[12], first_q[9], first_q[6]}),
    .data_i({main_axis_6, exponent_6}), .data_o({main_axis_13, exponent_13}));
  rp_ray_delay #(.WIDTH(12), .MOVES(3)) main_delay_22 (.clk_i(clk_i), .move_i({first_q[21], first_q[18], first_q[15]}),
    .data_i({counts_13, main_axis_13, exponent_13}), .data_o({counts_22, main_axis_22, exponent_22}));
  rp_ray_delay #(.WIDTH(12)) main_delay_25 (.clk_i(clk_i), .move_i(first_q[24]),
    .data_i({counts_22, main_axis_22, 9'd127 - exponent_22}), .data_o({hits_o, main_axis_o, scale_o}));

  // ---- 23 .. 25: the limit's key
  wire limit_sign, limit_zero;
  wire signed [8:0] limit_exponent;
  wire [22:0] limit_fraction;
  rp_float_parts limit_parts (
    .clk_i(clk_i),
    .float_i(limit_22),
    .sign_o(limit_sign),
    .zero_o(limit_zero),
    .exponent_o(limit_exponent),
    .fraction_o(limit_fraction)
  );
  wire unused = &{1'b0, limit_sign, limit_zero, limit_fraction};
  always @(posedge clk_i)
    if (first_q[24])
      key_o <= (limit_exponent == 9'sd255) ? {KEY_BITS{1'b1}} :
               {10'd385 + {limit_exponent[8], limit_exponent}, limit_fraction[22-:BITS-1]};

  // ---- 25 .. 27: the axes side by side. Shears are those of the axes behind the main one, in turn
  wire [1:0] main_axis_24 = first_q[24] ? main_axis_22 : main_axis_o;
  wire [1:0] axis_24 = first_q[24] ? 2'd0 : first_q[25] ? 2'd1 : 2'd2;
  wire [1:0] next_24 = (main_axis_24 == 2'd2) ? 2'd0 : main_axis_24 + 2'd1;
  always @(posedge clk_i) begin
    origin_o <= {origin_24, origin_o[95:32]};
    backwards_o <= {backwards_24, backwards_o[2:1]};
    still_o <= {still_24, still_o[2:1]};
    reciprocal_o <= {reciprocal_24, reciprocal_o[3*BITS-1:BITS]};
    exponent_o <= {exponent_24, exponent_o[29:10]};
    padding_o <= {padding_24, padding_o[29:10]};
    padded_lower_o <= {padded_lower_24, padded_lower_o[95:32]};
    padded_upper_o <= {padded_upper_24, padded_upper_o[95:32]};
    inverse_o <= {inverse_24, inverse_o[95:32]};
    direction_o <= {direction_24, direction_o[104:35]};
    if (axis_24 == next_24) shear_o[31:0] <= aside_24;
    else if (axis_24 != main_axis_24) shear_o[63:32] <= aside_24;
  end
endmodule
`default_nettype wire
