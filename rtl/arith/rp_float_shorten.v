// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A number with an exponent of 11 bits, and not subnormal, as a float, rounded to nearest even, two cycles later;
// infinite and not a number are what they are. MANTISSA_BITS: 25 or more.
`default_nettype none
module rp_float_shorten #(
  parameter integer MANTISSA_BITS = 31,
  parameter integer BITS = 12 + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire [BITS-1:0] number_i,
  output reg  [31:0]     float_o
);
  localparam integer S = MANTISSA_BITS + 1;
  wire sign = number_i[BITS-1];
  wire [10:0] wide = number_i[BITS-2-:11];
  wire [12:0] exponent = {2'b00, wide} - 13'd896;          // of the float, as it is stored; below 1: subnormal
  wire [12:0] below = 13'd1 - exponent;
  wire [4:0] distance = below[12] ? 5'd0 : (below[11:5] != 7'd0) ? 5'd31 : below[4:0];
  // Of what is shifted far it is enough to know that it is there.
  wire [S+30:0] moved = {1'b1, number_i[0+:S-1], 31'd0} >> distance;
  wire special = wide == 11'd2047, zero = wide == 11'd0;
  wire overflow = !exponent[12] && exponent >= 13'd255;

  reg [30:0] kept_q;
  reg guard_q, rest_q, sign_q;
  always @(posedge clk_i) begin
    sign_q <= sign;
    guard_q <= moved[S+6] && !(special || zero || overflow);
    rest_q <= moved[S+5:0] != {S+6{1'b0}};
    if (special && number_i[0+:S-1] != {S-1{1'b0}}) kept_q <= 31'h7fc00000;
    else if (special || overflow) kept_q <= 31'h7f800000;
    else if (zero) kept_q <= 31'd0;
    else kept_q <= {below[12] || below == 13'd0 ? exponent[7:0] : 8'd0, moved[S+29-:23]};
    float_o <= {sign_q, kept_q + {30'd0, guard_q && (rest_q || kept_q[0])}};
  end
endmodule
`default_nettype wire
