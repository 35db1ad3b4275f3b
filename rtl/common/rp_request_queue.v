// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A short first-in first-out queue with valid/ready at its end. Its output is a register and stays until taken.
// Must be given: push_i only while count_o < DEPTH; an entry taken in the same cycle does not count as free yet.
`default_nettype none
module rp_request_queue #(
  parameter integer WIDTH = 32,
  parameter integer DEPTH = 3   // 1 .. 3
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire             push_i,
  input  wire [WIDTH-1:0] data_i,
  output wire             valid_o,
  input  wire             ready_i,
  output wire [WIDTH-1:0] data_o,
  output wire [1:0]       count_o
);
  generate
    if (DEPTH < 1 || DEPTH > 3) begin : gen_illegal
      request_queue_depth_must_be_from_1_to_3 illegal ();
    end
  endgenerate

  reg [1:0] count_q;
  reg [DEPTH*WIDTH-1:0] entries_q;   // the oldest lowest
  wire pop = valid_o && ready_i;
  wire [1:0] place = count_q - {1'b0, pop};

  assign valid_o = count_q != 2'd0;
  assign data_o = entries_q[WIDTH-1:0];
  assign count_o = count_q;

  integer e;
  always @(posedge clk_i) begin
    if (!rst_ni) count_q <= 2'd0;
    else count_q <= place + {1'b0, push_i};
    if (push_i || pop) begin
      if (pop) entries_q <= entries_q >> WIDTH;
      for (e = 0; e < DEPTH; e = e + 1)
        if (push_i && place == e[1:0]) entries_q[e*WIDTH +: WIDTH] <= data_i;
    end
  end
endmodule
`default_nettype wire
