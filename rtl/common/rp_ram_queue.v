// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A first-in first-out queue in a RAM, with valid/ready at its end: what is pushed in a cycle is offered from the next
// one on, and an entry can be taken in every cycle.
// Promise: what is offered stays until it is taken. Must be given: push_i only while it holds fewer than DEPTH entries;
// one that is taken in the same cycle still counts.
`default_nettype none
module rp_ram_queue #(
  parameter integer WIDTH = 9,
  parameter integer DEPTH = 512
) (
  input  wire             clk_i,
  input  wire             rst_ni,
  input  wire             push_i,
  input  wire [WIDTH-1:0] data_i,
  output wire             valid_o,
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
  assign valid_o = some_q;
  wire pop = some_q && ready_i;
  wire [ADDRESS_BITS-1:0] behind_head = (head_q == LAST[ADDRESS_BITS-1:0]) ? {ADDRESS_BITS{1'b0}} : head_q + 1'b1;
  wire [ADDRESS_BITS-1:0] behind_tail = (tail_q == LAST[ADDRESS_BITS-1:0]) ? {ADDRESS_BITS{1'b0}} : tail_q + 1'b1;

  // The RAM's word is the oldest entry, but for one that came to an empty queue in the cycle before: it is still in the
  // register of what came last, which is loaded in every cycle, as whether the queue is empty is known late.
  reg fresh_q;
  reg [WIDTH-1:0] came_q;
  wire [WIDTH-1:0] word;
  assign data_o = fresh_q ? came_q : word;
  rp_ram_1r1w #(.WIDTH(WIDTH), .DEPTH(DEPTH)) ram (
    .clk_i(clk_i),
    .read_i(pop ? more_q : fresh_q),
    .read_address_i(pop ? behind_head : head_q),
    .read_data_o(word),
    .write_i(push_i),
    .write_address_i(tail_q),
    .write_data_i(data_i)
  );

  // What follows is known of registers; push_i and ready_i, which may both come late, choose.
  wire [COUNT_BITS-1:0] one_more = count_q + ONE, one_less = count_q - ONE;
  wire many = (one_less >> 1) != NONE;     // more than two, if it holds one
  always @(posedge clk_i)
    if (!rst_ni) begin
      count_q <= NONE;
      some_q <= 1'b0;
      more_q <= 1'b0;
      head_q <= {ADDRESS_BITS{1'b0}};
      tail_q <= {ADDRESS_BITS{1'b0}};
      fresh_q <= 1'b0;
    end else begin
      count_q <= pop ? (push_i ? count_q : one_less) : (push_i ? one_more : count_q);
      some_q <= push_i || (pop ? more_q : some_q);
      more_q <= pop ? (push_i ? more_q : many) : (push_i ? some_q : more_q);
      if (pop) head_q <= behind_head;
      if (push_i) tail_q <= behind_tail;
      fresh_q <= push_i && (pop ? !more_q : !some_q);
    end
  always @(posedge clk_i) came_q <= data_i;
endmodule
`default_nettype wire
