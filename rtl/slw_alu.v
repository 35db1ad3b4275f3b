// Slw ALU: fdiv fsqrt frsqrt frcp, a new task in any of its stages; further stages as delay. docs/numerics.md has the
// rules. SUBNORMALS 0: IEEE, 1: flushed. SLOW_UNIT 0: correctly rounded, 1: table and two Newton steps, both in 11
// stages; 2: one step, 8; 3: none, 6. Lanes outside the mask keep what they held and are not clocked.
`default_nettype none
module slw_alu #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 11,
  parameter integer SUBNORMALS = 0,
  parameter integer SLOW_UNIT = 0
) (
`include "alu_ports.vh"
);
  `include "isa.vh"

  localparam integer STAGES = (SLOW_UNIT <= 1) ? 11 : (SLOW_UNIT == 2) ? 8 : 6;
  generate
    if (DEPTH < STAGES) begin : gen_illegal_depth
      slw_alu_needs_more_depth illegal ();
    end
    if (SUBNORMALS < 0 || SUBNORMALS > 1) begin : gen_illegal_subnormals
      slw_alu_needs_subnormals_0_or_1 illegal ();
    end
    if (SLOW_UNIT < 0 || SLOW_UNIT > 3) begin : gen_illegal_slow_unit
      slw_alu_needs_slow_unit_0_to_3 illegal ();
    end
  endgenerate

  wire [DEPTH-1:0] stage_valid;
  alu_pipeline #(.WARP_BITS(WARP_BITS), .LATENCY(LATENCY), .DEPTH(DEPTH)) pipeline (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i), .task_warp_i(task_warp_i), .ready_o(ready_o),
    .done_valid_o(done_valid_o), .done_warp_o(done_warp_o), .stage_valid_o(stage_valid));

  wire moving = |stage_valid[STAGES-1:0];
  wire root = task_operation_i == ISA_SLW_FSQRT || task_operation_i == ISA_SLW_FRSQRT;
  wire unary = task_operation_i == ISA_SLW_FRSQRT || task_operation_i == ISA_SLW_FRCP;
  wire [LANES*32-1:0] result;
  genvar l;
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_lane
      // Whether each stage holds a task of this lane.
      reg [STAGES-2:0] later_q;
      wire [STAGES-1:0] enable = {later_q, task_valid_i && task_mask_i[l]};
      always @(posedge clk_i) begin
        if (!rst_ni) later_q <= {STAGES-1{1'b0}};
        else if (moving) later_q <= enable[STAGES-2:0];
      end
      slow_lane #(.SUBNORMALS(SUBNORMALS), .SLOW_UNIT(SLOW_UNIT), .STAGES(STAGES)) lane (
        .clk_i(clk_i), .enable_i(enable), .root_i(root), .unary_i(unary), .a_i(task_operand_a_i[l*32 +: 32]),
        .b_i(task_operand_b_i[l*32 +: 32]), .result_o(result[l*32 +: 32]));
    end
    if (DEPTH > STAGES) begin : gen_delay
      alu_delay #(.WIDTH(LANES*32), .STAGES(DEPTH-STAGES)) delay (
        .clk_i(clk_i), .valid_i(stage_valid[DEPTH-1:STAGES]), .data_i(result), .data_o(done_data_o));
    end else begin : gen_direct
      assign done_data_o = result;
    end
  endgenerate
  assign done_predicate_o = {LANES{1'b0}};
endmodule
`default_nettype wire
