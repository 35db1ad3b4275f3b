// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The frame buffer's port: takes one contribution a cycle, a unit's where there is one, else the traverser's.
// docs/machine/frame-port.md gives its cycles.
// Promises: contributions leave in the order in which they came, unchanged; what is offered stays until it is taken; a
// unit's never waits for one of the traverser that has not been taken. No output depends on an input of the same cycle,
// but that traverser_ready_o is low while unit_valid_i is high.
// Must be given: what is offered stays as it is until it is taken.
`default_nettype none
module rp_frame_port (
  input  wire         clk_i,
  input  wire         rst_ni,
  // from the units
  input  wire         unit_valid_i,
  output wire         unit_ready_o,
  input  wire [31:0]  unit_pixel_i,
  input  wire [95:0]  unit_color_i,        // red in the low word
  input  wire [1:0]   unit_number_i,
  // from the traverser
  input  wire         traverser_valid_i,
  output wire         traverser_ready_o,
  input  wire [31:0]  traverser_pixel_i,
  input  wire [95:0]  traverser_color_i,
  // to the frame buffer
  output wire         frame_valid_o,
  input  wire         frame_ready_i,
  output wire [31:0]  frame_pixel_o,
  output wire [95:0]  frame_color_o,
  // for the controller: the cycle after a unit's contribution has been taken
  output reg          exported_valid_o,
  output reg  [1:0]   exported_unit_o,
  output reg  [31:0]  exported_pixel_o,
  // for the report, right two cycles after the last event
  output wire [47:0]  taken_o
);
  wire [1:0] count;
  wire room = count != 2'd2;
  assign unit_ready_o = room;
  assign traverser_ready_o = room && !unit_valid_i;
  wire take = room && (unit_valid_i || traverser_valid_i);

  // Two places: one is filled while the other one leaves.
  rp_request_queue #(.WIDTH(128), .DEPTH(2)) contributions (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(take),
    .data_i(unit_valid_i ? {unit_color_i, unit_pixel_i} : {traverser_color_i, traverser_pixel_i}),
    .valid_o(frame_valid_o),
    .ready_i(frame_ready_i),
    .data_o({frame_color_o, frame_pixel_o}),
    .count_o(count)
  );

  always @(posedge clk_i)
    if (!rst_ni) exported_valid_o <= 1'b0;
    else exported_valid_o <= unit_valid_i && unit_ready_o;
  always @(posedge clk_i)
    if (unit_valid_i && unit_ready_o) begin
      exported_unit_o <= unit_number_i;
      exported_pixel_o <= unit_pixel_i;
    end

  wire [12:0] unused;
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) taken (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(take), .value_o(taken_o), .pending_o(unused));
endmodule
`default_nettype wire
