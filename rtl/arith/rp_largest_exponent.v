// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Of three numbers that come one after the other, the largest exponent, beside what came: four cycles later, so that
// all three have come, and for three cycles.
`default_nettype none
module rp_largest_exponent #(
  parameter integer BITS = 43                    // sign, exponent of 11 bits, the rest; a zero has the exponent 0
) (
  input  wire            clk_i,
  input  wire            first_i,                // this is the first of three
  input  wire            all_i,                  // three cycles later
  input  wire [BITS-1:0] number_i,
  output wire [BITS-1:0] number_o,
  output reg  [10:0]     largest_o
);
  wire [10:0] exponent = number_i[BITS-2-:11];
  reg [10:0] so_far_q;
  always @(posedge clk_i) begin
    if (first_i || exponent > so_far_q) so_far_q <= exponent;
    if (all_i) largest_o <= so_far_q;
  end
  rp_steady_delay #(.WIDTH(BITS), .CYCLES(4)) delay (.clk_i(clk_i), .data_i(number_i), .data_o(number_o));
endmodule
`default_nettype wire
