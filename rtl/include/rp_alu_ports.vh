// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // The ports of every ALU, to be included at the end of a module's port list. docs/machine/architecture.md, section 3,
  // has their protocol. A task is there in the cycle in which task_valid_i is high. No ALU looks at all of it.
  /* verilator lint_off UNUSEDSIGNAL */
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   task_valid_i,
  input  wire [WARP_BITS-1:0]   task_warp_i,
  input  wire [4:0]             task_operation_i,
  input  wire [LANES-1:0]       task_mask_i,
  input  wire [LANES*32-1:0]    task_operand_a_i,
  input  wire [LANES*32-1:0]    task_operand_b_i,      // a register, or the immediate
  input  wire [LANES*32-1:0]    task_operand_c_i,
  input  wire [31:0]            task_immediate_i,
  input  wire [4:0]             task_word_i,           // of a ray package
  input  wire [LANES-1:0]       task_predicate_x_i,
  input  wire [LANES-1:0]       task_predicate_b_i,
  output wire                   ready_o,               // takes a task that is granted in this cycle
  output wire                   done_valid_o,
  output wire [WARP_BITS-1:0]   done_warp_o,
  output wire [LANES*32-1:0]    done_data_o,
  output wire [LANES-1:0]       done_predicate_o
  /* verilator lint_on UNUSEDSIGNAL */
