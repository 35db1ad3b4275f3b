// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One SIMT compute unit: instruction routine, data routine, ALUs, caches, ray memory, launch.
// docs/machine/architecture.md describes it. Promises: no output depends combinationally on an input; every valid/ready
// pair keeps its payload until taken.
`default_nettype none
module rp_compute_unit #(
`include "rp_unit_parameters.vh"
  parameter integer UNIT = 0,   // its number among several
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1
) (
  input  wire                      clk_i,
  input  wire                      rst_ni,
  // set by the host before a launch, constant while a kernel runs
  input  wire [15:0]               program_length_i,   // instructions
  input  wire [31:0]               memory_limit_i,     // bytes
  input  wire                      argument_write_i,   // while idle; invalidates the caches, as memory may have changed
  input  wire [4:0]                argument_index_i,
  input  wire [31:0]               argument_data_i,
  // launch
  input  wire                      launch_valid_i,
  output wire                      launch_ready_o,
  input  wire [15:0]               launch_pc_i,
  input  wire [10:0]               launch_threads_i,   // 1 .. WARPS*LANES
  input  wire [31:0]               launch_block_i,
  input  wire [31:0]               launch_blocks_i,
  input  wire [1:0]                launch_import_i,    // 0 none, 1 normal, 2 shadow
  output wire                      kernel_done_o,      // one cycle a kernel
  output wire                      busy_o,             // a kernel is running
  output wire                      idle_o,             // nothing runs, waits, is being exported or stored
  // memory port
  output wire                      memory_request_valid_o,
  input  wire                      memory_request_ready_i,
  output wire                      memory_request_write_o,
  output wire [31:0]               memory_request_address_o,
  output wire [127:0]              memory_request_data_o,
  output wire [3:0]                memory_request_mask_o,
  output wire [4:0]                memory_request_id_o,
  input  wire                      memory_response_valid_i,
  input  wire [4:0]                memory_response_id_i,
  input  wire [1:0]                memory_response_beat_i,
  input  wire [127:0]              memory_response_data_i,
  // pools
  output wire                      import_request_valid_o,
  output wire [1:0]                import_request_kind_o,
  input  wire                      import_request_ready_i,
  input  wire                      import_beat_valid_i,
  input  wire [127:0]              import_beat_data_i,
  output wire                      export_valid_o,
  input  wire                      export_ready_i,
  output wire [127:0]              export_data_o,
  output wire                      export_last_o,
  output wire [15:0]               exports_o,          // packages that kernels have asked to export since reset
  // frame buffer
  output wire                      frame_valid_o,
  input  wire                      frame_ready_i,
  output wire [31:0]               frame_pixel_o,
  output wire [95:0]               frame_color_o,      // red in the low word
  // faults, sticky
  output wire                      fault_valid_o,
  output wire [3:0]                fault_code_o,
  output wire [WARP_BITS-1:0]      fault_warp_o,
  output wire [15:0]               fault_pc_o,
  // performance counters, docs/machine/architecture.md
  input  wire [5:0]                counter_select_i,
  output wire [63:0]               counter_o,          // the one exception: depends on counter_select_i
  // trace, valid in the cycle of write-back
  output wire [WARPS-1:0]          retire_valid_o,
  output wire [WARPS*16-1:0]       retire_pc_o,
  output wire [WARPS*64-1:0]       retire_instruction_o,
  output wire [WARPS*LANES-1:0]    retire_mask_o,
  output wire [WARPS*LANES*32-1:0] retire_data_o,
  output wire [WARPS*LANES-1:0]    retire_predicate_o,
  output wire                      store_trace_valid_o,
  output wire [WARP_BITS-1:0]      store_trace_warp_o,
  output wire [31:0]               store_trace_address_o,
  output wire [127:0]              store_trace_data_o,
  output wire [3:0]                store_trace_mask_o,
  output wire                      ray_trace_valid_o,
  output wire [WARP_BITS-1:0]      ray_trace_warp_o,
  output wire [4:0]                ray_trace_word_o,
  output wire [LANES-1:0]          ray_trace_mask_o,
  output wire [LANES*32-1:0]       ray_trace_data_o
);
`include "rp_isa.vh"
  localparam integer DATA = LANES * 32;
`include "rp_alu_instance_types.vh"

