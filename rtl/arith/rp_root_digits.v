// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The root of a number of 2 + 4 * DIGITS bits, of which the first two are not both zero, cut off: 1 + 2 * DIGITS bits,
// DIGITS cycles after it is taken. It takes a number in three cycles: each block finds three digits 0 .. 3, one in a
// cycle, and hands on what is left. Of four times a root so far, a digit takes off 8 d root + d d.
`default_nettype none
module rp_root_digits #(
  parameter integer DIGITS = 15,                 // a multiple of three
  parameter integer BLOCKS = DIGITS / 3
) (
  input  wire                clk_i,
  input  wire [BLOCKS-1:0]   take_i,             // bit b: the number is with block b for three cycles
  input  wire [4*DIGITS+1:0] value_i,
  output wire [2*DIGITS:0]   root_o              // as block BLOCKS would be given it
);
  generate
    if (DIGITS % 3 != 0) begin : gen_bad_digits
      root_digits_DIGITS_must_be_a_multiple_of_three illegal ();
    end
  endgenerate
  genvar b;
  generate
    for (b = 0; b < BLOCKS; b = b + 1) begin : gen_block
      // Bits at its end: of the root, of what is left, which is up to twice the root, and of what has not been looked
      // at, but for the next four.
      localparam integer Q = 6*b + 7, R = 6*b + 8, V = 4*DIGITS - 12*b - 4;
      wire [Q-7:0] given_root;
      wire [R-7:0] given_left;
      wire [V+3:0] given_value;
      if (b == 0) begin : gen_first
        assign given_root = 1'b1;
        assign given_left = value_i[4*DIGITS+1-:2] - 2'd1;
        assign given_value = value_i[0+:4*DIGITS];
      end else begin : gen_next
        assign given_root = gen_block[b-1].root_q;
        assign given_left = gen_block[b-1].left_q;
        assign given_value = gen_block[b-1].value_q[V+11-:V+4];
      end
      reg [Q-1:0] root_q;
      reg [R-1:0] left_q;
      reg [V-1:0] value_q;
      wire [Q-3:0] root = take_i[b] ? {4'd0, given_root} : root_q[Q-3:0];
      wire [R+1:0] left = take_i[b] ? {4'd0, given_left, given_value[V+3-:4]} : {left_q[R-3:0], value_q[V-1-:4]};
      wire [R+2:0] less_one = {1'b0, left} - {3'd0, root, 3'b001};
      wire [R+2:0] less_two = {1'b0, left} - {2'd0, root, 4'b0100};
      wire [R+2:0] less_three = {1'b0, left} - {2'd0, root, 4'b1001} - {3'd0, root, 3'b000};
      wire three = !less_three[R+2], two = !less_two[R+2], one = !less_one[R+2];
      always @(posedge clk_i) begin
        root_q <= {root, three || two, three || (!two && one)};
        left_q <= three ? less_three[R-1:0] : two ? less_two[R-1:0] : one ? less_one[R-1:0] : left[R-1:0];
        value_q <= take_i[b] ? given_value[V-1:0] : {value_q[V-5:0], 4'd0};
      end
      wire unused = &{1'b0, left_q};             // of the last block
    end
  endgenerate
  assign root_o = gen_block[BLOCKS-1].root_q;
endmodule
`default_nettype wire
