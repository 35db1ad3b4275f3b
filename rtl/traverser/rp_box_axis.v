// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Four boxes of a node against the slabs of one axis: the times between which the ray may be in each, as keys. Seven
// cycles. docs/machine/box-test.md proves that no interval is too short. A register's name ends with the stage that
// loads it. Promises: the results of what stood at the inputs seven moves before.
`default_nettype none
module rp_box_axis #(
  parameter integer BITS = 12,                   // of the reciprocal and of a key's significand
  parameter integer KEY_BITS = BITS + 9
) (
  input  wire                  clk_i,
  input  wire                  move_i,
  input  wire [31:0]           grid_i,           // the node's origin, a finite float
  input  wire [7:0]            step_i,           // exponent of a grid's step, signed
  input  wire [31:0]           lower_i,          // four boxes' planes, in steps
  input  wire [31:0]           upper_i,
  input  wire [31:0]           origin_i,         // of the ray, a finite float
  input  wire                  backwards_i,      // its direction is negative
  input  wire                  still_i,          // it is zero
  input  wire [BITS-1:0]       reciprocal_i,     // of its size, rounded down; the first bit is 1
  input  wire [9:0]            exponent_i,       // of the reciprocal's last bit, signed
  input  wire [9:0]            padding_i,        // exponent, signed
  output reg  [4*KEY_BITS-1:0] near_o,
  output reg  [4*KEY_BITS-1:0] far_o,
  output reg  [3:0]            missed_o
);
  localparam integer PLACES = BITS + 3;          // of the distance n
  localparam integer CUT = BITS - 1;             // of a product
  localparam integer PRODUCT_BITS = 2 * BITS + 6;
  localparam integer STEPS_BITS = BITS + 9;
  localparam integer SUM_BITS = BITS + 10;

  // ---- What the stages want of the inputs later: what each stage has loaded, the first one in the lowest bits.
  localparam integer PLANES = 4, STEP = 4, RECIPROCAL = 4, EXPONENT = 4, PADDING = 2, BACKWARDS = 5, STILL = 6;
  reg [64*PLANES-1:0] planes_q;                  // far ones, near ones
  reg [8*STEP-1:0] step_q;
  reg [BITS*RECIPROCAL-1:0] reciprocal_q;
  reg [10*EXPONENT-1:0] exponent_q;
  reg [10*PADDING-1:0] padding_q;
  reg [BACKWARDS-1:0] backwards_q;
  reg [STILL-1:0] still_q;
  always @(posedge clk_i)
    if (move_i) begin
      planes_q <= {planes_q[64*(PLANES-1)-1:0], backwards_i ? {lower_i, upper_i} : {upper_i, lower_i}};
      step_q <= {step_q[8*(STEP-1)-1:0], step_i};
      reciprocal_q <= {reciprocal_q[BITS*(RECIPROCAL-1)-1:0], reciprocal_i};
      exponent_q <= {exponent_q[10*(EXPONENT-1)-1:0], exponent_i};
      padding_q <= {padding_q[10*(PADDING-1)-1:0], padding_i};
      backwards_q <= {backwards_q[BACKWARDS-2:0], backwards_i};
      still_q <= {still_q[STILL-2:0], still_i};
    end
  wire signed [11:0] padding_1 = {{3{padding_q[9]}}, padding_q[8:0]};
  wire signed [11:0] padding_2 = {{3{padding_q[19]}}, padding_q[18:10]};
  wire signed [11:0] step_3 = {{5{step_q[23]}}, step_q[22:16]};
  wire signed [11:0] step_4 = {{5{step_q[31]}}, step_q[30:24]};
  wire signed [11:0] exponent_4 = {{3{exponent_q[39]}}, exponent_q[38:30]};
  wire [BITS-1:0] m_3 = reciprocal_q[BITS*2+:BITS], m_4 = reciprocal_q[BITS*3+:BITS];
  wire [31:0] first_4 = planes_q[64*3+:32], second_4 = planes_q[64*3+32+:32];
  wire backwards_3 = backwards_q[2], backwards_4 = backwards_q[3], backwards_5 = backwards_q[4];
  wire still_6 = still_q[5];

  // ---- 1: which of the origins is the greater one, and by how many places
  wire swap = origin_i[30:0] > grid_i[30:0];
  wire [7:0] grid_exponent = {grid_i[30:24], grid_i[23] || grid_i[30:23] == 8'd0};
  wire [7:0] origin_exponent = {origin_i[30:24], origin_i[23] || origin_i[30:23] == 8'd0};
  wire [23:0] grid_significand = {grid_i[30:23] != 8'd0, grid_i[22:0]};
  wire [23:0] origin_significand = {origin_i[30:23] != 8'd0, origin_i[22:0]};
  wire [7:0] apart = grid_exponent - origin_exponent;
  wire [7:0] apart_swapped = origin_exponent - grid_exponent;
  reg [23:0] greater_1, lesser_1;
  reg [7:0] greater_exponent_1, apart_1;
  reg add_1, behind_1;
  always @(posedge clk_i)
    if (move_i) begin
      greater_1 <= swap ? origin_significand : grid_significand;
      lesser_1 <= swap ? grid_significand : origin_significand;
      greater_exponent_1 <= swap ? origin_exponent : grid_exponent;
      apart_1 <= swap ? apart_swapped : apart;
      add_1 <= grid_i[31] != origin_i[31];
      behind_1 <= (swap ? !origin_i[31] : grid_i[31]) != backwards_i;
    end

  // ---- 2: the distance between the origins, rounded down: the lesser one is taken to two places more than the greater
  // one has, and rest is set if it has any behind them. The last places complete a difference, if nothing was lost.
  wire [4:0] align = (apart_1 > 8'd31) ? 5'd31 : apart_1[4:0];
  wire [56:0] part = {lesser_1, 33'd0} >> align;
  wire rest = |part[30:0];
  wire [27:0] both = {1'b0, greater_1, 3'b001} + {{1'b0, part[56:31]} ^ {27{!add_1}}, !add_1 && !rest};
  // n is the sum with PLACES - 1 places behind it, less those that padding or n's size drop.
  wire signed [11:0] unit = $signed({4'd0, greater_exponent_1}) - (12'sd151 + PLACES[11:0]);
  wire signed [11:0] padded = padding_1 - unit;
  reg [26:0] sum_2;
  reg [5:0] padded_2;
  reg signed [11:0] unit_2;
  reg behind_2;
  always @(posedge clk_i)
    if (move_i) begin
      sum_2 <= both[27:1];
      padded_2 <= padded[11] ? 6'd0 : (padded[10:6] != 5'd0) ? 6'd63 : padded[5:0];
      unit_2 <= unit;
      behind_2 <= behind_1;
    end

  // ---- 3: n, of PLACES bits, or less where the padding is coarser
  function [4:0] leading_of(input [31:0] value);
    reg [15:0] half;
    reg [7:0] quarter;
    reg [3:0] eighth;
    begin
      leading_of = 5'd0;
      leading_of[4] = value[31:16] != 16'd0;
      half = leading_of[4] ? value[31:16] : value[15:0];
      leading_of[3] = half[15:8] != 8'd0;
      quarter = leading_of[3] ? half[15:8] : half[7:0];
      leading_of[2] = quarter[7:4] != 4'd0;
      eighth = leading_of[2] ? quarter[7:4] : quarter[3:0];
      leading_of[1] = eighth[3:2] != 2'd0;
      leading_of[0] = leading_of[1] ? eighth[3] : eighth[1];
    end
  endfunction
  wire [5:0] leading = {1'b0, leading_of({5'd0, sum_2})};
  wire coarse = padded_2 > leading;
  wire [5:0] drop = coarse ? padded_2 : leading;
  wire [26+PLACES-1:0] dropped = {sum_2, {PLACES-1{1'b0}}} >> drop;
  reg [PLACES-1:0] n_3;
  reg signed [11:0] unit_3;
  reg behind_3;
  always @(posedge clk_i)
    if (move_i) begin
      n_3 <= dropped[PLACES-1:0];
      unit_3 <= coarse ? padding_2 : unit_2 + $signed({6'd0, leading});
      behind_3 <= behind_2;
    end

  // ---- 4, 5: in time. Padding takes the distance to n - 1 .. n + 2, the reciprocal lies in m .. m + 1.
  wire [PRODUCT_BITS-1:0] product, product_carry;
  rp_multiply_tree #(.A_BITS(PLACES), .B_BITS(BITS), .OUT_BITS(PRODUCT_BITS)) distance_tree (
    .a_i(n_3), .b_i(m_3), .c_i({PRODUCT_BITS{1'b0}}), .sum_o(product), .carry_o(product_carry));
  reg [PRODUCT_BITS-1:0] product_4, product_carry_4;
  reg [PLACES+1:0] more_4;                       // what the largest product has, but for one unit
  reg [BITS:0] first_factor_4, second_factor_4;
  reg signed [11:0] unit_4, coarser_4;
  reg behind_4;
  always @(posedge clk_i)
    if (move_i) begin
      product_4 <= product;
      product_carry_4 <= product_carry;
      more_4 <= {2'd0, n_3} + {{PLACES-BITS+1{1'b0}}, m_3, 1'b1};
      first_factor_4 <= {1'b0, m_3} + {{BITS{1'b0}}, backwards_3};
      second_factor_4 <= {1'b0, m_3} + {{BITS{1'b0}}, !backwards_3};
      unit_4 <= unit_3 + CUT[11:0];
      coarser_4 <= unit_3 - step_3 + CUT[11:0];
      behind_4 <= behind_3;
    end
  // -x is ~(x - 1): of the largest product one unit is left out.
  wire [PRODUCT_BITS-1:0] least = product_4 + product_carry_4 + {{PRODUCT_BITS-BITS{1'b1}}, ~m_4};
  wire [PRODUCT_BITS-1:0] most = ~(product_4 + product_carry_4 + {{PRODUCT_BITS-PLACES-2{1'b0}}, more_4});
  wire [PRODUCT_BITS-1:0] near_product = behind_4 ? most : least;
  wire [PRODUCT_BITS-1:0] far_product = behind_4 ? least : most;
  reg signed [SUM_BITS-1:0] near_base_5, far_base_5;
  // The coarser one's last bit is the sum's.
  wire [11:0] finer_4 = -coarser_4;
  reg [4:0] base_drop_5, steps_drop_5;
  reg signed [11:0] unit_5;
  always @(posedge clk_i)
    if (move_i) begin
      near_base_5 <= {{SUM_BITS-PRODUCT_BITS+CUT{near_product[PRODUCT_BITS-1]}}, near_product[PRODUCT_BITS-1:CUT]};
      far_base_5 <= {{SUM_BITS-PRODUCT_BITS+CUT{far_product[PRODUCT_BITS-1]}}, far_product[PRODUCT_BITS-1:CUT]};
      base_drop_5 <= !coarser_4[11] ? 5'd0 : (finer_4[10:5] != 6'd0) ? 5'd31 : finer_4[4:0];
      steps_drop_5 <= coarser_4[11] ? 5'd0 : (coarser_4[10:5] != 6'd0) ? 5'd31 : coarser_4[4:0];
      unit_5 <= (coarser_4[11] ? step_4 : unit_4) + exponent_4;
    end

  // ---- 6: the terms at the same places, and their sum
  wire signed [SUM_BITS-1:0] near_base = near_base_5 >>> base_drop_5;
  wire signed [SUM_BITS-1:0] far_base = far_base_5 >>> base_drop_5;
  reg [9:0] exponent_6;                          // of a key that begins with the sum's first bit
  always @(posedge clk_i) if (move_i) exponent_6 <= unit_5[9:0] + (10'd511 + SUM_BITS[9:0]);

  // ---- 7: keys. The leading bit is moved to the front, and BITS are kept.
  localparam integer SHIFT_BITS = $clog2(SUM_BITS);
  function [KEY_BITS-1:0] key_of(input [SUM_BITS-1:0] value, input [9:0] exponent);
    reg [SUM_BITS-1:0] moved;
    reg [SHIFT_BITS-1:0] places;
    integer i;
    begin
      moved = value;
      places = {SHIFT_BITS{1'b0}};
      for (i = SHIFT_BITS - 1; i >= 0; i = i - 1) begin
        places[i] = moved >> (SUM_BITS - (1 << i)) == {SUM_BITS{1'b0}};
        if (places[i]) moved = moved << (1 << i);
      end
      key_of = {exponent - {{10-SHIFT_BITS{1'b0}}, places}, moved[SUM_BITS-2-:BITS-1]};
      if (!moved[SUM_BITS-1]) key_of = {KEY_BITS{1'b0}};
    end
  endfunction

  genvar g;
  generate
    for (g = 0; g < 4; g = g + 1) begin : gen_box
      // What the far plane adds is negated, so that dropped bits make it later: product less one here, inverted in 6.
      reg [STEPS_BITS-1:0] first_5, second_5;
      reg signed [SUM_BITS-1:0] enters_6, leaves_6;
      wire [STEPS_BITS-1:0] first_product = {{STEPS_BITS-8{1'b0}}, first_4[8*g+:8]} * {8'd0, first_factor_4};
      wire [STEPS_BITS-1:0] second_product = {{STEPS_BITS-8{1'b0}}, second_4[8*g+:8]} * {8'd0, second_factor_4};
      wire signed [SUM_BITS-1:0] first_steps = {first_5[STEPS_BITS-1], first_5} ^ {SUM_BITS{backwards_5}};
      wire signed [SUM_BITS-1:0] second_steps = {second_5[STEPS_BITS-1], second_5} ^ {SUM_BITS{!backwards_5}};
      always @(posedge clk_i)
        if (move_i) begin
          first_5 <= first_product - {{STEPS_BITS-1{1'b0}}, backwards_4};
          second_5 <= second_product - {{STEPS_BITS-1{1'b0}}, !backwards_4};
          enters_6 <= near_base + (first_steps >>> steps_drop_5);
          leaves_6 <= -(far_base + (second_steps >>> steps_drop_5));
        end
      wire before = enters_6[SUM_BITS-1];
      wire left = leaves_6[SUM_BITS-1];
      wire [KEY_BITS-1:0] near_key = key_of(enters_6, exponent_6);
      wire [KEY_BITS-1:0] far_key = key_of(leaves_6, exponent_6);
      always @(posedge clk_i)
        if (move_i) begin
          near_o[g*KEY_BITS+:KEY_BITS] <= (before || still_6) ? {KEY_BITS{1'b0}} : near_key;
          far_o[g*KEY_BITS+:KEY_BITS] <= still_6 ? {KEY_BITS{1'b1}} : left ? {KEY_BITS{1'b0}} : far_key;
          missed_o[g] <= left || (still_6 && !before && enters_6 != {SUM_BITS{1'b0}});
        end
    end
  endgenerate
endmodule
`default_nettype wire
