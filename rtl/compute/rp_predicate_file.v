// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Predicates of one warp: PREDICATES registers of one bit a lane. p0 reads as all ones; writes to it are ignored.
// read_i captures the three reads and the thread mask; they stay until the next read.
`default_nettype none
module rp_predicate_file #(
  parameter integer LANES = 8,
  parameter integer PREDICATES = 16      // no instruction that is issued names another one
) (
  input  wire             clk_i,
  input  wire             clear_i,       // start of a kernel: all become 0
  input  wire             read_i,
  input  wire [LANES-1:0] launched_i,
  input  wire             guard_negated_i,
  input  wire [3:0]       guard_i,
  input  wire [3:0]       x_index_i,
  input  wire [3:0]       b_index_i,
  output reg  [LANES-1:0] mask_o,        // launched lanes with a guard that holds
  output reg  [LANES-1:0] x_o,
  output reg  [LANES-1:0] b_o,
  input  wire             write_i,
  input  wire [3:0]       write_index_i,
  input  wire [LANES-1:0] write_data_i
);
  localparam integer BITS = $clog2(PREDICATES);
  reg [LANES-1:0] predicates_q [1:PREDICATES-1];
  wire [BITS-1:0] guard = guard_i[BITS-1:0], x_index = x_index_i[BITS-1:0], b_index = b_index_i[BITS-1:0];
  wire [BITS-1:0] write_index = write_index_i[BITS-1:0];
  wire unused = &{1'b0, guard_i, x_index_i, b_index_i, write_index_i};
  integer i;

  always @(posedge clk_i)
    if (clear_i) begin
      for (i = 1; i < PREDICATES; i = i + 1) predicates_q[i] <= {LANES{1'b0}};
    end else if (write_i && write_index != {BITS{1'b0}}) begin
      predicates_q[write_index] <= write_data_i;
    end

  always @(posedge clk_i)
    if (read_i) begin
      mask_o <= launched_i & ((guard == {BITS{1'b0}} ? {LANES{1'b1}} : predicates_q[guard]) ^ {LANES{guard_negated_i}});
      x_o <= x_index == {BITS{1'b0}} ? {LANES{1'b1}} : predicates_q[x_index];
      b_o <= b_index == {BITS{1'b0}} ? {LANES{1'b1}} : predicates_q[b_index];
    end
endmodule
`default_nettype wire
