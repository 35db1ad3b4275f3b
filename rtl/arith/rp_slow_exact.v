// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Correctly rounded quotient w/v, w/sqrt(v) of slow_prepare, stages 1 .. 10 of the slow unit.
// 1: a table gives a line, 2: the line gives y, about 1/v or 1/sqrt(v), 3-6: one multiplicative step leaves an error
// below 2^-24 in the quotient. So of the floats only the two around the middle m of the interval that the estimate lies
// in can be the result, and the sign of w - m*v, of v - m*m (fsqrt) or of 4 - m*m*v (frsqrt) decides exactly between
// them. 7: m*v or m*m, 8: its sum, less w or v, 9: for frsqrt times m, 10: the sign, rounding.
// With a SIGNIFICAND of p bits, 24 here, the error must be below 2^-p, m has one bit more than a float, and 3 * p - 1
// fraction bits of m*m*v decide.
// enable_i[k] is high when stage 1 + k holds a task. result_o is combinational in stage 10 and zero while enable_i[9]
// is low.
`default_nettype none
module rp_slow_exact #(
  parameter integer SIGNIFICAND = 24,
  parameter integer WITHOUT = 0   // as rp_slow_operations.vh has it
) (
  input  wire        clk_i,
  input  wire [9:0]  enable_i,
  input  wire [8:0]  index_1_i,     // valid in stage 1
  input  wire [17:0] offset_digits_i, // these five in stage 2
  input  wire        root_i,
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
  `include "rp_free_running.vh"
  `include "rp_ones_below.vh"
  `include "rp_booth_digits.vh"
  `include "rp_slow_operations.vh"
  wire root, unary;
  assign {root, unary} = possible_operation(root_i, unary_i);
  localparam integer P = SIGNIFICAND;
  localparam integer D = 24 - P;
  // What travels with a task; registers sK_* are valid in stage K.
  localparam integer TAG_BITS = 18;
  reg s3_root_q, s3_unary_q;
  wire [TAG_BITS-1:0] s3_tag = {special_3_i, nan_3_i, sign_3_i, s3_root_q, s3_unary_q, exponent_3_i, shift_3_i};
  localparam integer SPECIAL = 17, NAN = 16, SIGN = 15, ROOT = 14, UNARY = 13, EXPONENT = 5;
  reg [TAG_BITS-1:0] s4_tag_q, s5_tag_q, s6_tag_q, s7_tag_q, s8_tag_q;
  reg [TAG_BITS-1:EXPONENT] s9_tag_q;
  reg [P:0] s3_v_q, s4_v_q, s5_v_q, s6_v_q, s7_v_q;   // P - 1 fraction bits
  reg [P:0] s3_w_q, s4_w_q, s5_w_q, s6_w_q, s7_w_q, s8_w_q;
  wire [28:0] s2_row;
  rp_slow_line_table #(.WITHOUT(WITHOUT)) line_table (
    .clk_i(clk_i), .enable_i(enable_i[0]), .index_i(index_1_i[8:1]), .row_o(s2_row));
  wire [27:0] line_sum, line_carry;
  rp_multiply_tree #(.A_BITS(11), .B_BITS(11), .OUT_BITS(28), .ADD(1), .NEGATE(1), .CUT(8), .ENCODED(1)) line (
    .a_i(s2_row[10:0]), .b_i(offset_digits_i), .c_i({s2_row[28:11], 10'd0}), .sum_o(line_sum), .carry_o(line_carry));
  wire [27:0] s2_y = line_sum + line_carry;
  wire [47:0] s2_y_digits = booth_digits({17'd0, s2_y[27:13]});

  reg [14:0] s3_y_q;              // 15 fraction bits
  reg [23:0] s3_y_digits_q;
  wire [31:0] s7_estimate;        // 24 fraction bits or less, and zeros
  wire [25:0] s3_v = {s3_v_q, {D+1{1'b0}}};
  wire [25:0] s3_w = {s3_w_q, {D+1{1'b0}}};
  rp_slow_refine #(.EXACT(1), .LESS((D < 8) ? D : 8)) refine (
    .clk_i(clk_i),
    .enable_i(enable_i[5:2]),
    .v_i(s3_v[25:1]),
    .w_i(s3_w[25:1]),
    .y_i(s3_y_q),
    .y_digits_i(s3_y_digits_q),
    .root_1_i(s4_tag_q[ROOT]),
    .unary_1_i(s4_tag_q[UNARY]),
    .root_2_i(s5_tag_q[ROOT]),
    .quotient_o(s7_estimate)
  );

  reg [P:0] s7_half_q;            // half a unit in the last place of the result: the lowest one of m
  reg [P:0] s7_keep_q;            // the bits of the estimate that stay in m
  reg [P:0] s8_m_q;               // P fraction bits
  localparam integer F = 2*P + 2; // bits of m*v and m*m
  reg [F-1:0] s8_sum_q, s8_carry_q;  // m*v or m*m as two numbers
  reg [P-1:0] s9_n_q;             // the float below m
  // m*v - w or m*m - v, signed; for frsqrt m*v. The tree's two numbers are the product only modulo 2^F.
  reg [F-1:0] s9_product_q;
  // Modulo 2^52, of 24 bits, as what is left over is small; for frsqrt it is more than the 2^22 that are lost below
  // 2^18. slw_alu_test goes through every v of every significand.
  localparam integer OUT = 2*P + 4, CUT = P - 6;
  localparam [0:0] FRSQRT = (WITHOUT & 4) == 0;
  reg [OUT-1:CUT] s10_sum_q, s10_carry_q;
  reg s10_above_q, s10_frsqrt_q, s10_sign_q;
  reg [P+6:0] s10_below_q;        // the float below m, or the special result

  // No true quotient is nearer to 2 than 2^-24, so the estimate is below 2 too.
  wire [P:0] s7_m = (s7_estimate[30 -: P+1] & s7_keep_q) | s7_half_q;
  wire [F-1:0] s7_sum, s7_carry;
  rp_multiply_tree #(.A_BITS(P+1), .B_BITS(P+1), .OUT_BITS(F)) first_product (
    .a_i((s7_tag_q[ROOT] && !s7_tag_q[UNARY]) ? s7_m : s7_v_q), .b_i(s7_m), .c_i({F{1'b0}}), .sum_o(s7_sum),
    .carry_o(s7_carry));
  wire [F-1:0] s8_whole = (s8_tag_q[ROOT] && s8_tag_q[UNARY]) ? {F{1'b0}} : s8_tag_q[ROOT] ? {s8_w_q, {P+1{1'b0}}} :
                          {1'b0, s8_w_q, {P{1'b0}}};
  wire [OUT-1:0] s9_sum, s9_carry;
  generate
    if (FRSQRT) begin : gen_second_product
      rp_multiply_tree #(.A_BITS(F), .B_BITS(P+1), .OUT_BITS(OUT), .CUT(CUT)) second_product (
        .a_i(s9_product_q), .b_i({s9_n_q, 1'b1}), .c_i({OUT{1'b0}}), .sum_o(s9_sum), .carry_o(s9_carry));
    end else begin : gen_no_second_product
      assign s9_sum = {OUT{1'b0}};
      assign s9_carry = {OUT{1'b0}};
    end
  endgenerate

  always @(posedge clk_i) begin
    if (`STAGE_LOADS(enable_i[8:1] != 8'd0)) begin
      if (`STAGE_LOADS(enable_i[1])) begin
        s3_y_q <= s2_y[27:13];
        s3_y_digits_q <= s2_y_digits[23:0];
        s3_root_q <= root;
        s3_unary_q <= unary;
        s3_v_q <= v_i[24:D];
        s3_w_q <= w_i[24:D];
      end
      if (`STAGE_LOADS(enable_i[2])) begin s4_tag_q <= s3_tag; s4_v_q <= s3_v_q; s4_w_q <= s3_w_q; end
      if (`STAGE_LOADS(enable_i[3])) begin s5_tag_q <= s4_tag_q; s5_v_q <= s4_v_q; s5_w_q <= s4_w_q; end
      if (`STAGE_LOADS(enable_i[4])) begin s6_tag_q <= s5_tag_q; s6_v_q <= s5_v_q; s6_w_q <= s5_w_q; end
      if (`STAGE_LOADS(enable_i[5])) begin
        s7_half_q <= {{P{1'b0}}, 1'b1} << s6_tag_q[4:0];
        s7_keep_q <= {{P{1'b1}}, 1'b0} << s6_tag_q[4:0];
        s7_tag_q <= s6_tag_q;
        s7_v_q <= s6_v_q;
        s7_w_q <= s6_w_q;
      end
      if (`STAGE_LOADS(enable_i[6])) begin
        s8_m_q <= s7_m;
        s8_sum_q <= s7_sum;
        s8_carry_q <= s7_carry;
        s8_tag_q <= s7_tag_q;
        s8_w_q <= s7_w_q;
      end
      if (`STAGE_LOADS(enable_i[7])) begin
        s9_product_q <= s8_sum_q + s8_carry_q - s8_whole;
        s9_n_q <= s8_m_q[P:1] >> s8_tag_q[4:0];
        s9_tag_q <= s8_tag_q[TAG_BITS-1:EXPONENT];
      end
      if (`STAGE_LOADS(enable_i[8])) begin
        s10_sum_q <= s9_sum[OUT-1:CUT];
        s10_carry_q <= s9_carry[OUT-1:CUT];
        s10_sign_q <= s9_tag_q[SIGN];
        s10_frsqrt_q <= FRSQRT && s9_tag_q[ROOT] && s9_tag_q[UNARY] && !s9_tag_q[SPECIAL];
        // Nothing is left over only when a subnormal quotient lies on m itself: then to even.
        s10_above_q <= !s9_tag_q[SPECIAL] && (s9_product_q[F-1] || (s9_product_q == {F{1'b0}} && s9_n_q[0]));
        s10_below_q <= s9_tag_q[SPECIAL] ? {s9_tag_q[EXPONENT +: 8], s9_tag_q[NAN], {P-2{1'b0}}} :
                       {s9_tag_q[EXPONENT +: 8] + {7'd0, s9_n_q[P-1]}, s9_n_q[P-2:0]};
      end
    end
  end

  always @* begin : stage10
    reg [OUT-1:CUT] rest;
    reg round_up;
    reg [63:0] ones;
    result_o = 32'd0;
    rest = {OUT-CUT{1'b0}};
    round_up = 1'b0;
    ones = ones_below({{56-P{1'b0}}, s10_below_q});
    if (enable_i[9]) begin
      rest = s10_sum_q + s10_carry_q;
      round_up = s10_frsqrt_q ? rest[OUT-1] : s10_above_q;
      result_o[31 -: P+8] = {s10_sign_q, s10_below_q ^ (ones[P+6:0] & {P+7{round_up}})};
    end
  end
endmodule
`default_nettype wire
