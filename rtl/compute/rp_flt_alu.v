// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Flt ALU: fadd fsub fmul fmin fmax f2i i2f in three stages, or with FMA these and ffma in five, further ones as delay.
// docs/use/arithmetic.md has the rules of the results. SUBNORMALS 0: IEEE, 1: flushed, 2: the same, and
// done_subnormal_o flags a task that has met one. SIGNIFICAND: bits of a float's significand, with its leading one.
// task_operand_c_i is register rc, the third operand of ffma. Lanes outside the mask keep what they held. Only the unit
// an operation needs is clocked.
`default_nettype none
module rp_flt_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 3,
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer FMA = 0,
  parameter integer WITHOUT = 0   // instructions that it lacks: a bit for each operation number
) (
  output wire                   done_subnormal_o,
`include "rp_alu_ports.vh"
);
  `include "rp_isa.vh"
  localparam integer STAGES = (FMA != 0) ? 5 : 3;

  generate
    if (FMA == 0 && DEPTH < 3) begin : gen_illegal_depth
      flt_alu_needs_a_depth_of_at_least_3 illegal ();
    end
    if (FMA != 0 && DEPTH < 5) begin : gen_illegal_fma_depth
      flt_alu_with_fma_needs_a_depth_of_at_least_5 illegal ();
    end
    if (FMA < 0 || FMA > 1) begin : gen_illegal_fma
      flt_alu_needs_fma_0_or_1 illegal ();
    end
    if (SUBNORMALS < 0 || SUBNORMALS > 2) begin : gen_illegal_subnormals
      flt_alu_needs_subnormals_0_to_2 illegal ();
    end
    if (SIGNIFICAND < 11 || SIGNIFICAND > 24) begin : gen_illegal_significand
      flt_alu_needs_a_significand_of_11_to_24 illegal ();
    end
  endgenerate

  wire [DEPTH-1:0] stage_valid;
  rp_alu_pipeline #(.WARP_BITS(WARP_BITS), .LATENCY(LATENCY), .DEPTH(DEPTH)) pipeline (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .task_valid_i(task_valid_i),
    .task_warp_i(task_warp_i),
    .ready_o(ready_o),
    .done_valid_o(done_valid_o),
    .done_warp_o(done_warp_o),
    .stage_valid_o(stage_valid)
  );

  wire moving = |stage_valid[STAGES-1:0];
  // The unit of an operation, and what its conversion is.
  wire add = task_valid_i && (task_operation_i == ISA_FLT_FADD || task_operation_i == ISA_FLT_FSUB);
  wire multiply = task_valid_i && task_operation_i == ISA_FLT_FMUL;
  wire fuse = task_valid_i && FMA != 0 && task_operation_i == ISA_FLT_FFMA;
  wire convert = task_valid_i && !add && !multiply && !fuse;
  reg [1:0] convert_op;
  always @* begin
    case (task_operation_i)
      ISA_FLT_FMIN: convert_op = 2'd0;
      ISA_FLT_FMAX: convert_op = 2'd1;
      ISA_FLT_F2I: convert_op = 2'd2;
      default: convert_op = 2'd3;
    endcase
  end

  wire [LANES*32-1:0] result;
  wire [LANES-1:0] tiny;
  genvar l;
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_lane
      // Whether each stage of a unit holds a task of this lane.
      reg [STAGES-2:0] add_later_q, multiply_later_q, fuse_later_q, convert_later_q;
      wire [STAGES-1:0] add_enable = {add_later_q, add && task_mask_i[l]};
      wire [STAGES-1:0] multiply_enable = {multiply_later_q, multiply && task_mask_i[l]};
      wire [STAGES-1:0] fuse_enable = {fuse_later_q, fuse && task_mask_i[l]};
      wire [STAGES-1:0] convert_enable = {convert_later_q, convert && task_mask_i[l]};
      always @(posedge clk_i) begin
        if (!rst_ni) begin
          add_later_q <= {STAGES-1{1'b0}};
          multiply_later_q <= {STAGES-1{1'b0}};
          fuse_later_q <= {STAGES-1{1'b0}};
          convert_later_q <= {STAGES-1{1'b0}};
        end else if (moving) begin
          add_later_q <= add_enable[STAGES-2:0];
          multiply_later_q <= multiply_enable[STAGES-2:0];
          fuse_later_q <= fuse_enable[STAGES-2:0];
          convert_later_q <= convert_enable[STAGES-2:0];
        end
      end
      rp_float_lane #(
        .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND), .FMA(FMA), .NO_CONVERSION(WITHOUT >> ISA_FLT_FMIN)
      ) lane (
        .clk_i(clk_i),
        .add_enable_i(add_enable),
        .multiply_enable_i(multiply_enable),
        .fuse_enable_i(fuse_enable),
        .convert_enable_i(convert_enable),
        .subtract_i(task_operation_i == ISA_FLT_FSUB),
        .convert_op_i(convert_op),
        .a_i(task_operand_a_i[l*32 +: 32]),
        .b_i(task_operand_b_i[l*32 +: 32]),
        .c_i(task_operand_c_i[l*32 +: 32]),
        .result_o(result[l*32 +: 32]),
        .tiny_o(tiny[l])
      );
    end
    if (DEPTH > STAGES) begin : gen_delay
      rp_alu_delay #(.WIDTH(LANES*32), .STAGES(DEPTH-STAGES)) delay (
        .clk_i(clk_i), .valid_i(stage_valid[DEPTH-1:STAGES]), .data_i(result), .data_o(done_data_o));
    end else begin : gen_direct
      assign done_data_o = result;
    end
    if (SUBNORMALS == 2) begin : gen_guard
      wire two = task_operation_i != ISA_FLT_F2I;   // float operands a and b, unless it is i2f
      rp_subnormal_guard #(.LANES(LANES), .SIGNIFICAND(SIGNIFICAND), .DEPTH(DEPTH), .RESULT_STAGE(STAGES)) guard (
        .clk_i(clk_i),
        .enter_i(task_mask_i & {LANES{task_valid_i && task_operation_i != ISA_FLT_I2F}}),
        .reads_i({fuse, two, 1'b1}),
        .a_i(task_operand_a_i),
        .b_i(task_operand_b_i),
        .c_i(task_operand_c_i),
        .result_i(|tiny),
        .subnormal_o(done_subnormal_o)
      );
    end else begin : gen_no_guard
      wire unused = &{1'b0, tiny};
      assign done_subnormal_o = 1'b0;
    end
  endgenerate
  assign done_predicate_o = {LANES{1'b0}};
endmodule
`default_nettype wire
