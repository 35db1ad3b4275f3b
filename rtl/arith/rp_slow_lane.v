// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One lane of the Slw ALU: STAGES stages, and the result register behind them. enable_i[k] is high when stage k holds a
// task of this lane.
// root_i and unary_i name the operation: 00 fdiv, 10 fsqrt, 11 frsqrt, 01 frcp. SLOW_UNIT 0:
// exact, 1 .. 3: two, one, no Newton steps. SIGNIFICAND below 24: what a word has below so many bits is not looked at,
// and zero in the result. tiny_3_o, for one cycle, in stage 3: the result is a subnormal number that becomes zero.
`default_nettype none
module rp_slow_lane #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer SLOW_UNIT = 0,
  parameter integer STAGES = 11,
  parameter integer WITHOUT = 0   // operations of slw that it lacks, as rp_slow_operations.vh has them
) (
  input  wire        clk_i,
  input  wire [STAGES-1:0] enable_i,
  input  wire        root_i,
  input  wire        unary_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  output wire [31:0] result_o,
  output wire        tiny_3_o
);
  wire root, unary, special, nan, sign;
  wire [7:0] exponent;
  wire [4:0] shift;
  wire [24:0] v, w;
  wire [8:0] index;
  wire [17:0] offset_digits;
  wire [31:0] result;
  reg [31:0] result_q;

  rp_slow_prepare #(.SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND), .WITHOUT(WITHOUT)) prepare (
    .clk_i(clk_i),
    .enable_i(enable_i[2:0]),
    .root_i(root_i),
    .unary_i(unary_i),
    .a_i(a_i),
    .b_i(b_i),
    .index_1_o(index),
    .offset_digits_o(offset_digits),
    .root_o(root),
    .unary_o(unary),
    .v_o(v),
    .w_o(w),
    .special_3_o(special),
    .nan_3_o(nan),
    .sign_3_o(sign),
    .exponent_3_o(exponent),
    .shift_3_o(shift),
    .tiny_3_o(tiny_3_o)
  );

  generate
    if (SLOW_UNIT == 0) begin : gen_exact
      rp_slow_exact #(.SIGNIFICAND(SIGNIFICAND), .WITHOUT(WITHOUT)) quotient (
        .clk_i(clk_i),
        .enable_i(enable_i[STAGES-1:1]),
        .index_1_i(index),
        .offset_digits_i(offset_digits),
        .root_i(root),
        .unary_i(unary),
        .v_i(v),
        .w_i(w),
        .special_3_i(special),
        .nan_3_i(nan),
        .sign_3_i(sign),
        .exponent_3_i(exponent),
        .shift_3_i(shift),
        .result_o(result)
      );
    end else begin : gen_newton
      rp_slow_newton #(
        .SIGNIFICAND(SIGNIFICAND), .STEPS(3 - SLOW_UNIT), .LAST(STAGES - 1), .WITHOUT(WITHOUT)
      ) quotient (
        .clk_i(clk_i),
        .enable_i(enable_i[STAGES-1:1]),
        .index_1_i(index),
        .root_i(root),
        .unary_i(unary),
        .v_i(v),
        .w_i(w),
        .special_3_i(special),
        .nan_3_i(nan),
        .sign_3_i(sign),
        .exponent_3_i(exponent),
        .shift_3_i(shift),
        .result_o(result)
      );
    end
  endgenerate

  always @(posedge clk_i) if (enable_i[STAGES-1]) result_q <= result;
  assign result_o = result_q;
endmodule
`default_nettype wire
