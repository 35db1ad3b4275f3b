// Four boxes of a node against the slabs of one axis: the times between which the ray may be in each, as keys. Five
// cycles. docs/traverser.md proves that no interval is too short.
// Promises: the results of what stood at the inputs five moves before.
`default_nettype none
module box_axis #(
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
  localparam integer SUM_BITS = BITS + 10;

  // ---- What the stages want of the inputs later
  reg [31:0] first_planes_1, second_planes_1, first_planes_2, second_planes_2;
  reg [BITS-1:0] reciprocal_1, reciprocal_2;
  reg [9:0] padding_q, exponent_1, exponent_2, exponent_q;
  reg [7:0] step_1, step_2, step_q;
  reg backwards_1, backwards_2, still_1, still_2, still_3, still_4;
  always @(posedge clk_i)
    if (move_i) begin
      first_planes_1 <= backwards_i ? upper_i : lower_i;
      second_planes_1 <= backwards_i ? lower_i : upper_i;
      first_planes_2 <= first_planes_1;
      second_planes_2 <= second_planes_1;
      reciprocal_1 <= reciprocal_i;
      reciprocal_2 <= reciprocal_1;
      padding_q <= padding_i;
      exponent_1 <= exponent_i;
      exponent_2 <= exponent_1;
      exponent_q <= exponent_2;
      step_1 <= step_i;
      step_2 <= step_1;
      step_q <= step_2;
      backwards_1 <= backwards_i;
      backwards_2 <= backwards_1;
      still_1 <= still_i;
      still_2 <= still_1;
      still_3 <= still_2;
      still_4 <= still_3;
    end
  wire signed [11:0] padding_1 = {{2{padding_q[9]}}, padding_q};
  wire [BITS-1:0] m_2 = reciprocal_2;
  wire signed [11:0] step_3 = {{4{step_q[7]}}, step_q};
  wire signed [11:0] exponent_3 = {{2{exponent_q[9]}}, exponent_q};

  // ---- 1: the distance between the origins, rounded down to the larger one's last bit and two more
  wire swap = origin_i[30:0] > grid_i[30:0];
  wire [31:0] greater = swap ? origin_i : grid_i;
  wire [31:0] lesser = swap ? grid_i : origin_i;
  wire [7:0] greater_exponent = (greater[30:23] == 8'd0) ? 8'd1 : greater[30:23];
  wire [7:0] lesser_exponent = (lesser[30:23] == 8'd0) ? 8'd1 : lesser[30:23];
  wire [7:0] apart = greater_exponent - lesser_exponent;
  wire [4:0] align = (apart > 8'd31) ? 5'd31 : apart[4:0];
  wire [26:0] whole = {1'b0, greater[30:23] != 8'd0, greater[22:0], 2'b00};
  wire [57:0] part = {1'b0, lesser[30:23] != 8'd0, lesser[22:0], 33'd0} >> align;
  wire subtract = grid_i[31] != origin_i[31];
  reg [26:0] sum_1;
  reg signed [11:0] unit_1;
  reg behind_1;
  always @(posedge clk_i)
    if (move_i) begin
      sum_1 <= subtract ? whole + part[57:31] : whole - part[57:31] - {26'd0, |part[30:0]};
      unit_1 <= $signed({4'd0, greater_exponent}) - 12'sd152;
      behind_1 <= (swap ? !origin_i[31] : grid_i[31]) != backwards_i;
    end

  // ---- 2: n, of PLACES bits, or less where the padding is coarser
  function [4:0] leading_of_distance(input [26:0] value);
    integer i;
    begin
      leading_of_distance = 5'd0;
      for (i = 1; i < 27; i = i + 1) if (value[i]) leading_of_distance = i[4:0];
    end
  endfunction
  wire signed [11:0] own_unit = unit_1 + $signed({7'd0, leading_of_distance(sum_1)}) - (PLACES[11:0] - 12'd1);
  wire signed [11:0] unit = (padding_1 > own_unit) ? padding_1 : own_unit;
  wire signed [11:0] drop = unit - unit_1;
  wire [11:0] raise = unit_1 - unit;
  wire [26:0] dropped = (drop > 12'sd31) ? 27'd0 : sum_1 >> drop[4:0];
  wire [26:0] raised = sum_1 << raise[4:0];
  reg [PLACES-1:0] n_2;
  reg signed [11:0] unit_2;
  reg behind_2;
  always @(posedge clk_i)
    if (move_i) begin
      n_2 <= (drop < 12'sd0) ? raised[PLACES-1:0] : dropped[PLACES-1:0];
      unit_2 <= unit;
      behind_2 <= behind_1;
    end

  // ---- 3: in time. Padding takes the distance to n - 1 .. n + 2, the reciprocal lies in m .. m + 1.
  wire [PRODUCT_BITS-1:0] wide_m = {{PRODUCT_BITS-BITS{1'b0}}, m_2};
  wire [PRODUCT_BITS-1:0] wide_n = {{PRODUCT_BITS-PLACES{1'b0}}, n_2};
  wire [PRODUCT_BITS-1:0] product = wide_n * wide_m;
  wire [PRODUCT_BITS-1:0] least = product - wide_m - {{PRODUCT_BITS-1{1'b0}}, 1'b1};
  wire [PRODUCT_BITS-1:0] most = product + (wide_m << 1) + wide_n + {{PRODUCT_BITS-2{1'b0}}, 2'd2};
  wire [PRODUCT_BITS-1:0] near_product = behind_2 ? -most : least;
  wire [PRODUCT_BITS-1:0] far_product = behind_2 ? least : -most;
  reg signed [SUM_BITS-1:0] near_base_3, far_base_3;
  reg signed [11:0] unit_3;
  always @(posedge clk_i)
    if (move_i) begin
      near_base_3 <= {{SUM_BITS-PRODUCT_BITS+CUT{near_product[PRODUCT_BITS-1]}}, near_product[PRODUCT_BITS-1:CUT]};
      far_base_3 <= {{SUM_BITS-PRODUCT_BITS+CUT{far_product[PRODUCT_BITS-1]}}, far_product[PRODUCT_BITS-1:CUT]};
      unit_3 <= unit_2 + CUT[11:0];
    end

  // ---- 4: the coarser one's last bit is the sum's
  wire signed [11:0] coarser = unit_3 - step_3;
  wire signed [11:0] finer = step_3 - unit_3;
  wire [4:0] base_drop = coarser[11] ? ((finer > 12'sd31) ? 5'd31 : finer[4:0]) : 5'd0;
  wire [4:0] step_drop = coarser[11] ? 5'd0 : ((coarser > 12'sd31) ? 5'd31 : coarser[4:0]);
  wire signed [SUM_BITS-1:0] near_base = near_base_3 >>> base_drop;
  wire signed [SUM_BITS-1:0] far_base = far_base_3 >>> base_drop;
  reg signed [11:0] unit_4;
  always @(posedge clk_i) if (move_i) unit_4 <= (coarser[11] ? step_3 : unit_3) + exponent_3;

  // ---- 5: keys
  localparam integer LEADING_BITS = 5;
  function [LEADING_BITS-1:0] leading_of_time(input [SUM_BITS-1:0] value);
    integer i;
    begin
      leading_of_time = {LEADING_BITS{1'b0}};
      for (i = 1; i < SUM_BITS; i = i + 1) if (value[i]) leading_of_time = i[LEADING_BITS-1:0];
    end
  endfunction
  // Its leading bit is moved to the front, and BITS are kept.
  function [KEY_BITS-1:0] key_of(input [SUM_BITS-1:0] value, input [11:0] at);
    reg [LEADING_BITS-1:0] leading;
    reg [SUM_BITS-1:0] shifted;
    reg [11:0] exponent;
    begin
      leading = leading_of_time(value);
      shifted = value << (SUM_BITS[LEADING_BITS-1:0] - 1'b1 - leading);
      exponent = at + {7'd0, leading} + 12'd512;
      key_of = {exponent[9:0], shifted[SUM_BITS-2-:BITS-1]};
      if (value == {SUM_BITS{1'b0}}) key_of = {KEY_BITS{1'b0}};
    end
  endfunction

  genvar g;
  generate
    for (g = 0; g < 4; g = g + 1) begin : gen_box
      // What the far plane adds is negated, so that dropped bits make it later.
      wire [7:0] first_2 = first_planes_2[g*8+:8];
      wire [7:0] second_2 = second_planes_2[g*8+:8];
      wire [BITS+8:0] first_product = {1'b0, {BITS{1'b0}}, first_2} * {9'd0, m_2};
      wire [BITS+8:0] second_product = {1'b0, {BITS{1'b0}}, second_2} * {9'd0, m_2};
      wire [BITS+8:0] first_more = first_product + {1'b0, {BITS{1'b0}}, first_2};
      wire [BITS+8:0] second_more = second_product + {1'b0, {BITS{1'b0}}, second_2};
      reg signed [SUM_BITS-1:0] first_3, second_3, enters_4, leaves_4;
      wire signed [SUM_BITS-1:0] first_steps = first_3 >>> step_drop;
      wire signed [SUM_BITS-1:0] second_steps = second_3 >>> step_drop;
      always @(posedge clk_i)
        if (move_i) begin
          first_3 <= backwards_2 ? -{1'b0, first_more} : {1'b0, first_product};
          second_3 <= backwards_2 ? {1'b0, second_product} : -{1'b0, second_more};
          enters_4 <= near_base + first_steps;
          leaves_4 <= -(far_base + second_steps);
        end
      wire before = enters_4[SUM_BITS-1];
      wire left = leaves_4[SUM_BITS-1];
      wire [KEY_BITS-1:0] near_key = key_of(enters_4, unit_4);
      wire [KEY_BITS-1:0] far_key = key_of(leaves_4, unit_4);
      always @(posedge clk_i)
        if (move_i) begin
          near_o[g*KEY_BITS+:KEY_BITS] <= (before || still_4) ? {KEY_BITS{1'b0}} : near_key;
          far_o[g*KEY_BITS+:KEY_BITS] <= still_4 ? {KEY_BITS{1'b1}} : left ? {KEY_BITS{1'b0}} : far_key;
          missed_o[g] <= left || (still_4 && !before && enters_4 != {SUM_BITS{1'b0}});
        end
    end
  endgenerate
endmodule
`default_nettype wire
