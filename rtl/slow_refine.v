// One multiplicative step of the slow unit in three stages: from y, about 1/v or 1/sqrt(v), the quotient w/v or w/sqrt(v).
// With n = w*y and e = 1 - v*y, or (1 - v*y*y)/2 for a root, the quotient is n + n*e but for n*e*e (n*1.5*e*e for a root).
// v, w: 23 fraction bits; y: 15, below 1; |e| must be below 2^-12. What is cut off is cut off downwards.
// enable_i[k] says that stage k holds a task; y_i and the others are taken with enable_i[0]. root_1_i belongs to the task in stage 1.
// quotient_o is a register with 30 fraction bits.
`default_nettype none
module slow_refine (
  input  wire        clk_i,
  input  wire [2:0]  enable_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  input  wire [14:0] y_i,
  input  wire        root_1_i,
  output wire [31:0] quotient_o
);
  reg [30:0] s1_t_q;              // v*y, 30 fraction bits
  reg [31:0] s1_n_q, s2_n_q;      // w*y, 30 fraction bits
  reg [14:0] s1_y_q;
  reg [16:0] s2_e_q;              // signed, 28 fraction bits
  reg [31:0] quotient_q;
  assign quotient_o = quotient_q;

  always @(posedge clk_i) begin
    if (enable_i[0]) begin : stage0
      reg [39:0] t, n;
      t = {15'd0, v_i} * {25'd0, y_i};
      n = {15'd0, w_i} * {25'd0, y_i};
      s1_t_q <= t[38:8];
      s1_n_q <= n[39:8];
      s1_y_q <= y_i;
    end
    if (enable_i[1]) begin : stage1
      // 1 - p without carry: all ones below 1 minus p.
      reg [45:0] p;
      p = {15'd0, s1_t_q} * {31'd0, s1_y_q};
      if (root_1_i) s2_e_q <= ~p[34:18];
      else s2_e_q <= ~s1_t_q[18:2];
      s2_n_q <= s1_n_q;
    end
    if (enable_i[2]) begin : stage2
      reg signed [48:0] sum;
      sum = $signed({29'd0, s2_n_q[31:12]}) * $signed({{32{s2_e_q[16]}}, s2_e_q}) + $signed({1'b0, s2_n_q, 16'd0});
      quotient_q <= sum[47:16];
    end
  end
endmodule
`default_nettype wire
