// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Thread, warp, block and unit indices, dimensions, kernel arguments.
`default_nettype none
module rp_tid_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 1,
  parameter integer UNIT = 0,               // number of the compute unit
  parameter integer SHARING = 0,            // has the instruction unit
  parameter integer ARGUMENTS = 32          // writes of others are ignored, reads never come
) (
  // the launch that runs, and the host's argument words
  input  wire [31:0]            block_i,
  input  wire [31:0]            blocks_i,
  input  wire [10:0]            threads_i,
  input  wire                   argument_write_i,
  input  wire [4:0]             argument_index_i,
  input  wire [31:0]            argument_data_i,
  // ALU framework
`include "rp_alu_ports.vh"
);
`include "rp_isa.vh"
  wire [DEPTH-1:0] stage_valid;
  reg [LANES*32-1:0] index_q;
  reg argument_q;
  wire [31:0] argument;
  integer l;

  rp_alu_pipeline #(.WARP_BITS(WARP_BITS), .LATENCY(LATENCY), .DEPTH(DEPTH)) alu_pipeline (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .task_valid_i(task_valid_i),
    .task_warp_i(task_warp_i),
    .ready_o(ready_o),
    .done_valid_o(done_valid_o),
    .done_warp_o(done_warp_o),
    .stage_valid_o(stage_valid)
  );

  localparam integer ARGUMENT_BITS = $clog2(ARGUMENTS);
  wire there = {1'b0, argument_index_i} < ARGUMENTS[5:0];
  rp_ram_1r1w #(.WIDTH(32), .DEPTH(ARGUMENTS)) arguments (
    .clk_i(clk_i),
    .read_i(task_valid_i),
    .read_address_i(task_immediate_i[ARGUMENT_BITS-1:0]),
    .read_data_o(argument),
    .write_i(argument_write_i && there),
    .write_address_i(argument_index_i[ARGUMENT_BITS-1:0]),
    .write_data_i(argument_data_i)
  );

  always @(posedge clk_i)
    if (task_valid_i) begin
      argument_q <= task_operation_i == ISA_TID_ARG;
      for (l = 0; l < LANES; l = l + 1)
        case (task_operation_i)
          ISA_TID_TID: index_q[l*32 +: 32] <= {{32-WARP_BITS{1'b0}}, task_warp_i} * LANES + l;
          ISA_TID_LANE: index_q[l*32 +: 32] <= l;
          ISA_TID_WARP: index_q[l*32 +: 32] <= {{32-WARP_BITS{1'b0}}, task_warp_i};
          ISA_TID_BLOCK: index_q[l*32 +: 32] <= block_i;
          ISA_TID_THREADS: index_q[l*32 +: 32] <= {21'd0, threads_i};
          default:
            index_q[l*32 +: 32] <= (SHARING != 0 && task_operation_i == ISA_TID_UNIT) ? UNIT : blocks_i;
        endcase
    end

  generate
    if (DEPTH == 1) begin : gen_direct
      assign done_data_o = argument_q ? {LANES{argument}} : index_q;
    end else begin : gen_delay
      rp_alu_delay #(.WIDTH(LANES*32), .STAGES(DEPTH-1)) alu_delay (
        .clk_i(clk_i), .valid_i(stage_valid[DEPTH-1:1]), .data_i(argument_q ? {LANES{argument}} : index_q),
        .data_o(done_data_o));
    end
  endgenerate
  assign done_predicate_o = {LANES{1'b0}};
endmodule
`default_nettype wire
