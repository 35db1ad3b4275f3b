// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What stood at the input CYCLES cycles before, as in steady_delay, but kept in a RAM. CYCLES must be 2 or more.
`default_nettype none
module rp_ram_delay #(
  parameter integer WIDTH = 32,
  parameter integer CYCLES = 8
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire [WIDTH-1:0] data_i,
  output wire [WIDTH-1:0] data_o
);
  generate
    if (CYCLES < 2) begin : gen_bad_cycles
      ram_delay_CYCLES_must_be_2_or_more illegal ();
    end
  endgenerate
  localparam integer ADDRESS_BITS = $clog2(CYCLES);
  localparam integer LAST = CYCLES - 1;
  reg [ADDRESS_BITS-1:0] place_q;   // of what comes; what is in the next one came CYCLES - 1 cycles before
  wire [ADDRESS_BITS-1:0] behind = (place_q == LAST[ADDRESS_BITS-1:0]) ? {ADDRESS_BITS{1'b0}} : place_q + 1'b1;
  always @(posedge clk_i)
    if (!rst_ni) place_q <= {ADDRESS_BITS{1'b0}};
    else place_q <= behind;
  rp_ram_1r1w #(.WIDTH(WIDTH), .DEPTH(CYCLES)) ram (
    .clk_i(clk_i),
    .read_i(1'b1),
    .read_address_i(behind),
    .read_data_o(data_o),
    .write_i(1'b1),
    .write_address_i(place_q),
    .write_data_i(data_i)
  );
endmodule
`default_nettype wire
