// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Joins the import ports of 2 to 4 units: requests leave in rotation, a package at a time, and their beats, which come
// back in the order of the requests, go to the units that asked.
// Promises: at most 3 packages are requested and not yet received. Must be given: for each request taken, in
// order, as many beats as INTERSECTION_WORDS need, from the next cycle on.
`default_nettype none
module rp_import_arbiter #(
  parameter integer UNITS = 4,
  parameter integer INTERSECTION_WORDS = 21
) (
  input  wire               clk_i,
  input  wire               rst_ni,
  // units
  input  wire [UNITS-1:0]   unit_request_valid_i,
  output wire [UNITS-1:0]   unit_request_ready_o,
  input  wire [UNITS*2-1:0] unit_request_kind_i,
  output wire [UNITS-1:0]   unit_beat_valid_o,
  // the pool's port
  output wire               request_valid_o,
  input  wire               request_ready_i,
  output wire [1:0]         request_kind_o,
  output wire [1:0]         request_unit_o,
  input  wire               beat_valid_i
);
  localparam integer PLACES = 3;
  localparam integer LAST_BEAT = (INTERSECTION_WORDS + 3) / 4 - 1;

  // The units that still await packages, in order; no request leaves while the queue is full.
  wire expected;
  wire [1:0] receiver, count;
  wire open = count != PLACES[1:0];
  rp_port_arbiter #(.COUNT(UNITS), .WIDTH(2)) port_arbiter (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(unit_request_valid_i & {UNITS{open}}),
    .ready_o(unit_request_ready_o),
    .data_i(unit_request_kind_i),
    .last_i({UNITS{1'b1}}),
    .valid_o(request_valid_o),
    .ready_i(request_ready_i),
    .data_o(request_kind_o),
    .number_o(request_unit_o)
  );

  reg [2:0] beat_q;
  wire beat = beat_valid_i && expected;
  wire package_end = beat && beat_q == LAST_BEAT[2:0];
  rp_request_queue #(.WIDTH(2), .DEPTH(PLACES)) order (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(request_valid_o && request_ready_i),
    .data_i(request_unit_o),
    .valid_o(expected),
    .ready_i(package_end),
    .data_o(receiver),
    .count_o(count)
  );

  always @(posedge clk_i)
    if (!rst_ni) beat_q <= 3'd0;
    else if (beat) beat_q <= package_end ? 3'd0 : beat_q + 3'd1;

  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      localparam [1:0] UNIT = u;
      assign unit_beat_valid_o[u] = beat && receiver == UNIT;
    end
  endgenerate
endmodule
`default_nettype wire
