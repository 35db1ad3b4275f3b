// On which side of a triangle's three edges a ray passes, exactly: the sign of each edge function x_a y_b - y_a x_b
// from its two products, which are compared and not subtracted. docs/traverser.md has the argument. A triangle a cycle,
// its result four moves later.
// Promises: it moves unless a result is there that nobody takes; no output but ready_o depends on an input of the same
// cycle. Must be given: floats that are finite.
`default_nettype none
module triangle_edges (
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
  reg [2:0] valid_q;
  always @(posedge clk_i)
    if (!rst_ni) {valid_o, valid_q} <= 4'd0;
    else if (move) {valid_o, valid_q} <= {valid_q, valid_i};

  // ---- Stage 1: significands whose first bit is 1, of subnormal numbers too.
  wire [191:0] numbers = {y_i, x_i};
  wire [5:0] sign_1, zero_1;
  wire [6*WIDTH-1:0] value_1;
  wire [6*UNIT_BITS-1:0] unit_1;
  genvar n, p, e;
  generate
    for (n = 0; n < 6; n = n + 1) begin : gen_number
      wire [31:0] number = numbers[n*32 +: 32];
      wire normal = number[30:23] != 8'd0;
      reg [WIDTH-1:0] shifted;
      reg [4:0] distance;
      integer step;
      always @* begin
        shifted = {normal, number[22:0]};
        distance = 5'd0;
        for (step = 4; step >= 0; step = step - 1)
          if (shifted >> (WIDTH - (1 << step)) == {WIDTH{1'b0}}) begin
            shifted = shifted << (1 << step);
            distance[step] = 1'b1;
          end
      end
      reg sign_q, zero_q;
      reg [WIDTH-1:0] value_q;
      reg [UNIT_BITS-1:0] unit_q;
      always @(posedge clk_i)
        if (move) begin
          sign_q <= number[31];
          zero_q <= number[30:0] == 31'd0;
          value_q <= shifted;
          unit_q <= {3'd0, normal ? number[30:23] : 8'd1} - {6'd0, distance};
        end
      assign sign_1[n] = sign_q;
      assign zero_1[n] = zero_q;
      assign value_1[n*WIDTH +: WIDTH] = value_q;
      assign unit_1[n*UNIT_BITS +: UNIT_BITS] = unit_q;
    end
  endgenerate

  // ---- Stages 2 and 3: of each edge two products, x_a y_b and y_a x_b. x of corner 0 is number 0, y of it number 3.
  localparam [17:0] FIRST = {3'd4, 3'd1, 3'd3, 3'd0, 3'd5, 3'd2};   // of product 0 in the lowest bits
  localparam [17:0] SECOND = {3'd0, 3'd3, 3'd2, 3'd5, 3'd1, 3'd4};
  wire [5:0] sign_3, zero_3;
  wire [6*PRODUCT-1:0] value_3;
  wire [6*UNIT_BITS-1:0] unit_3;
  generate
    for (p = 0; p < 6; p = p + 1) begin : gen_product
      localparam [2:0] A = FIRST[3*p +: 3], B = SECOND[3*p +: 3];
      wire [PRODUCT-1:0] sum, carry;
      multiply_tree #(.A_BITS(WIDTH), .B_BITS(WIDTH), .OUT_BITS(PRODUCT)) multiply_tree (
        .a_i(value_1[A*WIDTH +: WIDTH]), .b_i(value_1[B*WIDTH +: WIDTH]), .c_i({PRODUCT{1'b0}}), .sum_o(sum),
        .carry_o(carry));
      reg sign_2_q, zero_2_q, sign_q, zero_q;
      reg [UNIT_BITS-1:0] unit_2_q, unit_q;
      reg [PRODUCT-1:0] sum_q, carry_q, value_q;
      always @(posedge clk_i)
        if (move) begin
          sign_2_q <= sign_1[A] ^ sign_1[B];
          zero_2_q <= zero_1[A] || zero_1[B];
          unit_2_q <= unit_1[A*UNIT_BITS +: UNIT_BITS] + unit_1[B*UNIT_BITS +: UNIT_BITS];
          sum_q <= sum;
          carry_q <= carry;
          sign_q <= sign_2_q;
          zero_q <= zero_2_q;
          unit_q <= unit_2_q;
          value_q <= sum_q + carry_q;
        end
      assign sign_3[p] = sign_q;
      assign zero_3[p] = zero_q;
      assign unit_3[p*UNIT_BITS +: UNIT_BITS] = unit_q;
      assign value_3[p*PRODUCT +: PRODUCT] = value_q;
    end
  endgenerate

  // ---- Stage 4: a product begins with its first or second bit. Of two with the first bit in one place the exponents
  // decide, and then the bits.
  wire [2:0] negative, zero;
  generate
    for (e = 0; e < 3; e = e + 1) begin : gen_edge
      localparam integer A = 2 * e, B = 2 * e + 1;
      wire [PRODUCT-1:0] value_a = value_3[A*PRODUCT +: PRODUCT], value_b = value_3[B*PRODUCT +: PRODUCT];
      wire long_a = value_a[PRODUCT-1], long_b = value_b[PRODUCT-1];
      wire [UNIT_BITS-1:0] unit_a = unit_3[A*UNIT_BITS +: UNIT_BITS] + {{UNIT_BITS-1{1'b0}}, long_a};
      wire [UNIT_BITS-1:0] unit_b = unit_3[B*UNIT_BITS +: UNIT_BITS] + {{UNIT_BITS-1{1'b0}}, long_b};
      wire [PRODUCT-1:0] bits_a = long_a ? value_a : value_a << 1;
      wire [PRODUCT-1:0] bits_b = long_b ? value_b : value_b << 1;
      // Exponents are signed: with the sign inverted they compare like numbers that are not.
      wire [UNIT_BITS+PRODUCT-1:0] key_a = {!unit_a[UNIT_BITS-1], unit_a[UNIT_BITS-2:0], bits_a};
      wire [UNIT_BITS+PRODUCT-1:0] key_b = {!unit_b[UNIT_BITS-1], unit_b[UNIT_BITS-2:0], bits_b};
      wire equal = sign_3[A] == sign_3[B] && key_a == key_b;
      wire less = (sign_3[A] != sign_3[B]) ? sign_3[A] : sign_3[A] ? key_a > key_b : key_a < key_b;
      // One that is zero has no sign.
      assign zero[e] = zero_3[A] ? zero_3[B] : !zero_3[B] && equal;
      assign negative[e] = zero_3[A] ? !zero_3[B] && !sign_3[B] : zero_3[B] ? sign_3[A] : less;
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
