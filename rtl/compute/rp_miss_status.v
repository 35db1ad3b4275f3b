// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Miss-status holding registers (MSHRs) of the data cache: which lines are being fetched, into which
// way, and which warps wait for them.
// Promises: a line has at most one register, and a way of a set is promised to at most one register. A register
// is busy from its allocation until all its waiters are served, so a fetched line stays in the cache until every
// warp that waited for it has read it.
// Must be given: join_i, allocate_i only as match_o, available_o and locked_o of the same cycle allow.
`default_nettype none
module rp_miss_status #(
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer MSHRS = 4,
  parameter integer MSHR_BITS = (MSHRS > 1) ? $clog2(MSHRS) : 1,
  parameter integer SET_BITS = 6
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  // the access of this cycle
  input  wire                   access_i,
  input  wire [25:0]            access_line_i,
  input  wire [WARP_BITS-1:0]   access_warp_i,
  output reg                    match_o,          // its line is being fetched
  output reg                    available_o,      // a register is free
  output reg  [MSHR_BITS-1:0]   available_id_o,
  output reg  [1:0]             locked_o,         // ways of its set that are promised to a register
  input  wire                   join_i,           // the warp waits for the matching register
  input  wire                   allocate_i,       // the warp takes the free register
  input  wire                   allocate_way_i,
  // refill
  input  wire                   fill_i,
  input  wire [MSHR_BITS-1:0]   fill_id_i,
  input  wire                   fill_last_i,      // with fill_i: the line is complete after this cycle
  output reg  [25:0]            fill_line_o,
  output reg                    fill_way_o,
  // replay: this warp has been served everything it waited for in this register
  input  wire                   served_i,
  input  wire [MSHR_BITS-1:0]   served_id_i,
  input  wire [WARP_BITS-1:0]   served_warp_i,
  output wire                   freed_o,          // a register is free from the next cycle on
  output wire                   idle_o,           // all are free
  output wire [MSHRS-1:0]       filled_o,         // line complete, waiters being served
  output wire [MSHRS*26-1:0]    line_o,
  output wire [MSHRS*WARPS-1:0] waiters_o
);
  localparam [WARPS-1:0] ONE = 1;

  reg [MSHRS-1:0] busy_q;
  reg [MSHRS-1:0] filled_q;
  reg [MSHRS-1:0] way_q;
  reg [MSHRS*26-1:0] line_q;
  reg [MSHRS*WARPS-1:0] waiters_q;

  assign idle_o = busy_q == {MSHRS{1'b0}};
  assign filled_o = filled_q;
  assign line_o = line_q;
  assign waiters_o = waiters_q;

  reg [MSHRS-1:0] match;
  integer a;
  always @* begin
    match = {MSHRS{1'b0}};
    locked_o = 2'b00;
    available_o = 1'b0;
    available_id_o = {MSHR_BITS{1'b0}};
    if (access_i) begin
      for (a = MSHRS - 1; a >= 0; a = a - 1) begin
        if (busy_q[a]) begin
          match[a] = !filled_q[a] && line_q[a*26 +: 26] == access_line_i;
          if (line_q[a*26 +: SET_BITS] == access_line_i[SET_BITS-1:0]) locked_o[way_q[a]] = 1'b1;
        end else begin
          available_o = 1'b1;
          available_id_o = a[MSHR_BITS-1:0];
        end
      end
    end
    match_o = |match;
  end

  integer f;
  always @* begin
    fill_line_o = 26'd0;
    fill_way_o = 1'b0;
    if (fill_i)
      for (f = 0; f < MSHRS; f = f + 1)
        if (fill_id_i == f[MSHR_BITS-1:0]) begin
          fill_line_o = line_q[f*26 +: 26];
          fill_way_o = way_q[f];
        end
  end

  reg [MSHRS-1:0] finished;
  integer n;
  always @* begin
    finished = filled_q;
    if (|filled_q)
      for (n = 0; n < MSHRS; n = n + 1)
        if (|waiters_q[n*WARPS +: WARPS]) finished[n] = 1'b0;
  end
  assign freed_o = |finished;

  integer m;
  always @(posedge clk_i) begin
    if (!rst_ni) begin
      busy_q <= {MSHRS{1'b0}};
      filled_q <= {MSHRS{1'b0}};
    end else begin
      if (allocate_i) busy_q[available_id_o] <= 1'b1;
      if (fill_i && fill_last_i) filled_q[fill_id_i] <= 1'b1;
      for (m = 0; m < MSHRS; m = m + 1)
        if (finished[m]) begin
          busy_q[m] <= 1'b0;
          filled_q[m] <= 1'b0;
        end
    end
  end

  integer w;
  always @(posedge clk_i) begin
    if (allocate_i || join_i || served_i) begin
      for (w = 0; w < MSHRS; w = w + 1) begin
        if (allocate_i && available_id_o == w[MSHR_BITS-1:0]) begin
          line_q[w*26 +: 26] <= access_line_i;
          way_q[w] <= allocate_way_i;
          waiters_q[w*WARPS +: WARPS] <= ONE << access_warp_i;
        end
        if (join_i && match[w])
          waiters_q[w*WARPS +: WARPS] <= waiters_q[w*WARPS +: WARPS] | (ONE << access_warp_i);
        if (served_i && served_id_i == w[MSHR_BITS-1:0])
          waiters_q[w*WARPS +: WARPS] <= waiters_q[w*WARPS +: WARPS] & ~(ONE << served_warp_i);
      end
    end
  end
endmodule
`default_nettype wire
