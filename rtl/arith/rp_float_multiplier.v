// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Floating-point multiplier, three stages: the product as two numbers (multiply_tree), their sum with its leading one
// brought to the top two bits, rounding.
// The tree takes both operands as normal numbers, so that it need not wait for the exponents; what a subnormal one has
// too much is taken off in the sum. The product of two subnormal ones is zero however it is rounded.
// Operands are taken with enable_i[0]; enable_i[k] must be high when stage k holds that operation k cycles later.
// result_o is combinational, valid in stage 2, and zero while enable_i[2] is low, so that units of a lane can be
// ORed. Nearest even, one NaN (quiet, positive).
// SUBNORMALS 0: IEEE; 1: subnormal operands count as zero and a result is flushed to zero when
// it is tiny after rounding, as in SSE. 2: and tiny_o flags, with result_o, that it was.
`default_nettype none
module rp_float_multiplier #(
  parameter integer EXPONENT_BITS = 8,
  parameter integer MANTISSA_BITS = 23,   // stored bits, without the leading one
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire [2:0]      enable_i,
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  output reg  [BITS-1:0] result_o,
  output reg             tiny_o
);
  `include "rp_free_running.vh"
  localparam integer E = EXPONENT_BITS;
  localparam integer M = MANTISSA_BITS;
  localparam integer P = 2*M + 2;           // bits of the product
  localparam integer X = E + 2;             // signed exponent
  localparam integer STEPS = $clog2(M + 1); // of the normaliser: shifts by 2^(STEPS-1) .. 1
  localparam integer F = $clog2(M + 4);
  localparam integer FAR = M + 3;
  localparam [X-1:0] BIAS = {3'b000, {E-1{1'b1}}};
  localparam [X-1:0] ONE = {{X-1{1'b0}}, 1'b1};
  // Stage 0 -> 1
  reg s1_nan_q, s1_infinite_q, s1_zero_q, s1_sign_q;
  reg [X-1:0] s1_exponent_q;                // of a product in [1, 2), biased
  reg [STEPS-1:0] s1_shift_q;               // leading zeros of the subnormal operand
  reg [P-1:0] s1_sum_q, s1_carry_q;
  reg [M:0] s1_less_q;                      // to be taken off the sum, M bits up
  // Stage 1 -> 2
  reg s2_nan_q, s2_infinite_q, s2_infinite_above_q, s2_zero_q, s2_sign_q;  // above: if the product is 2 or more
  reg [X-1:0] s2_exponent_q;                // of a product in [1, 2)
  reg [F-1:0] s2_distance_q;                // shift to the right of a subnormal result; more leaves the sticky bit only
  reg [P-1:0] s2_product_q;

  wire normal_a = a_i[BITS-2 -: E] != {E{1'b0}};
  wire normal_b = b_i[BITS-2 -: E] != {E{1'b0}};
  wire [M:0] mantissa_a = {normal_a, (SUBNORMALS == 0 || normal_a) ? a_i[M-1:0] : {M{1'b0}}};
  wire [M:0] mantissa_b = {normal_b, (SUBNORMALS == 0 || normal_b) ? b_i[M-1:0] : {M{1'b0}}};
  wire [P-1:0] tree_sum, tree_carry;
  rp_multiply_tree #(.A_BITS(M+1), .B_BITS(M+1), .OUT_BITS(P)) tree (
    .a_i({1'b1, a_i[M-1:0]}), .b_i({1'b1, b_i[M-1:0]}), .c_i({P{1'b0}}), .sum_o(tree_sum), .carry_o(tree_carry));

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg zero_a, zero_b, max_a, max_b, nan_a, nan_b;
      reg [E-1:0] exponent_a, exponent_b;
      reg [M:0] guide;
      reg [STEPS-1:0] shift;
      integer step;
      exponent_a = a_i[BITS-2 -: E];
      exponent_b = b_i[BITS-2 -: E];
      zero_a = mantissa_a == {M+1{1'b0}};
      zero_b = mantissa_b == {M+1{1'b0}};
      max_a = &exponent_a;
      max_b = &exponent_b;
      nan_a = max_a && a_i[M-1:0] != {M{1'b0}};
      nan_b = max_b && b_i[M-1:0] != {M{1'b0}};
      s1_nan_q <= nan_a || nan_b || (max_a && zero_b) || (max_b && zero_a);
      s1_infinite_q <= max_a || max_b;
      s1_sign_q <= a_i[BITS-1] ^ b_i[BITS-1];
      // Leading zeros of the one subnormal operand; of two the product vanishes however it is shifted.
      shift = {STEPS{1'b0}};
      if (SUBNORMALS == 0 && !(mantissa_a[M] && mantissa_b[M])) begin
        guide = mantissa_a[M] ? mantissa_b : mantissa_a;
        for (step = STEPS - 1; step >= 0; step = step - 1) begin
          if (guide >> (M + 1 - (1 << step)) == {M+1{1'b0}}) begin
            guide = guide << (1 << step);
            shift[step] = 1'b1;
          end
        end
      end
      s1_shift_q <= shift;
      if (exponent_a == {E{1'b0}}) exponent_a = {{E-1{1'b0}}, 1'b1};
      if (exponent_b == {E{1'b0}}) exponent_b = {{E-1{1'b0}}, 1'b1};
      s1_exponent_q <= {2'b00, exponent_a} + {2'b00, exponent_b} - BIAS;
      s1_sum_q <= tree_sum;
      s1_carry_q <= tree_carry;
      s1_less_q <= (SUBNORMALS != 0 || normal_a == normal_b) ? {M+1{1'b0}} : {1'b1, normal_a ? a_i[M-1:0] : b_i[M-1:0]};
      s1_zero_q <= zero_a || zero_b || !(normal_a || normal_b);
    end
    if (`STAGE_LOADS(enable_i[1])) begin : stage1
      reg [P-1:0] product;
      reg [X-1:0] exponent, distance;
      product = s1_sum_q + s1_carry_q - {1'b0, s1_less_q, {M{1'b0}}};
      s2_product_q <= (SUBNORMALS == 0) ? product << s1_shift_q : product;
      exponent = s1_exponent_q - {{X-STEPS{1'b0}}, s1_shift_q};
      distance = ONE - exponent;
      if (SUBNORMALS != 0 || distance[X-1]) distance = {X{1'b0}};
      if (distance > FAR[X-1:0]) distance = FAR[X-1:0];
      s2_distance_q <= distance[F-1:0];
      s2_exponent_q <= exponent;
      s2_nan_q <= s1_nan_q;
      s2_zero_q <= s1_zero_q;
      s2_infinite_q <= s1_infinite_q || (!exponent[X-1] && (exponent[X-2] || &exponent[E-1:0]));
      s2_infinite_above_q <= s1_infinite_q || (!exponent[X-1] && (exponent[X-2] || &exponent[E-1:1]));
      s2_sign_q <= s1_sign_q;
    end
  end

  always @* begin : stage2
    reg [M+2:0] top, lost;                  // leading two bits, mantissa, guard
    reg [M:0] kept;                         // mantissa and guard
    reg [X-1:0] exponent;
    reg [X+M-1:0] magnitude;
    reg sticky, sign;
    result_o = {BITS{1'b0}};
    tiny_o = 1'b0;
    top = s2_product_q[P-1:M-1];
    lost = {M+3{1'b0}};
    kept = {M+1{1'b0}};
    exponent = s2_exponent_q;
    magnitude = {X+M{1'b0}};
    sticky = s2_product_q[M-2:0] != {M-1{1'b0}};
    sign = s2_sign_q;
    if (enable_i[2]) begin
      if (SUBNORMALS == 0 && s2_distance_q != {F{1'b0}}) begin
        // Below the normal numbers: the exponent is 0, or 1 if the leading bit comes to where a normal number's is.
        lost = top & ~({M+3{1'b1}} << s2_distance_q);
        top = top >> s2_distance_q;
        kept = top[M:0];
        sticky = sticky || lost != {M+3{1'b0}};
        exponent = {{X-1{1'b0}}, top[M+1]};
      end else if (top[M+2]) begin
        kept = top[M+1:1];
        sticky = sticky || top[0];
        exponent = s2_exponent_q + ONE;
      end else begin
        kept = top[M:0];
      end
      // A carry out of the mantissa goes up into the exponent.
      magnitude = {exponent, kept[M:1]} + {{X+M-1{1'b0}}, kept[0] && (kept[1] || sticky)};
      if (s2_nan_q) begin
        sign = 1'b0;
        magnitude = {2'b00, {E+1{1'b1}}, {M-1{1'b0}}};
      end else if (s2_zero_q) begin
        magnitude = {X+M{1'b0}};
      end else if (s2_product_q[P-1] ? s2_infinite_above_q : s2_infinite_q) begin
        magnitude = {2'b00, {E{1'b1}}, {M{1'b0}}};
      end else if (SUBNORMALS != 0 && (magnitude[X+M-1] || magnitude[X+M-1:M] == {X{1'b0}})) begin
        magnitude = {X+M{1'b0}};
        tiny_o = SUBNORMALS == 2;
      end
      result_o = {sign, magnitude[E+M-1:0]};
    end
  end
endmodule
`default_nettype wire
