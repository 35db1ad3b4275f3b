// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A finite float, subnormal or not, as a number with an exponent of 11 bits that is not subnormal, a cycle later. It
// may have MANTISSA_BITS of fraction, but is a multiple of 2^-149: a subnormal one has 23.
`default_nettype none
module rp_float_widen #(
  parameter integer MANTISSA_BITS = 31,          // 23 or more
  parameter integer FLOAT_BITS = 9 + MANTISSA_BITS,
  parameter integer BITS = 12 + MANTISSA_BITS
) (
  input  wire                  clk_i,
  input  wire [FLOAT_BITS-1:0] float_i,
  output reg  [BITS-1:0]       number_o
);
  localparam integer M = MANTISSA_BITS;
  wire sign = float_i[FLOAT_BITS-1];
  wire [7:0] exponent = float_i[M+:8];
  wire [22:0] moved;
  wire [4:0] places;
  rp_normaliser #(.WIDTH(23)) normaliser (.value_i(float_i[M-1-:23]), .moved_o(moved), .places_o(places));
  always @(posedge clk_i)
    if (exponent != 8'd0) number_o <= {sign, {3'd0, exponent} + 11'd896, float_i[M-1:0]};
    else if (!moved[22]) number_o <= {sign, {BITS-1{1'b0}}};
    else number_o <= {sign, 11'd896 - {6'd0, places}, moved[21:0], {M-22{1'b0}}};
endmodule
`default_nettype wire
