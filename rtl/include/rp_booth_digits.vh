// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Included in a module: what multiply_tree with ENCODED takes for its b, so that a register can stand between. word
// is b extended to 32 bits by zeros or by its sign. Digit i, for bits 2i+1 .. 2i-1 of the word, is -2 .. 2, as
// {negative, two, one}; zero has neither two nor one.
// Simulators multiply without digits (see there): for them it is the word.
function [47:0] booth_digits(input [31:0] word);
`ifdef SYNTHESIS
  reg [32:0] bits;
  integer i;
  begin
    bits = {word, 1'b0};
    for (i = 0; i < 16; i = i + 1) begin
      booth_digits[3*i] = bits[2*i] ^ bits[2*i+1];
      booth_digits[3*i+1] = bits[2*i +: 3] == 3'b011 || bits[2*i +: 3] == 3'b100;
      booth_digits[3*i+2] = bits[2*i+2] && !(bits[2*i+1] && bits[2*i]);
    end
  end
`else
  begin
    booth_digits = {16'd0, word};
  end
`endif
endfunction
`ifdef SYNTHESIS
// The same of 62 bits, 31 digits: without its first 30 bits a word's digits 1 .. 15 are 16 .. 30 of the whole.
function [92:0] wide_booth_digits(input [61:0] word);
  wide_booth_digits = {booth_digits(word[61:30]) & ~48'd7, 45'd0} | {45'd0, booth_digits(word[31:0])};
endfunction
`endif
