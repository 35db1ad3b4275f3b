// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The digits of a quotient of two significands of BITS bits, their first bits ones: one quotient in every cycle, 1 +
// BITS / 2 cycles later. An array of digits 0 .. 3: of each remainder, four times, so many divisors are taken as there
// is room for. The quotient's leading bit is a one, here or a place later; it is not among the digits.
`default_nettype none
module rp_quotient_digits #(
  parameter integer BITS = 32,        // an even number
  parameter integer WAITING = 1       // bits that go along
) (
  input  wire               clk_i,
  input  wire [BITS-1:0]    a_i,
  input  wire [BITS-1:0]    b_i,
  output wire               less_o,   // of this cycle's: a is less than b, so the first bit is a place later
  input  wire [WAITING-1:0] waiting_i,
  output wire [BITS-1:0]    digits_o, // BITS bits behind the leading one, cut off
  output wire               rest_o,   // something is left
  output wire [WAITING-1:0] waiting_o
);
  generate
    if (BITS % 2 != 0) begin : gen_bad_bits
      quotient_digits_BITS_must_be_even illegal ();
    end
  endgenerate
  localparam integer S = BITS;
  localparam integer DIGITS = S / 2;

  // ---- First stage: the leading bit.
  wire [S:0] once = {1'b0, a_i} - {1'b0, b_i};
  wire [S-1:0] twice = {a_i[S-2:0], 1'b0} - b_i;
  wire less = once[S];
  assign less_o = less;

  // ---- Of each stage: remainder, divisor, three of it, the digits so far, and what waits.
  localparam integer STATE = S + S + (S + 2) + S + WAITING;
  wire [(DIGITS+1)*STATE-1:0] state;
  reg [STATE-1:0] begun_q;
  always @(posedge clk_i)
    begun_q <= {less ? twice : once[S-1:0], b_i, {2'b00, b_i} + {1'b0, b_i, 1'b0}, {S{1'b0}}, waiting_i};
  assign state[0+:STATE] = begun_q;
  genvar d;
  generate
    for (d = 0; d < DIGITS; d = d + 1) begin : gen_digit
      wire [S-1:0] remainder, divisor, digits;
      wire [S+1:0] three;
      wire [WAITING-1:0] waiting;
      assign {remainder, divisor, three, digits, waiting} = state[d*STATE+:STATE];
      wire [S+2:0] less_one = {1'b0, remainder, 2'b00} - {3'b000, divisor};
      wire [S+2:0] less_two = {1'b0, remainder, 2'b00} - {2'b00, divisor, 1'b0};
      wire [S+2:0] less_three = {1'b0, remainder, 2'b00} - {1'b0, three};
      reg [S-1:0] left;
      reg [1:0] digit;
      always @*
        if (!less_three[S+2]) {digit, left} = {2'd3, less_three[S-1:0]};
        else if (!less_two[S+2]) {digit, left} = {2'd2, less_two[S-1:0]};
        else if (!less_one[S+2]) {digit, left} = {2'd1, less_one[S-1:0]};
        else {digit, left} = {2'd0, remainder[S-3:0], 2'b00};
      reg [STATE-1:0] state_q;
      always @(posedge clk_i) state_q <= {left, divisor, three, digits[S-3:0], digit, waiting};
      assign state[(d+1)*STATE+:STATE] = state_q;
    end
  endgenerate
  assign waiting_o = state[DIGITS*STATE+:WAITING];
  assign digits_o = state[DIGITS*STATE+WAITING+:S];
  assign rest_o = state[DIGITS*STATE+STATE-1-:S] != {S{1'b0}};
endmodule
`default_nettype wire
