// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Slw ALU: fdiv fsqrt frsqrt frcp, a new task in any of its stages; further stages as delay. docs/use/arithmetic.md
// has the rules. SUBNORMALS 0: IEEE, 1: flushed, 2: the same, and done_subnormal_o flags a task that has met one.
// SIGNIFICAND: bits of a float's significand, with its leading one. SLOW_UNIT 0: correctly rounded, 1: table and two
// Newton steps, both in 11 stages; 2: one step, 8; 3: none, 6. Lanes outside the mask keep what they held and are not
// clocked. With SLOW_LANES below LANES there are so many lanes only. They take a task group after group, the lowest
// lanes first, which makes LANES / SLOW_LANES - 1 cycles more than DEPTH, and as many between tasks; the task's
// operands must stay.
`default_nettype none
module rp_slw_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 11,
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer SLOW_UNIT = 0,
  parameter integer SLOW_LANES = 32,
  parameter integer WITHOUT = 0   // instructions that it lacks: a bit for each operation number
) (
  output wire                   done_subnormal_o,
`include "rp_alu_ports.vh"
);
  `include "rp_isa.vh"

  localparam integer STAGES = (SLOW_UNIT <= 1) ? 11 : (SLOW_UNIT == 2) ? 8 : 6;
  localparam integer GROUP = (SLOW_LANES < LANES) ? SLOW_LANES : LANES;   // lanes
  localparam integer GROUPS = LANES / GROUP;
  localparam integer DELAY = DEPTH - STAGES;
  localparam integer TASK_LATENCY = (LATENCY > GROUPS) ? LATENCY : GROUPS;
  localparam integer TASK_DEPTH = DEPTH + GROUPS - 1;
  generate
    if (DEPTH < STAGES) begin : gen_illegal_depth
      slw_alu_needs_more_depth illegal ();
    end
    if (SUBNORMALS < 0 || SUBNORMALS > 2) begin : gen_illegal_subnormals
      slw_alu_needs_subnormals_0_to_2 illegal ();
    end
    if (SIGNIFICAND < 11 || SIGNIFICAND > 24) begin : gen_illegal_significand
      slw_alu_needs_a_significand_of_11_to_24 illegal ();
    end
    if (SLOW_UNIT < 0 || SLOW_UNIT > 3) begin : gen_illegal_slow_unit
      slw_alu_needs_slow_unit_0_to_3 illegal ();
    end
  endgenerate

  wire [TASK_DEPTH-1:0] stage_valid;
  rp_alu_pipeline #(.WARP_BITS(WARP_BITS), .LATENCY(TASK_LATENCY), .DEPTH(TASK_DEPTH)) pipeline (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .task_valid_i(task_valid_i),
    .task_warp_i(task_warp_i),
    .ready_o(ready_o),
    .done_valid_o(done_valid_o),
    .done_warp_o(done_warp_o),
    .stage_valid_o(stage_valid)
  );

  // ---- The group that enters in this cycle: g of the task that arrived g cycles ago, which is one task at most.
  reg [GROUP*32-1:0] operand_a, operand_b;
  reg [GROUP-1:0] entering;   // lanes
  integer g;
  always @* begin
    operand_a = task_operand_a_i[GROUP*32-1:0];
    operand_b = task_operand_b_i[GROUP*32-1:0];
    entering = {GROUP{stage_valid[0]}} & task_mask_i[GROUP-1:0];
    if (GROUPS > 1) begin
      operand_a = {GROUP{32'd0}};
      operand_b = {GROUP{32'd0}};
      entering = {GROUP{1'b0}};
      for (g = 0; g < GROUPS; g = g + 1) begin
        operand_a = operand_a | ({GROUP*32{stage_valid[g]}} & task_operand_a_i[g*GROUP*32 +: GROUP*32]);
        operand_b = operand_b | ({GROUP*32{stage_valid[g]}} & task_operand_b_i[g*GROUP*32 +: GROUP*32]);
        entering = entering | ({GROUP{stage_valid[g]}} & task_mask_i[g*GROUP +: GROUP]);
      end
    end
  end

  // ---- The lanes. While a group is in its stages its task has not been done.
  wire moving = |stage_valid[STAGES+GROUPS-2:0];
  wire root = task_operation_i == ISA_SLW_FSQRT || task_operation_i == ISA_SLW_FRSQRT;
  wire unary = task_operation_i == ISA_SLW_FRSQRT || task_operation_i == ISA_SLW_FRCP;
  wire [GROUP*32-1:0] result, delayed;
  wire [GROUP-1:0] tiny;
  genvar l, s;
  generate
    for (l = 0; l < GROUP; l = l + 1) begin : gen_lane
      // Whether each stage holds a task of this lane.
      reg [STAGES-2:0] later_q;
      wire [STAGES-1:0] enable = {later_q, entering[l]};
      always @(posedge clk_i) begin
        if (!rst_ni) later_q <= {STAGES-1{1'b0}};
        else if (moving) later_q <= enable[STAGES-2:0];
      end
      rp_slow_lane #(
        .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND), .SLOW_UNIT(SLOW_UNIT), .STAGES(STAGES), .WITHOUT(WITHOUT)
      ) lane (
        .clk_i(clk_i),
        .enable_i(enable),
        .root_i(root),
        .unary_i(unary),
        .a_i(operand_a[l*32 +: 32]),
        .b_i(operand_b[l*32 +: 32]),
        .result_o(result[l*32 +: 32]),
        .tiny_3_o(tiny[l])
      );
    end
    if (DELAY > 0) begin : gen_delay
      wire [DELAY-1:0] holds;   // a stage of the delay takes a group
      for (s = 0; s < DELAY; s = s + 1) begin : gen_stage
        assign holds[s] = |stage_valid[STAGES+s +: GROUPS];
      end
      rp_alu_delay #(.WIDTH(GROUP*32), .STAGES(DELAY)) delay (
        .clk_i(clk_i), .valid_i(holds), .data_i(result), .data_o(delayed));
    end else begin : gen_direct
      assign delayed = result;
    end
    // The groups before the last one wait for it.
    assign done_data_o[(GROUPS-1)*GROUP*32 +: GROUP*32] = delayed;
    for (s = 0; s < GROUPS - 1; s = s + 1) begin : gen_early
      reg [GROUP*32-1:0] data_q;
      always @(posedge clk_i) if (stage_valid[DEPTH+s]) data_q <= delayed;
      assign done_data_o[s*GROUP*32 +: GROUP*32] = data_q;
    end
    if (SUBNORMALS == 2) begin : gen_guard
      wire found;   // of the group that leaves
      rp_subnormal_guard #(.LANES(GROUP), .SIGNIFICAND(SIGNIFICAND), .DEPTH(DEPTH), .RESULT_STAGE(3)) guard (
        .clk_i(clk_i),
        .enter_i(entering),
        .reads_i({1'b0, !root && !unary, 1'b1}),
        .a_i(operand_a),
        .b_i(operand_b),
        .c_i({GROUP*32{1'b0}}),
        .result_i(|tiny),
        .subnormal_o(found)
      );
      if (GROUPS > 1) begin : gen_groups
        reg before_q;   // of the task's groups that have left
        always @(posedge clk_i)
          if (|stage_valid[DEPTH +: GROUPS-1]) before_q <= found || (before_q && !stage_valid[DEPTH]);
        assign done_subnormal_o = found || before_q;
      end else begin : gen_whole
        assign done_subnormal_o = found;
      end
    end else begin : gen_no_guard
      wire unused = &{1'b0, tiny};
      assign done_subnormal_o = 1'b0;
    end
  endgenerate
  assign done_predicate_o = {LANES{1'b0}};
endmodule
`default_nettype wire
