    // Generated from cpp_model/isa/isa.hpp by `raypool isa --write`; a test compares. Do not edit.
    for (k = 0; k < BRH_COUNT; k = k + 1) begin : gen_brh
      brh_alu #(
        .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(BRH_LATENCY), .DEPTH(BRH_DEPTH), .SUBNORMALS(SUBNORMALS)
      ) brh_alu (
        .clk_i(clk_i), .rst_ni(rst_ni),
        .task_valid_i(task_valid[BRH_SLOT + k]), .task_warp_i(task_warp[(BRH_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .task_op_i(task_op[(BRH_SLOT + k)*5 +: 5]), .task_mask_i(task_mask[(BRH_SLOT + k)*LANES +: LANES]),
        .task_a_i(task_a[(BRH_SLOT + k)*DATA +: DATA]), .task_b_i(task_b[(BRH_SLOT + k)*DATA +: DATA]),
        .task_imm_i(task_imm[(BRH_SLOT + k)*32 +: 32]), .task_x_i(task_x[(BRH_SLOT + k)*5 +: 5]),
        .task_px_i(task_px[(BRH_SLOT + k)*LANES +: LANES]), .task_pb_i(task_pb[(BRH_SLOT + k)*LANES +: LANES]),
        .ready_o(ready[BRH_SLOT + k]), .done_valid_o(done_valid[BRH_SLOT + k]),
        .done_warp_o(done_warp[(BRH_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .done_data_o(done_data[(BRH_SLOT + k)*DATA +: DATA]), .done_pred_o(done_pred[(BRH_SLOT + k)*LANES +: LANES]));
    end
    for (k = 0; k < INT_COUNT; k = k + 1) begin : gen_int
      int_alu #(
        .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(INT_LATENCY), .DEPTH(INT_DEPTH)
      ) int_alu (
        .clk_i(clk_i), .rst_ni(rst_ni),
        .task_valid_i(task_valid[INT_SLOT + k]), .task_warp_i(task_warp[(INT_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .task_op_i(task_op[(INT_SLOT + k)*5 +: 5]), .task_mask_i(task_mask[(INT_SLOT + k)*LANES +: LANES]),
        .task_a_i(task_a[(INT_SLOT + k)*DATA +: DATA]), .task_b_i(task_b[(INT_SLOT + k)*DATA +: DATA]),
        .task_imm_i(task_imm[(INT_SLOT + k)*32 +: 32]), .task_x_i(task_x[(INT_SLOT + k)*5 +: 5]),
        .task_px_i(task_px[(INT_SLOT + k)*LANES +: LANES]), .task_pb_i(task_pb[(INT_SLOT + k)*LANES +: LANES]),
        .ready_o(ready[INT_SLOT + k]), .done_valid_o(done_valid[INT_SLOT + k]),
        .done_warp_o(done_warp[(INT_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .done_data_o(done_data[(INT_SLOT + k)*DATA +: DATA]), .done_pred_o(done_pred[(INT_SLOT + k)*LANES +: LANES]));
    end
    for (k = 0; k < FLT_COUNT; k = k + 1) begin : gen_flt
      flt_alu #(
        .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(FLT_LATENCY), .DEPTH(FLT_DEPTH), .SUBNORMALS(SUBNORMALS), .FMA(FMA)
      ) flt_alu (
        .clk_i(clk_i), .rst_ni(rst_ni),
        .task_valid_i(task_valid[FLT_SLOT + k]), .task_warp_i(task_warp[(FLT_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .task_op_i(task_op[(FLT_SLOT + k)*5 +: 5]), .task_mask_i(task_mask[(FLT_SLOT + k)*LANES +: LANES]),
        .task_a_i(task_a[(FLT_SLOT + k)*DATA +: DATA]), .task_b_i(task_b[(FLT_SLOT + k)*DATA +: DATA]),
        .task_c_i(task_c[(FLT_SLOT + k)*DATA +: DATA]),
        .task_imm_i(task_imm[(FLT_SLOT + k)*32 +: 32]), .task_x_i(task_x[(FLT_SLOT + k)*5 +: 5]),
        .task_px_i(task_px[(FLT_SLOT + k)*LANES +: LANES]), .task_pb_i(task_pb[(FLT_SLOT + k)*LANES +: LANES]),
        .ready_o(ready[FLT_SLOT + k]), .done_valid_o(done_valid[FLT_SLOT + k]),
        .done_warp_o(done_warp[(FLT_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .done_data_o(done_data[(FLT_SLOT + k)*DATA +: DATA]), .done_pred_o(done_pred[(FLT_SLOT + k)*LANES +: LANES]));
    end
    for (k = 0; k < SLW_COUNT; k = k + 1) begin : gen_slw
      slw_alu #(
        .WARPS(WARPS), .LANES(LANES), .WARP_BITS(WARP_BITS), .LATENCY(SLW_LATENCY), .DEPTH(SLW_DEPTH), .SUBNORMALS(SUBNORMALS), .SLOW_UNIT(SLOW_UNIT)
      ) slw_alu (
        .clk_i(clk_i), .rst_ni(rst_ni),
        .task_valid_i(task_valid[SLW_SLOT + k]), .task_warp_i(task_warp[(SLW_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .task_op_i(task_op[(SLW_SLOT + k)*5 +: 5]), .task_mask_i(task_mask[(SLW_SLOT + k)*LANES +: LANES]),
        .task_a_i(task_a[(SLW_SLOT + k)*DATA +: DATA]), .task_b_i(task_b[(SLW_SLOT + k)*DATA +: DATA]),
        .task_imm_i(task_imm[(SLW_SLOT + k)*32 +: 32]), .task_x_i(task_x[(SLW_SLOT + k)*5 +: 5]),
        .task_px_i(task_px[(SLW_SLOT + k)*LANES +: LANES]), .task_pb_i(task_pb[(SLW_SLOT + k)*LANES +: LANES]),
        .ready_o(ready[SLW_SLOT + k]), .done_valid_o(done_valid[SLW_SLOT + k]),
        .done_warp_o(done_warp[(SLW_SLOT + k)*WARP_BITS +: WARP_BITS]),
        .done_data_o(done_data[(SLW_SLOT + k)*DATA +: DATA]), .done_pred_o(done_pred[(SLW_SLOT + k)*LANES +: LANES]));
    end
