// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Quotient of two floating-point numbers of MANTISSA_BITS + 1 bits, rounded once, to nearest even: one in every cycle,
// 2 + (MANTISSA_BITS + 1) / 2 cycles later.
// It needs no bit behind the first that is rounded off: a quotient that ended there would have one more bit than its
// numerator. Nor is it ever rounded up to the next power of two.
// Promises: x / 0 is infinite, 0 / 0 a NaN, with the sign of both.
// Must be given: finite numbers, none subnormal, with a quotient that is neither too large for the format nor
// subnormal.
`default_nettype none
module rp_float_quotient #(
  parameter integer EXPONENT_BITS = 11,
  parameter integer MANTISSA_BITS = 31,          // stored bits, without the leading one; an odd number
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  output reg  [BITS-1:0] quotient_o
);
  generate
    if (MANTISSA_BITS % 2 == 0) begin : gen_bad_bits
      float_quotient_MANTISSA_BITS_must_be_odd illegal ();
    end
  endgenerate
  localparam integer E = EXPONENT_BITS;
  localparam integer S = MANTISSA_BITS + 1;      // bits of a significand
  localparam [E-1:0] BIAS = {1'b0, {E-1{1'b1}}};

  wire less;
  wire zero_a = a_i[BITS-2-:E] == {E{1'b0}}, zero_b = b_i[BITS-2-:E] == {E{1'b0}};
  wire [E-1:0] exponent = a_i[BITS-2-:E] - b_i[BITS-2-:E] + BIAS - {{E-1{1'b0}}, less};
  wire [S-1:0] bits;
  wire rest, zero_numerator, zero_denominator, sign;
  wire [E-1:0] quotient_exponent;
  rp_quotient_digits #(.BITS(S), .WAITING(E + 3)) digit_array (
    .clk_i(clk_i),
    .a_i({1'b1, a_i[0+:S-1]}),
    .b_i({1'b1, b_i[0+:S-1]}),
    .less_o(less),
    .waiting_i({zero_a, zero_b, a_i[BITS-1] ^ b_i[BITS-1], exponent}),
    .digits_o(bits),
    .rest_o(rest),
    .waiting_o({zero_numerator, zero_denominator, sign, quotient_exponent})
  );
  wire unused = &{1'b0, rest};

  // ---- Last stage: the last bit decides the rounding.
  always @(posedge clk_i)
    if (zero_numerator && zero_denominator) quotient_o <= {sign, {E+1{1'b1}}, {S-2{1'b0}}};
    else if (zero_denominator) quotient_o <= {sign, {E{1'b1}}, {S-1{1'b0}}};
    else if (zero_numerator) quotient_o <= {sign, {E+S-1{1'b0}}};
    else quotient_o <= {sign, quotient_exponent, bits[S-1:1] + {{S-2{1'b0}}, bits[0]}};
endmodule
`default_nettype wire
