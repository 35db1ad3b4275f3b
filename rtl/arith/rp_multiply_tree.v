// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Product of a and b, or c + a * b with ADD, or c - a * b with ADD and NEGATE, as two numbers that add up to it modulo
// 2^OUT_BITS: radix-4 Booth digits of b, then a tree of carry-save adders. Combinational. a_i is unsigned; b_i is
// unsigned, or signed with B_SIGNED, of up to 61 bits. OUT_BITS may be less than the product has: the rest is free.
// With CUT the rows are left out below 2^CUT: the sum is less than it should be by at most 2^CUT for each pair of bits
// of b below 2^CUT, CUT/2 of them rounded up; how much less is not specified.
// With ENCODED b_i is what booth_digits made of b.
// Digit i of b is -2 .. 2 and weighs 4^i; a row is the digit times a, inverted if the digit is negative, and the one
// that completes the negation stands in the next row. Signs are not extended: -s*2^k = ~s*2^k - 2^k, and the sum of all
// the -2^k is one at the first row's sign, one above each row's, and ones all the way up from the last.
`default_nettype none
module rp_multiply_tree #(
  parameter integer A_BITS = 24,
  parameter integer B_BITS = 24,
  parameter integer OUT_BITS = A_BITS + B_BITS,
  parameter integer B_SIGNED = 0,
  parameter integer ADD = 0,
  parameter integer NEGATE = 0,
  parameter integer CUT = 0,
  parameter integer ENCODED = 0,
  parameter integer DIGITS = (B_SIGNED != 0) ? (B_BITS + 1) / 2 : B_BITS / 2 + 1,
  parameter integer B_WIDTH = (ENCODED != 0) ? 3*DIGITS : B_BITS
) (
  input  wire [A_BITS-1:0]   a_i,
  input  wire [B_WIDTH-1:0]  b_i,
  input  wire [OUT_BITS-1:0] c_i,             // used with ADD
  output wire [OUT_BITS-1:0] sum_o,
  output wire [OUT_BITS-1:0] carry_o
);
`ifdef SYNTHESIS
  `include "rp_booth_digits.vh"
  // The last digit of an unsigned b is never negative.
  localparam integer LAST = (B_SIGNED != 0 || NEGATE != 0) ? 1 : 0;
  localparam integer ROWS = DIGITS + LAST + ((ADD != 0) ? 1 : 0);
  localparam [OUT_BITS-1:0] KEPT = {OUT_BITS{1'b1}} << CUT;
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

  wire [3*DIGITS-1:0] digits;
  generate
    if (ENCODED != 0) begin : gen_encoded
      assign digits = b_i;
    end else begin : gen_encode
      wire [92:0] encoded = wide_booth_digits({{62-B_BITS{(B_SIGNED != 0) && b_i[B_BITS-1]}}, b_i});
      assign digits = encoded[3*DIGITS-1:0];
    end
  endgenerate

  genvar i, l, t;
  generate
    for (l = 0; l <= LEVELS; l = l + 1) begin : gen_level
      localparam integer COUNT = rows_after(l);
      wire [COUNT*OUT_BITS-1:0] rows;
      if (l == 0) begin : gen_first
        wire [DIGITS:0] ends;
        assign ends[0] = 1'b0;
        for (i = 0; i < DIGITS; i = i + 1) begin : gen_row
          wire one = digits[3*i];
          wire two = digits[3*i+1];
          wire negative = digits[3*i+2] ^ (NEGATE != 0);
          wire [A_BITS:0] chosen = ({A_BITS+1{one}} & {1'b0, a_i}) | ({A_BITS+1{two}} & {a_i, 1'b0});
          wire [2:0] sign = (i == 0) ? {!negative, {2{negative}}} : {i == DIGITS - 1, 1'b1, !negative};
          wire [WIDE-1:0] row = {{WIDE-A_BITS-4{i == DIGITS - 1}}, sign, chosen ^ {A_BITS+1{negative}}};
          wire [WIDE-1:0] placed = row << 2*i;
          // The end of the row before lies two bits lower.
          wire [WIDE-1:0] before = {{WIDE-1{1'b0}}, ends[i]} << ((i == 0) ? 0 : 2*i - 2);
          assign ends[i+1] = negative;
          assign rows[i*OUT_BITS +: OUT_BITS] = (placed[OUT_BITS-1:0] | before[OUT_BITS-1:0]) & KEPT;
        end
        if (LAST != 0) begin : gen_last
          wire [WIDE-1:0] last = {{WIDE-1{1'b0}}, ends[DIGITS]} << (2*DIGITS - 2);
          assign rows[DIGITS*OUT_BITS +: OUT_BITS] = last[OUT_BITS-1:0] & KEPT;
        end
        if (ADD != 0) begin : gen_addend
          assign rows[(ROWS-1)*OUT_BITS +: OUT_BITS] = c_i;
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
          assign rows[2*TRIPLES*OUT_BITS +: (BEFORE%3)*OUT_BITS] =
              gen_level[l-1].rows[3*TRIPLES*OUT_BITS +: (BEFORE%3)*OUT_BITS];
        end
      end
    end
  endgenerate

  assign sum_o = gen_level[LEVELS].rows[0 +: OUT_BITS];
  assign carry_o = gen_level[LEVELS].rows[OUT_BITS +: OUT_BITS];
`else
  // The promise allows any two numbers. Simulators multiply much faster than they add bits up; the benches of the
  // arithmetic units define SYNTHESIS to try the tree itself.
  wire [OUT_BITS+A_BITS-1:0] a = {{OUT_BITS{1'b0}}, a_i};
  wire [OUT_BITS+B_BITS-1:0] b = {{OUT_BITS{(B_SIGNED != 0) && b_i[B_BITS-1]}}, b_i[B_BITS-1:0]};
  wire [OUT_BITS-1:0] product = a[OUT_BITS-1:0] * b[OUT_BITS-1:0];
  wire unused = &{1'b0, a, b, b_i, c_i, CUT[0]};
  assign sum_o = (NEGATE != 0) ? -product : product;
  assign carry_o = (ADD != 0) ? c_i : {OUT_BITS{1'b0}};
`endif
endmodule
`default_nettype wire
