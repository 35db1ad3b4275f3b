// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One warp: instruction buffer, PC stack, predicates and register bank, joined.
`default_nettype none
module rp_warp #(
  parameter integer LANES = 8,
  parameter integer STACK_DEPTH = 8,
  parameter integer INSTANCES = 7,
  parameter [INSTANCES*4-1:0] INSTANCE_TYPES = 28'h6543210,
  parameter integer FMA = 0,        // reads register rc too, and issues ffma
  parameter integer TRIPLES = 0,    // issues triples
  parameter integer SHARING = 0,
  parameter integer INTERSECTION_WORDS = 21,
  parameter integer REGISTERS = 16,
  parameter integer PREDICATES = 16,
  parameter integer ARGUMENTS = 32,
  parameter integer PC_BITS = 16,
  parameter [511:0] WITHOUT = 512'd0   // bit ALU type * 32 + operation: that ALU lacks the instruction
) (
  input  wire                      clk_i,
  input  wire                      rst_ni,
  input  wire                      start_i,
  input  wire [15:0]               start_pc_i,
  input  wire [LANES-1:0]          start_lanes_i,
  input  wire                      halt_i,
  output wire                      active_o,
  input  wire [15:0]               program_length_i,
  // instruction fetch
  output wire                      fetch_request_o,
  output wire [PC_BITS-1:0]        fetch_pc_o,
  input  wire                      fetch_grant_i,
  input  wire                      cache_hit_i,
  input  wire [63:0]               cache_instruction_i,
  input  wire                      refill_done_i,
  // dispatch
  output wire                      want_o,
  input  wire                      grant_i,
  output wire [3:0]                type_o,
  output wire [63:0]               instruction_o,
  output wire [63:0]               task_o,          // the same, or the element of a triple that is dispatched
  output wire                      overlaps_o,      // it is followed by another one at once
  output wire [LANES-1:0]          mask_o,
  output wire [LANES-1:0]          predicate_x_o,
  output wire [LANES-1:0]          predicate_b_o,
  output wire [LANES*32-1:0]       operand_a_o,
  output wire [LANES*32-1:0]       operand_b_o,
  output wire [LANES*32-1:0]       operand_c_o,
  // write-back: what every ALU instance has finished in this cycle, and whether it is this warp's task
  input  wire [INSTANCES-1:0]          done_i,
  input  wire [INSTANCES*LANES*32-1:0] done_data_i,
  input  wire [INSTANCES*LANES-1:0]    done_predicate_i,
  input  wire [INSTANCES-1:0]          done_subnormal_i,   // the task has met a subnormal number
  output reg                       retire_o,
  output wire [PC_BITS-1:0]        pc_o,
  output reg  [LANES*32-1:0]       retire_data_o,
  output reg  [LANES-1:0]          retire_predicate_o,
  // for the performance counters
  output wire                      fetching_o,
  output wire                      executing_o,
  // faults, one cycle; codes 1 and 2 are of the instruction at fetch_pc_o, 3, 4 and 8 of that at pc_o
  output wire                      fault_valid_o,
  output wire [3:0]                fault_code_o
);
`include "rp_isa.vh"
  localparam integer REGISTER_BITS = $clog2(REGISTERS);
  reg [LANES-1:0] launched_q;
  reg [LANES-1:0] retire_pred;
  integer s, n;

  wire step, pc_valid, read, writes_register, writes_predicate, illegal, outside, overflow, underflow;
  wire [PC_BITS-1:0] stack_pc;
  wire [63:0] instruction = instruction_o;
  wire triple;
  wire [1:0] read_element, done_element;