`include "rp_unit_parameter_checks.vh"

  // launch
  wire [WARPS-1:0] start, active, launched;
  wire [15:0] start_pc;
  wire [WARPS*LANES-1:0] start_lanes;
  wire [WARPS-1:0] launch_place;   // which of the launches that run is each warp's
  wire [WARPS-1:0] older;          // warps in the older one of two kernels
  reg  [WARPS-1:0] older_q, first_q;
  wire [2*11-1:0] threads;
  wire [2*32-1:0] block, blocks;
  wire waiting_launch, import_start, import_active, exporting;
  // instruction routine
  wire [WARPS-1:0] fetch_request, fetch_first, fetch_grant;
  wire [WARPS*16-1:0] fetch_pc;
  reg [15:0] lookup_pc;
  wire fetch_valid, instruction_hit, instruction_miss, refill_done;
  wire [WARP_BITS-1:0] fetch_warp, result_warp;
  wire [63:0] fetched;
  // data routine: what the warps offer to the dispatcher, and what ALU instances have done
  wire [WARPS-1:0] want, grant, waiting, retire, fetching, executing, import_wait, export_wait;
  wire [WARPS*4-1:0] wanted_type;
  wire [WARPS*64-1:0] instruction, task_of;
  wire [WARPS-1:0] overlaps;
  wire [WARPS*16-1:0] pc;
  wire [WARPS*LANES-1:0] thread_mask, predicate_x, predicate_b;
  wire [WARPS*DATA-1:0] operand_a, operand_b, operand_c;
  wire [INSTANCES-1:0] ready, instance_grant, done_valid;
  wire [INSTANCES*WARP_BITS-1:0] instance_warp, done_warp;
  wire [INSTANCES*DATA-1:0] done_data;
  wire [INSTANCES*LANES-1:0] done_predicate;
  wire [INSTANCES-1:0] done_subnormal;   // with done_valid: the task has met a subnormal number
  // memory
  wire instruction_request, instruction_request_ready, instruction_response;
  wire [31:0] instruction_request_address;
  wire data_request, data_request_ready, data_request_write, data_response;
  wire [31:0] data_request_address;
  wire [127:0] data_request_data;
  wire [3:0] data_request_mask;
  wire [4:0] data_request_id;
  wire data_hit, data_miss, data_store, mem_idle, arbiter_idle;
  // faults
  wire [WARPS-1:0] warp_fault;
  wire [WARPS*4-1:0] warp_fault_code;
  wire mem_fault, ray_fault;
  wire [3:0] mem_fault_code, ray_fault_code;
  wire [WARP_BITS-1:0] mem_fault_warp, ray_fault_warp;

  genvar w, k;

  rp_launcher #(.WARPS(WARPS), .LANES(LANES), .OVERLAP(KERNEL_OVERLAP)) launcher (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .launch_valid_i(launch_valid_i),
    .launch_ready_o(launch_ready_o),
    .launch_pc_i(launch_pc_i),
    .launch_threads_i(launch_threads_i),
    .launch_block_i(launch_block_i),
    .launch_blocks_i(launch_blocks_i),
    .launch_import_i(launch_import_i),
    .import_start_o(import_start),
    .import_active_i(import_active),
    .start_o(start),
    .start_pc_o(start_pc),
    .start_lanes_o(start_lanes),
    .active_i(active),
    .launched_o(launched),
    .place_o(launch_place),
    .older_o(older),
    .threads_o(threads),
    .block_o(block),
    .blocks_o(blocks),
    .kernel_done_o(kernel_done_o),
    .running_o(busy_o),
    .waiting_o(waiting_launch)
  );
  assign idle_o = !busy_o && !waiting_launch && !import_active && !exporting && mem_idle && arbiter_idle;

  rp_fetch_arbiter #(.WARPS(WARPS), .WARP_BITS(WARP_BITS)) fetch_arbiter (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .request_i(fetch_request),
    .first_i(fetch_first),
    .grant_o(fetch_grant),
    .valid_o(fetch_valid),
    .warp_o(fetch_warp)
  );

  // By the grants, which are there before the warp's number.
  integer g;
  always @* begin
    lookup_pc = 16'd0;
    if (fetch_valid)
      for (g = 0; g < WARPS; g = g + 1) lookup_pc = lookup_pc | (fetch_pc[g*16 +: 16] & {16{fetch_grant[g]}});
  end

  rp_instruction_cache #(
`include "rp_instruction_cache_parameter_map.vh"
    .WARPS(WARPS), .PC_BITS(PC_BITS), .WARP_BITS(WARP_BITS)
  ) instruction_cache (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .invalidate_i(argument_write_i),
    .lookup_valid_i(fetch_valid),
    .lookup_warp_i(fetch_warp),
    .lookup_pc_i(lookup_pc),
    .hit_o(instruction_hit),
    .miss_o(instruction_miss),
    .result_warp_o(result_warp),
    .instruction_o(fetched),
    .refill_done_o(refill_done),
    .first_o(fetch_first),
    .request_valid_o(instruction_request),
    .request_ready_i(instruction_request_ready),
    .request_address_o(instruction_request_address),
    .response_valid_i(instruction_response),
    .response_beat_i(memory_response_beat_i),
    .response_data_i(memory_response_data_i)
  );

  generate
    for (w = 0; w < WARPS; w = w + 1) begin : gen_warp
      wire [INSTANCES-1:0] done;   // the instances that have finished this warp's task
      for (k = 0; k < INSTANCES; k = k + 1) begin : gen_done
        assign done[k] = done_valid[k] && done_warp[k*WARP_BITS +: WARP_BITS] == w;
      end
      wire [PC_BITS-1:0] narrow_fetch_pc, narrow_pc;
      reg [15:0] wide_fetch_pc, wide_pc;
      always @* begin
        wide_fetch_pc = 16'd0;
        wide_pc = 16'd0;
        wide_fetch_pc[PC_BITS-1:0] = narrow_fetch_pc;
        wide_pc[PC_BITS-1:0] = narrow_pc;
      end
      assign fetch_pc[w*16 +: 16] = wide_fetch_pc;
      assign pc[w*16 +: 16] = wide_pc;
      rp_warp #(
        .LANES(LANES), .STACK_DEPTH(STACK_DEPTH), .INSTANCES(INSTANCES), .INSTANCE_TYPES(INSTANCE_TYPES), .FMA(FMA),
        .TRIPLES(TRIPLES), .SHARING(SHARING), .INTERSECTION_WORDS(INTERSECTION_WORDS), .REGISTERS(REGISTERS),
        .PREDICATES(PREDICATES), .ARGUMENTS(ARGUMENTS), .PC_BITS(PC_BITS), .WITHOUT(WITHOUT)
      ) warp (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .start_i(start[w]),
        .start_pc_i(start_pc),
        .start_lanes_i(start_lanes[w*LANES +: LANES]),
        .halt_i(fault_valid_o),
        .active_o(active[w]),
        .program_length_i(program_length_i),
        .fetch_request_o(fetch_request[w]),
        .fetch_pc_o(narrow_fetch_pc),
        .fetch_grant_i(fetch_grant[w]),
        .cache_hit_i(instruction_hit && result_warp == w),
        .cache_instruction_i(fetched),
        .refill_done_i(refill_done),
        .want_o(want[w]),
        .grant_i(grant[w]),
        .type_o(wanted_type[w*4 +: 4]),
        .instruction_o(instruction[w*64 +: 64]),
        .task_o(task_of[w*64 +: 64]),
        .overlaps_o(overlaps[w]),
        .mask_o(thread_mask[w*LANES +: LANES]),
        .predicate_x_o(predicate_x[w*LANES +: LANES]),
        .predicate_b_o(predicate_b[w*LANES +: LANES]),
        .operand_a_o(operand_a[w*DATA +: DATA]),
        .operand_b_o(operand_b[w*DATA +: DATA]),
        .operand_c_o(operand_c[w*DATA +: DATA]),
        .done_i(done),
        .done_data_i(done_data),
        .done_predicate_i(done_predicate),
        .done_subnormal_i(done_subnormal),
        .retire_o(retire[w]),
        .pc_o(narrow_pc),
        .retire_data_o(retire_data_o[w*DATA +: DATA]),
        .retire_predicate_o(retire_predicate_o[w*LANES +: LANES]),
        .fetching_o(fetching[w]),
        .executing_o(executing[w]),
        .fault_valid_o(warp_fault[w]),
        .fault_code_o(warp_fault_code[w*4 +: 4])
      );
    end
  endgenerate

  // The older kernel's warps go first, so that it ends and the next one can begin. Two cycles late: a warp granted then
  // has been in that kernel for at least as long.
  always @(posedge clk_i) begin
    older_q <= KERNEL_OVERLAP != 0 && rst_ni ? older : {WARPS{1'b0}};
    first_q <= older_q;
  end

  rp_dispatcher #(
    .WARPS(WARPS), .WARP_BITS(WARP_BITS), .INSTANCES(INSTANCES), .INSTANCE_TYPES(INSTANCE_TYPES),
    .OVERLAP(KERNEL_OVERLAP)
  ) dispatcher (
    .want_i(want),
    .type_i(wanted_type),
    .first_i(first_q),
    .grant_o(grant),
    .waiting_o(waiting),
    .ready_i(ready),
    .instance_grant_o(instance_grant),
    .instance_warp_o(instance_warp)
  );

  // Each ALU instance has a task register before it. Those with ports of their own stand here, the others in
  // rp_alu_instances.vh.
  generate
    for (k = 0; k < INSTANCES; k = k + 1) begin : gen_alu
      localparam [3:0] TYPE = INSTANCE_TYPES[k*4 +: 4];
      wire task_valid;
      wire [WARP_BITS-1:0] task_warp;
      wire [4:0] task_operation, task_word;
      wire [31:0] task_immediate;
      wire [LANES-1:0] task_mask, task_predicate_x, task_predicate_b;
      wire [DATA-1:0] task_operand_a, task_operand_b, task_operand_c;
      rp_task_register #(.WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .TYPE(TYPE), .FMA(FMA)) task_register (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .grant_i(instance_grant[k]),
        .warp_i(instance_warp[k*WARP_BITS +: WARP_BITS]),
        .instruction_i(task_of),
        .mask_i(thread_mask),
        .predicate_x_i(predicate_x),
        .predicate_b_i(predicate_b),
        .operand_a_i(operand_a),
        .operand_b_i(operand_b),
        .operand_c_i(operand_c),
        .task_valid_o(task_valid),
        .task_warp_o(task_warp),
        .task_operation_o(task_operation),
        .task_mask_o(task_mask),
        .task_operand_a_o(task_operand_a),
        .task_operand_b_o(task_operand_b),
        .task_operand_c_o(task_operand_c),
        .task_immediate_o(task_immediate),
        .task_word_o(task_word),
        .task_predicate_x_o(task_predicate_x),
        .task_predicate_b_o(task_predicate_b)
      );

