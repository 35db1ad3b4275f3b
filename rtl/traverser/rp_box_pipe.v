// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which of the four boxes of a node of 64 bytes a ray meets, in narrow integers that are rounded so that no box is
// missed; docs/machine/box-test.md proves it. A node a cycle, its result eight moves later.
// Promises: it moves unless a result is there and is not taken; no box that is not there is met; no output but ready_o
// depends on an input of the same cycle.
// Must be given: floats that are finite; lower planes not above upper ones; reciprocals that begin with a 1.
`default_nettype none
module rp_box_pipe #(
  parameter integer BITS = 12,                   // of a reciprocal and of a key's significand
  parameter integer KEY_BITS = BITS + 9
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire                  valid_i,
  output wire                  ready_o,
  // the node, as its 64 bytes have it
  input  wire [95:0]           grid_i,           // origin, x first
  input  wire [23:0]           step_i,           // exponents
  input  wire [2:0]            children_i,
  input  wire [95:0]           lower_i,          // planes: x of four boxes first
  input  wire [95:0]           upper_i,
  // the ray, as its set-up has it
  input  wire [95:0]           origin_i,
  input  wire [2:0]            backwards_i,
  input  wire [2:0]            still_i,
  input  wire [3*BITS-1:0]     reciprocal_i,
  input  wire [29:0]           exponent_i,
  input  wire [29:0]           padding_i,
  input  wire [KEY_BITS-1:0]   limit_i,          // or of its best hit
  output reg                   valid_o,
  input  wire                  ready_i,
  output reg  [3:0]            met_o,
  output reg  [4*KEY_BITS-1:0] entry_o
);
  generate
    if (BITS < 6 || BITS > 16) begin : gen_bad_bits
      box_pipe_BITS_must_be_from_6_to_16 illegal ();
    end
  endgenerate
  wire move = !valid_o || ready_i;
  assign ready_o = move;

  wire [12*KEY_BITS-1:0] near, far;              // x of four boxes first
  wire [11:0] missed;
  genvar a, g;
  generate
    for (a = 0; a < 3; a = a + 1) begin : gen_axis
      rp_box_axis #(.BITS(BITS)) box_axis (
        .clk_i(clk_i),
        .move_i(move),
        .grid_i(grid_i[32*a+:32]),
        .step_i(step_i[8*a+:8]),
        .lower_i(lower_i[32*a+:32]),
        .upper_i(upper_i[32*a+:32]),
        .origin_i(origin_i[32*a+:32]),
        .backwards_i(backwards_i[a]),
        .still_i(still_i[a]),
        .reciprocal_i(reciprocal_i[BITS*a+:BITS]),
        .exponent_i(exponent_i[10*a+:10]),
        .padding_i(padding_i[10*a+:10]),
        .near_o(near[4*KEY_BITS*a+:4*KEY_BITS]),
        .far_o(far[4*KEY_BITS*a+:4*KEY_BITS]),
        .missed_o(missed[4*a+:4])
      );
    end
  endgenerate

  // What each stage has loaded, the first one in the lowest bits.
  reg [6:0] valid_q;
  always @(posedge clk_i)
    if (!rst_ni) {valid_o, valid_q} <= 8'd0;
    else if (move) {valid_o, valid_q} <= {valid_q, valid_i};
  reg [7*KEY_BITS-1:0] limit_q;
  reg [7*3-1:0] children_q;
  wire [KEY_BITS-1:0] limit_7 = limit_q[6*KEY_BITS+:KEY_BITS];
  wire [2:0] children_7 = children_q[6*3+:3];
  wire [3:0] there = {children_7 > 3'd3, children_7 > 3'd2, children_7 > 3'd1, children_7 > 3'd0};
  always @(posedge clk_i)
    if (move) begin
      limit_q <= {limit_q[6*KEY_BITS-1:0], limit_i};
      children_q <= {children_q[6*3-1:0], children_i};
    end

  generate
    for (g = 0; g < 4; g = g + 1) begin : gen_box
      wire [KEY_BITS-1:0] near_x = near[g*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] near_y = near[(4+g)*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] near_z = near[(8+g)*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] near_xy = (near_x > near_y) ? near_x : near_y;
      wire [KEY_BITS-1:0] far_x = far[g*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] far_y = far[(4+g)*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] far_z = far[(8+g)*KEY_BITS+:KEY_BITS];
      wire [KEY_BITS-1:0] far_xy = (far_x < far_y) ? far_x : far_y;
      wire [KEY_BITS-1:0] far_zl = (far_z < limit_7) ? far_z : limit_7;
      // Each entry is compared with each exit, as the last entry and the first exit are known too late.
      wire overlap = near_xy <= far_xy && near_xy <= far_zl && near_z <= far_xy && near_z <= far_zl;
      always @(posedge clk_i)
        if (move) begin
          entry_o[g*KEY_BITS+:KEY_BITS] <= (near_xy > near_z) ? near_xy : near_z;
          met_o[g] <= there[g] && !(missed[g] || missed[4+g] || missed[8+g]) && overlap;
        end
    end
  endgenerate
endmodule
`default_nettype wire
