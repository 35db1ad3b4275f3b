// One lane of the Flt ALU: adder, multiplier and the unit of conversions, each in three stages, and the result register behind them.
// add_enable_i, multiply_enable_i and convert_enable_i: bit 0 takes the operands into that unit, bits 1 and 2 follow one and two cycles later;
// at most one unit is enabled in a stage. result_o is loaded at the end of stage 2 and stays until the next one.
`default_nettype none
module float_lane #(
  parameter integer SUBNORMALS = 0
) (
  input  wire        clk_i,
  input  wire [2:0]  add_enable_i,
  input  wire [2:0]  multiply_enable_i,
  input  wire [2:0]  convert_enable_i,
  input  wire        subtract_i,
  input  wire [1:0]  convert_op_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  output wire [31:0] result_o
);
  wire [31:0] sum, product, converted;
  reg [31:0] result_q;

  float_adder #(.EXPONENT_BITS(8), .MANTISSA_BITS(23), .SUBNORMALS(SUBNORMALS)) adder (
    .clk_i(clk_i), .enable_i(add_enable_i), .subtract_i(subtract_i), .a_i(a_i), .b_i(b_i), .result_o(sum));
  float_multiplier #(.EXPONENT_BITS(8), .MANTISSA_BITS(23), .SUBNORMALS(SUBNORMALS)) multiplier (
    .clk_i(clk_i), .enable_i(multiply_enable_i), .a_i(a_i), .b_i(b_i), .result_o(product));
  float_convert #(.SUBNORMALS(SUBNORMALS)) convert (
    .clk_i(clk_i), .enable_i(convert_enable_i), .op_i(convert_op_i), .a_i(a_i), .b_i(b_i), .result_o(converted));

  always @(posedge clk_i) begin
    if (add_enable_i[2] || multiply_enable_i[2] || convert_enable_i[2]) result_q <= sum | product | converted;
  end
  assign result_o = result_q;
endmodule
`default_nettype wire