`include "rp_alu_instances.vh"
      if (TYPE == ISA_TYPE_TID) begin : gen_tid
        wire task_place = KERNEL_OVERLAP != 0 && launch_place[task_warp];
        rp_tid_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(TID_LATENCY), .DEPTH(TID_DEPTH),
          .UNIT(UNIT), .SHARING(SHARING), .ARGUMENTS(ARGUMENTS)
        ) tid_alu (
          .block_i(task_place ? block[63:32] : block[31:0]),
          .blocks_i(task_place ? blocks[63:32] : blocks[31:0]),
          .threads_i(task_place ? threads[21:11] : threads[10:0]),
          .argument_write_i(argument_write_i),
          .argument_index_i(argument_index_i),
          .argument_data_i(argument_data_i),
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE == ISA_TYPE_MEM) begin : gen_mem
        rp_mem_alu #(
`include "rp_data_cache_parameter_map.vh"
          .SHARING(SHARING), .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS)
        ) mem_alu (
          .invalidate_i(argument_write_i),
          .memory_limit_i(memory_limit_i),
          .fault_valid_o(mem_fault),
          .fault_code_o(mem_fault_code),
          .fault_warp_o(mem_fault_warp),
          .request_valid_o(data_request),
          .request_ready_i(data_request_ready),
          .request_write_o(data_request_write),
          .request_address_o(data_request_address),
          .request_data_o(data_request_data),
          .request_mask_o(data_request_mask),
          .request_id_o(data_request_id),
          .response_valid_i(data_response),
          .response_id_i(memory_response_id_i),
          .response_beat_i(memory_response_beat_i),
          .response_data_i(memory_response_data_i),
          .store_trace_valid_o(store_trace_valid_o),
          .store_trace_warp_o(store_trace_warp_o),
          .store_trace_address_o(store_trace_address_o),
          .store_trace_data_o(store_trace_data_o),
          .store_trace_mask_o(store_trace_mask_o),
          .hit_o(data_hit),
          .miss_o(data_miss),
          .store_o(data_store),
          .idle_o(mem_idle),
`include "rp_alu_port_map.vh"
        );
      end
      if (TYPE == ISA_TYPE_RAY) begin : gen_ray
        rp_ray_alu #(
          .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .INTERSECTION_WORDS(INTERSECTION_WORDS),
          .WIDE_RAY_MEMORY(WIDE_RAY_MEMORY)
        ) ray_alu (
          .import_start_i(import_start),
          .import_start_kind_i(launch_import_i),
          .import_start_threads_i(launch_threads_i),
          .import_active_o(import_active),
          .import_request_valid_o(import_request_valid_o),
          .import_request_kind_o(import_request_kind_o),
          .import_request_ready_i(import_request_ready_i),
          .import_beat_valid_i(import_beat_valid_i),
          .import_beat_data_i(import_beat_data_i),
          .export_valid_o(export_valid_o),
          .export_ready_i(export_ready_i),
          .export_data_o(export_data_o),
          .export_last_o(export_last_o),
          .frame_valid_o(frame_valid_o),
          .frame_ready_i(frame_ready_i),
          .frame_pixel_o(frame_pixel_o),
          .frame_color_o(frame_color_o),
          .ray_trace_valid_o(ray_trace_valid_o),
          .ray_trace_warp_o(ray_trace_warp_o),
          .ray_trace_word_o(ray_trace_word_o),
          .ray_trace_mask_o(ray_trace_mask_o),
          .ray_trace_data_o(ray_trace_data_o),
          .fault_valid_o(ray_fault),
          .fault_code_o(ray_fault_code),
          .fault_warp_o(ray_fault_warp),
          .exporting_o(exporting),
          .exports_o(exports_o),
          .import_wait_o(import_wait),
          .export_wait_o(export_wait),
`include "rp_alu_port_map.vh"
        );
      end
    end
  endgenerate

  rp_memory_arbiter memory_arbiter (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .instruction_request_valid_i(instruction_request),
    .instruction_request_ready_o(instruction_request_ready),
    .instruction_request_address_i(instruction_request_address),
    .instruction_response_valid_o(instruction_response),
    .data_request_valid_i(data_request),
    .data_request_ready_o(data_request_ready),
    .data_request_write_i(data_request_write),
    .data_request_address_i(data_request_address),
    .data_request_data_i(data_request_data),
    .data_request_mask_i(data_request_mask),
    .data_request_id_i(data_request_id),
    .data_response_valid_o(data_response),
    .request_valid_o(memory_request_valid_o),
    .request_ready_i(memory_request_ready_i),
    .request_write_o(memory_request_write_o),
    .request_address_o(memory_request_address_o),
    .request_data_o(memory_request_data_o),
    .request_mask_o(memory_request_mask_o),
    .request_id_o(memory_request_id_o),
    .response_valid_i(memory_response_valid_i),
    .response_id_i(memory_response_id_i),
    .idle_o(arbiter_idle)
  );

  rp_performance_counters #(
    .WARPS(WARPS), .LANES(LANES), .INSTANCES(INSTANCES), .ALU_TYPES(ALU_TYPES), .INSTANCE_TYPES(INSTANCE_TYPES),
    .TRIPLES(TRIPLES), .COUNTER_BITS(COUNTER_BITS)
  ) performance_counters (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .running_i(busy_o),
    .retire_i(retire),
    .retire_mask_i(thread_mask),
    .instruction_hit_i(instruction_hit),
    .instruction_miss_i(instruction_miss),
    .data_hit_i(data_hit),
    .data_miss_i(data_miss),
    .data_store_i(data_store),
    .ready_i(ready),
    .grant_i(instance_grant),
    .waiting_i(waiting),
    .type_i(wanted_type),
    .launched_i(launched),
    .active_i(active),
    .fetching_i(fetching),
    .executing_i(executing),
    .overlapping_i(overlaps & grant),
    .import_wait_i(import_wait),
    .export_wait_i(export_wait),
    .select_i(counter_select_i),
    .value_o(counter_o)
  );

  // What the trace shows of an instruction's write-back.
  assign retire_valid_o = retire;
  assign retire_pc_o = pc;
  assign retire_instruction_o = instruction;
  assign retire_mask_o = thread_mask;

  // The first fault stays; of several in one cycle an ALU's wins, then the lowest warp's. Those of the cycle are kept
  // and chosen from afterwards; their PCs need not be, as a warp with a fault keeps its own.
  reg fault_q, alu_fault_q;
  reg [3:0] alu_fault_code_q;
  reg [WARP_BITS-1:0] alu_fault_warp_q;
  reg [WARPS-1:0] warp_fault_q;
  reg [WARPS*4-1:0] warp_fault_code_q;
  localparam [WARPS*4-1:0] WARP_FAULT_CODES = {WARPS{SUBNORMALS == 2 ? 4'hf : 4'h7}};   // bits that there are
  always @(posedge clk_i)
    if (!rst_ni) begin
      fault_q <= 1'b0;
    end else if (!fault_q) begin
      fault_q <= mem_fault || ray_fault || |warp_fault;
      alu_fault_q <= mem_fault || ray_fault;
      alu_fault_code_q <= mem_fault ? mem_fault_code : ray_fault_code;
      alu_fault_warp_q <= mem_fault ? mem_fault_warp : ray_fault_warp;
      warp_fault_q <= warp_fault;
      warp_fault_code_q <= warp_fault_code & WARP_FAULT_CODES;
    end

  reg [3:0] fault_code;
  reg [WARP_BITS-1:0] fault_warp;
  reg [15:0] fault_pc;
  integer f;
  always @* begin
    fault_code = 4'd0;
    fault_warp = {WARP_BITS{1'b0}};
    fault_pc = 16'd0;
    if (fault_q) begin
      for (f = WARPS - 1; f >= 0; f = f - 1)
        if (warp_fault_q[f]) begin
          fault_code = warp_fault_code_q[f*4 +: 4];
          fault_warp = f[WARP_BITS-1:0];
        end
      if (alu_fault_q) begin
        fault_code = alu_fault_code_q;
        fault_warp = alu_fault_warp_q;
      end
      // Codes 1 and 2 are of the next instruction.
      fault_pc = fault_code <= 4'd2 ? fetch_pc[fault_warp*16 +: 16] : pc[fault_warp*16 +: 16];
    end
  end
  assign fault_valid_o = fault_q;
  assign fault_code_o = fault_code;
  assign fault_warp_o = fault_warp;
  assign fault_pc_o = fault_pc;
endmodule
`default_nettype wire
