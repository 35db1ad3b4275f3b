// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Gives each launch to one of 2 to 4 units that can take it: to one that runs no kernel, if there is
// one, otherwise to one with a free waiting place; in rotation among these. launch_ready_o and launch_unit_o do not
// depend on launch_valid_i.
`default_nettype none
module rp_block_scheduler #(
  parameter integer UNITS = 4
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire             launch_valid_i,
  output wire             launch_ready_o,
  output reg  [1:0]       launch_unit_o,   // that takes a launch in this cycle; meaningful while launch_ready_o
  // units
  input  wire [UNITS-1:0] ready_i,
  input  wire [UNITS-1:0] busy_i,          // a kernel runs
  output wire [UNITS-1:0] valid_o
);
  wire [UNITS-1:0] free = ready_i & ~busy_i;
  wire [UNITS-1:0] next;

  rp_round_robin #(.COUNT(UNITS)) round_robin (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(|free ? free : ready_i), .advance_i(launch_valid_i), .grant_o(next));

  assign launch_ready_o = |ready_i;
  assign valid_o = next & {UNITS{launch_valid_i}};

  integer u;
  always @* begin
    launch_unit_o = 2'd0;
    for (u = 0; u < UNITS; u = u + 1)
      if (next[u]) launch_unit_o = u[1:0];
  end
endmodule
`default_nettype wire
