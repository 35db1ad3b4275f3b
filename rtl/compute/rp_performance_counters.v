// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Counts events while a kernel runs; rtl/include/rp_counters.vh has the counters' numbers.
// The events of a cycle are taken into registers and counted in the next one; value_o includes those of the cycle
// before. What many warps add to is summed up first and counted a cycle later: a warp retires at least two cycles
// before the unit is idle, so nothing is missing then.
`default_nettype none
module rp_performance_counters #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer INSTANCES = 7,
  parameter integer ALU_TYPES = 7,
  parameter [INSTANCES*4-1:0] INSTANCE_TYPES = 28'h6543210,
  parameter integer TRIPLES = 0,
  parameter integer COUNTER_BITS = 48       // each counts modulo 2^COUNTER_BITS
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   running_i,
  input  wire [WARPS-1:0]       retire_i,
  input  wire [WARPS*LANES-1:0] retire_mask_i,
  input  wire                   instruction_hit_i,
  input  wire                   instruction_miss_i,
  input  wire                   data_hit_i,
  input  wire                   data_miss_i,
  input  wire                   data_store_i,
  input  wire [INSTANCES-1:0]       ready_i,
  input  wire [INSTANCES-1:0]       grant_i,
  input  wire [WARPS-1:0]       waiting_i,        // warps that wanted an ALU and got none
  input  wire [WARPS*4-1:0]     type_i,           // of each warp's instruction; there are eight at most
  input  wire [WARPS-1:0]       launched_i,       // the launch has threads for them
  input  wire [WARPS-1:0]       active_i,
  input  wire [WARPS-1:0]       fetching_i,
  input  wire [WARPS-1:0]       executing_i,
  input  wire [WARPS-1:0]       overlapping_i,    // given an ALU, and read the next element of a triple at once
  input  wire [WARPS-1:0]       import_wait_i,    // of those that execute
  input  wire [WARPS-1:0]       export_wait_i,
  input  wire [5:0]             select_i,
  output wire [63:0]            value_o
);
`include "rp_counters.vh"
`include "rp_isa.vh"
  localparam integer BITS = COUNTER_BITS;
  localparam integer LOW_BITS = 12;
  localparam integer STATES = COUNTER_WARPS_NOT_LAUNCHED;   // the first of the counters of warps in a state
  localparam integer SINGLES = COUNTER_FLT_OVERLAPPED + 1;
  localparam integer STATE_COUNTERS = SINGLES - STATES;
  localparam integer COUNTERS = SINGLES + 3 * ALU_TYPES;
  localparam integer LANE_BITS = $clog2(LANES) + 1;   // of the number of a warp's lanes
  localparam integer WARP_BITS = $clog2(WARPS) + 1;   // of the number of warps
  localparam integer THREAD_BITS = $clog2(WARPS * LANES) + 1;
  localparam [LANE_BITS-1:0] ONE_LANE = 1;
  localparam [WARP_BITS-1:0] ONE_WARP = 1;

  // ---- Events of the cycle before; none while nothing runs.
  reg running_q;
  reg [4:0] single_q;                                 // instruction hit, miss, data hit, miss, store
  reg [WARPS-1:0] retire_q, waiting_q;
  reg [WARPS*LANE_BITS-1:0] threads_q;                // lanes that retire, for each warp
  reg [WARPS*3-1:0] type_q;
  reg [INSTANCES-1:0] unused_q, issued_q;
  integer w;

  always @(posedge clk_i) begin
    running_q <= rst_ni && running_i;
    retire_q <= retire_i;
    waiting_q <= waiting_i;
    for (w = 0; w < WARPS; w = w + 1) type_q[w*3 +: 3] <= type_i[w*4 +: 3];
    unused_q <= ready_i & ~grant_i;
    issued_q <= grant_i;
    single_q <= {data_store_i, data_miss_i, data_hit_i, instruction_miss_i, instruction_hit_i};
  end

  function [LANE_BITS-1:0] lanes(input [LANES-1:0] mask);   // that are set
    integer l;
    begin
      lanes = {LANE_BITS{1'b0}};
      for (l = 0; l < LANES; l = l + 1) if (mask[l]) lanes = lanes + ONE_LANE;
    end
  endfunction
  always @(posedge clk_i)
    for (w = 0; w < WARPS; w = w + 1) begin
      threads_q[w*LANE_BITS +: LANE_BITS] <= {LANE_BITS{1'b0}};
      if (retire_i[w]) threads_q[w*LANE_BITS +: LANE_BITS] <= lanes(retire_mask_i[w*LANES +: LANES]);
    end

  // ---- Which warps are in which state, in the order of the counters; with those that wait for an ALU, those that are
  // granted one and those that read registers, which is a cycle of each task, they are all.
  reg [WARPS-1:0] in_mem, in_ray, in_overlap;
  reg [STATE_COUNTERS*WARPS-1:0] states_q;
  integer v;
  always @* begin
    in_mem = {WARPS{1'b0}};
    in_ray = {WARPS{1'b0}};
    in_overlap = {WARPS{1'b0}};
    for (v = 0; v < WARPS; v = v + 1) begin
      in_mem[v] = executing_i[v] && type_i[v*4 +: 4] == ISA_TYPE_MEM;
      in_ray[v] = executing_i[v] && type_i[v*4 +: 4] == ISA_TYPE_RAY;
      in_overlap[v] = overlapping_i[v] && type_i[v*4 +: 4] == ISA_TYPE_FLT;
    end
  end
  always @(posedge clk_i)
    states_q <= !(rst_ni && running_i) ? {STATE_COUNTERS*WARPS{1'b0}}
                : {in_overlap, export_wait_i, import_wait_i, in_ray & ~import_wait_i & ~export_wait_i, in_mem,
                   fetching_i, launched_i & ~active_i, ~launched_i};

  function [WARP_BITS-1:0] warps(input [WARPS-1:0] state);   // that are in it
    integer n;
    begin
      warps = {WARP_BITS{1'b0}};
      for (n = 0; n < WARPS; n = n + 1) if (state[n]) warps = warps + ONE_WARP;
    end
  endfunction

  // How many of a type's instances are set.
  function [2:0] count(input [3:0] alu_type, input [INSTANCES-1:0] instances);
    integer n;
    begin
      count = 3'd0;
      for (n = 0; n < INSTANCES; n = n + 1)
        if (INSTANCE_TYPES[n*4 +: 4] == alu_type) count = count + {2'd0, instances[n]};
    end
  endfunction

  // ---- Sums over the warps: of those that retire, of their threads, of those that wait for each type.
  reg [WARP_BITS-1:0] instructions_q;
  reg [THREAD_BITS-1:0] threads_sum_q;
  reg [ALU_TYPES*WARP_BITS-1:0] queues_q;

  always @(posedge clk_i) begin : sums
    reg [WARP_BITS-1:0] instructions, queue;
    reg [THREAD_BITS-1:0] threads, lanes_of_warp;
    integer n, t;
    instructions = {WARP_BITS{1'b0}};
    lanes_of_warp = {THREAD_BITS{1'b0}};
    threads = {THREAD_BITS{1'b0}};
    if (rst_ni && running_q && |retire_q)
      for (n = 0; n < WARPS; n = n + 1) begin
        instructions = instructions + (ONE_WARP & {WARP_BITS{retire_q[n]}});
        lanes_of_warp[LANE_BITS-1:0] = threads_q[n*LANE_BITS +: LANE_BITS];
        threads = threads + lanes_of_warp;
      end
    instructions_q <= instructions;
    threads_sum_q <= threads;
    queues_q <= {ALU_TYPES*WARP_BITS{1'b0}};
    if (rst_ni && running_q && |waiting_q)
      for (t = 0; t < ALU_TYPES; t = t + 1) begin
        queue = {WARP_BITS{1'b0}};
        for (n = 0; n < WARPS; n = n + 1)
          queue = queue + (ONE_WARP & {WARP_BITS{waiting_q[n] && type_q[n*3 +: 3] == t[2:0]}});
        queues_q[t*WARP_BITS +: WARP_BITS] <= queue;
      end
  end

  // ---- Counters, in the order of their numbers: the single ones, then rows of one a type.
  function integer number(input integer counter);
    integer row, alu_type;
    begin
      row = (counter - SINGLES) / ALU_TYPES;
      alu_type = (counter - SINGLES) % ALU_TYPES;
      number = counter < SINGLES ? counter
               : (row == 0 ? COUNTER_UNUSED : row == 1 ? COUNTER_WAITING : COUNTER_ISSUED) + alu_type;
    end
  endfunction

  wire [COUNTERS*BITS-1:0] values;
  wire [COUNTERS*(LOW_BITS+1)-1:0] pendings;
  genvar c;
  generate
    for (c = 0; c < COUNTERS; c = c + 1) begin : gen_counter
      localparam integer ROW = (c < SINGLES) ? -1 : (c - SINGLES) / ALU_TYPES;
      localparam integer TYPE = (c - SINGLES) % ALU_TYPES;
      localparam integer EVENT_BITS = (c == COUNTER_THREAD_INSTRUCTIONS) ? THREAD_BITS
                                      : (c == COUNTER_INSTRUCTIONS || (c >= STATES && ROW < 0) || ROW == 1) ? WARP_BITS
                                      : (ROW >= 0) ? 3 : 1;
      if (c == COUNTER_FLT_OVERLAPPED && TRIPLES == 0) begin : gen_nothing
        wire unused = &{1'b0, states_q[(c-STATES)*WARPS +: WARPS]};
        assign values[c*BITS +: BITS] = {BITS{1'b0}};
        assign pendings[c*(LOW_BITS+1) +: LOW_BITS+1] = {LOW_BITS+1{1'b0}};
      end else begin : gen_events
        wire [EVENT_BITS-1:0] events;
        if (c == COUNTER_BUSY_CYCLES) begin : gen_event
          assign events = running_q;
        end else if (c == COUNTER_INSTRUCTIONS) begin : gen_event
          assign events = instructions_q;
        end else if (c == COUNTER_THREAD_INSTRUCTIONS) begin : gen_event
          assign events = threads_sum_q;
        end else if (c >= STATES && c < SINGLES) begin : gen_event
          assign events = warps(states_q[(c-STATES)*WARPS +: WARPS]);
        end else if (c < SINGLES) begin : gen_event
          assign events = running_q && single_q[c - COUNTER_INSTRUCTION_CACHE_HITS];
        end else if (ROW == 0) begin : gen_event
          assign events = running_q ? count(TYPE[3:0], unused_q) : 3'd0;
        end else if (ROW == 1) begin : gen_event
          assign events = queues_q[TYPE*WARP_BITS +: WARP_BITS];
        end else begin : gen_event
          assign events = running_q ? count(TYPE[3:0], issued_q) : 3'd0;
        end
        rp_event_counter #(.BITS(BITS), .LOW_BITS(LOW_BITS), .EVENT_BITS(EVENT_BITS)) event_counter (
          .clk_i(clk_i), .rst_ni(rst_ni), .event_i(events),
          .value_o(values[c*BITS +: BITS]), .pending_o(pendings[c*(LOW_BITS+1) +: LOW_BITS+1]));
      end
    end
  endgenerate

  reg [BITS-1:0] value;
  reg [LOW_BITS:0] pending;
  integer i;
  always @* begin
    value = {BITS{1'b0}};
    pending = {LOW_BITS+1{1'b0}};
    for (i = 0; i < COUNTERS; i = i + 1)
      if ({26'd0, select_i} == number(i)) begin
        value = value | values[i*BITS +: BITS];
        pending = pending | pendings[i*(LOW_BITS+1) +: LOW_BITS+1];
      end
  end
  wire [BITS-1:0] total = value + {{BITS-LOW_BITS-1{1'b0}}, pending};
  assign value_o = {{64-BITS{1'b0}}, total};
endmodule
`default_nettype wire
