// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A first-in first-out queue in a RAM, with valid/ready at its end: what is pushed is offered in the same cycle if
// nothing is before it, and else as soon as that is taken. It bears a ready_i that is known late.
// Promise: what is offered stays until it is taken. Must be given: push_i only while it holds fewer than DEPTH entries;
// one that is taken in the same cycle still counts.
`default_nettype none
module rp_pass_queue #(
  parameter integer WIDTH = 5,
  parameter integer DEPTH = 24
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire             push_i,
  input  wire [WIDTH-1:0] data_i,
  output wire             valid_o,
  output wire             passes_o,        // nothing is before what comes in this cycle
  input  wire             ready_i,
  output wire [WIDTH-1:0] data_o
);
  localparam integer COUNT_BITS = $clog2(DEPTH + 1);
  localparam integer ADDRESS_BITS = (DEPTH > 1) ? $clog2(DEPTH) : 1;
  localparam integer LAST = DEPTH - 1;
  localparam [COUNT_BITS-1:0] NONE = 0, ONE = 1;

  reg [COUNT_BITS-1:0] count_q;
  reg some_q, more_q;                      // it holds an entry; more than one
  reg [ADDRESS_BITS-1:0] head_q, tail_q;   // the oldest entry; the place of the next one
  wire [ADDRESS_BITS-1:0] behind_head = (head_q == LAST[ADDRESS_BITS-1:0]) ? {ADDRESS_BITS{1'b0}} : head_q + 1'b1;
  wire [ADDRESS_BITS-1:0] behind_tail = (tail_q == LAST[ADDRESS_BITS-1:0]) ? {ADDRESS_BITS{1'b0}} : tail_q + 1'b1;

  // The RAM's word is the oldest entry, but for one that came when there was no other: it is in a register of its own.
  // One that is taken in the cycle in which it comes has had a place too.
  reg alone_q;
  reg [WIDTH-1:0] alone_data_q;
  wire [WIDTH-1:0] word;
  assign valid_o = some_q || push_i;
  assign passes_o = !some_q;
  assign data_o = some_q ? (alone_q ? alone_data_q : word) : data_i;
  rp_ram_1r1w #(.WIDTH(WIDTH), .DEPTH(DEPTH)) ram (
    .clk_i(clk_i),
    .read_i(more_q && ready_i),
    .read_address_i(behind_head),
    .read_data_o(word),
    .write_i(push_i),
    .write_address_i(tail_q),
    .write_data_i(data_i)
  );

  // What follows if nothing is taken, and if something is: ready_i chooses between the two.
  wire [COUNT_BITS-1:0] pushed = {{COUNT_BITS-1{1'b0}}, push_i};
  wire [COUNT_BITS-1:0] count_left = count_q + pushed, count_taken = some_q ? count_left - ONE : NONE;
  wire some_left = some_q || push_i, some_taken = more_q || (some_q && push_i);
  wire more_left = more_q || (some_q && push_i), more_taken = (count_taken >> 1) != NONE;
  wire alone_left = some_q ? alone_q : push_i, alone_taken = some_q && !more_q && push_i;
  always @(posedge clk_i)
    if (!rst_ni) begin
      count_q <= NONE;
      some_q <= 1'b0;
      more_q <= 1'b0;
      alone_q <= 1'b0;
      head_q <= {ADDRESS_BITS{1'b0}};
      tail_q <= {ADDRESS_BITS{1'b0}};
    end else begin
      count_q <= ready_i ? count_taken : count_left;
      some_q <= ready_i ? some_taken : some_left;
      more_q <= ready_i ? more_taken : more_left;
      alone_q <= ready_i ? alone_taken : alone_left;
      if (ready_i && valid_o) head_q <= behind_head;
      if (push_i) tail_q <= behind_tail;
    end
  always @(posedge clk_i) if (ready_i || !some_q) alone_data_q <= data_i;
endmodule
`default_nettype wire
