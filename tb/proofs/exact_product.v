// What a floating-point multiplier must give, written for proofs and not for speed: the exact product of the mantissas
// as an integer, one rounding to nearest even. The product comes from outside, so that no proof has to see through a
// multiplication: ones_i is that of the stored bits with a one before each, and what a subnormal number has not is
// taken off. possible_o is high if the rest may be the product of the two mantissas by what is known of any product, a
// zero for a zero and a leading one at the sum of the factors' leading ones or one above. Combinational. SUBNORMALS as
// in rtl/arith/rp_float_multiplier.v. Shares nothing with it.
`default_nettype none
module exact_product #(
  parameter integer EXPONENT_BITS = 5,
  parameter integer MANTISSA_BITS = 10,
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS,
  parameter integer P = 2*MANTISSA_BITS + 2
) (
  input  wire [BITS-1:0] a_i,
  input  wire [BITS-1:0] b_i,
  input  wire [P-1:0]    ones_i,
  output reg             possible_o,
  output reg  [BITS-1:0] result_o
);
  localparam integer E = EXPONENT_BITS;
  localparam integer M = MANTISSA_BITS;
  localparam integer LARGEST = (1 << E) - 1;               // exponent of infinity
  // The smallest subnormal number in units of its square, as a power of two.
  localparam integer UNIT = (1 << (E - 1)) - 2 + M;

  function [M:0] mantissa(input [BITS-1:0] number);
    if (number[BITS-2 -: E] != {E{1'b0}}) mantissa = {1'b1, number[M-1:0]};
    else mantissa = {1'b0, (SUBNORMALS != 0) ? {M{1'b0}} : number[M-1:0]};
  endfunction
  function integer scale(input [BITS-1:0] number);
    scale = (number[BITS-2 -: E] != {E{1'b0}}) ? number[BITS-2 -: E] - 1 : 0;
  endfunction

  reg [M:0] x, y;
  reg nan_a, nan_b, infinite_a, infinite_b, sign;
  reg [P-1:0] product, tail, half;
  reg [M+1:0] kept;
  integer top, top_x, top_y, weight, last, exponent, i;

  always @* begin
    x = mantissa(a_i);
    y = mantissa(b_i);
    // (a - 2^M u)(b - 2^M v), u and v one for a subnormal number.
    product = ones_i;
    if (!x[M]) product = product - ({{P-M-1{1'b0}}, 1'b1, b_i[M-1:0]} << M);
    if (!y[M]) product = product - ({{P-M-1{1'b0}}, 1'b1, a_i[M-1:0]} << M);
    if (!x[M] && !y[M]) product = product + ({{P-1{1'b0}}, 1'b1} << 2*M);
    if (SUBNORMALS != 0 && !(x[M] && y[M])) product = {P{1'b0}};
    top = 0;
    top_x = 0;
    top_y = 0;
    for (i = 0; i <= M; i = i + 1) if (x[i]) top_x = i;
    for (i = 0; i <= M; i = i + 1) if (y[i]) top_y = i;
    for (i = 0; i < P; i = i + 1) if (product[i]) top = i;
    if (x == {M+1{1'b0}} || y == {M+1{1'b0}}) possible_o = product == {P{1'b0}};
    else possible_o = product != {P{1'b0}} && (top == top_x + top_y || top == top_x + top_y + 1);

    nan_a = &a_i[BITS-2 -: E] && a_i[M-1:0] != {M{1'b0}};
    nan_b = &b_i[BITS-2 -: E] && b_i[M-1:0] != {M{1'b0}};
    infinite_a = &a_i[BITS-2 -: E] && !nan_a;
    infinite_b = &b_i[BITS-2 -: E] && !nan_b;
    sign = a_i[BITS-1] ^ b_i[BITS-1];
    // The product's last bit that a float of that size has.
    weight = scale(a_i) + scale(b_i);
    last = top - M;
    if (SUBNORMALS == 0 && last < UNIT - weight) last = UNIT - weight;
    if (last <= 0) begin
      kept = product << -last;
      tail = {P{1'b0}};
      half = {{P-1{1'b0}}, 1'b1};
    end else begin
      kept = product >> last;
      tail = product & ~({P{1'b1}} << last);
      half = {{P-1{1'b0}}, 1'b1} << (last - 1);
      // Nothing but a tail that is below half.
      if (last > P) half = {P{1'b1}};
    end
    if (tail > half || (tail == half && kept[0])) kept = kept + 1'b1;
    if (kept[M+1]) begin
      kept = kept >> 1;
      last = last + 1;
    end
    exponent = last + weight - UNIT + 1;
    if (nan_a || nan_b || (infinite_a && y == {M+1{1'b0}}) || (infinite_b && x == {M+1{1'b0}}))
      result_o = {1'b0, {E+1{1'b1}}, {M-1{1'b0}}};
    else if (infinite_a || infinite_b) result_o = {sign, {E{1'b1}}, {M{1'b0}}};
    else if (product == {P{1'b0}}) result_o = {sign, {E+M{1'b0}}};
    else if (!kept[M]) result_o = {sign, {E{1'b0}}, kept[M-1:0]};
    else if (exponent < 1) result_o = {sign, {E+M{1'b0}}};
    else if (exponent >= LARGEST) result_o = {sign, {E{1'b1}}, {M{1'b0}}};
    else result_o = {sign, exponent[E-1:0], kept[M-1:0]};
  end
endmodule
`default_nettype wire
