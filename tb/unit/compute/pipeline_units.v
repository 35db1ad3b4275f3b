// Bench top: ALU pipelines of several latencies and depths, each with its own tasks. Pipeline m
// has the bits [m*...] of every port.
`default_nettype none
module pipeline_units (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire [4:0]  task_valid_i,
  input  wire [24:0] task_warp_i,
  output wire [4:0]  ready_o,
  output wire [4:0]  done_valid_o,
  output wire [24:0] done_warp_o,
  output wire [0:0]  stage_valid_0_o,
  output wire [1:0]  stage_valid_1_o,
  output wire [2:0]  stage_valid_2_o,
  output wire [10:0] stage_valid_3_o,
  output wire [31:0] stage_valid_4_o
);
  rp_alu_pipeline #(.WARP_BITS(5), .LATENCY(1), .DEPTH(1)) p0 (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[0]), .task_warp_i(task_warp_i[4:0]),
    .ready_o(ready_o[0]), .done_valid_o(done_valid_o[0]), .done_warp_o(done_warp_o[4:0]),
    .stage_valid_o(stage_valid_0_o));
  rp_alu_pipeline #(.WARP_BITS(5), .LATENCY(2), .DEPTH(2)) p1 (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[1]), .task_warp_i(task_warp_i[9:5]),
    .ready_o(ready_o[1]), .done_valid_o(done_valid_o[1]), .done_warp_o(done_warp_o[9:5]),
    .stage_valid_o(stage_valid_1_o));
  rp_alu_pipeline #(.WARP_BITS(5), .LATENCY(3), .DEPTH(3)) p2 (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[2]), .task_warp_i(task_warp_i[14:10]),
    .ready_o(ready_o[2]), .done_valid_o(done_valid_o[2]), .done_warp_o(done_warp_o[14:10]),
    .stage_valid_o(stage_valid_2_o));
  rp_alu_pipeline #(.WARP_BITS(5), .LATENCY(1), .DEPTH(11)) p3 (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[3]), .task_warp_i(task_warp_i[19:15]),
    .ready_o(ready_o[3]), .done_valid_o(done_valid_o[3]), .done_warp_o(done_warp_o[19:15]),
    .stage_valid_o(stage_valid_3_o));
  rp_alu_pipeline #(.WARP_BITS(5), .LATENCY(16), .DEPTH(32)) p4 (
    .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i[4]), .task_warp_i(task_warp_i[24:20]),
    .ready_o(ready_o[4]), .done_valid_o(done_valid_o[4]), .done_warp_o(done_warp_o[24:20]),
    .stage_valid_o(stage_valid_4_o));
endmodule
`default_nettype wire
