// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which warp's memory task goes through the cache next: the state of every warp that has a task which is not in the
// pipeline. A warp is queued (new, not started) or parked (lanes are left). A parked warp waits for lines in
// miss-status holding registers, or was refused one (it is a loser), or both. One pass is prepared at a time; the order
// is: waiters of a line that has come, the privileged loser, new tasks.
// Fairness: while a loser has the privilege only it may take a register. It tries when it gets the privilege and
// whenever a register becomes free, keeps the privilege until it got one or needs none, and then the next loser, round
// robin, has it. So every loser takes its turn.
// Must be given: a warp parks only after the end of its pass (pass_end_i), at the earliest one cycle after.
`default_nettype none
module rp_memory_sequencer #(
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer MSHRS = 4,
  parameter integer MSHR_BITS = (MSHRS > 1) ? $clog2(MSHRS) : 1
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   queue_i,            // a new task that cannot start at once
  input  wire [WARP_BITS-1:0]   queue_warp_i,
  input  wire                   park_i,
  input  wire [WARP_BITS-1:0]   park_warp_i,
  input  wire                   pass_end_i,         // last access of a pass
  input  wire [WARP_BITS-1:0]   pass_warp_i,
  input  wire                   pass_refused_i,     // it leaves lanes that were refused
  input  wire                   pass_allocated_i,   // it took a register
  input  wire [MSHRS-1:0]       filled_i,
  input  wire [MSHRS*WARPS-1:0] waiters_i,
  input  wire                   freed_i,
  // the pass chosen in this cycle: its context is read now
  output reg                    select_o,
  output reg  [WARP_BITS-1:0]   select_warp_o,
  // the pass that is ready to start; its context has been read
  output wire                   next_valid_o,
  output wire [1:0]             next_kind_o,        // 0 new, 1 a line has come, 2 privileged loser
  output wire [WARP_BITS-1:0]   next_warp_o,
  output wire [MSHR_BITS-1:0]   next_mshr_o,        // of kind 1
  input  wire                   next_take_i,
  output wire                   queue_empty_o,
  output wire                   privilege_o,        // only privilege_warp_o may take a register
  output wire [WARP_BITS-1:0]   privilege_warp_o,
  output wire                   idle_o              // no warp is queued, parked or about to start
);
  localparam [1:0] KIND_NEW = 2'd0;
  localparam [1:0] KIND_FILLED = 2'd1;
  localparam [1:0] KIND_LOSER = 2'd2;
  localparam [WARPS-1:0] ONE = 1;

  reg [WARPS-1:0]     queued_q;
  reg [WARPS-1:0]     parked_q;
  reg [WARPS-1:0]     loser_q;
  reg                 privilege_q;
  reg [WARP_BITS-1:0] privilege_warp_q;
  reg                 attempt_q;        // the privileged loser has not tried since a register became free
  reg                 next_valid_q;
  reg [1:0]           next_kind_q;
  reg [WARP_BITS-1:0] next_warp_q;
  reg [MSHR_BITS-1:0] next_mshr_q;

  assign next_valid_o = next_valid_q;
  assign next_kind_o = next_kind_q;
  assign next_warp_o = next_warp_q;
  assign next_mshr_o = next_mshr_q;
  assign queue_empty_o = queued_q == {WARPS{1'b0}};
  assign privilege_o = privilege_q;
  assign privilege_warp_o = privilege_warp_q;
  assign idle_o = queue_empty_o && parked_q == {WARPS{1'b0}} && !next_valid_q;

  // Number of the lowest bit that is set.
  function [WARP_BITS-1:0] lowest;
    input [WARPS-1:0] bits;
    reg [WARPS-1:0] first;
    integer i;
    begin
      first = bits & (~bits + ONE);
      lowest = {WARP_BITS{1'b0}};
      for (i = 0; i < WARPS; i = i + 1)
        if (first[i]) lowest = lowest | i[WARP_BITS-1:0];
    end
  endfunction

  // Bits above number `last`, or all when there is none.
  function [WARPS-1:0] after;
    input [WARPS-1:0] bits;
    input [WARP_BITS-1:0] last;
    integer i;
    begin
      after = bits;
      for (i = 0; i < WARPS; i = i + 1)
        if (i[WARP_BITS-1:0] <= last) after[i] = 1'b0;
      if (after == {WARPS{1'b0}}) after = bits;
    end
  endfunction

  reg [1:0]           select_kind;
  reg [MSHR_BITS-1:0] select_mshr;
  reg [WARPS-1:0]     candidates;
  integer m;
  always @* begin
    select_o = 1'b0;
    select_kind = KIND_NEW;
    select_mshr = {MSHR_BITS{1'b0}};
    candidates = {WARPS{1'b0}};
    if (!next_valid_q) begin
      if (filled_i != {MSHRS{1'b0}})
        for (m = MSHRS - 1; m >= 0; m = m - 1)
          if (filled_i[m] && |(waiters_i[m*WARPS +: WARPS] & parked_q)) begin
            select_o = 1'b1;
            select_kind = KIND_FILLED;
            select_mshr = m[MSHR_BITS-1:0];
            candidates = waiters_i[m*WARPS +: WARPS] & parked_q;
          end
      if (!select_o && privilege_q && attempt_q && loser_q[privilege_warp_q] && parked_q[privilege_warp_q]) begin
        select_o = 1'b1;
        select_kind = KIND_LOSER;
      end else if (!select_o && !queue_empty_o) begin
        select_o = 1'b1;
        candidates = queued_q;
      end
    end
    select_warp_o = lowest(candidates);
    if (select_kind == KIND_LOSER) select_warp_o = privilege_warp_q;
  end

  wire pass_of_privileged = pass_end_i && privilege_q && pass_warp_i == privilege_warp_q;

  always @(posedge clk_i) begin
    if (!rst_ni) begin
      queued_q <= {WARPS{1'b0}};
      parked_q <= {WARPS{1'b0}};
      loser_q <= {WARPS{1'b0}};
      privilege_q <= 1'b0;
      privilege_warp_q <= {WARP_BITS{1'b0}};
      attempt_q <= 1'b0;
      next_valid_q <= 1'b0;
    end else begin
      if (queue_i) queued_q[queue_warp_i] <= 1'b1;
      if (park_i) parked_q[park_warp_i] <= 1'b1;
      if (pass_end_i) loser_q[pass_warp_i] <= pass_refused_i;
      if (next_take_i) next_valid_q <= 1'b0;
      if (select_o) begin
        next_valid_q <= 1'b1;
        if (select_kind == KIND_NEW) queued_q[select_warp_o] <= 1'b0;
        else parked_q[select_warp_o] <= 1'b0;
        if (select_kind == KIND_LOSER) attempt_q <= 1'b0;
      end
      if (privilege_q) begin
        if (freed_i) attempt_q <= 1'b1;
        if ((pass_of_privileged && pass_allocated_i) || !loser_q[privilege_warp_q]) privilege_q <= 1'b0;
      end else if (loser_q != {WARPS{1'b0}}) begin
        privilege_q <= 1'b1;
        privilege_warp_q <= lowest(after(loser_q, privilege_warp_q));
        attempt_q <= 1'b1;
      end
    end
    if (select_o) begin
      next_kind_q <= select_kind;
      next_warp_q <= select_warp_o;
      next_mshr_q <= select_mshr;
    end
  end
endmodule
`default_nettype wire
