// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One read and one write port. The read word appears in the next cycle and stays until the next read. Reading the
// address that is written in the same cycle gives the old word; users must not rely on either.
`default_nettype none
module rp_ram_1r1w #(
  parameter integer WIDTH = 32,
  parameter integer DEPTH = 16,
  parameter integer ADDRESS_BITS = (DEPTH > 1) ? $clog2(DEPTH) : 1
) (
  input  wire                    clk_i,
  input  wire                    read_i,
  input  wire [ADDRESS_BITS-1:0] read_address_i,
  output reg  [WIDTH-1:0]        read_data_o,
  input  wire                    write_i,
  input  wire [ADDRESS_BITS-1:0] write_address_i,
  input  wire [WIDTH-1:0]        write_data_i
);
  reg [WIDTH-1:0] mem [0:DEPTH-1];

  always @(posedge clk_i) if (read_i) read_data_o <= mem[read_address_i];
  always @(posedge clk_i) if (write_i) mem[write_address_i] <= write_data_i;
endmodule
`default_nettype wire
