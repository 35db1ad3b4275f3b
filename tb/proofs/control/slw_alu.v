// Four lanes of threads on two lanes of the unit, on one, and on four. Here a lane only carries a bit that depends on
// its operands and the operation through its stages, as each is enabled. One task, chosen freely, is followed.
// @long 6
// @modules slw_alu alu_pipeline alu_delay
// @zeros
// @proves of a task each lane of the mask is done DEPTH cycles after the arrival, and as many more as there are further
//   groups of lanes, with what the unit makes of its operands and its operation; so is its warp
// @proves ready_o leaves each group a cycle of its own: tasks that come as soon as they may disturb no other
// @parameters SLOW_LANES=1 DEPTH=7
// @parameters SLOW_LANES=2 DEPTH=6
// @parameters SLOW_LANES=4 DEPTH=7
// @break slw_alu s/\(LATENCY > GROUPS\) \? LATENCY : GROUPS/LATENCY/
// @break slw_alu s/TASK_DEPTH = DEPTH \+ GROUPS - 1/TASK_DEPTH = DEPTH + GROUPS/
// @break slw_alu s/task_operand_a_i\[g\*GROUP\*32/task_operand_a_i[0*GROUP*32/
// @break slw_alu s/\& task_operand_b_i\[g\*GROUP\*32/\& task_operand_b_i[(GROUPS-1-g)*GROUP*32/
// @break slw_alu s/task_mask_i\[g\*GROUP \+: GROUP\]/task_mask_i[0 +: GROUP]/
// @break slw_alu s/stage_valid\[STAGES\+GROUPS-2:0\]/stage_valid[STAGES-2:0]/
// @break slw_alu s/\|stage_valid\[STAGES\+s \+: GROUPS\]/stage_valid[STAGES+s]/
// @break slw_alu s/if \(stage_valid\[DEPTH\+s\]\) data_q/if (stage_valid[DEPTH-1+s]) data_q/
// @break slw_alu s/if \(stage_valid\[DEPTH\+s\]\) data_q/if (1'b1) data_q/
`default_nettype none
module rp_slow_lane #(
  parameter SUBNORMALS = 0, parameter SIGNIFICAND = 24, parameter SLOW_UNIT = 0, parameter STAGES = 6,
  parameter WITHOUT = 0
) (
  input wire clk_i, input wire [STAGES-1:0] enable_i, input wire root_i, unary_i, input wire [31:0] a_i, b_i,
  output wire [31:0] result_o, output wire tiny_3_o
);
  assign tiny_3_o = 1'b0;
  reg [STAGES-1:0] stage_q;
  integer k;
  always @(posedge clk_i) begin
    if (enable_i[0]) stage_q[0] <= a_i[0] ^ (b_i[0] & !unary_i) ^ root_i;
    for (k = 1; k < STAGES; k = k + 1) if (enable_i[k]) stage_q[k] <= stage_q[k-1];
  end
  assign result_o = {31'd0, stage_q[STAGES-1]};
endmodule

module check #(parameter SLOW_LANES = 2, parameter DEPTH = 7) (
  input wire clk_i, grant_i, follow_i, warp_i, input wire [1:0] operation_i, input wire [3:0] mask_i, a_i, b_i
);
`include "rp_isa.vh"
  localparam integer LAST = DEPTH + 4 / SLOW_LANES - 1;   // cycles from a task's arrival to its end
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  (* anyconst *) wire [1:0] lane;

  // The task register: it changes with a grant.
  reg valid_q = 1'b0, warp_q;
  reg [1:0] operation_q;
  reg [3:0] mask_q, a_q, b_q;
  always @(posedge clk_i) begin
    valid_q <= grant_i && rst_n;
    if (grant_i) begin
      warp_q <= warp_i;
      operation_q <= operation_i;
      mask_q <= mask_i;
      a_q <= a_i;
      b_q <= b_i;
    end
  end
  wire [4:0] operation = (operation_q == 2'd0) ? ISA_SLW_FDIV : (operation_q == 2'd1) ? ISA_SLW_FSQRT
                         : (operation_q == 2'd2) ? ISA_SLW_FRSQRT : ISA_SLW_FRCP;
  wire root = operation_q == 2'd1 || operation_q == 2'd2, unary = operation_q >= 2'd2;

  wire ready, done_valid, done_warp;
  wire [127:0] done_data;
  wire [3:0] done_predicate;
  rp_slw_alu #(
    .WARPS(2), .LANES(4), .WARP_BITS(1), .LATENCY(1), .DEPTH(DEPTH), .SLOW_UNIT(3), .SLOW_LANES(SLOW_LANES)
  ) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .task_valid_i(valid_q), .task_warp_i(warp_q), .task_operation_i(operation),
    .task_mask_i(mask_q), .task_operand_a_i({31'd0, a_q[3], 31'd0, a_q[2], 31'd0, a_q[1], 31'd0, a_q[0]}),
    .task_operand_b_i({31'd0, b_q[3], 31'd0, b_q[2], 31'd0, b_q[1], 31'd0, b_q[0]}), .task_operand_c_i(128'd0),
    .task_immediate_i(32'd0), .task_word_i(5'd0), .task_predicate_x_i(4'd0), .task_predicate_b_i(4'd0),
    .ready_o(ready), .done_valid_o(done_valid), .done_warp_o(done_warp), .done_data_o(done_data),
    .done_predicate_o(done_predicate));

  // The task that is followed: its age, and what it must end with.
  reg followed_q = 1'b0, masked_q, expected_q, expected_warp_q;
  reg [4:0] age_q = 5'd0;
  always @(posedge clk_i) begin
    if (followed_q) age_q <= age_q + 5'd1;
    if (followed_q && age_q == LAST) followed_q <= 1'b0;
    if (!followed_q && follow_i && valid_q) begin
      followed_q <= 1'b1;
      age_q <= 5'd1;
      masked_q <= mask_q[lane];
      expected_q <= a_q[lane] ^ (b_q[lane] & !unary) ^ root;
      expected_warp_q <= warp_q;
    end
  end

  always @* begin
    assume (!grant_i || ready);
    if (followed_q && age_q == LAST) begin
      assert (done_valid && done_warp == expected_warp_q);
      assert (!masked_q || done_data[lane*32 +: 1] == expected_q);
    end
  end
endmodule
`default_nettype wire
