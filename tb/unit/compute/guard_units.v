// Bench top: ALUs that watch for subnormal numbers, fed from the same ports. 0: brh, 1: flt, 2: flt with fma and a
// delay behind its stages, 3: slw, exact, 4: slw without Newton steps, with one lane and a delay.
`default_nettype none
module guard_units #(
  parameter integer LANES = 4,
  parameter integer SIGNIFICAND = 24
) (
  input  wire                clk_i,
  input  wire                rst_ni,
  input  wire [4:0]          task_valid_i,   // of which ALU
  input  wire [4:0]          task_operation_i,
  input  wire [LANES-1:0]    task_mask_i,
  input  wire [LANES*32-1:0] task_operand_a_i,
  input  wire [LANES*32-1:0] task_operand_b_i,
  input  wire [LANES*32-1:0] task_operand_c_i,
  output wire [4:0]          done_valid_o,
  output wire [4:0]          done_subnormal_o
);
`define TASK(u) .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[u]), .task_warp_i(1'b0), \
    .task_operation_i(task_operation_i), .task_mask_i(task_mask_i), .task_operand_a_i(task_operand_a_i), \
    .task_operand_b_i(task_operand_b_i), .task_operand_c_i(task_operand_c_i), .task_immediate_i(32'd0), \
    .task_word_i(5'd0), .task_predicate_x_i({LANES{1'b0}}), .task_predicate_b_i({LANES{1'b0}}), .ready_o(), \
    .done_valid_o(done_valid_o[u]), .done_warp_o(), .done_data_o(), .done_predicate_o(), \
    .done_subnormal_o(done_subnormal_o[u])
  rp_brh_alu #(.WARPS(1), .LANES(LANES), .WARP_BITS(1), .SUBNORMALS(2), .SIGNIFICAND(SIGNIFICAND)) brh (`TASK(0));
  rp_flt_alu #(.WARPS(1), .LANES(LANES), .SUBNORMALS(2), .SIGNIFICAND(SIGNIFICAND)) flt (`TASK(1));
  rp_flt_alu #(
    .WARPS(1), .LANES(LANES), .DEPTH(7), .SUBNORMALS(2), .SIGNIFICAND(SIGNIFICAND), .FMA(1)
  ) fused (`TASK(2));
  rp_slw_alu #(.WARPS(1), .LANES(LANES), .SUBNORMALS(2), .SIGNIFICAND(SIGNIFICAND)) slw (`TASK(3));
  rp_slw_alu #(
    .WARPS(1), .LANES(LANES), .DEPTH(8), .SUBNORMALS(2), .SIGNIFICAND(SIGNIFICAND), .SLOW_UNIT(3), .SLOW_LANES(1)
  ) slow (`TASK(4));
endmodule
`default_nettype wire
