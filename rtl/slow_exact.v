// Correctly rounded quotient w/v, w/sqrt(v) of slow_prepare, stages 1 .. 10 of the slow unit.
// 1: a table gives a line, 2: the line gives y, about 1/v or 1/sqrt(v), 3-5: one multiplicative step leaves an error below 2^-26 in the
// quotient. So of the floats only the two around the middle m of the interval that the estimate lies in can be the result, and the sign of
// w - m*v, of v - m*m (fsqrt) or of 4 - m*m*v (frsqrt) decides exactly between them. 6, 7: m*v or m*m, 8: times v, 9: the rest, 10: rounding.
// enable_i[k] says that stage 1 + k holds a task. result_o is combinational in stage 10 and zero while enable_i[9] is low.
`default_nettype none
module slow_exact (
  input  wire        clk_i,
  input  wire [9:0]  enable_i,
  input  wire [8:0]  index_1_i,     // valid in stage 1, all others in stage 2
  input  wire        special_i,
  input  wire        nan_i,
  input  wire        sign_i,
  input  wire        root_i,
  input  wire        unary_i,
  input  wire [7:0]  exponent_i,
  input  wire [4:0]  shift_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  output reg  [31:0] result_o
);
  // What travels with a task; registers sK_* are valid in stage K.
  localparam integer TAG_BITS = 18;
  wire [TAG_BITS-1:0] s2_tag = {special_i, nan_i, sign_i, root_i, unary_i, exponent_i, shift_i};
  localparam integer SPECIAL = 17, NAN = 16, SIGN = 15, ROOT = 14, UNARY = 13, EXPONENT = 5;
  reg [TAG_BITS-1:0] s3_tag_q, s4_tag_q, s5_tag_q, s6_tag_q, s7_tag_q, s8_tag_q, s9_tag_q, s10_tag_q;
  reg [24:0] s3_v_q, s4_v_q, s5_v_q, s6_v_q, s7_v_q, s8_v_q;
  reg [24:0] s3_w_q, s4_w_q, s5_w_q, s6_w_q, s7_w_q, s8_w_q;

  wire [28:0] s2_row;
  slow_line_table line_table (.clk_i(clk_i), .enable_i(enable_i[0]), .index_i(index_1_i[8:1]), .row_o(s2_row));
  wire [10:0] s2_offset = v_i[24] ? v_i[17:7] : v_i[16:6];

  reg [14:0] s3_y_q;              // 15 fraction bits
  wire [31:0] s6_estimate;        // 30 fraction bits
  slow_refine refine (
    .clk_i(clk_i), .enable_i(enable_i[4:2]), .v_i(s3_v_q), .w_i(s3_w_q), .y_i(s3_y_q), .root_1_i(s4_tag_q[ROOT]),
    .quotient_o(s6_estimate));

  reg [24:0] s6_half_q;           // half a unit in the last place of the result: the lowest one of m
  reg [24:0] s6_keep_q;           // the bits of the estimate that stay in m
  reg [24:0] s7_m_q;              // 24 fraction bits
  reg [49:0] s7_sum_q, s7_carry_q;  // m*v or m*m as two numbers
  reg [23:0] s8_n_q, s9_n_q;      // the float below m
  reg [49:0] s8_product_q;        // m*v or m*m
  reg [52:0] s9_sum_q, s9_carry_q;  // m*v or m*m, or m*m*v, as two numbers; modulo 2^53, as what is left over is small
  reg [52:0] s9_whole_q;
  reg [52:0] s10_rest_q;
  reg [30:0] s10_below_q, s10_above_q;  // the floats below and above m

  // No true quotient is nearer to 2 than 2^-24, so the estimate is below 2 too.
  wire [24:0] s6_m = (s6_estimate[30:6] & s6_keep_q) | s6_half_q;
  wire [49:0] s6_sum, s6_carry;
  multiply_tree #(.A_BITS(25), .B_BITS(25), .OUT_BITS(50)) first_product (
    .a_i(s6_m), .b_i(s6_tag_q[ROOT] ? s6_m : s6_v_q), .sum_o(s6_sum), .carry_o(s6_carry));
  wire [52:0] s8_sum, s8_carry;
  multiply_tree #(.A_BITS(50), .B_BITS(25), .OUT_BITS(53)) second_product (
    .a_i(s8_product_q), .b_i(s8_v_q), .sum_o(s8_sum), .carry_o(s8_carry));

  always @(posedge clk_i) begin
    if (enable_i[9:1] != 9'd0) begin
      if (enable_i[1]) begin : stage2
        reg [27:0] y;
        y = {s2_row[28:11], 10'd0} - {6'd0, {11'd0, s2_row[10:0]} * {11'd0, s2_offset}};
        s3_y_q <= y[27:13];
        s3_tag_q <= s2_tag;
        s3_v_q <= v_i;
        s3_w_q <= w_i;
      end
      if (enable_i[2]) begin s4_tag_q <= s3_tag_q; s4_v_q <= s3_v_q; s4_w_q <= s3_w_q; end
      if (enable_i[3]) begin s5_tag_q <= s4_tag_q; s5_v_q <= s4_v_q; s5_w_q <= s4_w_q; end
      if (enable_i[4]) begin
        s6_half_q <= 25'd1 << s5_tag_q[4:0];
        s6_keep_q <= 25'h1fffffe << s5_tag_q[4:0];
        s6_tag_q <= s5_tag_q;
        s6_v_q <= s5_v_q;
        s6_w_q <= s5_w_q;
      end
      if (enable_i[5]) begin
        s7_m_q <= s6_m;
        s7_sum_q <= s6_sum;
        s7_carry_q <= s6_carry;
        s7_tag_q <= s6_tag_q;
        s7_v_q <= s6_v_q;
        s7_w_q <= s6_w_q;
      end
      if (enable_i[6]) begin
        s8_product_q <= s7_sum_q + s7_carry_q;
        s8_n_q <= s7_m_q[24:1] >> s7_tag_q[4:0];
        s8_tag_q <= s7_tag_q;
        s8_v_q <= s7_v_q;
        s8_w_q <= s7_w_q;
      end
      if (enable_i[7]) begin
        if (s8_tag_q[ROOT] && s8_tag_q[UNARY]) begin
          s9_sum_q <= s8_sum;
          s9_carry_q <= s8_carry;
          s9_whole_q <= 53'd0;    // 4 with 71 fraction bits
        end else begin
          s9_sum_q <= {3'd0, s8_product_q};
          s9_carry_q <= 53'd0;
          s9_whole_q <= s8_tag_q[ROOT] ? {3'd0, s8_v_q, 25'd0} : {4'd0, s8_w_q, 24'd0};
        end
        s9_n_q <= s8_n_q;
        s9_tag_q <= s8_tag_q;
      end
      if (enable_i[8]) begin
        s10_rest_q <= s9_whole_q - (s9_sum_q + s9_carry_q);
        s10_below_q <= {s9_tag_q[EXPONENT +: 8], 23'd0} + {7'd0, s9_n_q};
        s10_above_q <= {s9_tag_q[EXPONENT +: 8], 23'd1} + {7'd0, s9_n_q};
        s10_tag_q <= s9_tag_q;
      end
    end
  end

  always @* begin : stage10
    reg round_up;
    result_o = 32'd0;
    round_up = 1'b0;
    if (enable_i[9]) begin
      // Nothing is left over only when a subnormal quotient lies on m itself: then to even.
      round_up = !s10_rest_q[52] && (s10_rest_q != 53'd0 || s10_below_q[0]);
      if (s10_tag_q[SPECIAL]) result_o = {s10_tag_q[SIGN], s10_tag_q[EXPONENT +: 8], s10_tag_q[NAN], 22'd0};
      else result_o = {s10_tag_q[SIGN], round_up ? s10_above_q : s10_below_q};
    end
  end
endmodule
`default_nettype wire
