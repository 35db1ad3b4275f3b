// Quotient of two floating-point numbers of MANTISSA_BITS + 1 bits, rounded once, to nearest even: one in every cycle,
// 2 + (MANTISSA_BITS + 1) / 2 cycles later. An array of digits 0 .. 3: of each remainder, four times, so many divisors
// are taken as there is room for.
// It needs no bit behind the first that is rounded off: a quotient that ended there would have one more bit than its
// numerator. Nor is it ever rounded up to the next power of two.
// Promises: x / 0 is infinite, 0 / 0 a NaN, with the sign of both.
// Must be given: finite numbers, none subnormal, whose quotient is neither too large for the format nor subnormal.
`default_nettype none
module float_quotient #(
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
  localparam integer DIGITS = S / 2;
  localparam [E-1:0] BIAS = {1'b0, {E-1{1'b1}}};

  // ---- First stage: the quotient's leading bit is a one, here or a place later.
  wire [S-1:0] a = {1'b1, a_i[0+:S-1]}, b = {1'b1, b_i[0+:S-1]};
  wire [S:0] once = {1'b0, a} - {1'b0, b};
  wire [S-1:0] twice = {a[S-2:0], 1'b0} - b;
  wire less = once[S];
  wire zero_a = a_i[BITS-2-:E] == {E{1'b0}}, zero_b = b_i[BITS-2-:E] == {E{1'b0}};
  wire [E-1:0] exponent = a_i[BITS-2-:E] - b_i[BITS-2-:E] + BIAS - {{E-1{1'b0}}, less};

  // ---- Of each stage: remainder, divisor, three of it, the digits so far, and what waits.
  localparam integer WAITING = E + 3;
  localparam integer STATE = S + S + (S + 2) + S + WAITING;
  wire [(DIGITS+1)*STATE-1:0] state;
  reg [STATE-1:0] begun_q;
  always @(posedge clk_i)
    begun_q <= {less ? twice : once[S-1:0], b, {2'b00, b} + {1'b0, b, 1'b0}, {S{1'b0}}, zero_a, zero_b,
                a_i[BITS-1] ^ b_i[BITS-1], exponent};
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

  // ---- Last stage: the last bit decides the rounding.
  wire [S-1:0] bits = state[DIGITS*STATE+WAITING+:S];
  wire zero_numerator, zero_denominator, sign;
  wire [E-1:0] quotient_exponent;
  assign {zero_numerator, zero_denominator, sign, quotient_exponent} = state[DIGITS*STATE+:WAITING];
  always @(posedge clk_i)
    if (zero_numerator && zero_denominator) quotient_o <= {sign, {E+1{1'b1}}, {S-2{1'b0}}};
    else if (zero_denominator) quotient_o <= {sign, {E{1'b1}}, {S-1{1'b0}}};
    else if (zero_numerator) quotient_o <= {sign, {E+S-1{1'b0}}};
    else quotient_o <= {sign, quotient_exponent, bits[S-1:1] + {{S-2{1'b0}}, bits[0]}};
endmodule
`default_nettype wire
