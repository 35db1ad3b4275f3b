// The first two stages of the slow unit: unpacks, normalises subnormal operands, finds every result that needs no computation, and turns
// the rest into one task for the stages behind: the quotient q = w/v, or q = w/sqrt(v), which lies in [1, 2).
// enable_i[0] takes the operands, enable_i[1] must follow one cycle later; the outputs are registers that hold from then on.
//   fdiv: root 0 unary 0, fsqrt: root 1 unary 0, frsqrt: root 1 unary 1, frcp: root 0 unary 1
//   v_o, w_o     23 fraction bits; v in [1, 2), or [1, 4) for a root
//   index_1_o    already in stage 1, for a table: {root, odd exponent, 7 bits of the mantissa of v below its leading one}
//   special_o    the result is {sign, exponent, nan, 22 zeros}
//   else         the result is the sign and exponent_o * 2^23 + q, q with 23 - shift_o fraction bits; shift_o above 0: subnormal, 1 .. 24
// SUBNORMALS 0: IEEE; 1: subnormal operands count as zero, results below the normal numbers are zero (no quotient there rounds up to one).
`default_nettype none
module slow_prepare #(
  parameter integer SUBNORMALS = 0
) (
  input  wire        clk_i,
  input  wire [1:0]  enable_i,
  input  wire        root_i,
  input  wire        unary_i,
  input  wire [31:0] a_i,
  input  wire [31:0] b_i,
  output wire        special_o,
  output wire        nan_o,
  output wire        sign_o,
  output wire        root_o,
  output wire        unary_o,
  output wire [7:0]  exponent_o,
  output wire [4:0]  shift_o,
  output wire [24:0] v_o,
  output wire [24:0] w_o,
  output wire [8:0]  index_1_o
);
  // A number brought to the top: {leading zeros, 24 bits}.
  function [28:0] normalised(input [23:0] mantissa);
    reg [23:0] m;
    reg [4:0] zeros;
    begin
      m = mantissa;
      zeros = 5'd0;
      if (SUBNORMALS == 0 && !m[23]) begin
        if (m[23:8] == 16'd0) begin m = {m[7:0], 16'd0}; zeros[4] = 1'b1; end
        if (m[23:16] == 8'd0) begin m = {m[15:0], 8'd0}; zeros[3] = 1'b1; end
        if (m[23:20] == 4'd0) begin m = {m[19:0], 4'd0}; zeros[2] = 1'b1; end
        if (m[23:22] == 2'd0) begin m = {m[21:0], 2'd0}; zeros[1] = 1'b1; end
        if (!m[23]) begin m = {m[22:0], 1'b0}; zeros[0] = 1'b1; end
      end
      normalised = {zeros, m};
    end
  endfunction

  // Stage 0 -> 1: numerator n, divisor or radicand d. Exponents are biased by 127 and may be negative.
  reg s1_special_q, s1_nan_q, s1_infinite_q, s1_sign_q, s1_root_q, s1_unary_q;
  reg [9:0] s1_exponent_n_q, s1_exponent_d_q;
  reg [23:0] s1_n_q, s1_d_q;
  wire s1_odd = !s1_exponent_d_q[0];
  assign index_1_o = {s1_root_q, s1_root_q && s1_odd, s1_d_q[22:16]};
  // Stage 1 -> 2
  reg special_q, nan_q, sign_q, root_q, unary_q;
  reg [7:0] exponent_q;
  reg [4:0] shift_q;
  reg [24:0] v_q, w_q;

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg [31:0] n, d;
      reg zero_n, zero_d, max_n, max_d, nan, infinite;
      reg [4:0] zeros;
      reg [23:0] mantissa;
      d = (root_i || unary_i) ? a_i : b_i;
      n = (root_i || unary_i) ? 32'h3f800000 : a_i;
      max_n = &n[30:23];
      max_d = &d[30:23];
      zero_n = n[30:23] == 8'd0 && (SUBNORMALS != 0 || n[22:0] == 23'd0);
      zero_d = d[30:23] == 8'd0 && (SUBNORMALS != 0 || d[22:0] == 23'd0);
      nan = (max_n && n[22:0] != 23'd0) || (max_d && d[22:0] != 23'd0);
      infinite = 1'b0;
      if (root_i) begin
        if (d[31] && !zero_d) nan = 1'b1;
        infinite = unary_i ? zero_d : max_d;
      end else begin
        if ((max_n && max_d) || (zero_n && zero_d)) nan = 1'b1;
        infinite = max_n || zero_d;
      end
      s1_special_q <= nan || max_n || max_d || zero_n || zero_d;
      s1_nan_q <= nan;
      s1_infinite_q <= infinite;
      s1_sign_q <= !nan && (n[31] ^ d[31]);
      s1_root_q <= root_i;
      s1_unary_q <= unary_i;
      {zeros, mantissa} = normalised({n[30:23] != 8'd0, n[22:0]});
      s1_n_q <= mantissa;
      s1_exponent_n_q <= {2'd0, n[30:23]} + {9'd0, n[30:23] == 8'd0} - {5'd0, zeros};
      {zeros, mantissa} = normalised({d[30:23] != 8'd0, d[22:0]});
      s1_d_q <= mantissa;
      s1_exponent_d_q <= {2'd0, d[30:23]} + {9'd0, d[30:23] == 8'd0} - {5'd0, zeros};
    end
    if (enable_i[1]) begin : stage1
      reg smaller, special;
      reg [9:0] half, exponent, below;
      smaller = s1_n_q < s1_d_q;
      // A root: the number is v * 4^half, so an odd exponent leaves a factor of two in v.
      half = {s1_exponent_d_q[9], s1_exponent_d_q[9:1]} + {9'd0, s1_exponent_d_q[0]} - 10'd64;
      if (s1_root_q) exponent = s1_unary_q ? 10'd126 - half : 10'd127 + half;
      else exponent = s1_exponent_n_q - s1_exponent_d_q + 10'd127 - {9'd0, smaller};
      special = s1_special_q;
      below = 10'd1 - exponent;                 // how far below the normal numbers
      shift_q <= 5'd0;
      if (s1_special_q) begin
        exponent_q <= {8{s1_infinite_q || s1_nan_q}};
      end else if (s1_root_q && s1_unary_q && !s1_odd && s1_d_q == 24'h800000) begin
        special = 1'b1;                         // a power of four, whose result is no quotient below 2
        exponent_q <= exponent[7:0] + 8'd1;
      end else if (!exponent[9] && (exponent[8] || &exponent[7:0])) begin
        special = 1'b1;
        exponent_q <= 8'hff;
      end else if (exponent[9] || exponent == 10'd0) begin
        special = SUBNORMALS != 0 || below > 10'd24;
        exponent_q <= 8'd0;
        shift_q <= below[4:0];
      end else begin
        exponent_q <= exponent[7:0] - 8'd1;
      end
      special_q <= special;
      nan_q <= s1_nan_q;
      sign_q <= s1_sign_q;
      root_q <= s1_root_q;
      unary_q <= s1_unary_q;
      v_q <= (s1_root_q && s1_odd) ? {s1_d_q, 1'b0} : {1'b0, s1_d_q};
      if (s1_root_q && s1_unary_q) w_q <= {1'b1, 24'd0};
      else if (s1_root_q) w_q <= s1_odd ? {s1_d_q, 1'b0} : {1'b0, s1_d_q};
      else w_q <= smaller ? {s1_n_q, 1'b0} : {1'b0, s1_n_q};
    end
  end

  assign special_o = special_q;
  assign nan_o = nan_q;
  assign sign_o = sign_q;
  assign root_o = root_q;
  assign unary_o = unary_q;
  assign exponent_o = exponent_q;
  assign shift_o = shift_q;
  assign v_o = v_q;
  assign w_o = w_q;
endmodule
`default_nettype wire
