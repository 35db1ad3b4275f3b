// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Carries a WIDTH-bit result through STAGES registers; stage s loads when valid_i[s] is set. STAGES may be 0.
`default_nettype none
module rp_alu_delay #(
  parameter integer WIDTH = 32,
  parameter integer STAGES = 0,
  parameter integer VALID_BITS = (STAGES > 0) ? STAGES : 1
) (
  input  wire                  clk_i,
  input  wire [VALID_BITS-1:0] valid_i,
  input  wire [WIDTH-1:0]      data_i,
  output wire [WIDTH-1:0]      data_o
);
  genvar s;
  generate
    if (STAGES == 0) begin : gen_none
      assign data_o = data_i;
    end else begin : gen_stages
      wire [(STAGES+1)*WIDTH-1:0] stage;
      assign stage[WIDTH-1:0] = data_i;
      for (s = 0; s < STAGES; s = s + 1) begin : gen_stage
        reg [WIDTH-1:0] data_q;
        always @(posedge clk_i) if (valid_i[s]) data_q <= stage[s*WIDTH +: WIDTH];
        assign stage[(s+1)*WIDTH +: WIDTH] = data_q;
      end
      assign data_o = stage[STAGES*WIDTH +: WIDTH];
    end
  endgenerate
endmodule
`default_nettype wire
