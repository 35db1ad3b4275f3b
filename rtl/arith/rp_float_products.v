// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// COUNT multipliers side by side for a pipe that never waits: each begins a product in every cycle, and shows from a
// register that of what stood at its inputs three cycles before. Formats and SUBNORMALS as in float_multiplier.
`default_nettype none
module rp_float_products #(
  parameter integer COUNT = 1,
  parameter integer EXPONENT_BITS = 8,
  parameter integer MANTISSA_BITS = 23,
  parameter integer SUBNORMALS = 0,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire                  clk_i,
  input  wire [COUNT*BITS-1:0] a_i,
  input  wire [COUNT*BITS-1:0] b_i,
  output reg  [COUNT*BITS-1:0] product_o
);
  wire [COUNT*BITS-1:0] product;
  wire [COUNT-1:0] tiny;
  wire unused = &{1'b0, tiny};
  always @(posedge clk_i) product_o <= product;
  genvar k;
  generate
    for (k = 0; k < COUNT; k = k + 1) begin : gen_product
      rp_float_multiplier #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(SUBNORMALS))
      multiplier (
        .clk_i(clk_i),
        .enable_i(3'b111),
        .a_i(a_i[k*BITS+:BITS]),
        .b_i(b_i[k*BITS+:BITS]),
        .result_o(product[k*BITS+:BITS]),
        .tiny_o(tiny[k])
      );
    end
  endgenerate
endmodule
`default_nettype wire
