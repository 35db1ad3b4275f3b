// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One port: a cycle reads or writes. The read word appears in the next cycle and stays until the next read.
`default_nettype none
module rp_ram_1rw #(
  parameter integer WIDTH = 32,
  parameter integer DEPTH = 16,
  parameter integer ADDRESS_BITS = (DEPTH > 1) ? $clog2(DEPTH) : 1
) (
  input  wire                    clk_i,
  input  wire                    enable_i,
  input  wire                    write_i,
  input  wire [ADDRESS_BITS-1:0] address_i,
  input  wire [WIDTH-1:0]        data_i,
  output reg  [WIDTH-1:0]        data_o
);
  reg [WIDTH-1:0] mem [0:DEPTH-1];

  always @(posedge clk_i)
    if (enable_i) begin
      if (write_i) mem[address_i] <= data_i;
      else data_o <= mem[address_i];
    end
endmodule
`default_nettype wire
