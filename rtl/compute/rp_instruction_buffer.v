// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One warp's instruction buffer: the current instruction in the data routine, the next one in the instruction routine,
// and the state of both. docs/machine/architecture.md, section 3, has the cycles.
`default_nettype none
module rp_instruction_buffer #(
  parameter [0:0] FMA = 1'b0,          // ffma is legal
  parameter [0:0] TRIPLES = 1'b0,      // triples are legal
  parameter [0:0] SHARING = 1'b0,      // unit and inval are legal
  parameter integer INTERSECTION_WORDS = 21,  // among so many words
  parameter integer REGISTERS = 16,           // instructions name no others, predicates, arguments
  parameter integer PREDICATES = 16,
  parameter integer ARGUMENTS = 32,
  parameter integer PC_BITS = 16,
  parameter [511:0] WITHOUT = 512'd0   // bit ALU type * 32 + operation: that ALU lacks the instruction
) (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire        start_i,          // begin fetching at the PC stack's first entry
  input  wire        halt_i,           // a fault anywhere: nothing new is issued
  output reg         active_o,         // started and not yet exited
  // instruction routine
  output wire        step_o,           // PCStack: step the PC stack
  input  wire        pc_valid_i,
  input  wire [PC_BITS-1:0] pc_i,
  input  wire [15:0] program_length_i,
  output wire        fetch_request_o,  // IArb: wants the instruction cache
  output reg  [PC_BITS-1:0] fetch_pc_o,
  input  wire        fetch_grant_i,
  input  wire        cache_hit_i,      // ICache: result of the lookup granted in the cycle before
  input  wire [63:0] cache_instruction_i,
  input  wire        refill_done_i,    // a line has come back; missed lookups are worth repeating
  // data routine
  output wire        read_o,           // RegFile
  output wire        want_o,           // Dispatch
  input  wire        grant_i,
  input  wire        done_i,           // WriBack; of a triple, of each element
  input  wire        fault_i,          // with done_i: the instruction has a fault, so no other one is issued
  output reg  [63:0] instruction_o,
  output wire        triple_o,
  output wire [1:0]  read_element_o,   // of a triple, which is read and dispatched; else 0
  output wire [1:0]  done_element_o,   // of a triple, which is done next; else 0
  output wire        overlaps_o,       // once this element has its ALU, the next one is read at once
  output reg  [PC_BITS-1:0] pc_o,
  output wire        writes_register_o,
  output wire        writes_predicate_o,
  // for the performance counters: no instruction is under way; an ALU has it
  output wire        fetching_o,
  output wire        executing_o,
  // faults, one cycle; fetch_pc_o is that instruction's, from the next cycle on
  output wire        illegal_o,        // the next instruction has no table row; it is not issued
  output wire        outside_o         // its PC is not in the program
);
`include "rp_isa.vh"
`include "rp_isa_functions.vh"
  localparam [2:0] F_IDLE = 3'd0, F_STACK = 3'd1, F_ARBITER = 3'd2, F_CACHE = 3'd3, F_MISS = 3'd4, F_FULL = 3'd5;
  localparam [1:0] D_IDLE = 2'd0, D_READ = 2'd1, D_WANT = 2'd2, D_EXECUTE = 2'd3;

  reg [2:0] fetch_q;
  reg [1:0] data_q;
  reg [63:0] next_q;
  reg next_legal_q;
  reg next_control_q;

  wire [63:0] instruction = instruction_o;
`include "rp_isa_fields.vh"
  wire exits = field_type == ISA_TYPE_BRH && field_operation == ISA_BRH_EXIT;
  wire retire;   // done, and no element is left
  wire ready = fetch_q == F_FULL && (data_q == D_IDLE || retire) && !halt_i && !fault_i;

  assign step_o = fetch_q == F_STACK && !halt_i;
  assign fetch_request_o = fetch_q == F_ARBITER && !halt_i;
  wire issue = ready && next_legal_q;
  assign illegal_o = ready && !next_legal_q;
  reg [15:0] next_pc;
  always @* begin
    next_pc = 16'd0;
    next_pc[PC_BITS-1:0] = pc_i;
  end
  assign outside_o = step_o && pc_valid_i && next_pc >= program_length_i;
  assign read_o = data_q == D_READ;
  assign want_o = data_q == D_WANT && !halt_i;
  assign fetching_o = active_o && data_q == D_IDLE;
  assign executing_o = data_q == D_EXECUTE;
  assign writes_register_o = isa_writes_register(instruction);
  assign writes_predicate_o = isa_writes_predicate(instruction);

  always @(posedge clk_i)
    if (!rst_ni) begin
      active_o <= 1'b0;
      fetch_q <= F_IDLE;
      data_q <= D_IDLE;
    end else if (start_i) begin
      active_o <= 1'b1;
      fetch_q <= F_STACK;
      data_q <= D_IDLE;
    end else if (active_o) begin
      case (fetch_q)
        F_STACK:
          if (pc_valid_i) begin
            fetch_pc_o <= pc_i;
            if (!outside_o) fetch_q <= F_ARBITER;
          end
        F_ARBITER: if (fetch_grant_i) fetch_q <= F_CACHE;
        F_CACHE:
          if (cache_hit_i) begin
            next_q <= cache_instruction_i;
            next_legal_q <= isa_legal(cache_instruction_i, FMA, TRIPLES, SHARING, INTERSECTION_WORDS[4:0],
                                      WITHOUT[cache_instruction_i[63:55]]) &&
                            isa_numbers_fit(cache_instruction_i, REGISTERS[4:0], PREDICATES[4:0], ARGUMENTS[5:0]);
            next_control_q <= isa_control(cache_instruction_i);
            fetch_q <= F_FULL;
          end else begin
            fetch_q <= refill_done_i ? F_ARBITER : F_MISS;
          end
        F_MISS: if (refill_done_i) fetch_q <= F_ARBITER;
        default: ;
      endcase

      case (data_q)
        D_READ: data_q <= D_WANT;
        D_WANT: if (grant_i) data_q <= overlaps_o ? D_READ : D_EXECUTE;
        default: ;
      endcase
      if (next_after_done) data_q <= D_READ;
      if (retire) begin
        data_q <= D_IDLE;
        if (exits) active_o <= 1'b0;
        else if (isa_control(instruction)) fetch_q <= F_STACK;
      end

      if (issue) begin
        instruction_o <= next_q;
        pc_o <= fetch_pc_o;
        data_q <= D_READ;
        fetch_q <= next_control_q ? F_IDLE : F_STACK;
      end
    end

  // ---- Triples. Loads wait for each other, as the memory ALU has one task of a warp at a time; so do arguments, and
  // floats of which one reads what an earlier one has written. Of other floats, and accesses to ray memory, the next
  // element is read when the one before has its ALU; they are done in order.
  wire next_after_done;
  generate
    if (TRIPLES != 1'b0) begin : gen_triples
      reg triple_q, waits_q;
      reg [1:0] read_element_q, done_element_q;
      wire next_triple = isa_triple(next_q);
      wire next_waits = next_q[63:60] == ISA_TYPE_FLT ? isa_elements_depend(next_q) : next_q[63:60] != ISA_TYPE_RAY;
      wire last_read = !triple_q || read_element_q == 2'd2;
      wire last_done = !triple_q || done_element_q == 2'd2;
      always @(posedge clk_i)
        if (issue) begin
          triple_q <= next_triple;
          waits_q <= next_waits;
          read_element_q <= 2'd0;
          done_element_q <= 2'd0;
        end else begin
          if (next_after_done || (overlaps_o && want_o && grant_i)) read_element_q <= read_element_q + 2'd1;
          if (done_i && !last_done) done_element_q <= done_element_q + 2'd1;
        end
      assign triple_o = triple_q;
      assign read_element_o = read_element_q;
      assign done_element_o = done_element_q;
      assign overlaps_o = !last_read && !waits_q;
      assign next_after_done = done_i && !last_done && waits_q;
      assign retire = done_i && last_done;
    end else begin : gen_no_triples
      assign triple_o = 1'b0;
      assign read_element_o = 2'd0;
      assign done_element_o = 2'd0;
      assign overlaps_o = 1'b0;
      assign next_after_done = 1'b0;
      assign retire = done_i;
    end
  endgenerate
endmodule
`default_nettype wire
