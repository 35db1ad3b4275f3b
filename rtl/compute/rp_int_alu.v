// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Integer and logic operations. Stage 1: everything but the multiplication, of which it makes three partial products;
// stage 2 adds those.
`default_nettype none
module rp_int_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 2,
  parameter integer WITHOUT = 0   // instructions that it lacks: a bit for each operation number
) (
`include "rp_alu_ports.vh"
);
`include "rp_isa.vh"
  generate
    if (DEPTH < 2) begin : gen_illegal
      int_alu_depth_must_be_at_least_2 illegal ();
    end
  endgenerate
  localparam [31:0] LACKS = WITHOUT;
  wire [DEPTH-1:0] stage_valid;
  reg [LANES*32-1:0] low_q;     // the result, but of a multiplication
  reg [LANES*32-1:0] product_q; // a * b[10:0]
  reg [LANES*21-1:0] middle_q;  // a * b[21:11], weighing 2^11
  reg [LANES*10-1:0] high_q;    // a * b[31:22], weighing 2^22
  reg multiply_q;
  reg [LANES*32-1:0] result_q;
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

  function [31:0] compute(input [4:0] op, input [31:0] a, input [31:0] b, input p);
    reg signed_less;
    begin
      signed_less = $signed(a) < $signed(b);
      // What the unit lacks is never asked for; it counts as mov.
      case (op)
        ISA_INT_MOV: compute = b;
        ISA_INT_IADD: compute = a + b;
        ISA_INT_ISUB: compute = a - b;
        ISA_INT_AND: compute = a & b;
        ISA_INT_OR: compute = LACKS[ISA_INT_OR] ? b : a | b;
        ISA_INT_XOR: compute = a ^ b;
        ISA_INT_SHL: compute = a << b[4:0];
        ISA_INT_SHR: compute = a >> b[4:0];
        ISA_INT_SAR: if (LACKS[ISA_INT_SAR]) compute = b; else compute = $signed(a) >>> b[4:0];
        ISA_INT_IMIN: compute = (!LACKS[ISA_INT_IMIN] && signed_less) ? a : b;
        ISA_INT_IMAX: compute = (LACKS[ISA_INT_IMAX] || signed_less) ? b : a;
        ISA_INT_UMIN: compute = (!LACKS[ISA_INT_UMIN] && a < b) ? a : b;
        ISA_INT_UMAX: compute = (LACKS[ISA_INT_UMAX] || a < b) ? b : a;
        default: compute = (!LACKS[ISA_INT_SEL] && p) ? a : b;
      endcase
    end
  endfunction

  always @(posedge clk_i)
    if (task_valid_i) begin
      multiply_q <= !LACKS[ISA_INT_IMUL] && task_operation_i == ISA_INT_IMUL;
      for (l = 0; l < LANES; l = l + 1) begin
        low_q[l*32 +: 32] <= compute(task_operation_i, task_operand_a_i[l*32 +: 32], task_operand_b_i[l*32 +: 32],
                                     task_predicate_x_i[l]);
        product_q[l*32 +: 32] <= task_operand_a_i[l*32 +: 32] * {21'd0, task_operand_b_i[l*32 +: 11]};
        middle_q[l*21 +: 21] <= task_operand_a_i[l*32 +: 21] * {10'd0, task_operand_b_i[l*32+11 +: 11]};
        high_q[l*10 +: 10] <= task_operand_a_i[l*32 +: 10] * task_operand_b_i[l*32+22 +: 10];
      end
    end

  always @(posedge clk_i)
    if (stage_valid[1])
      for (l = 0; l < LANES; l = l + 1)
        result_q[l*32 +: 32] <= multiply_q ? product_q[l*32 +: 32] + {middle_q[l*21 +: 21], 11'd0} +
                                                 {high_q[l*10 +: 10], 22'd0}
                                           : low_q[l*32 +: 32];

  generate
    if (DEPTH == 2) begin : gen_direct
      assign done_data_o = result_q;
    end else begin : gen_delay
      rp_alu_delay #(.WIDTH(LANES*32), .STAGES(DEPTH-2)) alu_delay (
        .clk_i(clk_i), .valid_i(stage_valid[DEPTH-1:2]), .data_i(result_q), .data_o(done_data_o));
    end
  endgenerate
  assign done_predicate_o = {LANES{1'b0}};
endmodule
`default_nettype wire
