// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// COUNT adders side by side, or subtracters with SUBTRACT, for a pipe that never waits: each begins an operation in
// every cycle, and shows from a register what stood at its inputs three cycles before. Formats and SUBNORMALS as in
// float_adder.
`default_nettype none
module rp_float_sums #(
  parameter integer COUNT = 1,
  parameter integer SUBTRACT = 0,
  parameter integer EXPONENT_BITS = 8,
  parameter integer MANTISSA_BITS = 23,
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire                  clk_i,
  input  wire [COUNT*BITS-1:0] a_i,
  input  wire [COUNT*BITS-1:0] b_i,
  output reg  [COUNT*BITS-1:0] sum_o
);
  wire [COUNT*BITS-1:0] sum;
  wire [COUNT-1:0] tiny;
  wire unused = &{1'b0, tiny};
  always @(posedge clk_i) sum_o <= sum;
  genvar k;
  generate
    for (k = 0; k < COUNT; k = k + 1) begin : gen_sum
      rp_float_adder #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(SUBNORMALS)) adder (
        .clk_i(clk_i),
        .enable_i(3'b111),
        .subtract_i(SUBTRACT != 0),
        .a_i(a_i[k*BITS+:BITS]),
        .b_i(b_i[k*BITS+:BITS]),
        .result_o(sum[k*BITS+:BITS]),
        .tiny_o(tiny[k])
      );
    end
  endgenerate
endmodule
`default_nettype wire
