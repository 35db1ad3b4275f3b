// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Each cycle, gives every free ALU instance the lowest-numbered warp that wants its type and was given none yet. Never
// grants an instance that is not ready, nor a warp twice. What the warp offers is taken over by the instance's task
// register. With OVERLAP, warps in first_i go before all others.
`default_nettype none
module rp_dispatcher #(
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = 3,
  parameter integer INSTANCES = 7,
  parameter [INSTANCES*4-1:0] INSTANCE_TYPES = 28'h6543210,
  parameter integer OVERLAP = 0
) (
  // warps
  input  wire [WARPS-1:0]               want_i,
  input  wire [WARPS*4-1:0]             type_i,           // which each of them wants
  input  wire [WARPS-1:0]               first_i,
  output reg  [WARPS-1:0]               grant_o,
  output wire [WARPS-1:0]               waiting_o,        // those that want and are granted none
  // instances
  input  wire [INSTANCES-1:0]           ready_i,
  output reg  [INSTANCES-1:0]           instance_grant_o,
  output reg  [INSTANCES*WARP_BITS-1:0] instance_warp_o
);
  localparam [WARPS-1:0] ONE = 1;
  wire [WARPS-1:0] first = OVERLAP != 0 ? first_i : {WARPS{1'b0}};
  reg [WARPS-1:0] candidates, winner;
  integer i, w;

  always @* begin
    grant_o = {WARPS{1'b0}};
    instance_grant_o = {INSTANCES{1'b0}};
    instance_warp_o = {INSTANCES*WARP_BITS{1'b0}};
    candidates = {WARPS{1'b0}};
    winner = {WARPS{1'b0}};
    if (|want_i)
      for (i = 0; i < INSTANCES; i = i + 1)
        if (ready_i[i]) begin
          for (w = 0; w < WARPS; w = w + 1)
            candidates[w] = want_i[w] && !grant_o[w] && type_i[w*4 +: 4] == INSTANCE_TYPES[i*4 +: 4];
          if (|(candidates & first)) candidates = candidates & first;
          winner = candidates & (~candidates + ONE);
          grant_o = grant_o | winner;
          instance_grant_o[i] = |candidates;
          for (w = 0; w < WARPS; w = w + 1)
            if (winner[w]) instance_warp_o[i*WARP_BITS +: WARP_BITS] = w[WARP_BITS-1:0];
        end
  end

  assign waiting_o = want_i & ~grant_o;
endmodule
`default_nettype wire
