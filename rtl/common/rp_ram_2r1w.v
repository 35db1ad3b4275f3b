// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Two read ports (read together) and one write port with a mask of GRANULE-bit parts. The read words appear in the
// next cycle and stay until the next read. Reading the address that is written in the same cycle gives the old
// word; users must not rely on either.
`default_nettype none
module rp_ram_2r1w #(
  parameter integer WIDTH = 32,
  parameter integer DEPTH = 16,
  parameter integer GRANULE = 32,
  parameter integer ADDRESS_BITS = (DEPTH > 1) ? $clog2(DEPTH) : 1
) (
  input  wire                     clk_i,
  input  wire                     read_i,
  input  wire [ADDRESS_BITS-1:0]  read_address_a_i,
  input  wire [ADDRESS_BITS-1:0]  read_address_b_i,
  output reg  [WIDTH-1:0]         read_data_a_o,
  output reg  [WIDTH-1:0]         read_data_b_o,
  input  wire [WIDTH/GRANULE-1:0] write_mask_i,
  input  wire [ADDRESS_BITS-1:0]  write_address_i,
  input  wire [WIDTH-1:0]         write_data_i
);
  reg [WIDTH-1:0] mem [0:DEPTH-1];
  integer g;

  always @(posedge clk_i)
    if (read_i) begin
      read_data_a_o <= mem[read_address_a_i];
      read_data_b_o <= mem[read_address_b_i];
    end

  always @(posedge clk_i)
    for (g = 0; g < WIDTH / GRANULE; g = g + 1)
      if (write_mask_i[g]) mem[write_address_i][g*GRANULE +: GRANULE] <= write_data_i[g*GRANULE +: GRANULE];
endmodule
`default_nettype wire
