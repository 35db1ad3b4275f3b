// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What is known of a ray, in a register for each three cycles of its way: rays are three cycles apart or more.
// move_i: bit k is set when the ray leaves place k, so that its data goes to the next one; bit 0 takes data_i.
`default_nettype none
module rp_ray_delay #(
  parameter integer WIDTH = 32,
  parameter integer MOVES = 1
) (
  input  wire             clk_i,
  input  wire [MOVES-1:0] move_i,
  input  wire [WIDTH-1:0] data_i,
  output wire [WIDTH-1:0] data_o
);
  wire [(MOVES+1)*WIDTH-1:0] place;
  assign place[0+:WIDTH] = data_i;
  genvar k;
  generate
    for (k = 0; k < MOVES; k = k + 1) begin : gen_move
      reg [WIDTH-1:0] data_q;
      always @(posedge clk_i) if (move_i[k]) data_q <= place[k*WIDTH+:WIDTH];
      assign place[(k+1)*WIDTH+:WIDTH] = data_q;
    end
  endgenerate
  assign data_o = place[MOVES*WIDTH+:WIDTH];
endmodule
`default_nettype wire
