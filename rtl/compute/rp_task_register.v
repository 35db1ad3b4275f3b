// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The task of one ALU instance: takes over what the warp that the dispatcher chose offers, and holds it for one cycle.
// Operands that no instruction of the ALU's type has are zero: no register and no multiplexer is spent on them.
`default_nettype none
module rp_task_register #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter [3:0] TYPE = 4'd0,      // of the ALU
  parameter integer FMA = 0         // there is a third operand
) (
  input  wire                      clk_i,
  input  wire                      rst_ni,
  input  wire                      grant_i,       // in the next cycle there is a task
  input  wire [WARP_BITS-1:0]      warp_i,        // the task's
  // warps
  input  wire [WARPS*64-1:0]       instruction_i,
  input  wire [WARPS*LANES-1:0]    mask_i,
  input  wire [WARPS*LANES-1:0]    predicate_x_i,
  input  wire [WARPS*LANES-1:0]    predicate_b_i,
  input  wire [WARPS*LANES*32-1:0] operand_a_i,
  input  wire [WARPS*LANES*32-1:0] operand_b_i,
  input  wire [WARPS*LANES*32-1:0] operand_c_i,
  // the task
  output reg                       task_valid_o,
  output reg  [WARP_BITS-1:0]      task_warp_o,
  output reg  [4:0]                task_operation_o,
  output reg  [LANES-1:0]          task_mask_o,
  output reg  [LANES*32-1:0]       task_operand_a_o,
  output reg  [LANES*32-1:0]       task_operand_b_o,
  output reg  [LANES*32-1:0]       task_operand_c_o,
  output reg  [31:0]               task_immediate_o,
  output reg  [4:0]                task_word_o,
  output reg  [LANES-1:0]          task_predicate_x_o,
  output reg  [LANES-1:0]          task_predicate_b_o
);
`include "rp_isa.vh"
  localparam integer DATA = LANES * 32;
  localparam [DATA-1:0] NO_DATA = 0;
  localparam [LANES-1:0] NO_PREDICATE = 0;

  wire [63:0] instruction = instruction_i[warp_i*64 +: 64];
`include "rp_isa_fields.vh"

  always @(posedge clk_i)
    if (!rst_ni) task_valid_o <= 1'b0;
    else task_valid_o <= grant_i;

  always @(posedge clk_i)
    if (grant_i) begin
      task_warp_o <= warp_i;
      task_operation_o <= field_operation;
      task_mask_o <= mask_i[warp_i*LANES +: LANES];
      task_operand_a_o <= ISA_HAS_OPERAND_A[TYPE] ? operand_a_i[warp_i*DATA +: DATA] : NO_DATA;
      task_operand_b_o <= !ISA_HAS_OPERAND_B[TYPE] ? NO_DATA
                          : field_b_is_immediate ? {LANES{field_immediate}} : operand_b_i[warp_i*DATA +: DATA];
      task_operand_c_o <= FMA != 0 && ISA_HAS_OPERAND_C[TYPE] ? operand_c_i[warp_i*DATA +: DATA] : NO_DATA;
      task_immediate_o <= ISA_HAS_IMMEDIATE[TYPE] ? field_immediate : 32'd0;
      task_word_o <= ISA_HAS_WORD[TYPE] ? field_x : 5'd0;
      task_predicate_x_o <= ISA_HAS_PREDICATE_X[TYPE] ? predicate_x_i[warp_i*LANES +: LANES] : NO_PREDICATE;
      task_predicate_b_o <= ISA_HAS_PREDICATE_B[TYPE] ? predicate_b_i[warp_i*LANES +: LANES] : NO_PREDICATE;
    end
endmodule
`default_nettype wire
