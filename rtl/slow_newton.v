// Approximate quotient w/v, w/sqrt(v) of slow_prepare, stages 1 .. 10 of the slow unit: a table of bytes gives y, about 1/v or 1/sqrt(v).
// STEPS 0: w*y. STEPS 1: a Newton step on y before, y + y*(1 - v*y), for a root y + y*(1 - v*y*y)/2. STEPS 2: a second one, on the quotient.
// Then the quotient is rounded to nearest even. cpp_model/arith/arith.cpp does the same integer steps and defines the results.
// enable_i[k] says that stage 1 + k holds a task. result_o is combinational in stage 10 and zero while enable_i[9] is low.
`default_nettype none
module slow_newton #(
  parameter integer STEPS = 2
) (
  input  wire        clk_i,
  input  wire [9:0]  enable_i,
  input  wire [8:0]  index_1_i,     // valid in stage 1, all others in stage 2
  input  wire        special_i,
  input  wire        nan_i,
  input  wire        sign_i,
  input  wire        root_i,
  input  wire [7:0]  exponent_i,
  input  wire [4:0]  shift_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  output reg  [31:0] result_o
);
  // What travels with a task; registers sK_* are valid in stage K.
  localparam integer TAG_BITS = 17;
  wire [TAG_BITS-1:0] s2_tag = {special_i, nan_i, sign_i, root_i, exponent_i, shift_i};
  localparam integer SPECIAL = 16, NAN = 15, SIGN = 14, ROOT = 13, EXPONENT = 5;
  reg [TAG_BITS-1:0] s3_tag_q, s4_tag_q, s5_tag_q, s6_tag_q, s7_tag_q, s8_tag_q, s9_tag_q, s10_tag_q;
  reg [24:0] s3_w_q, s4_w_q, s5_w_q;

  wire [7:0] s2_seed;
  slow_seed_table seed_table (
    .clk_i(clk_i), .enable_i(enable_i[0]), .seed_o(s2_seed),
    .index_i(index_1_i[8] ? index_1_i[8:1] : {1'b0, index_1_i[6:0]}));

  reg [8:0] s3_y_q, s4_y_q;       // 9 fraction bits
  reg [33:0] s3_t_q;              // v*y, 32 fraction bits
  reg [12:0] s4_e_q;              // signed, 18 fraction bits
  reg [14:0] s5_y_q;              // 15 fraction bits
  wire [31:0] s8_estimate;        // 30 fraction bits
  reg [30:0] s9_q_q;
  reg [30:0] s10_magnitude_q;
  reg s10_round_up_q;

  always @(posedge clk_i) begin
    if (enable_i[8:1] != 8'd0) begin
      if (enable_i[1]) begin
        if (STEPS >= 1) s3_t_q <= {9'd0, v_i} * {25'd0, 1'b1, s2_seed};
        s3_y_q <= {1'b1, s2_seed};
        s3_tag_q <= s2_tag;
        s3_w_q <= w_i;
      end
      if (enable_i[2]) begin : stage3
        // 1 - p without carry: all ones below 1 minus p.
        reg [42:0] p;
        p = {9'd0, s3_t_q} * {34'd0, s3_y_q};
        s4_e_q <= s3_tag_q[ROOT] ? ~p[36:24] : ~s3_t_q[26:14];
        s4_y_q <= s3_y_q;
        s4_tag_q <= s3_tag_q;
        s4_w_q <= s3_w_q;
      end
      if (enable_i[3]) begin : stage4
        // The added half makes cutting off a rounding. The step errs low, so y stays below 1 for every v.
        reg signed [28:0] sum;
        sum = $signed({20'd0, s4_y_q}) * $signed({{16{s4_e_q[12]}}, s4_e_q}) + $signed({2'b00, s4_y_q, 18'h00800});
        if (STEPS >= 1) s5_y_q <= sum[26:12];
        else s5_y_q <= {s4_y_q, 6'd0};
        s5_tag_q <= s4_tag_q;
        s5_w_q <= s4_w_q;
      end
      if (enable_i[4]) s6_tag_q <= s5_tag_q;
      if (enable_i[5]) s7_tag_q <= s6_tag_q;
      if (enable_i[6]) s8_tag_q <= s7_tag_q;
      if (enable_i[7]) begin
        // The true quotient lies in [1, 2), so the nearest number there is no worse.
        if (s8_estimate[31]) s9_q_q <= 31'h7fffffff;
        else if (!s8_estimate[30]) s9_q_q <= 31'h40000000;
        else s9_q_q <= s8_estimate[30:0];
        s9_tag_q <= s8_tag_q;
      end
      if (enable_i[8]) begin : stage9
        reg [30:0] kept, lost;
        kept = s9_q_q >> s9_tag_q[4:0];
        lost = s9_q_q & ~(31'h7fffffff << s9_tag_q[4:0]);
        s10_magnitude_q <= {s9_tag_q[EXPONENT +: 8], 23'd0} + {7'd0, kept[30:7]};
        s10_round_up_q <= kept[6] && (kept[7] || kept[5:0] != 6'd0 || lost != 31'd0);
        s10_tag_q <= s9_tag_q;
      end
    end
  end

  generate
    if (STEPS == 2) begin : gen_second_step
      reg [24:0] s3_v_q, s4_v_q, s5_v_q;
      always @(posedge clk_i) begin
        if (enable_i[1]) s3_v_q <= v_i;
        if (enable_i[2]) s4_v_q <= s3_v_q;
        if (enable_i[3]) s5_v_q <= s4_v_q;
      end
      slow_refine refine (
        .clk_i(clk_i), .enable_i(enable_i[6:4]), .v_i(s5_v_q), .w_i(s5_w_q), .y_i(s5_y_q), .root_1_i(s6_tag_q[ROOT]),
        .quotient_o(s8_estimate));
    end else begin : gen_product
      reg [31:0] s6_q_q, s7_q_q, s8_q_q;
      always @(posedge clk_i) begin
        if (enable_i[4]) begin : stage5
          reg [39:0] product;
          product = {15'd0, s5_w_q} * {25'd0, s5_y_q};
          s6_q_q <= product[39:8];
        end
        if (enable_i[5]) s7_q_q <= s6_q_q;
        if (enable_i[6]) s8_q_q <= s7_q_q;
      end
      assign s8_estimate = s8_q_q;
    end
  endgenerate

  always @* begin
    result_o = 32'd0;
    if (enable_i[9]) begin
      if (s10_tag_q[SPECIAL]) result_o = {s10_tag_q[SIGN], s10_tag_q[EXPONENT +: 8], s10_tag_q[NAN], 22'd0};
      else result_o = {s10_tag_q[SIGN], s10_magnitude_q + {30'd0, s10_round_up_q}};
    end
  end
endmodule
`default_nettype wire
