// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Whether and where a ray hits a triangle, from the triangle's plane: docs/machine/triangle-test.md defines it.
// A test a cycle, its result 30 + BITS / 2 cycles later; it never waits. Tests of one ray may follow each other at
// once: what may change, its best hit, each is given in the cycle before its result, so the answer must take the result
// that is shown then into account. Each asks a cycle before it is answered. Must be given: corners, and what the set-up
// of a valid ray has, so that no difference is infinite; a limit above zero, and a best hit that is not before zero.
`default_nettype none
module rp_triangle_pipe #(
  parameter integer BITS = 32,        // of the significands of t
  parameter integer TAG_BITS = 8
) (
  input  wire                clk_i,
  input  wire                rst_ni,
  input  wire                valid_i,
  input  wire [TAG_BITS-1:0] tag_i,           // which ray
  // the triangle, and the ray as its set-up has it
  input  wire [287:0]        corners_i,       // corner 0 first, x first
  input  wire [31:0]         number_i,
  input  wire [95:0]         origin_i,
  input  wire [95:0]         padded_lower_i,  // what is subtracted from lower planes
  input  wire [95:0]         padded_upper_i,
  input  wire [95:0]         inverse_i,       // of the direction
  input  wire [1:0]          main_axis_i,
  input  wire [63:0]         shear_i,
  input  wire [104:0]        direction_i,     // sign, 11 bits of exponent, 23 of fraction; x first
  // five cycles before its result a test asks for its ray's limit, and is answered in the next cycle
  output wire                asks_limit_o,
  output wire [TAG_BITS-1:0] limit_tag_o,
  input  wire [31:0]         limit_i,
  input  wire signed [8:0]   scale_i,         // the ray's t is internal t x 2^scale
  // two cycles before it, for its best hit so far
  output wire                asks_best_o,
  output wire [TAG_BITS-1:0] best_tag_o,
  input  wire [31:0]         best_t_i,        // internal
  input  wire [31:0]         best_number_i,
  output reg                 valid_o,
  output wire [TAG_BITS-1:0] tag_o,
  output wire [31:0]         number_o,
  output reg                 hit_o,           // this is the ray's best hit from now on
  output wire [31:0]         t_o              // internal, where hit_o is set
);
  localparam integer T = 24 + BITS / 2;       // cycles until t is there
  localparam integer ASKS_LIMIT = T + 1, ASKS_BEST = T + 4, END = T + 6;

  // ---- What goes along
  reg [END-2:0] valid_q;
  always @(posedge clk_i)
    if (!rst_ni) {valid_o, valid_q} <= {END{1'b0}};
    else {valid_o, valid_q} <= {valid_q, valid_i};
  assign asks_limit_o = valid_q[ASKS_LIMIT-1];
  assign asks_best_o = valid_q[ASKS_BEST-1];
  wire [31:0] number_asks, number_asks_best, number_best;
  wire [TAG_BITS-1:0] tag_best;
  rp_steady_delay #(.WIDTH(TAG_BITS+32), .CYCLES(ASKS_LIMIT)) tag_delay (.clk_i(clk_i), .data_i({tag_i, number_i}),
    .data_o({limit_tag_o, number_asks}));
  rp_steady_delay #(.WIDTH(TAG_BITS+32), .CYCLES(3)) best_tag_delay (.clk_i(clk_i), .data_i({limit_tag_o, number_asks}),
    .data_o({best_tag_o, number_asks_best}));
  rp_steady_delay #(.WIDTH(TAG_BITS+32)) told_tag_delay (.clk_i(clk_i), .data_i({best_tag_o, number_asks_best}),
    .data_o({tag_best, number_best}));
  rp_steady_delay #(.WIDTH(TAG_BITS+32)) end_tag_delay (.clk_i(clk_i), .data_i({tag_best, number_best}),
    .data_o({tag_o, number_o}));

  // ---- 1: from here on the triangle is wanted in many places
  wire [287:0] corners;
  wire [95:0] origin, padded_lower, padded_upper, inverse;
  wire [1:0] main_axis;
  wire [63:0] shear;
  wire [104:0] direction;
  rp_steady_delay #(.WIDTH(843)) begin_delay (.clk_i(clk_i),
    .data_i({corners_i, origin_i, padded_lower_i, padded_upper_i, inverse_i, main_axis_i, shear_i, direction_i}),
    .data_o({corners, origin, padded_lower, padded_upper, inverse, main_axis, shear, direction}));

  // ---- The parts, and their results in the cycle of t
  wire [104:0] main_direction = direction >> ((main_axis == 2'd2) ? 7'd70 : (main_axis == 2'd1) ? 7'd35 : 7'd0);
  wire [95:0] x, y;
  wire [2:0] in_front;
  rp_triangle_view view (
    .clk_i(clk_i),
    .corners_i(corners),
    .origin_i(origin),
    .main_axis_i(main_axis),
    .backwards_i(main_direction[34]),
    .shear_i(shear),
    .x_o(x),
    .y_o(y),
    .in_front_o(in_front)
  );
  wire inside, edges_ready, edges_valid;
  wire [2:0] negative, zero;
  rp_triangle_edges edges (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(1'b1),
    .ready_o(edges_ready),
    .x_i(x),
    .y_i(y),
    .valid_o(edges_valid),
    .ready_i(1'b1),
    .negative_o(negative),
    .zero_o(zero),
    .inside_o(inside)
  );
  wire unused = &{1'b0, main_direction, edges_ready, edges_valid, negative, zero, best_t_i[31]};
  wire all_front, some_front, inside_t, all_front_t;
  rp_steady_delay #(.WIDTH(2), .CYCLES(5)) front_delay (.clk_i(clk_i), .data_i({in_front != 3'd0, in_front == 3'd7}),
    .data_o({some_front, all_front}));
  rp_steady_delay #(.WIDTH(2), .CYCLES(T-16)) inside_delay (.clk_i(clk_i), .data_i({inside && some_front, all_front}),
    .data_o({inside_t, all_front_t}));
  wire [30:0] near, far, near_t, far_t;
  wire met, met_t;
  rp_triangle_interval interval (
    .clk_i(clk_i),
    .corners_i(corners),
    .padded_lower_i(padded_lower),
    .padded_upper_i(padded_upper),
    .inverse_i(inverse),
    .near_o(near),
    .far_o(far),
    .met_o(met)
  );
  rp_steady_delay #(.WIDTH(63), .CYCLES(T-15)) interval_delay (.clk_i(clk_i), .data_i({near, far, met}),
    .data_o({near_t, far_t, met_t}));
  wire [31:0] t;
  rp_triangle_plane #(.BITS(BITS)) plane (.clk_i(clk_i), .corners_i(corners), .origin_i(origin),
    .direction_i(direction), .t_o(t));

  // ---- One cycle more: what lies in front is hit, whatever rounding has made of its plane; two: t in the box
  wire not_a_number = t[30:23] == 8'd255 && t[22:0] != 23'd0;
  wire positive = !t[31] && t[30:0] != 31'd0 && !not_a_number;
  reg met_1, met_2;
  reg [30:0] t_1, near_1, far_1, t_2;
  always @(posedge clk_i) begin
    met_1 <= inside_t && met_t && (positive || all_front_t);
    t_1 <= positive ? t[30:0] : 31'd1;
    near_1 <= near_t;
    far_1 <= far_t;
    met_2 <= met_1;
    t_2 <= (t_1 < near_1) ? near_1 : (t_1 > far_1) ? far_1 : t_1;
  end

  // ---- The ray's t, and its limit: t is finite, as the box is left along the main axis. 3: exponent; 4: place of a
  // subnormal number; 5: comparison with the limit, which is one less where t is rounded up
  // As normaliser does it: mapped in one piece with what is added it is faster.
  reg [23:0] moved;
  reg [4:0] places;
  integer step;
  always @* begin
    moved = {t_2[30:23] != 8'd0, t_2[22:0]};
    places = 5'd0;
    for (step = 4; step >= 0; step = step - 1)
      if (moved >> (24 - (1 << step)) == 24'd0) begin
        moved = moved << (1 << step);
        places[step] = 1'b1;
      end
  end
  reg [23:0] significand_3;
  reg signed [10:0] exponent_3;       // as it is stored; below 1: subnormal
  reg [31:0] limit_3, limit_4;
  reg [30:0] before_limit_4, t_4;
  reg met_3, guard_4, rest_4, met_4, met_5;
  wire [10:0] below = 11'd1 - exponent_3;
  wire subnormal = !below[10] && below != 11'd0;
  wire [4:0] distance = !subnormal ? 5'd0 : (below[9:5] != 5'd0) ? 5'd31 : below[4:0];
  wire [54:0] placed = {significand_3, 31'd0} >> distance;   // 24 bits, and what is rounded off
  wire unused_place = &{1'b0, placed[54]};
  wire up_4 = guard_4 && (rest_4 || t_4[0]);
  always @(posedge clk_i) begin
    met_3 <= met_2;
    significand_3 <= moved;
    exponent_3 <= ($signed({3'd0, (t_2[30:23] != 8'd0) ? t_2[30:23] : 8'd1}) + $signed({{2{scale_i[8]}}, scale_i})) -
                  $signed({6'd0, places});
    limit_3 <= limit_i;
    met_4 <= met_3 && significand_3[23];
    limit_4 <= limit_3;
    before_limit_4 <= limit_3[30:0] - 31'd1;
    t_4 <= (!exponent_3[10] && exponent_3 >= 11'sd255) ? 31'h7f800000 :
           {subnormal ? 8'd0 : exponent_3[7:0], placed[53:31]};
    guard_4 <= placed[30];
    rest_4 <= placed[29:0] != 30'd0;
    met_5 <= met_4 && (t_4 != 31'd0 || up_4) && !limit_4[31] && t_4 < (up_4 ? before_limit_4 : limit_4[30:0]);
  end

  // ---- 6: the best hit
  wire [30:0] t_5, t_6;
  rp_steady_delay #(.WIDTH(31), .CYCLES(3)) t_delay (.clk_i(clk_i), .data_i(t_2), .data_o(t_5));
  rp_steady_delay #(.WIDTH(31)) end_t_delay (.clk_i(clk_i), .data_i(t_5), .data_o(t_6));
  assign t_o = {1'b0, t_6};
  always @(posedge clk_i)
    hit_o <= met_5 && (t_5 < best_t_i[30:0] || (t_5 == best_t_i[30:0] && number_best < best_number_i));
endmodule
`default_nettype wire
