// Bench top: one Flt ALU for each pair of modes, fed with the same tasks. Unit m has SUBNORMALS m % 2 and FMA m / 2,
// and the bits [m*...] of every output. Those with odd numbers are deeper, so that the delay behind the stages is seen
// too.
`default_nettype none
module flt_units #(
  parameter integer LANES = 4,
  parameter integer SIGNIFICAND = 24
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire                  task_valid_i,
  input  wire [2:0]            task_warp_i,
  input  wire [4:0]            task_operation_i,
  input  wire [LANES-1:0]      task_mask_i,
  input  wire [LANES*32-1:0]   task_operand_a_i,
  input  wire [LANES*32-1:0]   task_operand_b_i,
  input  wire [LANES*32-1:0]   task_operand_c_i,
  output wire [3:0]            ready_o,
  output wire [3:0]            done_valid_o,
  output wire [4*3-1:0]        done_warp_o,
  output wire [4*LANES*32-1:0] done_data_o
);
  genvar m;
  generate
    for (m = 0; m < 4; m = m + 1) begin : gen_mode
      rp_flt_alu #(.WARPS(8), .LANES(LANES), .LATENCY(1), .DEPTH(3 + 2*(m/2) + 2*(m%2)), .SUBNORMALS(m%2),
          .SIGNIFICAND(SIGNIFICAND), .FMA(m/2)) unit (
        .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i), .task_warp_i(task_warp_i),
        .task_operation_i(task_operation_i), .task_mask_i(task_mask_i), .task_operand_a_i(task_operand_a_i),
        .task_operand_b_i(task_operand_b_i), .task_operand_c_i(task_operand_c_i), .task_immediate_i(32'd0),
        .task_word_i(5'd0), .task_predicate_x_i({LANES{1'b0}}), .task_predicate_b_i({LANES{1'b0}}),
        .ready_o(ready_o[m]), .done_valid_o(done_valid_o[m]), .done_warp_o(done_warp_o[m*3 +: 3]),
        .done_data_o(done_data_o[m*LANES*32 +: LANES*32]), .done_predicate_o(), .done_subnormal_o());
    end
  endgenerate
endmodule
`default_nettype wire
