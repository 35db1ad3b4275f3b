// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Grants one of the requesting warps a cycle, in rotation: the search starts behind the warp granted last, so that
// every request is granted within WARPS cycles, not counting those of first_i. A request of a warp in first_i is
// granted at once and leaves the rotation as it is.
`default_nettype none
module rp_fetch_arbiter #(
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = 3
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  input  wire [WARPS-1:0]     request_i,
  input  wire [WARPS-1:0]     first_i,   // one-hot, or zero
  output wire [WARPS-1:0]     grant_o,   // one-hot, or zero without a request
  output wire                 valid_o,
  output reg  [WARP_BITS-1:0] warp_o
);
  integer w;
  wire [WARPS-1:0] first = request_i & first_i;
  wire [WARPS-1:0] turn;
  assign valid_o = |request_i;
  assign grant_o = |first ? first : turn;

  rp_round_robin #(.COUNT(WARPS)) round_robin (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(request_i), .advance_i(!(|first)), .grant_o(turn));

  always @* begin
    warp_o = {WARP_BITS{1'b0}};
    for (w = 0; w < WARPS; w = w + 1)
      if (grant_o[w]) warp_o = w[WARP_BITS-1:0];
  end
endmodule
`default_nettype wire
