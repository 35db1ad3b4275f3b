// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What stood at the input CYCLES cycles before, of a pipe that never waits. CYCLES may be 0.
`default_nettype none
module rp_steady_delay #(
  parameter integer WIDTH = 32,
  parameter integer CYCLES = 1
) (
  input  wire             clk_i,
  input  wire [WIDTH-1:0] data_i,
  output wire [WIDTH-1:0] data_o
);
  genvar c;
  generate
    if (CYCLES == 0) begin : gen_none
      assign data_o = data_i;
    end else begin : gen_cycles
      wire [(CYCLES+1)*WIDTH-1:0] stage;
      assign stage[0+:WIDTH] = data_i;
      for (c = 0; c < CYCLES; c = c + 1) begin : gen_cycle
        reg [WIDTH-1:0] data_q;
        always @(posedge clk_i) data_q <= stage[c*WIDTH+:WIDTH];
        assign stage[(c+1)*WIDTH+:WIDTH] = data_q;
      end
      assign data_o = stage[CYCLES*WIDTH+:WIDTH];
    end
  endgenerate
endmodule
`default_nettype wire
