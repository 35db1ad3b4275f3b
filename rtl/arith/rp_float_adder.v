// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Floating-point adder and subtracter, three stages: align, add and begin to normalise, normalise and round.
// Operands are taken with enable_i[0]; enable_i[k] must be high when stage k holds that operation k cycles later.
// result_o is combinational, valid in stage 2, and zero while enable_i[2] is low, so that units of a lane can be
// ORed. Nearest even, one NaN (quiet, positive).
// SUBNORMALS 0: IEEE; 1: subnormal operands and results become the zero of their sign. A subnormal sum is exact, so it
// never depends on rounding whether one is flushed. 2: and tiny_o flags, with result_o, a result that was.
`default_nettype none
module rp_float_adder #(
  parameter integer EXPONENT_BITS = 8,
  parameter integer MANTISSA_BITS = 23,   // stored bits, without the leading one
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire [2:0]      enable_i,
  input  wire            subtract_i,
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  output reg  [BITS-1:0] result_o,
  output reg             tiny_o
);
  `include "rp_free_running.vh"
  localparam integer E = EXPONENT_BITS;
  localparam integer M = MANTISSA_BITS;
  localparam integer A = M + 4;             // aligned mantissa: leading bit, M bits, guard, round, sticky
  localparam integer W = M + 5;             // sum, with its carry
  localparam integer STEPS = $clog2(W);     // of the normaliser: shifts by 2^(STEPS-1) .. 1
  localparam integer EARLY = STEPS - 3;     // steps 2^(STEPS-1) .. 8 are taken in stage 1
  localparam [E-1:0] ONE = 1;
  localparam [E-4:0] ONE_HIGH = 1;

  `include "rp_ones_below.vh"

  // Stage 0 -> 1
  reg s1_nan_q, s1_infinite_q, s1_sign_q, s1_subtract_q;
  reg [E-1:0] s1_exponent_q;
  reg [M:0] s1_large_q;
  reg [A-1:0] s1_small_q;
  // Stage 1 -> 2
  reg s2_nan_q, s2_infinite_q, s2_sign_q, s2_subtract_q;
  reg [E-1:0] s2_exponent_q;                // of an infinite sum too large for it
  reg [W-1:0] s2_sum_q, s2_guide_q;

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg sign_a, sign_b, swap, nan_a, nan_b, max_a, max_b;
      reg [E-1:0] exponent_a, exponent_b, distance;
      reg [E:0] ahead;
      reg [M:0] mantissa_a, mantissa_b;
      reg [A-1:0] aligned, lost;
      sign_a = a_i[BITS-1];
      sign_b = b_i[BITS-1] ^ subtract_i;
      exponent_a = a_i[BITS-2 -: E];
      exponent_b = b_i[BITS-2 -: E];
      mantissa_a = {exponent_a != {E{1'b0}}, (SUBNORMALS == 0 || exponent_a != {E{1'b0}}) ? a_i[M-1:0] : {M{1'b0}}};
      mantissa_b = {exponent_b != {E{1'b0}}, (SUBNORMALS == 0 || exponent_b != {E{1'b0}}) ? b_i[M-1:0] : {M{1'b0}}};
      max_a = &exponent_a;
      max_b = &exponent_b;
      nan_a = max_a && a_i[M-1:0] != {M{1'b0}};
      nan_b = max_b && b_i[M-1:0] != {M{1'b0}};
      s1_nan_q <= nan_a || nan_b || (max_a && max_b && sign_a != sign_b);
      s1_infinite_q <= max_a || max_b;
      swap = b_i[BITS-2:0] > a_i[BITS-2:0];
      // A subnormal number has the exponent of the smallest normal one.
      exponent_a[0] = exponent_a[0] || exponent_a == {E{1'b0}};
      exponent_b[0] = exponent_b[0] || exponent_b == {E{1'b0}};
      // Both differences, so that the distance does not wait for the comparison of the mantissas.
      ahead = {1'b0, exponent_a} - {1'b0, exponent_b};
      distance = exponent_b - exponent_a;
      if (!ahead[E]) distance = ahead[E-1:0];
      aligned = {swap ? mantissa_a : mantissa_b, 3'b000};
      lost = aligned & ~({A{1'b1}} << distance);
      aligned = aligned >> distance;
      s1_sign_q <= swap ? sign_b : sign_a;
      s1_subtract_q <= sign_a ^ sign_b;
      s1_exponent_q <= ahead[E] ? exponent_b : exponent_a;
      s1_large_q <= swap ? mantissa_b : mantissa_a;
      s1_small_q <= {aligned[A-1:1], aligned[0] || lost != {A{1'b0}}};
    end
    if (`STAGE_LOADS(enable_i[1])) begin : stage1
      reg [W-1:0] sum, guide;
      reg [E-1:0] exponent;
      integer step;
      sum = s1_subtract_q ? {1'b0, s1_large_q, 3'b000} - {1'b0, s1_small_q} :
            {1'b0, s1_large_q, 3'b000} + {1'b0, s1_small_q};
      // The sum is shifted up until its leading one is at the top. The guide has a further one
      // where the exponent would become zero.
      guide = sum | ({1'b1, {W-1{1'b0}}} >> s1_exponent_q);
      exponent = s1_exponent_q + ONE;
      for (step = STEPS - 1; step >= STEPS - EARLY; step = step - 1) begin
        if (guide >> (W - (1 << step)) == {W{1'b0}}) begin
          guide = guide << (1 << step);
          sum = sum << (1 << step);
          exponent = exponent - (ONE << step);
        end
      end
      s2_nan_q <= s1_nan_q;
      s2_infinite_q <= s1_infinite_q;
      s2_sign_q <= s1_sign_q;
      s2_subtract_q <= s1_subtract_q;
      s2_exponent_q <= exponent;
      s2_sum_q <= sum;
      s2_guide_q <= guide;
    end
  end

  always @* begin : stage2
    reg [W-1:0] sum, guide;
    reg [2:0] shift;
    reg [4:0] low;  // three bits of the exponent, less the shift, more by a carry out of the mantissa: -7 .. 8
    reg [E-4:0] high;                       // the others
    reg [E+M-1:0] magnitude;
    reg [63:0] ones;
    reg round_up, sign;
    integer step;
    result_o = {BITS{1'b0}};
    tiny_o = 1'b0;
    sum = s2_sum_q;
    guide = s2_guide_q;
    shift = 3'd0;
    low = 5'd0;
    high = {E-3{1'b0}};
    magnitude = {E+M{1'b0}};
    round_up = 1'b0;
    sign = s2_sign_q;
    if (enable_i[2]) begin
      for (step = STEPS - EARLY - 1; step >= 0; step = step - 1) begin
        if (guide >> (W - (1 << step)) == {W{1'b0}}) begin
          guide = guide << (1 << step);
          sum = sum << (1 << step);
          shift[step] = 1'b1;
        end
      end
      round_up = sum[3] && (sum[4] || sum[2:0] != 3'b000);
      // A carry out of the mantissa goes up into the exponent, to infinity too. It comes late, so what it may
      // make of the exponent is ready before.
      low = {2'b00, s2_exponent_q[2:0]} - {2'b00, shift} + {4'd0, &sum[W-2:3]};
      high = s2_exponent_q[E-1:3];
      if (low[4]) high = s2_exponent_q[E-1:3] - ONE_HIGH;
      else if (low[3]) high = s2_exponent_q[E-1:3] + ONE_HIGH;
    end
    ones = ones_below({{63-M{1'b0}}, sum[W-2:4]});
    if (enable_i[2]) begin
      if (s2_nan_q) begin
        sign = 1'b0;
        magnitude = {{E+1{1'b1}}, {M-1{1'b0}}};
      end else if (s2_infinite_q || (&s2_exponent_q && s2_guide_q[W-1])) begin
        magnitude = {{E{1'b1}}, {M{1'b0}}};
      end else begin
        if (sum[W-1]) magnitude[E+M-1:M] = {high, low[2:0]};
        if (SUBNORMALS == 0 || sum[W-1]) magnitude[M-1:0] = sum[W-2:4] ^ (ones[M-1:0] & {M{round_up}});
        if (sum == {W{1'b0}} && s2_subtract_q) sign = 1'b0;
        tiny_o = SUBNORMALS == 2 && !sum[W-1] && sum != {W{1'b0}};
      end
      result_o = {sign, magnitude};
    end
  end
endmodule
`default_nettype wire
