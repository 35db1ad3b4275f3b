// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One multiplicative step of the slow unit in four stages: from y, about 1/v or
// 1/sqrt(v), the quotient w/v or w/sqrt(v).
// With n = w*y and e = 1 - v*y, or (1 - v*y*y)/2 for a root, the quotient is n + n*e
// but for n*e*e (n*1.5*e*e for a root).
// 0: t = v*y, 1: its product with y for a root, w*y for a quotient, 2: their sums give n and e
//    (of a root n is t, or 2*y), 3: n + n*e.
// v, w: 23 fraction bits; y: 15, below 1; w is v for fsqrt (root, not unary) and 2 for frsqrt (root and unary).
// EXACT 0: cut off downwards are t and n at 30 fraction bits, e at 28, the n of n*e at 18, the
// quotient at 30; |e| must be below 2^-12.
// EXACT 1: for a caller that needs less. 2 + LESS bits fewer each, sums lose what multiply_tree leaves out, the
// quotient has 24 - LESS fraction bits; |e| must be below 2^-14. rp_slow_exact.v gives its error. LESS 0 .. 8.
// y_digits_i is what booth_digits makes of y.
// enable_i[k] is high when stage k holds a task; v_i, w_i, y_i and its digits are taken with enable_i[0]. root_1_i and
// unary_1_i are those of the task in stage 1, root_2_i that of stage 2. quotient_o is a register with 30 fraction bits.
`default_nettype none
module rp_slow_refine #(
  parameter integer EXACT = 0,
  parameter integer LESS = 0
) (
  input  wire        clk_i,
  input  wire [3:0]  enable_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  input  wire [14:0] y_i,
  input  wire [23:0] y_digits_i,
  input  wire        root_1_i,
  input  wire        unary_1_i,
  input  wire        root_2_i,
  output wire [31:0] quotient_o
);
  `include "rp_free_running.vh"
  `include "rp_booth_digits.vh"
  localparam integer FEWER = (EXACT != 0) ? 2 + LESS : 0;
  localparam integer N = 32 - FEWER;        // of n
  localparam integer T = 31 - FEWER;        // of t
  localparam integer E = (EXACT != 0) ? 13 - LESS : 17;
  localparam integer E_DIGITS = 3 * ((E + 1) / 2);
  localparam integer H = 20 - FEWER;        // of the n in n*e
  localparam integer P = N + 15;            // of x*y
  localparam integer T_CUT = (EXACT != 0) ? 8 + LESS : 0;
  localparam integer P_CUT = (EXACT != 0) ? 13 : 0;
  localparam integer S = 48 - 2*FEWER;      // of n + n*e, 46 - 2*FEWER fraction bits
  localparam integer S_CUT = (EXACT != 0) ? 11 - LESS : 0;
  localparam integer Q = (EXACT != 0) ? 24 - LESS : 30;  // fraction bits of the quotient
  reg [T-1:0] s1_t_q, s2_t_q;               // s2: of frsqrt 2*y
  reg [14:0] s1_y_q;
  reg [24:0] s1_w_q;
  reg [P-1:P_CUT] s2_sum_q, s2_carry_q;
  reg [N-1:0] s3_n_q;
  reg [E_DIGITS-1:0] s3_e_q;                // digits of e, which is signed
  reg [Q+1:0] quotient_q;

  wire [38:0] t_sum, t_carry;
  rp_multiply_tree #(.A_BITS(25), .B_BITS(15), .OUT_BITS(39), .CUT(T_CUT), .ENCODED(1)) t_tree (
    .a_i(v_i), .b_i(y_digits_i), .c_i(39'd0), .sum_o(t_sum), .carry_o(t_carry));
  wire [38:0] t = t_sum + t_carry;

  wire [31:0] s1_w = {s1_w_q, 7'd0};
  wire [N-1:0] s1_x = root_1_i ? {1'b0, s1_t_q} : s1_w[31 -: N];
  wire [P-1:0] p_sum, p_carry;
  rp_multiply_tree #(.A_BITS(N), .B_BITS(15), .OUT_BITS(P), .CUT(P_CUT)) p_tree (
    .a_i(s1_x), .b_i(s1_y_q), .c_i({P{1'b0}}), .sum_o(p_sum), .carry_o(p_carry));
  wire [P-1:P_CUT] s2_p = s2_sum_q + s2_carry_q;
  // 1 - p without carry: all ones below 1 minus p. p has 45 - FEWER fraction bits, t 30 - FEWER.
  wire [E-1:0] s2_e = root_2_i ? ~s2_p[18 +: E] : ~s2_t_q[2 +: E];
  wire [47:0] s2_e_digits = booth_digits({{32-E{s2_e[E-1]}}, s2_e});

  wire [S-1:0] s_sum, s_carry;
  rp_multiply_tree #(
    .A_BITS(H), .B_BITS(E), .OUT_BITS(S), .B_SIGNED(1), .ADD(1), .CUT(S_CUT), .ENCODED(1)
  ) quotient_tree (
    .a_i(s3_n_q[N-1 -: H]), .b_i(s3_e_q), .c_i({s3_n_q, {S-N{1'b0}}}), .sum_o(s_sum), .carry_o(s_carry));
  wire [S-1:0] quotient = s_sum + s_carry;

  always @(posedge clk_i) begin
    if (`STAGE_LOADS(enable_i[0])) begin
      s1_t_q <= t[38 -: T];
      s1_w_q <= w_i;
      s1_y_q <= y_i;
    end
    if (`STAGE_LOADS(enable_i[1])) begin
      s2_sum_q <= p_sum[P-1:P_CUT];
      s2_carry_q <= p_carry[P-1:P_CUT];
      s2_t_q <= (root_1_i && unary_1_i) ? {s1_y_q, {T-15{1'b0}}} : s1_t_q;
    end
    if (`STAGE_LOADS(enable_i[2])) begin
      s3_n_q <= root_2_i ? {1'b0, s2_t_q} : s2_p[P-1 -: N];
      s3_e_q <= s2_e_digits[E_DIGITS-1:0];
    end
    if (`STAGE_LOADS(enable_i[3])) quotient_q <= quotient[S-1 -: Q+2];
  end
  assign quotient_o = {quotient_q, {30-Q{1'b0}}};
endmodule
`default_nettype wire
