// Conversions between single precision and 32-bit signed integers, and minimum and maximum, in three stages like the adder's and multiplier's.
// Operands are taken with enable_i[0]; enable_i[k] must say that stage k holds that operation k cycles later. result_o is combinational,
// valid in stage 2, and zero while enable_i[2] is low, so that units of a lane can be ORed.
// op_i: 0 smaller, 1 larger (the number if one is a NaN, -0 below +0), 2 float to integer (towards zero, saturating, NaN gives 0),
// 3 integer to float (nearest even). SUBNORMALS 1: minimum and maximum see, and give, subnormal operands as the zero of their sign.
`default_nettype none
module float_convert #(
  parameter integer SUBNORMALS = 0
) (
  input  wire        clk_i,
  input  wire [2:0]  enable_i,
  input  wire [1:0]  op_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  output reg  [31:0] result_o
);
  // value: the chosen operand, a mantissa at the top of a word, or an integer's magnitude.
  reg [1:0] s1_op_q, s2_op_q;
  reg s1_sign_q, s2_sign_q, s1_saturate_q, s2_saturate_q;
  reg [5:0] s1_shift_q;                     // to the right, 32 and more leave nothing
  reg [31:0] s1_value_q, s2_value_q;
  reg [4:0] s2_zeros_q;

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg [31:0] a, b;
      reg nan_a, nan_b, below;
      reg [8:0] distance;
      s1_op_q <= op_i;
      s1_sign_q <= a_i[31];
      nan_a = &a_i[30:23] && a_i[22:0] != 23'd0;
      nan_b = &b_i[30:23] && b_i[22:0] != 23'd0;
      if (!op_i[1]) begin
        a = a_i;
        b = b_i;
        if (SUBNORMALS != 0 && a[30:23] == 8'd0) a[22:0] = 23'd0;
        if (SUBNORMALS != 0 && b[30:23] == 8'd0) b[22:0] = 23'd0;
        below = {!a[31], a[30:0] ^ {31{a[31]}}} < {!b[31], b[30:0] ^ {31{b[31]}}};
        if (nan_a && nan_b) s1_value_q <= 32'h7fc00000;
        else s1_value_q <= (nan_b || (!nan_a && below != op_i[0])) ? a : b;
      end else if (!op_i[0]) begin
        // Mantissa with its leading one at bit 31, to be shifted right by 158 - exponent.
        distance = 9'd158 - {1'b0, a_i[30:23]};
        s1_saturate_q <= distance[8] || distance == 9'd0;
        s1_shift_q <= (distance > 9'd32) ? 6'd32 : distance[5:0];
        s1_value_q <= nan_a ? 32'd0 : {1'b1, a_i[22:0], 8'd0};
        if (nan_a) s1_saturate_q <= 1'b0;
      end else begin
        s1_value_q <= a_i[31] ? -a_i : a_i;
      end
    end
    if (enable_i[1]) begin : stage1
      reg [31:0] value;
      reg [4:0] zeros;
      value = s1_value_q;
      zeros = 5'd0;
      if (s1_op_q == 2'd2) value = s1_value_q >> s1_shift_q;
      if (s1_op_q == 2'd3) begin
        if (value[31:16] == 16'd0) begin value = {value[15:0], 16'd0}; zeros[4] = 1'b1; end
        if (value[31:24] == 8'd0) begin value = {value[23:0], 8'd0}; zeros[3] = 1'b1; end
        if (value[31:28] == 4'd0) begin value = {value[27:0], 4'd0}; zeros[2] = 1'b1; end
        if (value[31:30] == 2'd0) begin value = {value[29:0], 2'd0}; zeros[1] = 1'b1; end
        if (!value[31]) begin value = {value[30:0], 1'b0}; zeros[0] = 1'b1; end
      end
      s2_value_q <= value;
      s2_zeros_q <= zeros;
      s2_op_q <= s1_op_q;
      s2_sign_q <= s1_sign_q;
      s2_saturate_q <= s1_saturate_q;
    end
  end

  always @* begin : stage2
    result_o = 32'd0;
    if (enable_i[2]) begin
      case (s2_op_q)
        2'd2: begin
          if (s2_saturate_q) result_o = s2_sign_q ? 32'h80000000 : 32'h7fffffff;
          else result_o = s2_sign_q ? -s2_value_q : s2_value_q;
        end
        2'd3: begin
          // 158 is the exponent of 2^31. No leading one: zero.
          if (s2_value_q[31]) begin
            result_o = {1'b0, 8'd158 - {3'd0, s2_zeros_q}, s2_value_q[30:8]} +
                       {31'd0, s2_value_q[7] && (s2_value_q[8] || s2_value_q[6:0] != 7'd0)};
            result_o[31] = s2_sign_q;
          end
        end
        default: result_o = s2_value_q;
      endcase
    end
  end
endmodule
`default_nettype wire
