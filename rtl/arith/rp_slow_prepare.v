// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The first three stages of the slow unit: unpacks, normalises subnormal operands, finds every result that needs
// no computation, and turns the rest into one task for the stages behind: the quotient q = w/v,
// or q = w/sqrt(v), which lies in [1, 2).
// enable_i[0] takes the operands, enable_i[k] must follow k cycles later; the outputs
// are registers that hold from then on.
//   fdiv: root 0 unary 0, fsqrt: root 1 unary 0, frsqrt: root 1 unary 1, frcp: root 0 unary 1
//   index_1_o    in stage 1, for a table: {root, odd exponent, 7 bits of the mantissa of v below its leading one}
//   offset_digits_o  in stage 2, as the next ones: what booth_digits makes of the next 11 bits, which the
//                    exact unit's table is not asked for
//   v_o, w_o     23 fraction bits; v in [1, 2), or [1, 4) for a root; w is v for fsqrt, 2 for frsqrt
//   special_3_o  in stage 3, as all others: the result is {sign, exponent, nan, 22 zeros}
//   else         the result is the sign and exponent * 2^23 + q, q with 23 - shift fraction
//                bits; shift above 0: subnormal, 1 .. 24
// With a SIGNIFICAND of p bits, 24 here, what an operand has below them is not looked at, v and w have p - 1 fraction
// bits and zeros below, and q has p - 1 - shift, shift 0 .. p.
// SUBNORMALS 0: IEEE; 1: subnormal operands count as zero, results below the normal numbers are zero
// (no quotient there rounds up to one); 2: and tiny_3_o flags such a result for one cycle, in stage 3.
`default_nettype none
module rp_slow_prepare #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer WITHOUT = 0   // as rp_slow_operations.vh has it
) (
  input  wire        clk_i,
  input  wire [2:0]  enable_i,
  input  wire        root_i,
  input  wire        unary_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  output wire [8:0]  index_1_o,
  output wire [17:0] offset_digits_o,
  output wire        root_o,
  output wire        unary_o,
  output wire [24:0] v_o,
  output wire [24:0] w_o,
  output wire        special_3_o,
  output wire        nan_3_o,
  output wire        sign_3_o,
  output wire [7:0]  exponent_3_o,
  output wire [4:0]  shift_3_o,
  output reg         tiny_3_o
);
  `include "rp_booth_digits.vh"
  `include "rp_slow_operations.vh"
  wire root, unary;
  assign {root, unary} = possible_operation(root_i, unary_i);
  localparam [31:0] KEPT = 32'hffffffff << (24 - SIGNIFICAND);
  localparam [9:0] LAST_SHIFT = SIGNIFICAND[9:0];
  wire [31:0] float_a = a_i & KEPT;
  wire [31:0] float_b = b_i & KEPT;
  // A number brought to the top: {leading zeros, 24 bits}.
  function [28:0] normalised(input [23:0] mantissa);
    reg [23:0] m;
    reg [4:0] zeros;
    begin
      m = mantissa;
      zeros = 5'd0;
      if (SUBNORMALS == 0 && !m[23]) begin
        if (m[23:8] == 16'd0) begin m = {m[7:0], 16'd0}; zeros[4] = 1'b1; end
        if (m[23:16] == 8'd0) begin m = {m[15:0], 8'd0}; zeros[3] = 1'b1; end
        if (m[23:20] == 4'd0) begin m = {m[19:0], 4'd0}; zeros[2] = 1'b1; end
        if (m[23:22] == 2'd0) begin m = {m[21:0], 2'd0}; zeros[1] = 1'b1; end
        if (!m[23]) begin m = {m[22:0], 1'b0}; zeros[0] = 1'b1; end
      end
      normalised = {zeros, m};
    end
  endfunction
  `include "rp_free_running.vh"
  // Stage 0 -> 1: numerator n, divisor or radicand d: exponents, biased by 127, still without the leading zeros.
  reg s1_special_q, s1_nan_q, s1_infinite_q, s1_sign_q, s1_root_q, s1_unary_q;
  reg [7:0] s1_exponent_n_q, s1_exponent_d_q;
  reg [4:0] s1_zeros_n_q, s1_zeros_d_q;
  reg [23:0] s1_n_q, s1_d_q;
  wire s1_odd = !(s1_exponent_d_q[0] ^ s1_zeros_d_q[0]);
  assign index_1_o = {s1_root_q, s1_root_q && s1_odd, s1_d_q[22:16]};
  // Stage 1 -> 2: the exponents' difference, or half of the radicand's, and whether that is off by one.
  reg s2_special_q, s2_nan_q, s2_infinite_q, s2_sign_q, s2_root_q, s2_unary_q, s2_four_q, s2_step_q;
  reg [9:0] s2_exponent_q;
  reg [24:0] s2_v_q, s2_w_q;
  reg [17:0] s2_offset_digits_q;
  wire [47:0] s1_offset_digits = booth_digits({21'd0, s1_d_q[16:6]});
  // Stage 2 -> 3
  reg s3_special_q, s3_nan_q, s3_sign_q;
  reg [7:0] s3_exponent_q;
  reg [4:0] s3_shift_q;

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg single, zero_a, zero_b, zero_n, zero_d, max_a, max_b, max_n, max_d, nan_a, nan_b, nan, infinite;
      reg [28:0] a, b;
      single = root || unary;               // a_i is the divisor or radicand, and n is 1
      max_a = &float_a[30:23];
      max_b = &float_b[30:23];
      zero_a = float_a[30:23] == 8'd0 && (SUBNORMALS != 0 || float_a[22:0] == 23'd0);
      zero_b = float_b[30:23] == 8'd0 && (SUBNORMALS != 0 || float_b[22:0] == 23'd0);
      nan_a = max_a && float_a[22:0] != 23'd0;
      nan_b = max_b && float_b[22:0] != 23'd0;
      max_n = max_a && !single;
      zero_n = zero_a && !single;
      max_d = single ? max_a : max_b;
      zero_d = single ? zero_a : zero_b;
      nan = nan_a || (nan_b && !single);
      infinite = 1'b0;
      if (root) begin
        if (float_a[31] && !zero_d) nan = 1'b1;
        infinite = unary ? zero_d : max_d;
      end else begin
        if ((max_n && max_d) || (zero_n && zero_d)) nan = 1'b1;
        infinite = max_n || zero_d;
      end
      s1_special_q <= nan || max_n || max_d || zero_n || zero_d;
      s1_nan_q <= nan;
      s1_infinite_q <= infinite;
      s1_sign_q <= !nan && (float_a[31] ^ (float_b[31] && !single));
      s1_root_q <= root;
      s1_unary_q <= unary;
      a = normalised({float_a[30:23] != 8'd0, float_a[22:0]});
      b = normalised({float_b[30:23] != 8'd0, float_b[22:0]});
      {s1_zeros_n_q, s1_n_q} <= single ? {5'd0, 24'h800000} : a;
      {s1_zeros_d_q, s1_d_q} <= single ? a : b;
      // A subnormal number has the exponent of the smallest normal one.
      s1_exponent_n_q <= single ? 8'd127 : {float_a[30:24], float_a[23] || float_a[30:23] == 8'd0};
      s1_exponent_d_q <= single ? {float_a[30:24], float_a[23] || float_a[30:23] == 8'd0} :
                         {float_b[30:24], float_b[23] || float_b[30:23] == 8'd0};
    end
    if (`STAGE_LOADS(enable_i[1])) begin : stage1
      reg smaller;
      reg [9:0] exponent_n, exponent_d;
      smaller = s1_n_q < s1_d_q;
      exponent_n = {2'd0, s1_exponent_n_q} - {5'd0, s1_zeros_n_q};
      exponent_d = {2'd0, s1_exponent_d_q} - {5'd0, s1_zeros_d_q};
      // A root: the number is v * 4^half, so an odd exponent leaves a factor of two in v.
      s2_exponent_q <= s1_root_q ? {exponent_d[9], exponent_d[9:1]} : exponent_n - exponent_d;
      s2_step_q <= s1_root_q ? exponent_d[0] : smaller;
      s2_special_q <= s1_special_q;
      s2_nan_q <= s1_nan_q;
      s2_infinite_q <= s1_infinite_q;
      s2_sign_q <= s1_sign_q;
      s2_root_q <= s1_root_q;
      s2_unary_q <= s1_unary_q;
      s2_four_q <= s1_root_q && s1_unary_q && !s1_odd && s1_d_q == 24'h800000;
      s2_offset_digits_q <= s1_offset_digits[17:0];
      s2_v_q <= (s1_root_q && s1_odd) ? {s1_d_q, 1'b0} : {1'b0, s1_d_q};
      if (s1_root_q && s1_unary_q) s2_w_q <= {1'b1, 24'd0};
      else if (s1_root_q) s2_w_q <= s1_odd ? {s1_d_q, 1'b0} : {1'b0, s1_d_q};
      else s2_w_q <= smaller ? {s1_n_q, 1'b0} : {1'b0, s1_n_q};
    end
    tiny_3_o <= 1'b0;
    if (`STAGE_LOADS(enable_i[2])) begin : stage2
      reg special;
      reg [9:0] exponent, below;
      // 127 + n's - d's, 63 + half, 190 - half; -half = ~half + 1.
      if (!s2_root_q) exponent = s2_exponent_q + {3'd0, {6{1'b1}}, !s2_step_q};
      else if (!s2_unary_q) exponent = s2_exponent_q + (s2_step_q ? 10'd64 : 10'd63);
      else exponent = ~s2_exponent_q + (s2_step_q ? 10'd190 : 10'd191);
      special = s2_special_q;
      below = 10'd1 - exponent;                 // how far below the normal numbers
      s3_shift_q <= 5'd0;
      if (s2_special_q) begin
        s3_exponent_q <= {8{s2_infinite_q || s2_nan_q}};
      end else if (s2_four_q) begin
        special = 1'b1;                         // a power of four: its result is no quotient below 2
        s3_exponent_q <= exponent[7:0] + 8'd1;
      end else if (!exponent[9] && (exponent[8] || &exponent[7:0])) begin
        special = 1'b1;
        s3_exponent_q <= 8'hff;
      end else if (exponent[9] || exponent == 10'd0) begin
        special = SUBNORMALS != 0 || below > LAST_SHIFT;
        tiny_3_o <= enable_i[2] && SUBNORMALS == 2;
        s3_exponent_q <= 8'd0;
        if (SUBNORMALS == 0) s3_shift_q <= below[4:0];
      end else begin
        s3_exponent_q <= exponent[7:0] - 8'd1;
      end
      s3_special_q <= special;
      s3_nan_q <= s2_nan_q;
      s3_sign_q <= s2_sign_q;
    end
  end

  assign offset_digits_o = s2_offset_digits_q;
  assign root_o = s2_root_q;
  assign unary_o = s2_unary_q;
  assign v_o = s2_v_q;
  assign w_o = s2_w_q;
  assign special_3_o = s3_special_q;
  assign nan_3_o = s3_nan_q;
  assign sign_3_o = s3_sign_q;
  assign exponent_3_o = s3_exponent_q;
  assign shift_3_o = s3_shift_q;
endmodule
`default_nettype wire
