// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// PC/RPC stack of one warp. In a step it either yields the top entry's PC and increments it, or, when that PC has
// reached the entry's RPC, pops the entry and yields nothing. Control instructions change it at their write-back. The
// caller never steps and controls in the same cycle. The first entry has no RPC; popping it is an underflow.
`default_nettype none
module rp_pc_stack #(
  parameter integer DEPTH = 8,
  parameter integer PC_BITS = 16
) (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire        start_i,        // one entry with PC = start_pc_i
  input  wire [15:0] start_pc_i,     // as target_i and end_i: one that does not fit becomes the greatest PC there is
  input  wire        step_i,
  output wire        pc_valid_o,     // in a step: pc_o is to be fetched; else an entry was popped
  output wire [PC_BITS-1:0] pc_o,
  input  wire        jump_i,         // top PC = target_i
  input  wire        push_i,         // push {target_i, end_i}; with push_return_i the one below gets return_i as its PC
  input  wire        push_return_i,
  input  wire        pop_i,
  input  wire [15:0] target_i,
  input  wire [15:0] end_i,
  input  wire [PC_BITS-1:0] return_i,
  output wire        overflow_o,     // push_i on a full stack
  output wire        underflow_o     // pop_i on the first entry
);
  localparam integer POINTER_BITS = $clog2(DEPTH);
  localparam integer LAST = DEPTH - 1;
  localparam [POINTER_BITS-1:0] ONE = 1;

  reg [PC_BITS-1:0] pc_q [0:DEPTH-1];
  reg [PC_BITS-1:0] rpc_q [0:DEPTH-1];
  reg [POINTER_BITS-1:0] top_q;
  wire [POINTER_BITS-1:0] above = top_q + ONE;

  // The greatest PC lies outside of every program: it stands for all that are beyond it.
  function [PC_BITS-1:0] fitting(input [15:0] pc);
    integer b;
    begin
      fitting = pc[PC_BITS-1:0];
      for (b = PC_BITS; b < 16; b = b + 1) if (pc[b]) fitting = {PC_BITS{1'b1}};
    end
  endfunction

  wire first = top_q == {POINTER_BITS{1'b0}};
  wire finished = !first && pc_q[top_q] >= rpc_q[top_q];

  assign pc_o = pc_q[top_q];
  assign pc_valid_o = step_i && !finished;
  assign overflow_o = push_i && top_q == LAST[POINTER_BITS-1:0];
  assign underflow_o = pop_i && first;

  always @(posedge clk_i)
    if (!rst_ni) begin
      top_q <= {POINTER_BITS{1'b0}};
    end else if (start_i) begin
      top_q <= {POINTER_BITS{1'b0}};
      pc_q[0] <= fitting(start_pc_i);
    end else if (step_i) begin
      if (finished) top_q <= top_q - ONE;
      else pc_q[top_q] <= pc_q[top_q] + {{PC_BITS-1{1'b0}}, 1'b1};
    end else if (jump_i) begin
      pc_q[top_q] <= fitting(target_i);
    end else if (push_i && !overflow_o) begin
      if (push_return_i) pc_q[top_q] <= return_i;
      pc_q[above] <= fitting(target_i);
      rpc_q[above] <= fitting(end_i);
      top_q <= above;
    end else if (pop_i && !first) begin
      top_q <= top_q - ONE;
    end
endmodule
`default_nettype wire
