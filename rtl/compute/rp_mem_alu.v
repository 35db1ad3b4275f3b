// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The memory ALU: loads and stores of a warp's lanes through the data cache, one quadword (16 bytes) a cycle.
// docs/machine/memory.md gives it cycle by cycle. A task that arrives in cycle t computes its addresses in t, looks
// quadword k up in t+1+k and accesses it in t+2+k; with n quadwords that hit, it is done in t+2+n. Lanes that miss are
// left over: the warp is parked and gives way to others, and passes again over the lanes concerned when the line has
// come. Promises: an instruction with an illegal address has no effect but the fault; every task ends, whatever other
// warps do, if the memory answers. Must be given: one task at a time of a warp; invalidate_i only while there is no
// task.
`default_nettype none
module rp_mem_alu #(
`include "rp_data_cache_parameters.vh"
  parameter integer SHARING = 0,   // has the instruction inval
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1
) (
  input  wire                   invalidate_i,      // one cycle: the memory may have changed
  input  wire [31:0]            memory_limit_i,    // bytes
  output wire                   fault_valid_o,     // one cycle; the task is dropped
  output wire [3:0]             fault_code_o,      // 5 misaligned (wins), 6 at or beyond memory_limit_i
  output wire [WARP_BITS-1:0]   fault_warp_o,
  // memory port, data side
  output wire                   request_valid_o,
  input  wire                   request_ready_i,
  output wire                   request_write_o,
  output wire [31:0]            request_address_o,
  output wire [127:0]           request_data_o,
  output wire [3:0]             request_mask_o,
  output wire [4:0]             request_id_o,      // of a read: number of the miss-status holding register
  input  wire                   response_valid_i,
  input  wire [4:0]             response_id_i,
  input  wire [1:0]             response_beat_i,
  input  wire [127:0]           response_data_i,
  // one cycle for each quadword stored
  output wire                   store_trace_valid_o,
  output wire [WARP_BITS-1:0]   store_trace_warp_o,
  output wire [31:0]            store_trace_address_o,
  output wire [127:0]           store_trace_data_o,
  output wire [3:0]             store_trace_mask_o,
  // events to be counted
  output wire                   hit_o,             // a quadword load was served at first try
  output wire                   miss_o,            // a quadword load was left over at first try
  output wire                   store_o,           // a quadword was stored
  output wire                   idle_o,            // no task, and no request waits
  // ALU framework
`include "rp_alu_ports.vh"
);
  `include "rp_isa.vh"
  localparam integer MSHR_BITS = (DATA_CACHE_MSHRS > 1) ? $clog2(DATA_CACHE_MSHRS) : 1;
  // Kinds of pass. The third, 2, goes over the lanes that were refused a miss-status holding register.
  localparam [1:0] KIND_NEW = 2'd0;      // first pass, over all lanes of the mask
  localparam [1:0] KIND_FILLED = 2'd1;   // over the lanes of a line that has come
  localparam [LANES-1:0] ONE = 1;
  localparam [LANES-1:0] NONE = 0;

  wire unused = &{1'b0, response_id_i};
  assign done_predicate_o = NONE;

  // ---- Arrival: addresses. Word addresses are enough from here on, with one bit that flags a byte address that was
  // none.
  // An inval goes the way of a store, and writes nothing.
  wire arrive_inval = SHARING != 0 && task_operation_i == ISA_MEM_INVAL;
  wire arrive_store = task_operation_i == ISA_MEM_ST || arrive_inval;
  reg [LANES*30-1:0] arrive_words;
  reg                arrive_misaligned;
  reg [31:0]         sum;
  integer a;
  always @* begin
    arrive_words = {LANES*30{1'b0}};
    arrive_misaligned = 1'b0;
    sum = 32'd0;
    if (task_valid_i)
      for (a = 0; a < LANES; a = a + 1) begin
        sum = task_operand_a_i[a*32 +: 32] + task_immediate_i;
        arrive_words[a*30 +: 30] = sum[31:2];
        if (task_mask_i[a] && sum[1:0] != 2'b00) arrive_misaligned = 1'b1;
      end
  end

  // ---- Context of the warps that are not in the pipeline: the task as it came, and what a parked one has so far.
  localparam integer TASK_BITS = 2 + LANES * 63;
  localparam integer PARTIAL_BITS = LANES * 34;
  wire                    select;
  wire [WARP_BITS-1:0]    select_warp;
  wire [TASK_BITS-1:0]    task_word;
  wire [PARTIAL_BITS-1:0] partial_word;
  wire                    kept_misaligned, kept_store, kept_inval;
  wire [LANES-1:0]        kept_mask, kept_left, kept_refused;
  wire [LANES*32-1:0]     kept_data, kept_result;
  wire [LANES*30-1:0]     kept_words;
  assign {kept_misaligned, kept_store, kept_mask, kept_data, kept_words} = task_word;
  assign {kept_left, kept_refused, kept_result} = partial_word;

  reg                  park_q;
  reg [WARP_BITS-1:0]  end_warp_q;
  reg [LANES-1:0]      left_q;
  reg [LANES-1:0]      refused_q;
  reg [LANES*32-1:0]   result_q;

  rp_ram_1r1w #(.WIDTH(TASK_BITS), .DEPTH(WARPS)) u_task (
    .clk_i(clk_i),
    .read_i(select),
    .read_address_i(select_warp),
    .read_data_o(task_word),
    .write_i(task_valid_i),
    .write_address_i(task_warp_i),
    .write_data_i({arrive_misaligned, arrive_store, task_mask_i, task_operand_b_i, arrive_words})
  );
  generate
    if (SHARING != 0) begin : gen_inval
      rp_ram_1r1w #(.WIDTH(1), .DEPTH(WARPS)) u_inval (
        .clk_i(clk_i),
        .read_i(select),
        .read_address_i(select_warp),
        .read_data_o(kept_inval),
        .write_i(task_valid_i),
        .write_address_i(task_warp_i),
        .write_data_i(arrive_inval)
      );
    end else begin : gen_no_inval
      assign kept_inval = 1'b0;
    end
  endgenerate
  rp_ram_1r1w #(.WIDTH(PARTIAL_BITS), .DEPTH(WARPS)) u_partial (
    .clk_i(clk_i),
    .read_i(select),
    .read_address_i(select_warp),
    .read_data_o(partial_word),
    .write_i(park_q),
    .write_address_i(end_warp_q),
    .write_data_i({left_q, refused_q, result_q})
  );

  // ---- Lookup stage: the pass that is looked up. The lowest pending lane leads; all pending lanes of its quadword go
  // along.
  reg                 pass_q;
  reg                 pass_first_q;       // no lookup of this pass yet
  reg [WARP_BITS-1:0] pass_warp_q;
  reg [1:0]           pass_kind_q;
  reg [MSHR_BITS-1:0] pass_mshr_q;
  reg                 pass_store_q;
  reg                 pass_inval_q;
  reg                 pass_misaligned_q;
  reg [LANES-1:0]     pass_pending_q;
  reg [LANES-1:0]     pass_leader_q;      // the lowest pending lane
  reg [LANES-1:0]     pass_left_q;        // lanes not served before this pass
  reg [LANES-1:0]     pass_refused_q;     // those of them that this pass does not try and that need a register
  reg [LANES*30-1:0]  pass_words_q;
  reg [LANES*32-1:0]  pass_data_q;

  function [LANES-1:0] lowest;   // of the bits that are set
    input [LANES-1:0] bits;
    lowest = bits & (~bits + ONE);
  endfunction

  reg [27:0]      quad;
  reg [LANES-1:0] served;
  integer l;
  always @* begin
    quad = 28'd0;
    served = NONE;
    if (pass_q) begin
      for (l = 0; l < LANES; l = l + 1) quad = quad | ({28{pass_leader_q[l]}} & pass_words_q[l*30+2 +: 28]);
      for (l = 0; l < LANES; l = l + 1) served[l] = pass_pending_q[l] && pass_words_q[l*30+2 +: 28] == quad;
    end
  end

  reg outside;
  integer o;
  always @* begin
    outside = 1'b0;
    if (pass_q && pass_first_q && pass_kind_q == KIND_NEW)
      for (o = 0; o < LANES; o = o + 1)
        if (pass_pending_q[o] && {pass_words_q[o*30 +: 30], 2'b00} >= memory_limit_i) outside = 1'b1;
  end
  wire illegal = outside || pass_misaligned_q;

  wire       load_ready;
  wire       store_ready;
  wire [1:0] queue_count;
  reg        access_valid_q;
  // An access cannot stall, so a lookup needs a free request entry beside that of the access of this cycle.
  wire room = queue_count < 2'd2 || (queue_count == 2'd2 && !access_valid_q);
  wire look = pass_q && room && (pass_store_q ? store_ready : load_ready);
  wire [LANES-1:0] pending_after = pass_pending_q & ~served;
  wire look_last = look && pending_after == NONE;
  wire look_legal = look && !illegal;

  // ---- What starts next: a pass that is prepared, or the task that arrives, if the stage is free after this cycle.
  wire                  next_valid;
  wire [1:0]            next_kind;
  wire [WARP_BITS-1:0]  next_warp;
  wire [MSHR_BITS-1:0]  next_mshr;
  wire                  waiting_empty;
  wire                  privilege;
  wire [WARP_BITS-1:0]  privilege_warp;
  wire                  sequencer_idle;
  wire free_after = !pass_q || look_last;
  // A pass that continues a task brings its partial result back, so no other task's may be under way.
  wire take = next_valid && (next_kind == KIND_NEW ? free_after : !pass_q && !access_valid_q);
  wire start = task_valid_i && free_after && !next_valid && waiting_empty;
  assign ready_o = waiting_empty;

  wire [DATA_CACHE_MSHRS*26-1:0] mshr_lines;
  reg [25:0]      next_line;
  reg [LANES-1:0] next_pending;
  integer n;
  always @* begin
    next_line = 26'd0;
    next_pending = NONE;
    if (take) begin
      next_pending = next_kind == KIND_NEW ? kept_mask : kept_refused;
      if (next_kind == KIND_FILLED) begin
        for (n = 0; n < DATA_CACHE_MSHRS; n = n + 1)
          if (next_mshr == n[MSHR_BITS-1:0]) next_line = mshr_lines[n*26 +: 26];
        for (n = 0; n < LANES; n = n + 1) next_pending[n] = kept_left[n] && kept_words[n*30+4 +: 26] == next_line;
      end
    end
  end

  always @(posedge clk_i) begin
    if (!rst_ni) pass_q <= 1'b0;
    else if (take || start) pass_q <= 1'b1;
    else if (look && (illegal || look_last)) pass_q <= 1'b0;

    if (take) begin
      pass_first_q <= 1'b1;
      pass_warp_q <= next_warp;
      pass_kind_q <= next_kind;
      pass_mshr_q <= next_mshr;
      pass_store_q <= kept_store;
      pass_inval_q <= kept_inval;
      pass_misaligned_q <= kept_misaligned;
      pass_pending_q <= next_pending;
      pass_leader_q <= lowest(next_pending);
      pass_left_q <= next_kind == KIND_NEW ? kept_mask : kept_left;
      pass_refused_q <= next_kind == KIND_FILLED ? kept_refused & ~next_pending : NONE;
      pass_words_q <= kept_words;
      pass_data_q <= kept_data;
    end else if (start) begin
      pass_first_q <= 1'b1;
      pass_warp_q <= task_warp_i;
      pass_kind_q <= KIND_NEW;
      pass_store_q <= arrive_store;
      pass_inval_q <= arrive_inval;
      pass_misaligned_q <= arrive_misaligned;
      pass_pending_q <= task_mask_i;
      pass_leader_q <= lowest(task_mask_i);
      pass_left_q <= task_mask_i;
      pass_refused_q <= NONE;
      pass_words_q <= arrive_words;
      pass_data_q <= task_operand_b_i;
    end else if (look) begin
      pass_first_q <= 1'b0;
      pass_pending_q <= pending_after;
      pass_leader_q <= lowest(pending_after);
    end
  end

  // ---- Faults
  reg                 fault_q;
  reg [3:0]           fault_code_q;
  reg [WARP_BITS-1:0] fault_warp_q;
  always @(posedge clk_i) begin
    if (!rst_ni) fault_q <= 1'b0;
    else fault_q <= look && illegal;
    if (look && illegal) begin
      fault_code_q <= pass_misaligned_q ? 4'd5 : 4'd6;
      fault_warp_q <= pass_warp_q;
    end
  end
  assign fault_valid_o = fault_q;
  assign fault_code_o = fault_code_q;
  assign fault_warp_o = fault_warp_q;

  // ---- Access stage
  reg                 access_any_q;       // not the empty pass of an empty mask
  reg                 access_first_q;
  reg                 access_last_q;
  reg [WARP_BITS-1:0] access_warp_q;
  reg [1:0]           access_kind_q;
  reg [MSHR_BITS-1:0] access_mshr_q;
  reg                 access_store_q;
  reg                 access_inval_q;
  reg [LANES-1:0]     access_served_q;
  reg [LANES-1:0]     access_left_q;
  reg [LANES-1:0]     access_refused_q;
  reg [LANES*2-1:0]   access_word_q;      // word of the quadword, for each lane
  reg [127:0]         access_data_q;
  reg [3:0]           access_mask_q;

  // The quadword that the served lanes of a store make: each word comes from the highest lane that writes it.
  function [131:0] gathered;   // {word mask, quadword}
    input [LANES-1:0]    lanes;
    input [LANES*30-1:0] words;
    input [LANES*32-1:0] data;
    reg [LANES-1:0] writers;   // lane 0 highest
    integer w, i;
    begin
      gathered = 132'd0;
      for (w = 0; w < 4; w = w + 1) begin
        for (i = 0; i < LANES; i = i + 1) writers[LANES-1-i] = lanes[i] && words[i*30 +: 2] == w[1:0];
        gathered[128+w] = |writers;
        writers = writers & (~writers + ONE);
        for (i = 0; i < LANES; i = i + 1)
          gathered[w*32 +: 32] = gathered[w*32 +: 32] | ({32{writers[LANES-1-i]}} & data[i*32 +: 32]);
      end
    end
  endfunction

  integer c;
  always @(posedge clk_i) begin
    if (!rst_ni) access_valid_q <= 1'b0;
    else access_valid_q <= look_legal;
    if (look_legal) begin
      access_any_q <= pass_pending_q != NONE;
      access_first_q <= pass_first_q;
      access_last_q <= pending_after == NONE;
      access_warp_q <= pass_warp_q;
      access_kind_q <= pass_kind_q;
      access_mshr_q <= pass_mshr_q;
      access_store_q <= pass_store_q;
      access_inval_q <= pass_inval_q;
      access_served_q <= served;
      access_left_q <= pass_left_q;
      access_refused_q <= pass_refused_q;
      if (pass_store_q) {access_mask_q, access_data_q} <= gathered(served, pass_words_q, pass_data_q);
      else
        for (c = 0; c < LANES; c = c + 1) access_word_q[c*2 +: 2] <= pass_words_q[c*30 +: 2];
    end
  end

  wire                 access = access_valid_q && access_any_q;
  wire                 hit, allocates, refuses, accepts, push, push_write;
  wire [127:0]         quad_data;
  wire [27:0]          push_quad;
  wire [MSHR_BITS-1:0] push_id;
  wire [DATA_CACHE_MSHRS-1:0] filled;
  wire [DATA_CACHE_MSHRS*WARPS-1:0] waiters;
  wire                   freed;
  wire                   cache_idle;
  wire access_end = access_valid_q && access_last_q;
  wire access_new = access && !access_store_q && access_kind_q == KIND_NEW;

  rp_data_cache #(
`include "rp_data_cache_parameter_map.vh"
    .SHARING(SHARING), .WARPS(WARPS), .WARP_BITS(WARP_BITS), .MSHR_BITS(MSHR_BITS)
  ) u_cache (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .invalidate_i(invalidate_i),
    .load_ready_o(load_ready),
    .store_ready_o(store_ready),
    .lookup_i(look),
    .lookup_store_i(pass_store_q),
    .lookup_quad_i(quad),
    .access_i(access),
    .access_store_i(access_store_q),
    .access_inval_i(access_inval_q),
    .access_may_allocate_i(!privilege || privilege_warp == access_warp_q),
    .access_warp_i(access_warp_q),
    .access_data_i(access_data_q),
    .access_mask_i(access_mask_q),
    .hit_o(hit),
    .data_o(quad_data),
    .allocate_o(allocates),
    .refuse_o(refuses),
    .accept_o(accepts),
    .push_o(push),
    .push_write_o(push_write),
    .push_quad_o(push_quad),
    .push_id_o(push_id),
    .response_valid_i(response_valid_i),
    .response_id_i(response_id_i[MSHR_BITS-1:0]),
    .response_beat_i(response_beat_i),
    .response_data_i(response_data_i),
    .served_i(access_end && access_kind_q == KIND_FILLED),
    .served_id_i(access_mshr_q),
    .served_warp_i(access_warp_q),
    .freed_o(freed),
    .idle_o(cache_idle),
    .filled_o(filled),
    .line_o(mshr_lines),
    .waiters_o(waiters)
  );

  // ---- Results gather here over the accesses of a pass; after the last one the warp
  // is done, or parked with what it has.
  wire [LANES-1:0] gone = (hit || accepts) ? access_served_q : NONE;
  wire [LANES-1:0] left_after = (access_first_q ? access_left_q : left_q) & ~gone;
  wire [LANES-1:0] refused_after = (access_first_q ? access_refused_q : refused_q) | (refuses ? access_served_q : NONE);
  reg              allocated_q;
  wire             allocated_after = allocates || (!access_first_q && allocated_q);
  reg              done_q;
  reg              hit_q;
  reg              miss_q;

  integer d;
  always @(posedge clk_i) begin
    if (!rst_ni) begin
      done_q <= 1'b0;
      park_q <= 1'b0;
      hit_q <= 1'b0;
      miss_q <= 1'b0;
    end else begin
      done_q <= access_end && left_after == NONE;
      park_q <= access_end && left_after != NONE;
      hit_q <= access_new && hit;
      miss_q <= access_new && !hit;
    end
    if (access_valid_q) begin
      end_warp_q <= access_warp_q;
      left_q <= left_after;
      refused_q <= refused_after;
      allocated_q <= allocated_after;
    end
    if (hit) begin
      for (d = 0; d < LANES; d = d + 1)
        if (access_served_q[d]) result_q[d*32 +: 32] <= quad_data[access_word_q[d*2 +: 2]*32 +: 32];
    end else if (take && next_kind != KIND_NEW) result_q <= kept_result;
  end

  assign done_valid_o = done_q;
  assign done_warp_o = end_warp_q;
  assign done_data_o = result_q;
  assign hit_o = hit_q;
  assign miss_o = miss_q;
  assign store_o = accepts && !access_inval_q;
  assign store_trace_valid_o = store_o;
  assign store_trace_warp_o = access_warp_q;
  assign store_trace_address_o = {push_quad, 4'b0000};
  assign store_trace_data_o = access_data_q;
  assign store_trace_mask_o = access_mask_q;

  rp_memory_sequencer #(
    .WARPS(WARPS), .WARP_BITS(WARP_BITS), .MSHRS(DATA_CACHE_MSHRS), .MSHR_BITS(MSHR_BITS)
  ) u_sequencer (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .queue_i(task_valid_i && !start),
    .queue_warp_i(task_warp_i),
    .park_i(park_q),
    .park_warp_i(end_warp_q),
    .pass_end_i(access_end),
    .pass_warp_i(access_warp_q),
    .pass_refused_i(refused_after != NONE),
    .pass_allocated_i(allocated_after),
    .filled_i(filled),
    .waiters_i(waiters),
    .freed_i(freed),
    .select_o(select),
    .select_warp_o(select_warp),
    .next_valid_o(next_valid),
    .next_kind_o(next_kind),
    .next_warp_o(next_warp),
    .next_mshr_o(next_mshr),
    .next_take_i(take),
    .queue_empty_o(waiting_empty),
    .privilege_o(privilege),
    .privilege_warp_o(privilege_warp),
    .idle_o(sequencer_idle)
  );

  // ---- Requests, in the order of the accesses: a read leaves after every earlier store.
  wire [MSHR_BITS-1:0] request_id;
  wire [27:0]          request_quad;
  rp_request_queue #(.WIDTH(1 + 28 + 128 + 4 + MSHR_BITS), .DEPTH(3)) u_requests (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(push),
    .data_i({push_write, push_quad, access_data_q, access_mask_q, push_id}),
    .valid_o(request_valid_o),
    .ready_i(request_ready_i),
    .data_o({request_write_o, request_quad, request_data_o, request_mask_o, request_id}),
    .count_o(queue_count)
  );
  assign request_address_o = {request_quad, 4'b0000};
  assign request_id_o = {{(5-MSHR_BITS){1'b0}}, request_id};

  assign idle_o = !pass_q && !access_valid_q && !done_q && !park_q && sequencer_idle && cache_idle &&
                  queue_count == 2'd0;
endmodule
`default_nettype wire
