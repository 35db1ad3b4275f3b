// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Floating-point fused multiply-add, five stages: a * b + c, rounded once.
// 0: product as two numbers (multiply_tree), distance of c, 1: their sum; c is aligned with it, 2: addition or
// subtraction, 3: magnitude, the leading one brought into the top eight bits, 4: to the top, rounding.
// Operands are taken with enable_i[0]; enable_i[k] must be high when stage k holds that operation k cycles later.
// result_o is combinational, valid in stage 4, and zero while enable_i[4] is low, so that units of a lane can be
// ORed. Nearest even, one NaN (quiet, positive).
// SUBNORMALS 0: IEEE; 1: subnormal operands count as zero and a result is flushed to zero when
// it is tiny after rounding, as in SSE. 2: and tiny_o flags, with result_o, that it was.
//
// With p = MANTISSA_BITS + 1 the window has c in its top p bits when c dominates, two free bits, the product of 2p
// bits, and bits below it in which the last one collects what is shifted out of c. Two below the product suffice: a
// product of fewer than 2p bits, from a subnormal operand, still has p (two subnormal ones leave c alone), so where
// more than one leading bit cancels c has lost nothing. When c dominates the product is below a quarter of its last
// bit, and where exactly does not matter. The exponent of the window's top is at least c's, so a result needs shifting
// up only, and no further than to the smallest exponent.
`default_nettype none
module rp_float_fma #(
  parameter integer EXPONENT_BITS = 8,
  parameter integer MANTISSA_BITS = 23,   // stored bits, without the leading one
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire [4:0]      enable_i,
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  input  wire [BITS-1:0] c_i,
  input  wire            multiply_i,      // a * b: c_i is not looked at
  output reg  [BITS-1:0] result_o,
  output reg             tiny_o
);
  `include "rp_free_running.vh"
  localparam integer E = EXPONENT_BITS;
  localparam integer M = MANTISSA_BITS;
  localparam integer P = M + 1;
  localparam integer GROUPS = (3*P + 5 + 7) / 8;
  localparam integer W = 8 * GROUPS;        // window
  localparam integer LOW = W - 3*P - 2;     // bits below the product
  localparam integer X = E + 2;             // signed exponent
  localparam integer D = $clog2(W + 1);     // distance
  localparam integer C = $clog2(GROUPS);
  localparam integer K = P + 8;             // bits kept behind stage 3, without sticky
  localparam [X-1:0] BIAS = {3'b000, {E-1{1'b1}}};
  localparam integer ABOVE = P + 3;         // from a product in [1, 2) to the top
  localparam integer LIMIT_AT_ONE = (SUBNORMALS == 0) ? 1 : 0;
  // Stage 0 -> 1. Tag: {nan, infinite, sign of an infinity, sign of the product, effective
  // subtraction, no result flushed away}
  reg [3:0] s1_tag_q, s2_tag_q, s3_tag_q;
  localparam integer NAN = 3, INFINITE = 2, SIGN = 1, SUBTRACT = 0;
  reg [2*P-1:0] s1_sum_q, s1_carry_q;
  reg [M:0] s1_c_q;
  reg [D-1:0] s1_distance_q;
  reg [X-1:0] s1_exponent_q, s2_exponent_q, s3_exponent_q;   // of the window's top, biased, 1 and above
  // Stage 1 -> 2
  reg [2*P-1:0] s2_product_q;
  reg [W-1:0] s2_addend_q;
  // Stage 2 -> 3
  reg [W:0] s3_sum_q;                       // signed
  // Stage 3 -> 4
  reg [3:0] s4_tag_q;
  reg s4_zero_q, s4_sticky_q;
  reg [X-1:0] s4_exponent_q;
  reg [K-1:0] s4_kept_q;
  reg [7:0] s4_guide_q;

  wire [E-1:0] exponent_a = a_i[BITS-2 -: E];
  wire [E-1:0] exponent_b = b_i[BITS-2 -: E];
  wire normal_a = exponent_a != {E{1'b0}};
  wire normal_b = exponent_b != {E{1'b0}};
  wire [M:0] mantissa_a = {normal_a, (SUBNORMALS == 0 || normal_a) ? a_i[M-1:0] : {M{1'b0}}};
  wire [M:0] mantissa_b = {normal_b, (SUBNORMALS == 0 || normal_b) ? b_i[M-1:0] : {M{1'b0}}};
  wire [2*P-1:0] tree_sum, tree_carry;
  rp_multiply_tree #(.A_BITS(P), .B_BITS(P), .OUT_BITS(2*P)) tree (
    .a_i(mantissa_a), .b_i(mantissa_b), .c_i({2*P{1'b0}}), .sum_o(tree_sum), .carry_o(tree_carry));

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg normal_c, zero_a, zero_b, zero_c, max_a, max_b, max_c, nan_a, nan_b, nan_c, sign_p, sign_c, infinite_p;
      reg [E-1:0] exponent_c, field_a, field_b, field_c;
      reg [M:0] mantissa_c;
      reg [X-1:0] top, distance;
      exponent_c = c_i[BITS-2 -: E];
      normal_c = exponent_c != {E{1'b0}};
      mantissa_c = {normal_c, (SUBNORMALS == 0 || normal_c) ? c_i[M-1:0] : {M{1'b0}}};
      max_a = &exponent_a;
      max_b = &exponent_b;
      max_c = &exponent_c && !multiply_i;
      zero_a = !normal_a && (SUBNORMALS != 0 || a_i[M-1:0] == {M{1'b0}});
      zero_b = !normal_b && (SUBNORMALS != 0 || b_i[M-1:0] == {M{1'b0}});
      nan_a = max_a && a_i[M-1:0] != {M{1'b0}};
      nan_b = max_b && b_i[M-1:0] != {M{1'b0}};
      nan_c = max_c && c_i[M-1:0] != {M{1'b0}};
      zero_c = multiply_i;
      infinite_p = max_a || max_b;
      sign_p = a_i[BITS-1] ^ b_i[BITS-1];
      sign_c = multiply_i ? sign_p : c_i[BITS-1];
      s1_tag_q[NAN] <= nan_a || nan_b || nan_c || (max_a && zero_b) || (max_b && zero_a) ||
                       (infinite_p && max_c && sign_p != sign_c);
      s1_tag_q[INFINITE] <= infinite_p || max_c;
      s1_tag_q[SIGN] <= (max_c && !infinite_p) ? sign_c : sign_p;
      s1_tag_q[SUBTRACT] <= sign_p != sign_c;
      s1_sum_q <= tree_sum;
      s1_carry_q <= tree_carry;
      s1_c_q <= zero_c ? {P{1'b0}} : mantissa_c;
      // A subnormal number has the exponent of the smallest normal one.
      field_a = normal_a ? exponent_a : {{E-1{1'b0}}, 1'b1};
      field_b = normal_b ? exponent_b : {{E-1{1'b0}}, 1'b1};
      field_c = (normal_c && !zero_c) ? exponent_c : {{E-1{1'b0}}, 1'b1};
      top = ({2'b00, field_a} + {2'b00, field_b}) + (ABOVE[X-1:0] - BIAS);
      distance = top - {2'b00, field_c};
      if (distance[X-1] || zero_a || zero_b) begin
        // c dominates: the window's top is its own.
        s1_distance_q <= {D{1'b0}};
        s1_exponent_q <= {2'b00, field_c};
      end else begin
        s1_distance_q <= (distance > W[X-1:0]) ? W[D-1:0] : distance[D-1:0];
        s1_exponent_q <= top;
      end
    end
    if (`STAGE_LOADS(enable_i[1])) begin : stage1
      reg [W+P-1:0] aligned;
      aligned = {s1_c_q, {W{1'b0}}} >> s1_distance_q;
      s2_product_q <= s1_sum_q + s1_carry_q;
      s2_addend_q <= {aligned[W+P-1:P+1], aligned[P:0] != {P+1{1'b0}}};
      s2_exponent_q <= s1_exponent_q;
      s2_tag_q <= s1_tag_q;
    end
    if (`STAGE_LOADS(enable_i[2])) begin : stage2
      reg [W:0] product, addend;
      product = {{P+3{1'b0}}, s2_product_q, {LOW{1'b0}}};
      addend = {1'b0, s2_addend_q} ^ {W+1{s2_tag_q[SUBTRACT]}};
      s3_sum_q <= product + addend + {{W{1'b0}}, s2_tag_q[SUBTRACT]};
      s3_exponent_q <= s2_exponent_q;
      s3_tag_q <= s2_tag_q;
    end
    if (`STAGE_LOADS(enable_i[3])) begin : stage3
      reg [W-1:0] magnitude, shifted;
      reg [X-1:0] limit;
      reg [7:0] guide;
      reg [C-1:0] group;
      reg found;
      integer g;
      magnitude = (s3_sum_q[W-1:0] ^ {W{s3_sum_q[W]}}) + {{W-1{1'b0}}, s3_sum_q[W]};
      // So far the leading one may be shifted up.
      limit = s3_exponent_q - LIMIT_AT_ONE[X-1:0];
      // The group of eight bits that has the leading one, or in which the limit lies; the guide has a one there.
      found = 1'b0;
      group = {C{1'b0}};
      guide = 8'd0;
      shifted = {W{1'b0}};
      for (g = 0; g < GROUPS; g = g + 1) begin
        if (!found && (magnitude[W-1-8*g -: 8] != 8'd0 || limit[X-1:3] == g[X-4:0] || g == GROUPS - 1)) begin
          found = 1'b1;
          group = g[C-1:0];
          shifted = magnitude << (8*g);
          guide = magnitude[W-1-8*g -: 8] | ((limit[X-1:3] == g[X-4:0]) ? 8'h80 >> limit[2:0] : 8'd0);
        end
      end
      s4_guide_q <= guide;
      s4_kept_q <= shifted[W-1 -: K];
      s4_sticky_q <= shifted[W-K-1:0] != {W-K{1'b0}};
      s4_zero_q <= s3_sum_q == {W+1{1'b0}};
      s4_exponent_q <= s3_exponent_q - {{X-C-3{1'b0}}, group, 3'b000};
      s4_tag_q <= s3_tag_q;
      if (!s3_tag_q[INFINITE]) s4_tag_q[SIGN] <= s3_tag_q[SIGN] ^ s3_sum_q[W];
    end
  end

  always @* begin : stage4
    reg [K-1:0] kept;
    reg [7:0] guide;
    reg [X-1:0] exponent;
    reg [2:0] shift;
    reg [X+M-1:0] magnitude;
    reg sign, round_up;
    result_o = {BITS{1'b0}};
    tiny_o = 1'b0;
    kept = s4_kept_q;
    guide = s4_guide_q;
    shift = 3'd0;
    magnitude = {X+M{1'b0}};
    exponent = {X{1'b0}};
    round_up = 1'b0;
    sign = s4_tag_q[SIGN];
    if (enable_i[4]) begin
      if (guide[7:4] == 4'd0) begin kept = kept << 4; guide = guide << 4; shift[2] = 1'b1; end
      if (guide[7:6] == 2'd0) begin kept = kept << 2; guide = guide << 2; shift[1] = 1'b1; end
      if (!guide[7]) begin kept = kept << 1; shift[0] = 1'b1; end
      // Below the normal numbers the leading one is not at the top, and the exponent field is zero.
      if (kept[K-1]) exponent = s4_exponent_q - {{X-3{1'b0}}, shift};
      round_up = kept[K-1-P] && (kept[K-P] || s4_sticky_q || kept[K-P-2:0] != {K-P-1{1'b0}});
      // A carry out of the mantissa goes up into the exponent, to infinity too.
      magnitude = {exponent, kept[K-2 -: M]} + {{X+M-1{1'b0}}, round_up};
      if (s4_tag_q[NAN]) begin
        sign = 1'b0;
        magnitude = {2'b00, {E+1{1'b1}}, {M-1{1'b0}}};
      end else if (s4_tag_q[INFINITE] || (magnitude[X+M-1 -: 2] != 2'b00) || &magnitude[E+M-1:M]) begin
        magnitude = {2'b00, {E{1'b1}}, {M{1'b0}}};
      end else if (s4_zero_q) begin
        magnitude = {X+M{1'b0}};
        if (s4_tag_q[SUBTRACT]) sign = 1'b0;
      end else if (SUBNORMALS != 0 && (!kept[K-1] || magnitude[E+M-1:M] == {E{1'b0}})) begin
        magnitude = {X+M{1'b0}};
        tiny_o = SUBNORMALS == 2;
      end
      result_o = {sign, magnitude[E+M-1:0]};
    end
  end
endmodule
`default_nettype wire
