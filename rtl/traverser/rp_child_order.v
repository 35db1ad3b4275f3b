// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The children of a node that a ray meets, the nearest first: with that one the ray goes on, the others are put on its
// stack, the furthest first. Of two that are entered at the same time the one with the higher number is the nearer.
// All outputs come in the next cycle.
`default_nettype none
module rp_child_order #(
  parameter integer KEY_BITS = 21,
  parameter integer REFERENCE_BITS = 32,
  parameter integer ENTRY_BITS = KEY_BITS + REFERENCE_BITS
) (
  input  wire                        clk_i,
  input  wire [3:0]                  met_i,
  input  wire [4*KEY_BITS-1:0]       entry_i,      // keys of the times
  input  wire [4*REFERENCE_BITS-1:0] reference_i,
  output reg  [2:0]                  children_o,   // how many are met
  output reg  [REFERENCE_BITS-1:0]   nearest_o,
  output reg  [3*ENTRY_BITS-1:0]     others_o      // as lane_stacks takes them: the furthest in the lowest bits
);
  // Of each child: those that are nearer.
  reg [15:0] nearer;                              // four bits each
  integer i, j;
  always @* begin
    for (i = 0; i < 4; i = i + 1) begin
      for (j = 0; j < 4; j = j + 1)
        if (j == i) nearer[4*i+j] = 1'b0;
        else
          nearer[4*i+j] = met_i[j] && ((j > i) ? entry_i[j*KEY_BITS+:KEY_BITS] <= entry_i[i*KEY_BITS+:KEY_BITS] :
                                                entry_i[j*KEY_BITS+:KEY_BITS] < entry_i[i*KEY_BITS+:KEY_BITS]);
    end
  end
  function [2:0] count(input [3:0] bits);
    count = {2'd0, bits[0]} + {2'd0, bits[1]} + {2'd0, bits[2]} + {2'd0, bits[3]};
  endfunction

  wire [2:0] children = count(met_i);
  reg [2:0] rank;
  reg [REFERENCE_BITS-1:0] nearest;
  reg [3*ENTRY_BITS-1:0] others;
  integer c, place;
  always @* begin
    nearest = {REFERENCE_BITS{1'b0}};
    others = {3*ENTRY_BITS{1'b0}};
    for (c = 0; c < 4; c = c + 1) begin
      rank = count(nearer[4*c+:4]);
      if (met_i[c] && rank == 3'd0) nearest = nearest | reference_i[c*REFERENCE_BITS+:REFERENCE_BITS];
      for (place = 0; place < 3; place = place + 1)
        if (met_i[c] && rank != 3'd0 && children - rank == place[2:0] + 3'd1)
          others[place*ENTRY_BITS+:ENTRY_BITS] = others[place*ENTRY_BITS+:ENTRY_BITS] |
            {entry_i[c*KEY_BITS+:KEY_BITS], reference_i[c*REFERENCE_BITS+:REFERENCE_BITS]};
    end
  end
  always @(posedge clk_i) begin
    children_o <= children;
    nearest_o <= nearest;
    others_o <= others;
  end
endmodule
`default_nettype wire
