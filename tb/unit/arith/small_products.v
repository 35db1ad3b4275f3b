// Bench top: multipliers of a narrow format, LANES of them in each subnormal mode (mode m has the
// bits [m*LANES*BITS +: ...]), fed with one first operand and LANES second ones a cycle: all
// pairs there are shall take minutes.
`default_nettype none
module small_products #(
  parameter integer EXPONENT_BITS = 5,
  parameter integer MANTISSA_BITS = 10,
  parameter integer LANES = 16,
  parameter integer BITS = 1 + EXPONENT_BITS + MANTISSA_BITS
) (
  input  wire                    clk_i,
  input  wire [BITS-1:0]         a_i,
  input  wire [LANES*BITS-1:0]   b_i,
  output wire [2*LANES*BITS-1:0] product_o      // two cycles later
);
  genvar m, l;
  generate
    for (m = 0; m < 2; m = m + 1) begin : gen_mode
      for (l = 0; l < LANES; l = l + 1) begin : gen_lane
        rp_float_multiplier #(.EXPONENT_BITS(EXPONENT_BITS), .MANTISSA_BITS(MANTISSA_BITS), .SUBNORMALS(m)) multiplier (
          .clk_i(clk_i), .enable_i(3'b111), .a_i(a_i), .b_i(b_i[l*BITS +: BITS]),
          .result_o(product_o[(m*LANES+l)*BITS +: BITS]), .tiny_o());
      end
    end
  endgenerate
endmodule
`default_nettype wire
