// What a floating-point adder must give, written for proofs and not for speed: both numbers as integers in units of the
// smallest subnormal number, their exact sum, one rounding to nearest even. Combinational. SUBNORMALS as in
// rtl/arith/rp_float_adder.v. Shares nothing with it.
`default_nettype none
module exact_adder #(
  parameter integer EXPONENT_BITS = 5,
  parameter integer MANTISSA_BITS = 10,
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire            subtract_i,
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  output reg  [BITS-1:0] result_o
);
  localparam integer E = EXPONENT_BITS;
  localparam integer M = MANTISSA_BITS;
  localparam integer LARGEST = (1 << E) - 1;          // exponent of infinity
  localparam integer WIDE = LARGEST + M + 2;

  function [WIDE-1:0] value(input [BITS-1:0] number);
    begin
      value = {WIDE{1'b0}};
      value[M-1:0] = number[M-1:0];
      if (number[BITS-2 -: E] != {E{1'b0}}) begin
        value[M] = 1'b1;
        value = value << (number[BITS-2 -: E] - {{E-1{1'b0}}, 1'b1});
      end else if (SUBNORMALS != 0) value = {WIDE{1'b0}};
    end
  endfunction

  reg [BITS-1:0] b;
  reg [WIDE-1:0] x, y, magnitude, tail, half;
  reg [M+1:0] kept;
  reg nan_a, nan_b, infinite_a, infinite_b, sign;
  integer top, last, i;

  always @* begin
    b = {b_i[BITS-1] ^ subtract_i, b_i[BITS-2:0]};
    nan_a = &a_i[BITS-2 -: E] && a_i[M-1:0] != {M{1'b0}};
    nan_b = &b[BITS-2 -: E] && b[M-1:0] != {M{1'b0}};
    infinite_a = &a_i[BITS-2 -: E] && !nan_a;
    infinite_b = &b[BITS-2 -: E] && !nan_b;
    x = value(a_i);
    y = value(b);
    sign = a_i[BITS-1];
    if (a_i[BITS-1] == b[BITS-1]) magnitude = x + y;
    else if (x >= y) magnitude = x - y;
    else begin
      magnitude = y - x;
      sign = b[BITS-1];
    end
    if (magnitude == {WIDE{1'b0}} && a_i[BITS-1] != b[BITS-1]) sign = 1'b0;
    // The leading one, and the last bit that a float of that size has.
    top = 0;
    for (i = 0; i < WIDE; i = i + 1) if (magnitude[i]) top = i;
    last = (top > M) ? top - M : 0;
    half = ({{WIDE-1{1'b0}}, 1'b1} << last) >> 1;
    tail = magnitude & ~({WIDE{1'b1}} << last);
    kept = magnitude >> last;
    if (tail > half || (tail == half && last != 0 && kept[0])) kept = kept + 1'b1;
    if (kept[M+1]) begin
      kept = kept >> 1;
      last = last + 1;
    end
    if (nan_a || nan_b || (infinite_a && infinite_b && a_i[BITS-1] != b[BITS-1]))
      result_o = {1'b0, {E+1{1'b1}}, {M-1{1'b0}}};
    else if (infinite_a) result_o = a_i;
    else if (infinite_b) result_o = b;
    else if (!kept[M]) result_o = {sign, {E{1'b0}}, (SUBNORMALS != 0) ? {M{1'b0}} : kept[M-1:0]};
    else if (last + 1 >= LARGEST) result_o = {sign, {E{1'b1}}, {M{1'b0}}};
    else begin
      last = last + 1;
      result_o = {sign, last[E-1:0], kept[M-1:0]};
    end
  end
endmodule
`default_nettype wire