`include "rp_isa_fields.vh"
  assign type_o = field_type;

  // The result mux: at most one ALU instance holds this warp.
  always @* begin
    retire_o = 1'b0;
    retire_data_o = {LANES*32{1'b0}};
    retire_pred = {LANES{1'b0}};
    for (s = 0; s < INSTANCES; s = s + 1)
      if (done_i[s]) begin
        retire_o = 1'b1;
        retire_data_o = done_data_i[s*LANES*32 +: LANES*32];
        retire_pred = done_predicate_i[s*LANES +: LANES];
      end
    retire_predicate_o = retire_pred & mask_o;
  end

  // What has met a subnormal number is followed by no other instruction, so that its PC stays.
  wire subnormal = |(done_i & done_subnormal_i);

  // Control instructions: the branch ALU gives in every lane's predicate bit whether the jump is taken. Only its done
  // counts, so that the path to the PC stack leads through no other ALU's.
  reg control, taken;
  always @* begin
    control = 1'b0;
    taken = 1'b0;
    for (n = 0; n < INSTANCES; n = n + 1)
      if (INSTANCE_TYPES[n*4 +: 4] == ISA_TYPE_BRH && done_i[n]) begin
        control = 1'b1;
        taken = done_predicate_i[n*LANES];
      end
  end
  wire jump = control && taken && (field_operation == ISA_BRH_JANY || field_operation == ISA_BRH_JNONE);
  wire enter = control && taken && field_operation == ISA_BRH_LOOP;
  wire leave = control && !taken && field_operation == ISA_BRH_LOOP;
  wire call = control && field_operation == ISA_BRH_CALL;

  always @(posedge clk_i) if (start_i) launched_q <= start_lanes_i;

  reg [15:0] target;
  always @* begin
    target = field_target;
    if (enter) begin
      target = 16'd0;
      target[PC_BITS-1:0] = pc_o + {{PC_BITS-1{1'b0}}, 1'b1};
    end
  end

  rp_pc_stack #(.DEPTH(STACK_DEPTH), .PC_BITS(PC_BITS)) pc_stack (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i(start_i),
    .start_pc_i(start_pc_i),
    .step_i(step),
    .pc_valid_o(pc_valid),
    .pc_o(stack_pc),
    .jump_i(jump || leave),
    .push_i(enter || call),
    .push_return_i(enter),
    .pop_i(control && field_operation == ISA_BRH_RET),
    .target_i(target),
    .end_i(enter ? field_target : field_end),
    .return_i(pc_o),
    .overflow_o(overflow),
    .underflow_o(underflow)
  );

  rp_instruction_buffer #(
    .FMA(FMA != 0), .TRIPLES(TRIPLES != 0), .SHARING(SHARING != 0),
    .INTERSECTION_WORDS(INTERSECTION_WORDS), .REGISTERS(REGISTERS),
    .PREDICATES(PREDICATES), .ARGUMENTS(ARGUMENTS), .PC_BITS(PC_BITS), .WITHOUT(WITHOUT)
  ) instruction_buffer (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i(start_i),
    .halt_i(halt_i),
    .active_o(active_o),
    .step_o(step),
    .pc_valid_i(pc_valid),
    .pc_i(stack_pc),
    .program_length_i(program_length_i),
    .fetch_request_o(fetch_request_o),
    .fetch_pc_o(fetch_pc_o),
    .fetch_grant_i(fetch_grant_i),
    .cache_hit_i(cache_hit_i),
    .cache_instruction_i(cache_instruction_i),
    .refill_done_i(refill_done_i),
    .read_o(read),
    .want_o(want_o),
    .grant_i(grant_i),
    .done_i(retire_o),
    .fault_i(subnormal),
    .instruction_o(instruction_o),
    .triple_o(triple),
    .read_element_o(read_element),
    .done_element_o(done_element),
    .overlaps_o(overlaps_o),
    .pc_o(pc_o),
    .writes_register_o(writes_register),
    .writes_predicate_o(writes_predicate),
    .fetching_o(fetching_o),
    .executing_o(executing_o),
    .illegal_o(illegal),
    .outside_o(outside)
  );

  // ---- The element of a triple: what of its numbers moves on, and the operation that it has alone.
  wire one_ra;
  wire [3:0] task_ra = field_ra + (one_ra ? 4'd0 : {2'd0, read_element});
  wire [3:0] task_rb = field_rb + {2'd0, read_element};
  wire [3:0] written = field_rd + {2'd0, done_element};
  wire unused_bits = &{1'b0, task_ra, task_rb, written};   // of numbers that no instruction has
  generate
    if (TRIPLES != 0) begin : gen_triples
      wire address = field_type == ISA_TYPE_MEM;
      wire argument = field_type == ISA_TYPE_TID;
      wire word = field_type == ISA_TYPE_RAY;
      assign one_ra = (triple && field_operation[3]) || address;
      assign task_o = {field_type, triple ? {2'd0, field_operation[2:0]} : field_operation, instruction[54:37],
                       word ? field_x + {3'd0, read_element} : field_x, instruction[31:5],
                       argument ? instruction[4:0] + {3'd0, read_element}
                       : address ? {instruction[4], instruction[3:2] | read_element, instruction[1:0]}
                       : instruction[4:0]};
    end else begin : gen_no_triples
      wire unused = triple;
      assign one_ra = 1'b0;
      assign task_o = instruction_o;
    end
  endgenerate

  rp_predicate_file #(.LANES(LANES), .PREDICATES(PREDICATES)) predicate_file (
    .clk_i(clk_i),
    .clear_i(start_i),
    .read_i(read),
    .launched_i(launched_q),
    .guard_negated_i(field_guard_negated),
    .guard_i(field_guard),
    .x_index_i(field_x[3:0]),
    .b_index_i(field_rb),
    .mask_o(mask_o),
    .x_o(predicate_x_o),
    .b_o(predicate_b_o),
    .write_i(retire_o && writes_predicate),
    .write_index_i(field_rd),
    .write_data_i(retire_predicate_o)
  );

  rp_ram_2r1w #(.WIDTH(LANES*32), .DEPTH(REGISTERS), .GRANULE(32)) register_bank (
    .clk_i(clk_i),
    .read_i(read),
    .read_address_a_i(task_ra[REGISTER_BITS-1:0]),
    .read_address_b_i(task_rb[REGISTER_BITS-1:0]),
    .read_data_a_o(operand_a_o),
    .read_data_b_o(operand_b_o),
    .write_mask_i(retire_o && writes_register ? mask_o : {LANES{1'b0}}),
    .write_address_i(written[REGISTER_BITS-1:0]),
    .write_data_i(retire_data_o)
  );

  // A copy of the bank gives the third operand, as memories with three read ports are rare.
  genvar l;
  generate
    if (FMA != 0) begin : gen_third
      wire [3:0] task_rc = field_x[3:0] + {2'd0, read_element};
      for (l = 0; l < LANES; l = l + 1) begin : gen_lane
        rp_ram_1r1w #(.WIDTH(32), .DEPTH(REGISTERS)) register_copy (
          .clk_i(clk_i),
          .read_i(read),
          .read_address_i(task_rc[REGISTER_BITS-1:0]),
          .read_data_o(operand_c_o[l*32 +: 32]),
          .write_i(retire_o && writes_register && mask_o[l]),
          .write_address_i(written[REGISTER_BITS-1:0]),
          .write_data_i(retire_data_o[l*32 +: 32])
        );
      end
      wire unused = &{1'b0, task_rc};
    end else begin : gen_no_third
      assign operand_c_o = {LANES*32{1'b0}};
    end
  endgenerate

  assign fault_valid_o = illegal || outside || overflow || underflow || subnormal;
  assign fault_code_o = subnormal ? 4'd8 : illegal ? 4'd1 : outside ? 4'd2 : overflow ? 4'd3 : 4'd4;
endmodule
`default_nettype wire
