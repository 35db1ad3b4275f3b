// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A finite float that is not negative times 2^-PLACES, rounded to nearest even where that is subnormal, two cycles
// later. take_i: what was given two cycles before its result shows is shown from then on, until the next one.
`default_nettype none
module rp_float_share #(
  parameter integer PLACES = 20                  // 1 .. 24
) (
  input  wire        clk_i,
  input  wire        take_i,                     // a cycle after float_i
  input  wire [30:0] float_i,
  output reg  [30:0] share_o
);
  wire normal = float_i[30:23] > PLACES[7:0];
  wire [7:0] exponent = float_i[30:23] - PLACES[7:0];
  wire [7:0] stored = (float_i[30:23] == 8'd0) ? 8'd1 : float_i[30:23];
  wire [7:0] distance = PLACES[7:0] + 8'd1 - stored;
  wire [47:0] moved = {float_i[30:23] != 8'd0, float_i[22:0], 24'd0} >> distance[4:0];
  wire unused = &{1'b0, distance[7:5]};
  reg [30:0] kept_q;
  reg guard_q, rest_q;
  always @(posedge clk_i) begin
    kept_q <= normal ? {exponent, float_i[22:0]} : {7'd0, moved[47:24]};
    guard_q <= !normal && moved[23];
    rest_q <= moved[22:0] != 23'd0;
    if (take_i) share_o <= kept_q + {30'd0, guard_q && (rest_q || kept_q[0])};
  end
endmodule
`default_nettype wire
