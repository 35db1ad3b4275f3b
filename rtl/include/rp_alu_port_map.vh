// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
        // The ALU of instance k: its ports, and what they are joined to. To be included at the end of its connections.
        .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid), .task_warp_i(task_warp),
        .task_operation_i(task_operation), .task_mask_i(task_mask), .task_operand_a_i(task_operand_a),
        .task_operand_b_i(task_operand_b), .task_operand_c_i(task_operand_c), .task_immediate_i(task_immediate),
        .task_word_i(task_word), .task_predicate_x_i(task_predicate_x), .task_predicate_b_i(task_predicate_b),
        .ready_o(ready[k]), .done_valid_o(done_valid[k]), .done_warp_o(done_warp[k*WARP_BITS +: WARP_BITS]),
        .done_data_o(done_data[k*DATA +: DATA]), .done_predicate_o(done_predicate[k*LANES +: LANES])
