// A triangle pipe, and the lanes that share it: each cycle one of those that have a test begins it, in rotation. What
// the pipe asks for is asked of all lanes, and who answers is the lane whose test it is.
// Must be given: what triangle_pipe must.
`default_nettype none
module triangle_group #(
  parameter integer LANES = 2,
  parameter integer TAG_BITS = 35,               // of a lane's test
  parameter integer BITS = 32,
  parameter integer TEST_BITS = 875
) (
  input  wire                       clk_i,
  input  wire                       rst_ni,
  // of each lane a test: its ray's direction, shears, main axis, inverse and padded upper and lower planes, origin; the
  // triangle's number, its corners in the low bits
  input  wire [LANES-1:0]           test_valid_i,
  output wire [LANES-1:0]           test_ready_o,
  input  wire [LANES*TAG_BITS-1:0]  test_tag_i,
  input  wire [LANES*TEST_BITS-1:0] test_i,
  // the ray's limit, and its best hit: told in the cycle after it is asked for
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
  localparam integer LANE_BITS = (LANES > 1) ? $clog2(LANES) : 1;
  round_robin #(.COUNT(LANES)) turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(test_valid_i), .advance_i(1'b1), .grant_o(test_ready_o));
  reg [LANE_BITS-1:0] lane;
  reg [TAG_BITS-1:0] tag;
  reg [TEST_BITS-1:0] test;
  integer l;
  always @* begin
    lane = {LANE_BITS{1'b0}};
    tag = {TAG_BITS{1'b0}};
    test = {TEST_BITS{1'b0}};
    for (l = 0; l < LANES; l = l + 1)
      if (test_ready_o[l]) begin
        lane = lane | l[LANE_BITS-1:0];
        tag = tag | test_tag_i[l*TAG_BITS +: TAG_BITS];
        test = test | test_i[l*TEST_BITS +: TEST_BITS];
      end
  end

  wire asks_limit, asks_best, valid;
  wire [LANE_BITS-1:0] limit_lane, best_lane, result_lane;
  reg [LANE_BITS-1:0] limit_lane_q, best_lane_q;
  always @(posedge clk_i) begin
    limit_lane_q <= limit_lane;
    best_lane_q <= best_lane;
  end
  wire [LANE_BITS-1:0] limit_of = limit_lane_q, best_of = best_lane_q;
  wire unused = &{1'b0, asks_limit, asks_best};

  triangle_pipe #(.BITS(BITS), .TAG_BITS(LANE_BITS+TAG_BITS)) triangles (
    .clk_i(clk_i), .rst_ni(rst_ni), .valid_i(|test_valid_i), .tag_i({lane, tag}), .corners_i(test[0+:288]),
    .number_i(test[288+:32]), .origin_i(test[320+:96]), .padded_lower_i(test[416+:96]),
    .padded_upper_i(test[512+:96]), .inverse_i(test[608+:96]), .main_axis_i(test[704+:2]), .shear_i(test[706+:64]),
    .direction_i(test[770+:105]), .asks_limit_o(asks_limit), .limit_tag_o({limit_lane, limit_tag_o}),
    .limit_i(limit_i[limit_of*32 +: 32]), .scale_i(scale_i[limit_of*9 +: 9]), .asks_best_o(asks_best),
    .best_tag_o({best_lane, best_tag_o}), .best_t_i(best_t_i[best_of*32 +: 32]),
    .best_number_i(best_number_i[best_of*32 +: 32]), .valid_o(valid), .tag_o({result_lane, result_tag_o}),
    .number_o(result_number_o), .hit_o(result_hit_o), .t_o(result_t_o));
  genvar g;
  generate
    for (g = 0; g < LANES; g = g + 1) begin : gen_lane
      assign result_valid_o[g] = valid && result_lane == g[LANE_BITS-1:0];
    end
  endgenerate
endmodule
`default_nettype wire
