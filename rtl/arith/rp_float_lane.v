// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One lane of the Flt ALU and the result register behind it. FMA 0: adder, multiplier and the unit
// of conversions, each in three stages.
// FMA 1: the fused unit, which adds a * 1 + b and multiplies too, in five, and the conversions; their results wait for
// two more.
// add_enable_i, multiply_enable_i, fuse_enable_i and convert_enable_i: bit 0 takes the operands into that unit, bit k
// is high when stage k holds that operation k cycles later; at most one unit is enabled in a stage.
// result_o is loaded at the end of the last stage and stays until the next one. tiny_o, for one cycle from then on: it
// was flushed.
// SIGNIFICAND below 24: the units have so many bits; what a word has below them is not looked at, and zero in results.
`default_nettype none
module rp_float_lane #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer FMA = 0,
  parameter integer NO_CONVERSION = 0,   // of float_convert
  parameter integer STAGES = (FMA != 0) ? 5 : 3
) (
  input  wire        clk_i,
  input  wire [STAGES-1:0] add_enable_i,
  input  wire [STAGES-1:0] multiply_enable_i,
  input  wire [STAGES-1:0] fuse_enable_i,
  input  wire [STAGES-1:0] convert_enable_i,
  input  wire        subtract_i,
  input  wire [1:0]  convert_op_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  input  wire [31:0] c_i,
  output wire [31:0] result_o,
  output reg         tiny_o
);
  `include "rp_free_running.vh"
  localparam integer M = SIGNIFICAND - 1;   // stored bits of a mantissa
  localparam integer D = 23 - M;            // bits of a word that it lacks
  wire [31:0] converted;
  reg [31:0] computed, result_q;            // computed: by the other units
  rp_float_convert #(.SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND), .WITHOUT(NO_CONVERSION)) convert (
    .clk_i(clk_i),
    .enable_i(convert_enable_i[2:0]),
    .op_i(convert_op_i),
    .a_i(a_i),
    .b_i(b_i),
    .result_o(converted)
  );

  generate
    if (FMA == 0) begin : gen_separate
      wire [31:D] sum, product;
      wire tiny_sum, tiny_product;
      rp_float_adder #(.EXPONENT_BITS(8), .MANTISSA_BITS(M), .SUBNORMALS(SUBNORMALS)) adder (
        .clk_i(clk_i),
        .enable_i(add_enable_i[2:0]),
        .subtract_i(subtract_i),
        .a_i(a_i[31:D]),
        .b_i(b_i[31:D]),
        .result_o(sum),
        .tiny_o(tiny_sum)
      );
      rp_float_multiplier #(.EXPONENT_BITS(8), .MANTISSA_BITS(M), .SUBNORMALS(SUBNORMALS)) multiplier (
        .clk_i(clk_i),
        .enable_i(multiply_enable_i[2:0]),
        .a_i(a_i[31:D]),
        .b_i(b_i[31:D]),
        .result_o(product),
        .tiny_o(tiny_product)
      );
      always @(posedge clk_i) tiny_o <= SUBNORMALS == 2 && (tiny_sum || tiny_product);
      always @* begin
        computed = 32'd0;
        computed[31:D] = sum | product;
      end
      always @(posedge clk_i) begin
        if (add_enable_i[2] || multiply_enable_i[2] || convert_enable_i[2]) result_q <= computed | converted;
      end
    end else begin : gen_fused
      wire [4:0] enable = add_enable_i | multiply_enable_i | fuse_enable_i;
      wire [31:D] fused;
      wire tiny_fused;
      localparam [31:0] ONE = 32'h3f800000;
      wire [31:D] addend = add_enable_i[0] ? {b_i[31] ^ subtract_i, b_i[30:D]} : c_i[31:D];
      wire [31:D] factor = add_enable_i[0] ? ONE[31:D] : b_i[31:D];
      reg [31:0] s3_converted_q, s4_converted_q;
      rp_float_fma #(.EXPONENT_BITS(8), .MANTISSA_BITS(M), .SUBNORMALS(SUBNORMALS)) fma (
        .clk_i(clk_i),
        .enable_i(enable),
        .a_i(a_i[31:D]),
        .b_i(factor),
        .c_i(addend),
        .multiply_i(multiply_enable_i[0]),
        .result_o(fused),
        .tiny_o(tiny_fused)
      );
      always @(posedge clk_i) tiny_o <= SUBNORMALS == 2 && tiny_fused;
      always @* begin
        computed = 32'd0;
        computed[31:D] = fused;
      end
      always @(posedge clk_i) begin
        if (`STAGE_LOADS(convert_enable_i[2])) s3_converted_q <= converted;
        if (`STAGE_LOADS(convert_enable_i[3])) s4_converted_q <= s3_converted_q;
        if (enable[4] || convert_enable_i[4]) result_q <= convert_enable_i[4] ? s4_converted_q : computed;
      end
    end
  endgenerate
  assign result_o = result_q;
endmodule
`default_nettype wire
