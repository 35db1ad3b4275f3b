// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Chooses one of the requesters in rotation: the search starts behind the one that was chosen last, so that a requester
// that keeps asking is chosen before any other is chosen twice.
`default_nettype none
module rp_round_robin #(
  parameter integer COUNT = 4
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire [COUNT-1:0] request_i,
  input  wire             advance_i,   // the choice of this cycle is made use of: the next search starts behind it
  output wire [COUNT-1:0] grant_o      // one-hot, or zero without a request
);
  localparam [COUNT-1:0] ONE = 1;
  reg [COUNT-1:0] behind_q;  // the numbers behind the one chosen last
  wire [COUNT-1:0] behind = request_i & behind_q;
  // The first of those behind and the first of all are looked for side by side: requests may be known late.
  wire [COUNT-1:0] first_behind = behind & (~behind + ONE), first = request_i & (~request_i + ONE);
  assign grant_o = |behind ? first_behind : first;

  always @(posedge clk_i)
    if (!rst_ni) behind_q <= {COUNT{1'b1}};
    else if (advance_i && |request_i) behind_q <= ~(grant_o | (grant_o - ONE));
endmodule
`default_nettype wire
