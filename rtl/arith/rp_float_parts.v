// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Splits a finite float, subnormal or not, into exponent and significand, its leading one not stored; a cycle later.
// Infinite and not a number keep the exponent that they have.
`default_nettype none
module rp_float_parts (
  input  wire              clk_i,
  input  wire [31:0]       float_i,
  output reg               sign_o,
  output reg               zero_o,
  output reg signed [8:0]  exponent_o,   // as a normal number's is stored; -22 .. 255
  output reg [22:0]        fraction_o    // 0 of a zero
);
  // Of a subnormal number: it is moved up until its first bit would be the one that is not stored.
  wire [22:0] moved;
  wire [4:0] places;
  rp_normaliser #(.WIDTH(23)) normaliser (.value_i(float_i[22:0]), .moved_o(moved), .places_o(places));
  wire normal = float_i[30:23] != 8'd0;
  wire unused = &{1'b0, moved[22]};
  always @(posedge clk_i) begin
    sign_o <= float_i[31];
    zero_o <= float_i[30:0] == 31'd0;
    exponent_o <= normal ? {1'b0, float_i[30:23]} : -{4'd0, places};
    fraction_o <= normal ? float_i[22:0] : {moved[21:0], 1'b0};
  end
endmodule
`default_nettype wire
