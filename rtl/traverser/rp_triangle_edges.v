// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// On which side of a triangle's three edges a ray passes, exactly: the sign of each edge function x_a y_b - y_a x_b
// from its two products, compared and not subtracted: docs/machine/triangle-test.md has the argument. A triangle
// a cycle, its result five moves later. Promises: it moves unless a result is there and is not taken; no output but
// ready_o depends on an input of the same cycle. Must be given: floats that are finite.
`default_nettype none
module rp_triangle_edges (
  input  wire        clk_i,
  input  wire        rst_ni,
  input  wire        valid_i,
  output wire        ready_o,
  input  wire [95:0] x_i,           // of the corners, across the ray: corner 0 first
  input  wire [95:0] y_i,
  output reg         valid_o,
  input  wire        ready_i,
  output reg  [2:0]  negative_o,    // u, v, w, opposite corners 0, 1, 2; u in the lowest bit
  output reg  [2:0]  zero_o,
  output reg         inside_o       // or on the border
);
  localparam integer WIDTH = 24;    // of a significand
  localparam integer PRODUCT = 2 * WIDTH;
  localparam integer UNIT_BITS = 11;  // signed: what a product's last bit weighs, but for a constant

  wire move = !valid_o || ready_i;
  assign ready_o = move;
  reg [3:0] valid_q;
  always @(posedge clk_i)
    if (!rst_ni) {valid_o, valid_q} <= 5'd0;
    else if (move) {valid_o, valid_q} <= {valid_q, valid_i};

  // ---- Stages 1 and 2: significands that begin with a 1, of subnormal numbers too. First by 16 and 8 places.
  wire [191:0] numbers = {y_i, x_i};
  wire [5:0] sign_2, zero_2;
  wire [6*WIDTH-1:0] value_2;
  wire [6*UNIT_BITS-1:0] unit_2;
  genvar n, p, e;
  generate
    for (n = 0; n < 6; n = n + 1) begin : gen_number
      wire [31:0] number = numbers[n*32 +: 32];
      wire normal = number[30:23] != 8'd0;
      reg [WIDTH-1:0] far, far_q, near;
      reg [4:0] distance;
      reg [1:0] far_distance_q;
      reg [7:0] exponent_q;
      integer step;
      always @* begin
        far = {normal, number[22:0]};
        for (step = 4; step >= 3; step = step - 1) begin
          distance[step] = far >> (WIDTH - (1 << step)) == {WIDTH{1'b0}};
          if (distance[step]) far = far << (1 << step);
        end
        near = far_q;
        for (step = 2; step >= 0; step = step - 1) begin
          distance[step] = near >> (WIDTH - (1 << step)) == {WIDTH{1'b0}};
          if (distance[step]) near = near << (1 << step);
        end
      end
      reg sign_1_q, zero_1_q, sign_q, zero_q;
      reg [WIDTH-1:0] value_q;
      reg [UNIT_BITS-1:0] unit_q;
      always @(posedge clk_i)
        if (move) begin
          far_q <= far;
          far_distance_q <= distance[4:3];
          exponent_q <= normal ? number[30:23] : 8'd1;
          sign_1_q <= number[31];
          zero_1_q <= number[30:0] == 31'd0;
          value_q <= near;
          unit_q <= {3'd0, exponent_q} - {6'd0, far_distance_q, distance[2:0]};
          sign_q <= sign_1_q;
          zero_q <= zero_1_q;
        end
      assign sign_2[n] = sign_q;
      assign zero_2[n] = zero_q;
      assign value_2[n*WIDTH +: WIDTH] = value_q;
      assign unit_2[n*UNIT_BITS +: UNIT_BITS] = unit_q;
    end
  endgenerate

  // ---- Stages 3 and 4: of each edge two products, x_a y_b and y_a x_b. x of corner 0 is number 0, y of it number 3.
  localparam [17:0] FIRST = {3'd4, 3'd1, 3'd3, 3'd0, 3'd5, 3'd2};   // of product 0 in the lowest bits
  localparam [17:0] SECOND = {3'd0, 3'd3, 3'd2, 3'd5, 3'd1, 3'd4};
  wire [5:0] sign_4, zero_4;
  wire [6*PRODUCT-1:0] value_4;
  wire [6*UNIT_BITS-1:0] unit_4;
  generate
    for (p = 0; p < 6; p = p + 1) begin : gen_product
      localparam [2:0] A = FIRST[3*p +: 3], B = SECOND[3*p +: 3];
      wire [PRODUCT-1:0] sum, carry;
      rp_multiply_tree #(.A_BITS(WIDTH), .B_BITS(WIDTH), .OUT_BITS(PRODUCT)) multiply_tree (
        .a_i(value_2[A*WIDTH +: WIDTH]), .b_i(value_2[B*WIDTH +: WIDTH]), .c_i({PRODUCT{1'b0}}), .sum_o(sum),
        .carry_o(carry));
      reg sign_3_q, zero_3_q, sign_q, zero_q;
      reg [UNIT_BITS-1:0] unit_3_q, unit_q;
      reg [PRODUCT-1:0] sum_q, carry_q, value_q;
      always @(posedge clk_i)
        if (move) begin
          sign_3_q <= sign_2[A] ^ sign_2[B];
          zero_3_q <= zero_2[A] || zero_2[B];
          unit_3_q <= unit_2[A*UNIT_BITS +: UNIT_BITS] + unit_2[B*UNIT_BITS +: UNIT_BITS];
          sum_q <= sum;
          carry_q <= carry;
          sign_q <= sign_3_q;
          zero_q <= zero_3_q;
          unit_q <= unit_3_q;
          value_q <= sum_q + carry_q;
        end
      assign sign_4[p] = sign_q;
      assign zero_4[p] = zero_q;
      assign unit_4[p*UNIT_BITS +: UNIT_BITS] = unit_q;
      assign value_4[p*PRODUCT +: PRODUCT] = value_q;
    end
  endgenerate

  // ---- Stage 5: a product begins with its first or second bit. Of two with the first bit in one place the exponents
  // decide, and then the bits.
  wire [2:0] negative, zero;
  generate
    for (e = 0; e < 3; e = e + 1) begin : gen_edge
      localparam integer A = 2 * e, B = 2 * e + 1;
      wire [PRODUCT-1:0] value_a = value_4[A*PRODUCT +: PRODUCT], value_b = value_4[B*PRODUCT +: PRODUCT];
      wire long_a = value_a[PRODUCT-1], long_b = value_b[PRODUCT-1];
      wire [UNIT_BITS-1:0] unit_a = unit_4[A*UNIT_BITS +: UNIT_BITS] + {{UNIT_BITS-1{1'b0}}, long_a};
      wire [UNIT_BITS-1:0] unit_b = unit_4[B*UNIT_BITS +: UNIT_BITS] + {{UNIT_BITS-1{1'b0}}, long_b};
      wire [PRODUCT-1:0] bits_a = long_a ? value_a : value_a << 1;
      wire [PRODUCT-1:0] bits_b = long_b ? value_b : value_b << 1;
      // Exponents are signed: with the sign inverted they compare like numbers that are not.
      wire [UNIT_BITS+PRODUCT-1:0] key_a = {!unit_a[UNIT_BITS-1], unit_a[UNIT_BITS-2:0], bits_a};
      wire [UNIT_BITS+PRODUCT-1:0] key_b = {!unit_b[UNIT_BITS-1], unit_b[UNIT_BITS-2:0], bits_b};
      wire equal = sign_4[A] == sign_4[B] && key_a == key_b;
      wire less = (sign_4[A] != sign_4[B]) ? sign_4[A] : sign_4[A] ? key_a > key_b : key_a < key_b;
      // One that is zero has no sign.
      assign zero[e] = zero_4[A] ? zero_4[B] : !zero_4[B] && equal;
      assign negative[e] = zero_4[A] ? !zero_4[B] && !sign_4[B] : zero_4[B] ? sign_4[A] : less;
    end
  endgenerate
  wire [2:0] positive = ~(negative | zero);
  always @(posedge clk_i)
    if (move) begin
      negative_o <= negative;
      zero_o <= zero;
      inside_o <= (negative != 3'd0) != (positive != 3'd0);
    end
endmodule
`default_nettype wire
