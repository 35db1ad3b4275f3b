// Product of a and b as two numbers whose sum, modulo 2^OUT_BITS, it is: radix-4 Booth digits of b, then a tree of carry-save adders.
// Combinational. a_i is unsigned; b_i is unsigned, or signed with B_SIGNED. OUT_BITS may be less than the product has: what is not wanted
// costs nothing. Digit i of b is -2 .. 2 and weighs 4^i; a row is the digit times a, inverted if the digit is negative, and the one that
// completes the negation stands in the next row. Signs are not extended: -s*2^k = ~s*2^k - 2^k, and the sum of all the -2^k is one at the
// first row's sign and one above each row's.
`default_nettype none
module multiply_tree #(
  parameter integer A_BITS = 24,
  parameter integer B_BITS = 24,
  parameter integer OUT_BITS = A_BITS + B_BITS,
  parameter integer B_SIGNED = 0
) (
  input  wire [A_BITS-1:0]   a_i,
  input  wire [B_BITS-1:0]   b_i,
  output wire [OUT_BITS-1:0] sum_o,
  output wire [OUT_BITS-1:0] carry_o
);
`ifdef SYNTHESIS
  localparam integer DIGITS = (B_SIGNED != 0) ? (B_BITS + 1) / 2 : B_BITS / 2 + 1;
  // The last digit of an unsigned b is never negative.
  localparam integer ROWS = DIGITS + ((B_SIGNED != 0) ? 1 : 0);
  localparam integer WIDE = OUT_BITS + A_BITS + 4;   // room for every row before it is cut off

  // Rows that are left after so many levels of carry-save adders.
  function integer rows_after(input integer levels);
    integer n, l;
    begin
      n = ROWS;
      for (l = 0; l < levels; l = l + 1) n = (n / 3) * 2 + n % 3;
      rows_after = n;
    end
  endfunction
  function integer levels_needed(input integer unused);
    integer n, l;
    begin
      n = ROWS + 0 * unused;
      l = 0;
      while (n > 2) begin
        n = (n / 3) * 2 + n % 3;
        l = l + 1;
      end
      levels_needed = l;
    end
  endfunction
  localparam integer LEVELS = levels_needed(0);

  // b with a zero below and its sign, or zeros, above.
  wire [2*DIGITS:0] digits = {{2*DIGITS-B_BITS{(B_SIGNED != 0) && b_i[B_BITS-1]}}, b_i, 1'b0};

  genvar i, l, t;
  generate
    for (l = 0; l <= LEVELS; l = l + 1) begin : gen_level
      localparam integer COUNT = rows_after(l);
      wire [COUNT*OUT_BITS-1:0] rows;
      if (l == 0) begin : gen_first
        wire [DIGITS:0] ends;
        assign ends[0] = 1'b0;
        for (i = 0; i < DIGITS; i = i + 1) begin : gen_row
          wire [2:0] digit = digits[2*i +: 3];
          wire one = digit[0] ^ digit[1];
          wire two = (digit == 3'b011) || (digit == 3'b100);
          wire negative = digit[2] && !(digit[1] && digit[0]);
          wire [A_BITS:0] chosen = ({A_BITS+1{one}} & {1'b0, a_i}) | ({A_BITS+1{two}} & {a_i, 1'b0});
          wire [2:0] sign = (i == 0) ? {!negative, {2{negative}}} : {1'b0, 1'b1, !negative};
          wire [WIDE-1:0] row = {{WIDE-A_BITS-4{1'b0}}, sign, chosen ^ {A_BITS+1{negative}}};
          wire [WIDE-1:0] placed = row << 2*i;
          // The end of the row before lies two bits lower.
          wire [WIDE-1:0] before = {{WIDE-1{1'b0}}, ends[i]} << ((i == 0) ? 0 : 2*i - 2);
          assign ends[i+1] = negative;
          assign rows[i*OUT_BITS +: OUT_BITS] = placed[OUT_BITS-1:0] | before[OUT_BITS-1:0];
        end
        if (B_SIGNED != 0) begin : gen_last
          wire [WIDE-1:0] last = {{WIDE-1{1'b0}}, ends[DIGITS]} << (2*DIGITS - 2);
          assign rows[DIGITS*OUT_BITS +: OUT_BITS] = last[OUT_BITS-1:0];
        end
      end else begin : gen_reduce
        localparam integer BEFORE = rows_after(l - 1);
        localparam integer TRIPLES = BEFORE / 3;
        for (t = 0; t < TRIPLES; t = t + 1) begin : gen_adder
          wire [OUT_BITS-1:0] x = gen_level[l-1].rows[(3*t)*OUT_BITS +: OUT_BITS];
          wire [OUT_BITS-1:0] y = gen_level[l-1].rows[(3*t+1)*OUT_BITS +: OUT_BITS];
          wire [OUT_BITS-1:0] z = gen_level[l-1].rows[(3*t+2)*OUT_BITS +: OUT_BITS];
          wire [OUT_BITS-1:0] majority = (x & y) | (z & (x | y));
          assign rows[(2*t)*OUT_BITS +: OUT_BITS] = x ^ y ^ z;
          assign rows[(2*t+1)*OUT_BITS +: OUT_BITS] = majority << 1;
        end
        if (BEFORE % 3 != 0) begin : gen_rest
          assign rows[2*TRIPLES*OUT_BITS +: (BEFORE%3)*OUT_BITS] = gen_level[l-1].rows[3*TRIPLES*OUT_BITS +: (BEFORE%3)*OUT_BITS];
        end
      end
    end
  endgenerate

  assign sum_o = gen_level[LEVELS].rows[0 +: OUT_BITS];
  assign carry_o = gen_level[LEVELS].rows[OUT_BITS +: OUT_BITS];
`else
  // The promise allows any two numbers. Simulators multiply much faster than they add bits up; the benches of the arithmetic units define
  // SYNTHESIS to try the tree itself.
  wire [OUT_BITS+A_BITS-1:0] a = {{OUT_BITS{1'b0}}, a_i};
  wire [OUT_BITS+B_BITS-1:0] b = {{OUT_BITS{(B_SIGNED != 0) && b_i[B_BITS-1]}}, b_i};
  wire unused = &{1'b0, a, b};
  assign sum_o = a[OUT_BITS-1:0] * b[OUT_BITS-1:0];
  assign carry_o = {OUT_BITS{1'b0}};
`endif
endmodule
`default_nettype wire
