// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Conversions between single precision and 32-bit signed integers, and minimum and maximum, in three
// stages like the adder's and multiplier's.
// Operands are taken with enable_i[0]; enable_i[k] must be high when stage k holds that operation k cycles later.
// result_o is combinational, valid in stage 2, and zero while enable_i[2] is low, so that units of a lane can be ORed.
// op_i: 0 smaller, 1 larger (the number if one is a NaN, -0 below +0), 2 float to integer (towards zero, saturating,
// NaN gives 0), 3 integer to float (nearest even). SUBNORMALS above 0: minimum and maximum see, and give, subnormal
// operands as the zero of their sign. SIGNIFICAND below 24: what a word has below so many bits is not looked at, and
// zero in a float.
`default_nettype none
module rp_float_convert #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer WITHOUT = 0   // a bit for each op_i that never comes
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
  reg [4:0] s1_places_q, s2_places_q;  // rotation to the left: for 2 digits before the point, for 3 leading zeros
  reg [31:0] s1_value_q, s2_value_q;
  `include "rp_free_running.vh"
  localparam integer D = 24 - SIGNIFICAND;
  localparam [31:0] KEPT = 32'hffffffff << D;
  // Constant where nothing else comes: what only other operations need goes.
  localparam [3:0] LACKS = WITHOUT[3:0];
  wire converts = &LACKS[1:0] ? 1'b1 : &LACKS[3:2] ? 1'b0 : op_i[1];
  wire larger = (converts ? LACKS[2] : LACKS[0]) || (op_i[0] && !(converts ? LACKS[3] : LACKS[1]));
  wire s1_to_integer = s1_op_q == 2'd2 && !LACKS[2], s2_to_integer = s2_op_q == 2'd2 && !LACKS[2];
  wire s1_to_float = s1_op_q == 2'd3 && !LACKS[3], s2_to_float = s2_op_q == 2'd3 && !LACKS[3];
  wire [31:0] float_a = a_i & KEPT;
  wire [31:0] float_b = b_i & KEPT;
  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg nan_a, nan_b, below;
      reg [31:0] a, b;
      s1_op_q <= {converts, larger};
      s1_sign_q <= a_i[31];
      a = float_a;
      b = float_b;
      nan_a = &a[30:23] && a[22:0] != 23'd0;
      nan_b = &b[30:23] && b[22:0] != 23'd0;
      if (SUBNORMALS != 0 && a[30:23] == 8'd0) a[22:0] = 23'd0;
      if (SUBNORMALS != 0 && b[30:23] == 8'd0) b[22:0] = 23'd0;
      below = {!a[31], a[30:D] ^ {31-D{a[31]}}} < {!b[31], b[30:D] ^ {31-D{b[31]}}};
      if (!converts) begin
        if (nan_a && nan_b) s1_value_q <= 32'h7fc00000;
        else s1_value_q <= (nan_b || (!nan_a && below != larger)) ? a : b;
      end else if (!larger) begin
        s1_value_q <= {1'b1, float_a[22:0], 8'd0};
      end else begin
        s1_value_q <= (a_i ^ {32{a_i[31]}}) + {31'd0, a_i[31]};
      end
      // 127 is the exponent of 1, with one digit before the point; 158 that of 2^31.
      s1_places_q <= (a_i[30:23] < 8'd127 || nan_a) ? 5'd0 : a_i[27:23] + 5'd2;
      s1_saturate_q <= a_i[30:23] >= 8'd158 && !nan_a;
    end
    if (`STAGE_LOADS(enable_i[1])) begin : stage1
      reg [31:0] value, kept;
      // The lowest bit of each part does not matter: if no other one is set the number is 1 or 0.
      reg [14:0] half;
      reg [6:0] quarter;
      reg [2:0] three;
      reg [4:0] places;
      places = s1_places_q;
      if (s1_to_float) begin
        places[4] = s1_value_q[31:16] == 16'd0;
        half = places[4] ? s1_value_q[15:1] : s1_value_q[31:17];
        places[3] = half[14:7] == 8'd0;
        quarter = places[3] ? half[6:0] : half[14:8];
        places[2] = quarter[6:3] == 4'd0;
        three = places[2] ? quarter[2:0] : quarter[6:4];
        places[1] = three[2:1] == 2'd0;
        places[0] = places[1] ? !three[0] : !three[2];
      end
      else if (!s1_to_integer) places = 5'd0;
      // Of a number the digits before the point come to the bottom and the others are left out; the zeros
      // above an integer may come in below.
      value = s1_value_q;
      if (places[4]) value = {value[15:0], value[31:16]};
      if (places[3]) value = {value[23:0], value[31:24]};
      if (places[2]) value = {value[27:0], value[31:28]};
      if (places[1]) value = {value[29:0], value[31:30]};
      if (places[0]) value = {value[30:0], value[31]};
      kept = ~(32'hffffffff << places);
      s2_value_q <= s1_to_integer ? value & kept : value;
      s2_places_q <= places;
      s2_op_q <= s1_op_q;
      s2_sign_q <= s1_sign_q;
      s2_saturate_q <= s1_saturate_q;
    end
  end

  always @* begin : stage2
    reg [31:0] value;
    reg up, increment;                      // to the next float, to the next integer
    result_o = 32'd0;
    value = s2_value_q;
    up = 1'b0;
    increment = 1'b0;
    if (enable_i[2]) begin
      if (s2_to_integer) begin
        value = s2_value_q ^ {32{s2_sign_q}};
        increment = s2_sign_q;
      end
      if (s2_to_float) begin
        // No leading one: zero.
        value = s2_value_q[31] ? {1'b0, 8'd158 - {3'd0, s2_places_q}, s2_value_q[30:8]} & KEPT : 32'd0;
        up = s2_value_q[7+D] && (s2_value_q[8+D] || s2_value_q[6+D:0] != {7+D{1'b0}});
      end
      result_o = value + ({31'd0, up} << D) + {31'd0, increment};
      if (s2_to_float && s2_value_q[31]) result_o[31] = s2_sign_q;
      if (s2_to_integer && s2_saturate_q) result_o = {s2_sign_q, {31{!s2_sign_q}}};
    end
  end
endmodule
`default_nettype wire
