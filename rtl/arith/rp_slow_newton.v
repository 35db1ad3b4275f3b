// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Approximate quotient w/v, w/sqrt(v) of slow_prepare, stages 1 .. LAST of the slow unit: a table of
// bytes gives y, about 1/v or 1/sqrt(v).
// STEPS 0: w*y. STEPS 1: a Newton step on y before, y + y*(1 - v*y), for a root y + y*(1 - v*y*y)/2.
// STEPS 2: a second one, on the quotient.
// Then the quotient is rounded to nearest even, but never to another exponent: a true quotient is not that near to 2.
// docs/machine/float-units.md defines the results, cpp_model/arith/arith.cpp does the same integer steps.
// enable_i[k] is high when stage 1 + k holds a task. result_o is combinational in stage LAST, zero while it holds none.
`default_nettype none
module rp_slow_newton #(
  parameter integer SIGNIFICAND = 24,
  parameter integer STEPS = 2,
  parameter integer LAST = 10,
  parameter integer WITHOUT = 0   // as rp_slow_operations.vh has it
) (
  input  wire        clk_i,
  input  wire [LAST-1:0] enable_i,
  input  wire [8:0]  index_1_i,     // valid in stage 1
  input  wire        root_i,        // these four in stage 2
  input  wire        unary_i,
  input  wire [24:0] v_i,
  input  wire [24:0] w_i,
  input  wire        special_3_i,   // these five in stage 3
  input  wire        nan_3_i,
  input  wire        sign_3_i,
  input  wire [7:0]  exponent_3_i,
  input  wire [4:0]  shift_3_i,
  output reg  [31:0] result_o
);
  `include "rp_free_running.vh"
  `include "rp_ones_below.vh"
  `include "rp_booth_digits.vh"
  `include "rp_slow_operations.vh"
  wire root, unary;
  assign {root, unary} = possible_operation(root_i, unary_i);
  // The stages that make the quotient of w and y, and that round it.
  localparam integer PRODUCT = (STEPS == 0) ? 3 : 5, ROUND = LAST - 1;
  generate
    if (STEPS < 0 || STEPS > 2 || LAST != ((STEPS == 2) ? 10 : PRODUCT + 2)) begin : gen_illegal
      slow_newton_needs_other_stages illegal ();
    end
  endgenerate
  // What travels with a task, from stage 3 to ROUND; registers sK_* are valid in stage K.
  localparam integer TAG_BITS = 18;
  reg s3_root_q, s3_unary_q;
  localparam integer P = SIGNIFICAND;
  localparam integer UNARY = 17, SPECIAL = 16, NAN = 15, SIGN = 14, ROOT = 13, EXPONENT = 5;
  reg [(ROUND-3)*TAG_BITS-1:0] tags_q;  // of stages 4 .. ROUND
  wire [(ROUND-2)*TAG_BITS-1:0] tags =
    {tags_q, s3_unary_q, special_3_i, nan_3_i, sign_3_i, s3_root_q, exponent_3_i, shift_3_i};
  wire [TAG_BITS-1:0] round_tag = tags[(ROUND-3)*TAG_BITS +: TAG_BITS];
  reg [SPECIAL:0] last_tag_q;
  integer k;

  wire [7:0] s2_seed;
  rp_slow_seed_table seed_table (
    .clk_i(clk_i), .enable_i(enable_i[0]), .seed_o(s2_seed),
    .index_i(index_1_i[8] ? index_1_i[8:1] : {1'b0, index_1_i[6:0]}));

  reg [24:0] s3_w_q;
  reg [8:0] s3_y_q;               // 9 fraction bits
  localparam integer Y_BITS = (STEPS == 0) ? 9 : 15;
  wire [24:0] w;                  // of stage PRODUCT, as y
  wire [Y_BITS-1:0] y;            // Y_BITS fraction bits
  wire [31:0] round_estimate;     // 30 fraction bits
  reg [P+6:0] last_magnitude_q;   // exponent and P - 1 bits
  reg last_round_up_q;

  always @(posedge clk_i) begin
    if (`STAGE_LOADS(enable_i[ROUND-1:1] != {ROUND-1{1'b0}})) begin
      if (`STAGE_LOADS(enable_i[1])) begin
        s3_y_q <= {1'b1, s2_seed};
        s3_root_q <= root;
        s3_unary_q <= unary;
        s3_w_q <= w_i;
      end
      for (k = 4; k <= ROUND; k = k + 1)
        if (`STAGE_LOADS(enable_i[k-2])) tags_q[(k-4)*TAG_BITS +: TAG_BITS] <= tags[(k-4)*TAG_BITS +: TAG_BITS];
      if (`STAGE_LOADS(enable_i[ROUND-1])) begin : round
        reg [30:0] nearest, kept, lost;
        // The true quotient lies in [1, 2), so the nearest number there is no worse.
        nearest = round_estimate[30:0];
        if (round_estimate[31]) nearest = 31'h7fffffff;
        else if (!round_estimate[30]) nearest = 31'h40000000;
        kept = nearest >> round_tag[4:0];
        lost = nearest & ~(31'h7fffffff << round_tag[4:0]);
        last_magnitude_q <= {round_tag[EXPONENT +: 8] + {7'd0, kept[30]}, kept[29 -: P-1]};
        last_round_up_q <= kept[30-P] && (kept[31-P] || kept[29-P:0] != {30-P{1'b0}} || lost != 31'd0);
        last_tag_q <= round_tag[SPECIAL:0];
      end
    end
  end

  generate
    if (STEPS == 0) begin : gen_seed
      assign w = s3_w_q;
      assign y = s3_y_q;
    end else begin : gen_first_step
      reg [33:0] s3_t_q;            // v*y, 32 fraction bits
      reg [12:0] s4_e_q;            // signed, 18 fraction bits
      reg [8:0] s4_y_q;
      reg [14:0] s5_y_q;
      reg [24:0] s4_w_q, s5_w_q;
      assign w = s5_w_q;
      assign y = s5_y_q;
      wire [33:0] t_sum, t_carry;
      rp_multiply_tree #(.A_BITS(25), .B_BITS(9), .OUT_BITS(34)) t_tree (
        .a_i(v_i), .b_i({1'b1, s2_seed}), .c_i(34'd0), .sum_o(t_sum), .carry_o(t_carry));
      wire [36:0] p_sum, p_carry;
      rp_multiply_tree #(.A_BITS(34), .B_BITS(9), .OUT_BITS(37)) p_tree (
        .a_i(s3_t_q), .b_i(s3_y_q), .c_i(37'd0), .sum_o(p_sum), .carry_o(p_carry));
      wire [36:0] s3_p = p_sum + p_carry;
      // The added half makes cutting off a rounding. The step errs low, so y stays below 1 for every v.
      wire [26:0] y_sum, y_carry;
      rp_multiply_tree #(.A_BITS(9), .B_BITS(13), .OUT_BITS(27), .B_SIGNED(1), .ADD(1)) y_tree (
        .a_i(s4_y_q), .b_i(s4_e_q), .c_i({s4_y_q, 18'h00800}), .sum_o(y_sum), .carry_o(y_carry));
      wire [26:0] s4_y = y_sum + y_carry;
      always @(posedge clk_i) begin
        if (`STAGE_LOADS(enable_i[1])) s3_t_q <= t_sum + t_carry;
        if (`STAGE_LOADS(enable_i[2])) begin
          // 1 - p without carry: all ones below 1 minus p.
          s4_e_q <= s3_root_q ? ~s3_p[36:24] : ~s3_t_q[26:14];
          s4_y_q <= s3_y_q;
          s4_w_q <= s3_w_q;
        end
        if (`STAGE_LOADS(enable_i[3])) begin
          s5_y_q <= s4_y[26:12];
          s5_w_q <= s4_w_q;
        end
      end
      if (STEPS == 2) begin : gen_second_step
        reg [24:0] s3_v_q, s4_v_q, s5_v_q;
        reg [23:0] s5_y_digits_q;
        wire [47:0] s4_y_digits = booth_digits({17'd0, s4_y[26:12]});
        always @(posedge clk_i) begin
          if (`STAGE_LOADS(enable_i[1])) s3_v_q <= v_i;
          if (`STAGE_LOADS(enable_i[2])) s4_v_q <= s3_v_q;
          if (`STAGE_LOADS(enable_i[3])) s5_v_q <= s4_v_q;
          if (`STAGE_LOADS(enable_i[3])) s5_y_digits_q <= s4_y_digits[23:0];
        end
        rp_slow_refine #(.EXACT(0)) refine (
          .clk_i(clk_i),
          .enable_i(enable_i[7:4]),
          .v_i(s5_v_q),
          .w_i(w),
          .y_i(y),
          .y_digits_i(s5_y_digits_q),
          .root_1_i(tags[3*TAG_BITS+ROOT]),
          .unary_1_i(tags[3*TAG_BITS+UNARY]),
          .root_2_i(tags[4*TAG_BITS+ROOT]),
          .quotient_o(round_estimate)
        );
      end
    end
    if (STEPS != 2) begin : gen_product
      localparam integer Q_BITS = 25 + Y_BITS;
      wire [Q_BITS-1:0] q_sum, q_carry;
      rp_multiply_tree #(.A_BITS(25), .B_BITS(Y_BITS), .OUT_BITS(Q_BITS)) q_tree (
        .a_i(w), .b_i(y), .c_i({Q_BITS{1'b0}}), .sum_o(q_sum), .carry_o(q_carry));
      wire [Q_BITS-1:0] q = q_sum + q_carry;
      reg [31:0] q_q;
      always @(posedge clk_i) if (`STAGE_LOADS(enable_i[PRODUCT-1])) q_q <= q[Q_BITS-1 -: 32];
      assign round_estimate = q_q;
    end
  endgenerate

  always @* begin : last
    reg [63:0] ones;
    reg [P+6:0] rounded;
    result_o = 32'd0;
    ones = ones_below({{56-P{1'b0}}, last_magnitude_q});
    rounded = {P+7{1'b0}};
    if (enable_i[LAST-1]) begin
      // ones[P-1]: what is above a fraction of ones is the exponent.
      rounded = last_magnitude_q ^ (ones[P+6:0] & {P+7{last_round_up_q && !ones[P-1]}});
      if (last_tag_q[SPECIAL]) result_o = {last_tag_q[SIGN], last_tag_q[EXPONENT +: 8], last_tag_q[NAN], 22'd0};
      else result_o[31 -: P+8] = {last_tag_q[SIGN], rounded};
    end
  end
endmodule
`default_nettype wire
