// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Of three pairs (x, y) that come one after the other, 0, 1 and 2, the cross products of 0 and 1, 1 and 2, 2 and 0:
// x' y - y' x of a pair (x, y) and the next one (x', y'), rounded once, to nearest even, to 32 bits. The three follow
// each other too, the first one eight cycles after pair 0. It never waits.
// Numbers have exponents of 11 bits, and none is subnormal.
// Must be given: exponents that no product leaves.
`default_nettype none
module rp_cross_products #(
  parameter integer MANTISSA_BITS = 35,          // of x and y, without the leading one
  parameter integer BITS = 12 + MANTISSA_BITS
) (
  input  wire            clk_i,
  input  wire            wrap_i,                 // three cycles after pair 0
  input  wire [BITS-1:0] x_i,
  input  wire [BITS-1:0] y_i,
  output reg  [42:0]     product_o               // sign, exponent, 31 bits behind the first one
);
  localparam integer M = MANTISSA_BITS;
  localparam integer P = 2*M + 2;                // bits of a product
  localparam integer D = $clog2(P + 4);
  localparam [12:0] FAR = P[12:0] + 13'd3;
  localparam integer W = P + 4;                  // a sum, with its carry, two bits and what shows that there is more

  // ---- 2: a pair, and the one after it; in the end that is pair 0 again
  reg [2*BITS-1:0] pair_1, pair_2, pair_3, next_2;
  always @(posedge clk_i) begin
    {pair_3, pair_2, pair_1} <= {pair_2, pair_1, y_i, x_i};
    next_2 <= wrap_i ? pair_3 : {y_i, x_i};
  end
  wire [BITS-1:0] x, y, next_x, next_y;
  assign {y, x} = pair_2;
  assign {next_y, next_x} = next_2;

  // ---- 3: both products as sums of two numbers; 4: as one, and which of the two reaches higher up, by their exponents
  wire [P-1:0] sum_a, carry_a, sum_b, carry_b;
  wire zero_x = x[M+:11] == 11'd0, zero_y = y[M+:11] == 11'd0;
  wire zero_next_x = next_x[M+:11] == 11'd0, zero_next_y = next_y[M+:11] == 11'd0;
  rp_multiply_tree #(.A_BITS(M+1), .B_BITS(M+1), .OUT_BITS(P)) tree_a (.a_i({!zero_next_x, next_x[M-1:0]}),
    .b_i({!zero_y, y[M-1:0]}), .c_i({P{1'b0}}), .sum_o(sum_a), .carry_o(carry_a));
  rp_multiply_tree #(.A_BITS(M+1), .B_BITS(M+1), .OUT_BITS(P)) tree_b (.a_i({!zero_next_y, next_y[M-1:0]}),
    .b_i({!zero_x, x[M-1:0]}), .c_i({P{1'b0}}), .sum_o(sum_b), .carry_o(carry_b));
  reg [P-1:0] sum_a_3, carry_a_3, sum_b_3, carry_b_3, product_a_4, product_b_4;
  reg sign_a_3, sign_b_3, sign_4, subtract_4, swap_4;
  reg [11:0] exponent_a_3, exponent_b_3, exponent_4;
  reg [D-1:0] distance_4;
  wire [12:0] ahead = {1'b0, exponent_a_3} - {1'b0, exponent_b_3};
  wire [12:0] behind = {1'b0, exponent_b_3} - {1'b0, exponent_a_3};
  wire [12:0] distance = ahead[12] ? behind : ahead;
  always @(posedge clk_i) begin
    {sum_a_3, carry_a_3, sum_b_3, carry_b_3} <= {sum_a, carry_a, sum_b, carry_b};
    sign_a_3 <= next_x[BITS-1] ^ y[BITS-1];
    sign_b_3 <= !(next_y[BITS-1] ^ x[BITS-1]);   // it is taken off
    exponent_a_3 <= (zero_next_x || zero_y) ? 12'd0 : {1'b0, next_x[M+:11]} + {1'b0, y[M+:11]};
    exponent_b_3 <= (zero_next_y || zero_x) ? 12'd0 : {1'b0, next_y[M+:11]} + {1'b0, x[M+:11]};
    product_a_4 <= sum_a_3 + carry_a_3;
    product_b_4 <= sum_b_3 + carry_b_3;
    sign_4 <= ahead[12] ? sign_b_3 : sign_a_3;
    subtract_4 <= sign_a_3 ^ sign_b_3;
    swap_4 <= ahead[12];
    exponent_4 <= ahead[12] ? exponent_b_3 : exponent_a_3;
    distance_4 <= (distance > FAR) ? FAR[D-1:0] : distance[D-1:0];
  end

  // ---- 5: the lower one at the place of the other. If it is moved by more than two places, the difference has lost
  // one bit at the most, so what lies behind two more bits only shows that it is there.
  wire [P-1:0] higher = swap_4 ? product_b_4 : product_a_4;
  wire [P-1:0] lower = swap_4 ? product_a_4 : product_b_4;
  wire [2*P+4:0] moved = {lower, {P+5{1'b0}}} >> distance_4;
  // Only there the lower one can be larger.
  wire at_once = distance_4 == {D{1'b0}} && lower > higher;
  wire moved_once = distance_4 == {{D-1{1'b0}}, 1'b1} && {1'b0, lower} > {higher, 1'b0};
  reg [P-1:0] higher_5;
  reg [P+2:0] lower_5;
  reg sign_5, subtract_5, below_5;
  reg [11:0] exponent_5;
  always @(posedge clk_i) begin
    higher_5 <= higher;
    lower_5 <= {moved[2*P+4-:P+2], moved[P+2:0] != {P+3{1'b0}}};
    {subtract_5, exponent_5} <= {subtract_4, exponent_4};
    below_5 <= subtract_4 && (at_once || moved_once);
    sign_5 <= sign_4;
  end

  // ---- 6: their sum, or the size of their difference; 7: its first bit at the top, or next to it; 8: rounded
  wire [W-1:0] larger = below_5 ? {1'b0, lower_5} : {1'b0, higher_5, 3'b000};
  wire [W-1:0] smaller = below_5 ? {1'b0, higher_5, 3'b000} : {1'b0, lower_5};
  reg [W-1:0] sum_6, sum_7;
  reg sign_6, sign_7;
  reg [11:0] exponent_6, exponent_7;
  wire [W-1:0] moved_6;
  localparam integer PLACES_BITS = $clog2(W);
  wire [PLACES_BITS-1:0] places_6;
  reg [PLACES_BITS-1:0] places_7;
  rp_normaliser #(.WIDTH(W), .LEFT(1)) normaliser (.value_i(sum_6), .moved_o(moved_6), .places_o(places_6));
  wire [W-1:0] bits = sum_7[W-1] ? sum_7 : sum_7 << 1;
  wire up = bits[W-33] && (bits[W-32] || bits[W-34:0] != {W-33{1'b0}});
  wire [10:0] exponent = exponent_7[10:0] - {{11-PLACES_BITS{1'b0}}, places_7[PLACES_BITS-1:1], !sum_7[W-1]};
  always @(posedge clk_i) begin
    sum_6 <= larger + (smaller ^ {W{subtract_5}}) + {{W-1{1'b0}}, subtract_5};
    sign_6 <= sign_5 ^ below_5;
    exponent_6 <= exponent_5;
    sum_7 <= moved_6;
    places_7 <= places_6;
    sign_7 <= sign_6;
    exponent_7 <= exponent_6 - 12'd1021;         // a product of two ones has its first bit two places below the top
    product_o <= bits[W-1] ? {sign_7, {exponent, bits[W-2-:31]} + {41'd0, up}} : 43'd0;
  end
  wire unused = &{1'b0, distance[12:D], exponent_7[11], places_7[0]};
endmodule
`default_nettype wire
