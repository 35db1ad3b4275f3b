// Bench top: Slw ALUs with fewer lanes than a task has, fed with the same tasks. Units 0 and 1 have one lane, 2 and 3
// two; 0 and 2 are exact, the others without Newton steps. Unit u has u stages of delay, and 2 takes a task in three
// cycles.
`default_nettype none
module slw_group_units #(
  parameter integer LANES = 4
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire                  task_valid_i,
  input  wire [2:0]            task_warp_i,
  input  wire [4:0]            task_operation_i,
  input  wire [LANES-1:0]      task_mask_i,
  input  wire [LANES*32-1:0]   task_operand_a_i,
  input  wire [LANES*32-1:0]   task_operand_b_i,
  output wire [3:0]            ready_o,
  output wire [3:0]            done_valid_o,
  output wire [4*3-1:0]        done_warp_o,
  output wire [4*LANES*32-1:0] done_data_o
);
  genvar u;
  generate
    for (u = 0; u < 4; u = u + 1) begin : gen_unit
      rp_slw_alu #(.WARPS(8), .LANES(LANES), .LATENCY(u == 2 ? 3 : 1), .DEPTH((u%2 == 0 ? 11 : 6) + u),
          .SLOW_UNIT(u%2 * 3), .SLOW_LANES(1 + u/2)) unit (
        .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i), .task_warp_i(task_warp_i),
        .task_operation_i(task_operation_i), .task_mask_i(task_mask_i), .task_operand_a_i(task_operand_a_i),
        .task_operand_b_i(task_operand_b_i), .task_operand_c_i({LANES*32{1'b0}}), .task_immediate_i(32'd0),
        .task_word_i(5'd0), .task_predicate_x_i({LANES{1'b0}}), .task_predicate_b_i({LANES{1'b0}}),
        .ready_o(ready_o[u]), .done_valid_o(done_valid_o[u]), .done_warp_o(done_warp_o[u*3 +: 3]),
        .done_data_o(done_data_o[u*LANES*32 +: LANES*32]), .done_predicate_o(), .done_subnormal_o());
    end
  endgenerate
endmodule
`default_nettype wire
