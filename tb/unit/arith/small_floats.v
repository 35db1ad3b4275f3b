// Bench top: adder, multiplier and fused multiply-add of a narrow format, each in both subnormal modes (mode m has the
// bits [m*...]), fed with an operation a cycle.
`default_nettype none
module small_floats #(
  parameter integer EXPONENT_BITS = 5,
  parameter integer MANTISSA_BITS = 10,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire              clk_i,
  input  wire              subtract_i,
  input  wire              multiply_i,
  input  wire [BITS-1:0]   a_i,
  input  wire [BITS-1:0]   b_i,
  input  wire [BITS-1:0]   c_i,
  output wire [2*BITS-1:0] sum_o,       // two cycles later
  output wire [2*BITS-1:0] product_o,   // two cycles later
  output wire [2*BITS-1:0] fused_o      // four cycles later
);
  genvar m;
  generate
    for (m = 0; m < 2; m = m + 1) begin : gen_mode
      rp_float_adder #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(m)) adder (
        .clk_i(clk_i), .enable_i(3'b111), .subtract_i(subtract_i), .a_i(a_i), .b_i(b_i),
        .result_o(sum_o[m*BITS +: BITS]), .tiny_o());
      rp_float_multiplier #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(m)) multiplier (
        .clk_i(clk_i), .enable_i(3'b111), .a_i(a_i), .b_i(b_i), .result_o(product_o[m*BITS +: BITS]), .tiny_o());
      rp_float_fma #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(m)) fma (
        .clk_i(clk_i), .enable_i(5'b11111), .a_i(a_i), .b_i(b_i), .c_i(c_i), .multiply_i(multiply_i),
        .result_o(fused_o[m*BITS +: BITS]), .tiny_o());
    end
  endgenerate
endmodule
`default_nettype wire
