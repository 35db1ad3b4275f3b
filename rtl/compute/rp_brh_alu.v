// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Compares into predicates, predicate logic, and the decision of control instructions: taken, in every lane of
// done_predicate_o. SUBNORMALS 0: IEEE, 1: subnormal operands count as zero, 2: the same, and done_subnormal_o flags a
// task that has met one.
`default_nettype none
module rp_brh_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 2,
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,   // of a float: bits below are not looked at
  parameter integer WITHOUT = 0   // instructions that it lacks: a bit for each operation number
) (
  output wire                   done_subnormal_o,
`include "rp_alu_ports.vh"
);
`include "rp_isa.vh"
  generate
    if (DEPTH < 2) begin : gen_illegal
      brh_alu_depth_must_be_at_least_2 illegal ();
    end
  endgenerate
  wire [DEPTH-1:0] stage_valid;
  reg [LANES-1:0] result_q;
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

  localparam integer D = 24 - SIGNIFICAND;
  localparam [31:0] LACKS = WITHOUT;
  // Zero, also where subnormals are flushed.
  function is_zero(input [31:D] v);
    is_zero = v[30:23] == 8'd0 && (SUBNORMALS != 0 || v[22:D] == {23-D{1'b0}});
  endfunction
  function is_nan(input [31:D] v);
    is_nan = v[30:23] == 8'hff && v[22:D] != {23-D{1'b0}};
  endfunction

  function compare(input [4:0] op, input [31:0] a, input [31:0] b);
    reg equal, less, signed_less, float_equal, float_less, ordered;
    reg [31:D] x, y;                        // as floats
    begin
      x = a[31:D];
      y = b[31:D];
      equal = a == b;
      less = a < b;
      signed_less = (a[31] != b[31]) ? a[31] : less;
      ordered = !is_nan(x) && !is_nan(y);
      float_equal = ordered && ((is_zero(x) && is_zero(y)) || x == y);
      // Magnitudes order like integers; a flushed or signed zero equals any other zero.
      if (is_zero(x)) float_less = !is_zero(y) && !y[31];
      else if (is_zero(y)) float_less = x[31];
      else if (x[31] != y[31]) float_less = x[31];
      else float_less = x[31] ? (y < x) : (x < y);
      float_less = float_less && ordered;
      // What the unit lacks is never asked for, and false.
      case (op)
        ISA_BRH_IEQ: compare = equal;
        ISA_BRH_INE: compare = !LACKS[ISA_BRH_INE] && !equal;
        ISA_BRH_ILT: compare = !LACKS[ISA_BRH_ILT] && signed_less;
        ISA_BRH_ILE: compare = !LACKS[ISA_BRH_ILE] && (signed_less || equal);
        ISA_BRH_IGT: compare = !(signed_less || equal);
        ISA_BRH_IGE: compare = !LACKS[ISA_BRH_IGE] && !signed_less;
        ISA_BRH_ULT: compare = less;
        ISA_BRH_ULE: compare = !LACKS[ISA_BRH_ULE] && (less || equal);
        ISA_BRH_UGT: compare = !LACKS[ISA_BRH_UGT] && !(less || equal);
        ISA_BRH_UGE: compare = !less;
        ISA_BRH_FEQ: compare = !LACKS[ISA_BRH_FEQ] && float_equal;
        ISA_BRH_FNE: compare = !LACKS[ISA_BRH_FNE] && !float_equal;
        ISA_BRH_FLT: compare = !LACKS[ISA_BRH_FLT] && float_less;
        ISA_BRH_FLE: compare = !LACKS[ISA_BRH_FLE] && (float_less || float_equal);
        ISA_BRH_FGT: compare = !LACKS[ISA_BRH_FGT] && (ordered && !float_less && !float_equal);
        default: compare = !LACKS[ISA_BRH_FGE] && ordered && !float_less;
      endcase
    end
  endfunction

  always @(posedge clk_i)
    if (task_valid_i)
      case (task_operation_i)
        ISA_BRH_PAND: result_q <= task_predicate_x_i & task_predicate_b_i;
        ISA_BRH_POR: result_q <= task_predicate_x_i | task_predicate_b_i;
        ISA_BRH_PXOR: result_q <= task_predicate_x_i ^ task_predicate_b_i;
        ISA_BRH_PANDN: result_q <= task_predicate_x_i & ~task_predicate_b_i;
        ISA_BRH_JANY, ISA_BRH_LOOP: result_q <= {LANES{|task_mask_i}};
        ISA_BRH_JNONE: result_q <= {LANES{~|task_mask_i}};
        ISA_BRH_CALL, ISA_BRH_RET, ISA_BRH_EXIT: result_q <= {LANES{1'b1}};
        default:
          for (l = 0; l < LANES; l = l + 1)
            result_q[l] <= compare(task_operation_i, task_operand_a_i[l*32 +: 32], task_operand_b_i[l*32 +: 32]);
      endcase

  rp_alu_delay #(.WIDTH(LANES), .STAGES(DEPTH-1)) alu_delay (
    .clk_i(clk_i), .valid_i(stage_valid[DEPTH-1:1]), .data_i(result_q), .data_o(done_predicate_o));
  assign done_data_o = {LANES*32{1'b0}};

  generate
    if (SUBNORMALS == 2) begin : gen_guard
      wire floats = task_operation_i >= ISA_BRH_FEQ && task_operation_i <= ISA_BRH_FGE;
      rp_subnormal_guard #(.LANES(LANES), .SIGNIFICAND(SIGNIFICAND), .DEPTH(DEPTH), .RESULT_STAGE(DEPTH)) guard (
        .clk_i(clk_i),
        .enter_i(task_mask_i & {LANES{task_valid_i && floats}}),
        .reads_i(3'b011),
        .a_i(task_operand_a_i),
        .b_i(task_operand_b_i),
        .c_i({LANES*32{1'b0}}),
        .result_i(1'b0),
        .subnormal_o(done_subnormal_o)
      );
    end else begin : gen_no_guard
      assign done_subnormal_o = 1'b0;
    end
  endgenerate
endmodule
`default_nettype wire
