// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A triangle pipe, and the lanes that share it: each cycle one of those that have a test begins it, in rotation. What
// the pipe asks for is asked of all lanes, and the lane that owns the test answers.
// Must be given: what triangle_pipe must.
`default_nettype none
module rp_triangle_group #(
  parameter integer LANES = 2,
  parameter integer TAG_BITS = 35,               // of a lane's test
  parameter integer BITS = 32,
  parameter integer WIDTH = 875                  // of a test: TEST_BITS
) (
  input  wire                       clk_i,
  input  wire                       rst_ni,
  // of each lane a test, as rtl/include/rp_records.vh has it
  input  wire [LANES-1:0]           test_valid_i,
  output wire [LANES-1:0]           test_ready_o,
  input  wire [LANES*TAG_BITS-1:0]  test_tag_i,
  input  wire [LANES*WIDTH-1:0]     test_i,
  // the ray's limit, and its best hit: given in the cycle after it is asked for
  output wire [TAG_BITS-1:0]        limit_tag_o,
  input  wire [LANES*32-1:0]        limit_i,
  input  wire [LANES*9-1:0]         scale_i,
  output wire [TAG_BITS-1:0]        best_tag_o,
  input  wire [LANES*32-1:0]        best_t_i,
  input  wire [LANES*32-1:0]        best_number_i,
  // a result, of one lane
  output wire [LANES-1:0]           result_valid_o,
  output wire [TAG_BITS-1:0]        result_tag_o,
  output wire [31:0]                result_number_o,
  output wire                       result_hit_o,
  output wire [31:0]                result_t_o
);
`include "rp_onehot.vh"
`include "rp_records.vh"
  generate
    if (WIDTH != TEST_BITS) begin : gen_bad_width
      triangle_group_WIDTH_must_be_TEST_BITS illegal ();
    end
  endgenerate
  localparam integer LANE_BITS = (LANES > 1) ? $clog2(LANES) : 1;
  rp_round_robin #(.COUNT(LANES)) turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(test_valid_i), .advance_i(1'b1), .grant_o(test_ready_o));
  `ONEHOT_NUMBER(lane_among, LANES, LANE_BITS)
  `ONEHOT_SELECT(tag_among, LANES, TAG_BITS)
  `ONEHOT_SELECT(test_among, LANES, TEST_BITS)
  wire [LANE_BITS-1:0] lane = lane_among(test_ready_o);
  wire [TAG_BITS-1:0] tag = tag_among(test_ready_o, test_tag_i);
  wire [TEST_BITS-1:0] test = test_among(test_ready_o, test_i);

  wire asks_limit, asks_best, valid;
  wire [LANE_BITS-1:0] limit_lane, best_lane, result_lane;
  reg [LANE_BITS-1:0] limit_lane_q, best_lane_q;
  always @(posedge clk_i) begin
    limit_lane_q <= limit_lane;
    best_lane_q <= best_lane;
  end
  wire [LANE_BITS-1:0] limit_of = limit_lane_q, best_of = best_lane_q;
  wire unused = &{1'b0, asks_limit, asks_best};

  rp_triangle_pipe #(.BITS(BITS), .TAG_BITS(LANE_BITS+TAG_BITS)) triangles (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(|test_valid_i),
    .tag_i({lane, tag}),
    .corners_i(test[TEST_CORNERS +: TEST_CORNERS_BITS]),
    .number_i(test[TEST_NUMBER +: TEST_NUMBER_BITS]),
    .origin_i(test[TEST_ORIGIN +: TEST_ORIGIN_BITS]),
    .padded_lower_i(test[TEST_PADDED_LOWER +: TEST_PADDED_LOWER_BITS]),
    .padded_upper_i(test[TEST_PADDED_UPPER +: TEST_PADDED_UPPER_BITS]),
    .inverse_i(test[TEST_INVERSE +: TEST_INVERSE_BITS]),
    .main_axis_i(test[TEST_MAIN_AXIS +: TEST_MAIN_AXIS_BITS]),
    .shear_i(test[TEST_SHEAR +: TEST_SHEAR_BITS]),
    .direction_i(test[TEST_DIRECTION +: TEST_DIRECTION_BITS]),
    .asks_limit_o(asks_limit),
    .limit_tag_o({limit_lane, limit_tag_o}),
    .limit_i(limit_i[limit_of*32 +: 32]),
    .scale_i(scale_i[limit_of*9 +: 9]),
    .asks_best_o(asks_best),
    .best_tag_o({best_lane, best_tag_o}),
    .best_t_i(best_t_i[best_of*32 +: 32]),
    .best_number_i(best_number_i[best_of*32 +: 32]),
    .valid_o(valid),
    .tag_o({result_lane, result_tag_o}),
    .number_o(result_number_o),
    .hit_o(result_hit_o),
    .t_o(result_t_o)
  );
  genvar g;
  generate
    for (g = 0; g < LANES; g = g + 1) begin : gen_lane
      assign result_valid_o[g] = valid && result_lane == g[LANE_BITS-1:0];
    end
  endgenerate
endmodule
`default_nettype wire
