// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Watches the float tasks of an ALU: flags, when one is done, that an operand that it read, or a result before it was
// flushed, was a subnormal number in any lane of its mask.
// enter_i: lanes that enter in this cycle, and have their operands at a_i, b_i and c_i; reads_i: which of these {c, b,
// a} are floats that the operation reads. result_i: in stage RESULT_STAGE is a task with a result that is tiny.
// subnormal_o: the task, or group of lanes, that entered DEPTH cycles ago has met one.
`default_nettype none
module rp_subnormal_guard #(
  parameter integer LANES = 8,
  parameter integer SIGNIFICAND = 24,   // what a word has below is not looked at
  parameter integer DEPTH = 3,
  parameter integer RESULT_STAGE = 3    // 1 .. DEPTH
) (
  input  wire                clk_i,
  input  wire [LANES-1:0]    enter_i,
  input  wire [2:0]          reads_i,
  input  wire [LANES*32-1:0] a_i,
  input  wire [LANES*32-1:0] b_i,
  input  wire [LANES*32-1:0] c_i,
  input  wire                result_i,
  output wire                subnormal_o
);
  localparam [31:0] FRACTION = 32'h007fffff & (32'hffffffff << (24 - SIGNIFICAND));
  localparam [31:0] EXPONENT = 32'h7f800000;
  function is_subnormal(input [31:0] word);
    is_subnormal = (word & EXPONENT) == 32'd0 && (word & FRACTION) != 32'd0;
  endfunction

  reg operand;
  integer l;
  always @* begin
    operand = 1'b0;
    for (l = 0; l < LANES; l = l + 1)
      if (enter_i[l] && ((reads_i[0] && is_subnormal(a_i[l*32 +: 32])) ||
                         (reads_i[1] && is_subnormal(b_i[l*32 +: 32])) ||
                         (reads_i[2] && is_subnormal(c_i[l*32 +: 32])))) operand = 1'b1;
  end

  // Bit k - 1: of the task in stage k. Empty stages have zeros.
  reg [DEPTH-1:0] found_q;
  wire [DEPTH-1:0] found = found_q | ({{DEPTH-1{1'b0}}, result_i} << (RESULT_STAGE - 1));
  always @(posedge clk_i) found_q <= {found[DEPTH-2:0], operand};
  assign subnormal_o = found[DEPTH-1];
endmodule
`default_nettype wire
