// Approximate quotient w/v, w/sqrt(v) of slow_prepare, stages 1 .. 10 of the slow unit: a table of bytes gives y, about 1/v or 1/sqrt(v).
// STEPS 0: w*y. STEPS 1: a Newton step on y before, y + y*(1 - v*y), for a root y + y*(1 - v*y*y)/2. STEPS 2: a second one, on the quotient.
// Then the quotient is rounded to nearest even. cpp_model/arith/arith.cpp does the same integer steps and defines the results.
// enable_i[k] says that stage 1 + k holds a task. result_o is combinational in stage 10 and zero while enable_i[9] is low.
`default_nettype none
module slow_newton #(
  parameter integer STEPS = 2
) (
  input  wire        clk_i,
  input  wire [9:0]  enable_i,
  input  wire [8:0]  index_1_i,     // valid in stage 1
  input  wire        root_i,        // these four in stage 2
  input  wire        unary_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  input  wire        special_3_i,   // these five in stage 3
  input  wire        nan_3_i,
  input  wire        sign_3_i,
  input  wire [7:0]  exponent_3_i,
  input  wire [4:0]  shift_3_i,
  output reg  [31:0] result_o
);
  `include "ones_below.vh"
  `include "booth_digits.vh"
  // What travels with a task; registers sK_* are valid in stage K.
  localparam integer TAG_BITS = 18;
  reg s3_root_q, s3_unary_q;
  wire [TAG_BITS-1:0] s3_tag = {s3_unary_q, special_3_i, nan_3_i, sign_3_i, s3_root_q, exponent_3_i, shift_3_i};
  localparam integer UNARY = 17, SPECIAL = 16, NAN = 15, SIGN = 14, ROOT = 13, EXPONENT = 5;
  reg [TAG_BITS-1:0] s4_tag_q, s5_tag_q, s6_tag_q, s7_tag_q, s8_tag_q, s9_tag_q;
  reg [SPECIAL:0] s10_tag_q;
  reg [24:0] s3_w_q, s4_w_q, s5_w_q;

  wire [7:0] s2_seed;
  slow_seed_table seed_table (
    .clk_i(clk_i), .enable_i(enable_i[0]), .seed_o(s2_seed),
    .index_i(index_1_i[8] ? index_1_i[8:1] : {1'b0, index_1_i[6:0]}));

  reg [8:0] s3_y_q, s4_y_q;       // 9 fraction bits
  reg [33:0] s3_t_q;              // v*y, 32 fraction bits
  reg [12:0] s4_e_q;              // signed, 18 fraction bits
  reg [14:0] s5_y_q;              // 15 fraction bits
  wire [31:0] s9_estimate;        // 30 fraction bits
  reg [30:0] s10_magnitude_q;
  reg s10_round_up_q;

  wire [33:0] t_sum, t_carry;
  multiply_tree #(.A_BITS(25), .B_BITS(9), .OUT_BITS(34)) t_tree (
    .a_i(v_i), .b_i({1'b1, s2_seed}), .c_i(34'd0), .sum_o(t_sum), .carry_o(t_carry));
  wire [36:0] p_sum, p_carry;
  multiply_tree #(.A_BITS(34), .B_BITS(9), .OUT_BITS(37)) p_tree (
    .a_i(s3_t_q), .b_i(s3_y_q), .c_i(37'd0), .sum_o(p_sum), .carry_o(p_carry));
  wire [36:0] s3_p = p_sum + p_carry;
  // The added half makes cutting off a rounding. The step errs low, so y stays below 1 for every v.
  wire [26:0] y_sum, y_carry;
  multiply_tree #(.A_BITS(9), .B_BITS(13), .OUT_BITS(27), .B_SIGNED(1), .ADD(1)) y_tree (
    .a_i(s4_y_q), .b_i(s4_e_q), .c_i({s4_y_q, 18'h00800}), .sum_o(y_sum), .carry_o(y_carry));
  wire [26:0] s4_y = y_sum + y_carry;

  always @(posedge clk_i) begin
    if (enable_i[8:1] != 8'd0) begin
      if (enable_i[1]) begin
        if (STEPS >= 1) s3_t_q <= t_sum + t_carry;
        s3_y_q <= {1'b1, s2_seed};
        s3_root_q <= root_i;
        s3_unary_q <= unary_i;
        s3_w_q <= w_i;
      end
      if (enable_i[2]) begin
        // 1 - p without carry: all ones below 1 minus p.
        s4_e_q <= s3_root_q ? ~s3_p[36:24] : ~s3_t_q[26:14];
        s4_y_q <= s3_y_q;
        s4_tag_q <= s3_tag;
        s4_w_q <= s3_w_q;
      end
      if (enable_i[3]) begin
        if (STEPS >= 1) s5_y_q <= s4_y[26:12];
        else s5_y_q <= {s4_y_q, 6'd0};
        s5_tag_q <= s4_tag_q;
        s5_w_q <= s4_w_q;
      end
      if (enable_i[4]) s6_tag_q <= s5_tag_q;
      if (enable_i[5]) s7_tag_q <= s6_tag_q;
      if (enable_i[6]) s8_tag_q <= s7_tag_q;
      if (enable_i[7]) s9_tag_q <= s8_tag_q;
      if (enable_i[8]) begin : stage9
        reg [30:0] nearest, kept, lost;
        // The true quotient lies in [1, 2), so the nearest number there is no worse.
        nearest = s9_estimate[30:0];
        if (s9_estimate[31]) nearest = 31'h7fffffff;
        else if (!s9_estimate[30]) nearest = 31'h40000000;
        kept = nearest >> s9_tag_q[4:0];
        lost = nearest & ~(31'h7fffffff << s9_tag_q[4:0]);
        s10_magnitude_q <= {s9_tag_q[EXPONENT +: 8] + {7'd0, kept[30]}, kept[29:7]};
        s10_round_up_q <= kept[6] && (kept[7] || kept[5:0] != 6'd0 || lost != 31'd0);
        s10_tag_q <= s9_tag_q[SPECIAL:0];
      end
    end
  end

  generate
    if (STEPS == 2) begin : gen_second_step
      reg [24:0] s3_v_q, s4_v_q, s5_v_q;
      reg [23:0] s5_y_digits_q;
      wire [47:0] s4_y_digits = booth_digits({17'd0, s4_y[26:12]});
      always @(posedge clk_i) begin
        if (enable_i[1]) s3_v_q <= v_i;
        if (enable_i[2]) s4_v_q <= s3_v_q;
        if (enable_i[3]) s5_v_q <= s4_v_q;
        if (enable_i[3]) s5_y_digits_q <= s4_y_digits[23:0];
      end
      slow_refine #(.EXACT(0)) refine (
        .clk_i(clk_i), .enable_i(enable_i[7:4]), .v_i(s5_v_q), .w_i(s5_w_q), .y_i(s5_y_q), .y_digits_i(s5_y_digits_q),
        .root_1_i(s6_tag_q[ROOT]), .unary_1_i(s6_tag_q[UNARY]), .root_2_i(s7_tag_q[ROOT]), .quotient_o(s9_estimate));
    end else begin : gen_product
      wire [39:0] q_sum, q_carry;
      multiply_tree #(.A_BITS(25), .B_BITS(15), .OUT_BITS(40)) q_tree (
        .a_i(s5_w_q), .b_i(s5_y_q), .c_i(40'd0), .sum_o(q_sum), .carry_o(q_carry));
      wire [39:0] s5_q = q_sum + q_carry;
      reg [31:0] s6_q_q, s7_q_q, s8_q_q, s9_q_q;
      always @(posedge clk_i) begin
        if (enable_i[4]) s6_q_q <= s5_q[39:8];
        if (enable_i[5]) s7_q_q <= s6_q_q;
        if (enable_i[6]) s8_q_q <= s7_q_q;
        if (enable_i[7]) s9_q_q <= s8_q_q;
      end
      assign s9_estimate = s9_q_q;
    end
  endgenerate

  always @* begin : stage10
    reg [63:0] ones;
    result_o = 32'd0;
    ones = 64'd0;
    if (enable_i[9]) begin
      ones = ones_below({32'd0, s10_magnitude_q});
      if (s10_tag_q[SPECIAL]) result_o = {s10_tag_q[SIGN], s10_tag_q[EXPONENT +: 8], s10_tag_q[NAN], 22'd0};
      else result_o = {s10_tag_q[SIGN], s10_magnitude_q ^ (ones[30:0] & {31{s10_round_up_q}})};
    end
  end
endmodule
`default_nettype wire
