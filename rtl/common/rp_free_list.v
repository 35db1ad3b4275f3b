// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The numbers 0 .. SIZE-1 that are free, with valid/ready at its end: first 0, 1, 2 and so on, then those that have
// come back, in the order in which they did. One that comes back in a cycle can be had from the next one on.
// Must be given: a number comes back once for each time that it was taken. So it needs no reset of a memory, and knows
// of nothing that is taken.
`default_nettype none
module rp_free_list #(
  parameter integer SIZE = 512,
  parameter integer NUMBER_BITS = (SIZE > 1) ? $clog2(SIZE) : 1
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  output wire                   valid_o,
  input  wire                   ready_i,
  output wire [NUMBER_BITS-1:0] number_o,
  input  wire                   free_i,
  input  wire [NUMBER_BITS-1:0] free_number_i
);
  localparam integer COUNT_BITS = $clog2(SIZE + 1);
  reg [COUNT_BITS-1:0] used_q;   // numbers that have ever been taken
  wire unused_left = used_q != SIZE[COUNT_BITS-1:0];
  wire back_valid;
  wire [NUMBER_BITS-1:0] back;
  rp_ram_queue #(.WIDTH(NUMBER_BITS), .DEPTH(SIZE)) returned (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(free_i),
    .data_i(free_number_i),
    .valid_o(back_valid),
    .ready_i(ready_i && !unused_left),
    .data_o(back)
  );
  assign valid_o = unused_left || back_valid;
  assign number_o = unused_left ? used_q[NUMBER_BITS-1:0] : back;

  always @(posedge clk_i)
    if (!rst_ni) used_q <= {COUNT_BITS{1'b0}};
    else if (ready_i && unused_left) used_q <= used_q + 1'b1;
endmodule
`default_nettype wire
