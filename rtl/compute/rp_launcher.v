// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Takes launches: one may wait while a kernel runs. Starts the warps, detects the end of the kernel.
// With OVERLAP a launch begins as soon as no more than one kernel runs and all warps of that one have started. Each of
// its warps starts when it has ended in the kernel before. So two kernels may run; the older one ends first.
`default_nettype none
module rp_launcher #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer OVERLAP = 0
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   launch_valid_i,
  output wire                   launch_ready_o,
  input  wire [15:0]            launch_pc_i,
  input  wire [10:0]            launch_threads_i,
  input  wire [31:0]            launch_block_i,
  input  wire [31:0]            launch_blocks_i,
  input  wire [1:0]             launch_import_i,
  // the ray ALU's import engine
  output wire                   import_start_o,
  input  wire                   import_active_i,
  // warps
  output wire [WARPS-1:0]       start_o,
  output wire [15:0]            start_pc_o,
  output wire [WARPS*LANES-1:0] start_lanes_o,
  input  wire [WARPS-1:0]       active_i,
  // the launches that run
  output wire [WARPS-1:0]       launched_o,     // has threads of one of them
  output wire [WARPS-1:0]       place_o,        // of each warp's launch below
  output wire [WARPS-1:0]       older_o,        // in the older one of two that run
  output wire [2*11-1:0]        threads_o,
  output wire [2*32-1:0]        block_o,
  output wire [2*32-1:0]        blocks_o,
  output wire                   kernel_done_o,
  output reg                    running_o,
  output wire                   waiting_o
);
  reg pending_q;
  reg [15:0] pc_q;
  reg [10:0] threads_q;
  reg [31:0] block_q, blocks_q;
  wire accept = launch_valid_i && launch_ready_o;
  wire begins;                   // the launch that waits runs from the next cycle on
  wire still_runs;               // another one, then
  wire [10:0] start_threads;
  wire [WARPS-1:0] has;          // threads of the launch that began last
  genvar t;

  assign launch_ready_o = !pending_q && !import_active_i;
  assign import_start_o = accept && launch_import_i != 2'd0;
  assign waiting_o = pending_q;

  generate
    for (t = 0; t < WARPS * LANES; t = t + 1) begin : gen_thread
      localparam [10:0] THREAD = t;
      assign start_lanes_o[t] = THREAD < start_threads;
    end
  endgenerate

  always @(posedge clk_i)
    if (!rst_ni) begin
      pending_q <= 1'b0;
      running_o <= 1'b0;
    end else begin
      if (accept) begin
        pending_q <= 1'b1;
        pc_q <= launch_pc_i;
        threads_q <= launch_threads_i;
        block_q <= launch_block_i;
        blocks_q <= launch_blocks_i;
      end
      if (begins) begin
        pending_q <= 1'b0;
        running_o <= 1'b1;
      end else if (kernel_done_o) begin
        running_o <= still_runs;
      end
    end

  generate
    if (OVERLAP == 0) begin : gen_one
      reg [10:0] running_threads_q;
      reg [31:0] running_block_q, running_blocks_q;
      assign begins = pending_q && !running_o;
      assign still_runs = 1'b0;
      assign kernel_done_o = running_o && active_i == {WARPS{1'b0}};
      assign start_threads = threads_q;
      assign start_pc_o = pc_q;
      assign launched_o = has;
      assign place_o = {WARPS{1'b0}};
      assign older_o = {WARPS{1'b0}};
      assign threads_o = {11'd0, running_threads_q};
      assign block_o = {32'd0, running_block_q};
      assign blocks_o = {32'd0, running_blocks_q};
      for (t = 0; t < WARPS; t = t + 1) begin : gen_warp
        localparam integer FIRST_THREAD = t * LANES;
        assign start_o[t] = begins && start_lanes_o[t*LANES];
        assign has[t] = running_threads_q > FIRST_THREAD[10:0];
      end
      always @(posedge clk_i)
        if (begins) begin
          running_threads_q <= threads_q;
          running_block_q <= block_q;
          running_blocks_q <= blocks_q;
        end
    end else begin : gen_two
      // Two places, of which the launch that began last has newest_q.
      reg newest_q, older_q;               // an older one runs too
      reg [15:0] newest_pc_q;
      reg [2*11-1:0] place_threads_q;
      reg [2*32-1:0] place_block_q, place_blocks_q;
      reg [WARPS-1:0] started_q;           // in the newest
      reg [WARPS-1:0] warp_place_q;
      wire [WARPS-1:0] of_newest = warp_place_q ~^ {WARPS{newest_q}};
      wire all_started = (started_q | ~has) == {WARPS{1'b1}};
      wire newest_done = running_o && all_started && active_i == {WARPS{1'b0}};
      wire older_done = older_q && (active_i & ~of_newest) == {WARPS{1'b0}};
      assign begins = pending_q && !older_q;
      assign kernel_done_o = older_q ? older_done : newest_done;
      assign still_runs = older_q;
      assign start_threads = newest_q ? place_threads_q[21:11] : place_threads_q[10:0];
      assign start_pc_o = newest_pc_q;
      assign start_o = running_o ? has & ~started_q & ~active_i : {WARPS{1'b0}};
      assign launched_o = has | active_i;
      assign place_o = warp_place_q;
      assign older_o = ~of_newest & {WARPS{older_q}};
      assign threads_o = place_threads_q;
      assign block_o = place_block_q;
      assign blocks_o = place_blocks_q;
      for (t = 0; t < WARPS; t = t + 1) begin : gen_warp
        localparam integer FIRST_THREAD = t * LANES;
        assign has[t] = start_threads > FIRST_THREAD[10:0];
      end
      integer w;
      always @(posedge clk_i) begin
        if (!rst_ni) begin
          newest_q <= 1'b0;
          older_q <= 1'b0;
        end else if (begins) begin
          newest_q <= !newest_q;
          older_q <= running_o && !kernel_done_o;
        end else if (kernel_done_o) begin
          older_q <= 1'b0;
        end
        started_q <= begins ? {WARPS{1'b0}} : started_q | start_o;
        for (w = 0; w < WARPS; w = w + 1) if (start_o[w]) warp_place_q[w] <= newest_q;
        if (begins) begin
          newest_pc_q <= pc_q;
          if (newest_q) begin
            place_threads_q[10:0] <= threads_q;
            place_block_q[31:0] <= block_q;
            place_blocks_q[31:0] <= blocks_q;
          end else begin
            place_threads_q[21:11] <= threads_q;
            place_block_q[63:32] <= block_q;
            place_blocks_q[63:32] <= blocks_q;
          end
        end
      end
    end
  endgenerate
endmodule
`default_nettype wire
