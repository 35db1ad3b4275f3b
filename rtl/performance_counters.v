// Counts events while a kernel runs; numbers as in cpp_model/machine/compute_unit.hpp, namespace counter.
// The events of a cycle are taken into registers and counted in the next one; value_o includes those of the cycle before. What many warps
// add to is summed up first and counted a cycle later: a warp retires at least two cycles before the unit is idle, so nothing is missing then.
`default_nettype none
module performance_counters #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer SLOTS = 7,
  parameter integer UNITS = 7,
  parameter [SLOTS*4-1:0] SLOT_UNITS = 28'h6543210
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
  input  wire [SLOTS-1:0]       ready_i,
  input  wire [SLOTS-1:0]       grant_i,
  input  wire [WARPS-1:0]       waiting_i,        // warps that wanted an ALU and got none
  input  wire [WARPS*3-1:0]     unit_i,           // the type each warp wants
  input  wire [5:0]             select_i,
  output wire [63:0]            value_o
);
  localparam integer BITS = 48;
  localparam integer LOW_BITS = 12;
  localparam integer COUNTERS = 8 + 3 * UNITS;
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
  reg [WARPS*3-1:0] unit_q;
  reg [SLOTS-1:0] unused_q, issued_q;
  integer w;

  always @(posedge clk_i) begin
    running_q <= rst_ni && running_i;
    retire_q <= retire_i;
    waiting_q <= waiting_i;
    unit_q <= unit_i;
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

  // How many of a type's slots are set in `slots`.
  function [2:0] count(input [3:0] unit, input [SLOTS-1:0] slots);
    integer s;
    begin
      count = 3'd0;
      for (s = 0; s < SLOTS; s = s + 1)
        if (SLOT_UNITS[s*4 +: 4] == unit) count = count + {2'd0, slots[s]};
    end
  endfunction

  // ---- Sums over the warps: of those that retire, of their threads, of those that wait for each type.
  reg [WARP_BITS-1:0] instructions_q;
  reg [THREAD_BITS-1:0] threads_sum_q;
  reg [UNITS*WARP_BITS-1:0] queues_q;

  always @(posedge clk_i) begin : sums
    reg [WARP_BITS-1:0] instructions, queue;
    reg [THREAD_BITS-1:0] threads, lanes_of_warp;
    integer n, u;
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
    queues_q <= {UNITS*WARP_BITS{1'b0}};
    if (rst_ni && running_q && |waiting_q)
      for (u = 0; u < UNITS; u = u + 1) begin
        queue = {WARP_BITS{1'b0}};
        for (n = 0; n < WARPS; n = n + 1) queue = queue + (ONE_WARP & {WARP_BITS{waiting_q[n] && unit_q[n*3 +: 3] == u[2:0]}});
        queues_q[u*WARP_BITS +: WARP_BITS] <= queue;
      end
  end

  // ---- Counters, in the order of their numbers: eight single ones, then rows of one a type.
  wire [COUNTERS*BITS-1:0] values;
  wire [COUNTERS*(LOW_BITS+1)-1:0] pendings;
  genvar c;
  generate
    for (c = 0; c < COUNTERS; c = c + 1) begin : gen_counter
      localparam integer UNIT = (c - 8) % UNITS;
      localparam integer EVENT_BITS = (c == 2) ? THREAD_BITS : (c == 1 || (c >= 8 + UNITS && c < 8 + 2 * UNITS)) ? WARP_BITS : (c >= 8) ? 3 : 1;
      wire [EVENT_BITS-1:0] events;
      if (c == 0) begin : gen_event
        assign events = running_q;
      end else if (c == 1) begin : gen_event
        assign events = instructions_q;
      end else if (c == 2) begin : gen_event
        assign events = threads_sum_q;
      end else if (c < 8) begin : gen_event
        assign events = running_q && single_q[c - 3];
      end else if (c < 8 + UNITS) begin : gen_event
        assign events = running_q ? count(UNIT[3:0], unused_q) : 3'd0;
      end else if (c < 8 + 2 * UNITS) begin : gen_event
        assign events = queues_q[UNIT*WARP_BITS +: WARP_BITS];
      end else begin : gen_event
        assign events = running_q ? count(UNIT[3:0], issued_q) : 3'd0;
      end
      event_counter #(.BITS(BITS), .LOW_BITS(LOW_BITS), .EVENT_BITS(EVENT_BITS)) event_counter (
        .clk_i(clk_i), .rst_ni(rst_ni), .event_i(events),
        .value_o(values[c*BITS +: BITS]), .pending_o(pendings[c*(LOW_BITS+1) +: LOW_BITS+1]));
    end
  endgenerate

  // Numbers 0 to 7, and from 16, 24 and 32 on a row of eight, one a type.
  reg [BITS-1:0] value;
  reg [LOW_BITS:0] pending;
  integer i;
  always @* begin
    value = {BITS{1'b0}};
    pending = {LOW_BITS+1{1'b0}};
    for (i = 0; i < COUNTERS; i = i + 1)
      if ((i < 8 && select_i == i[5:0]) ||
          (i >= 8 && {26'd0, select_i} == 16 + 8 * ((i - 8) / UNITS) + (i - 8) % UNITS)) begin
        value = value | values[i*BITS +: BITS];
        pending = pending | pendings[i*(LOW_BITS+1) +: LOW_BITS+1];
      end
  end
  wire [BITS-1:0] total = value + {{BITS-LOW_BITS-1{1'b0}}, pending};
  assign value_o = {{64-BITS{1'b0}}, total};
endmodule
`default_nettype wire
