// @modules line_offers
// @proves each line that comes is offered until it is taken, once, as it came, and then asked for in the next cycle
// @proves what is older is offered first; there is room for one if and only if fewer than two are there
// @break line_offers s/older_q <= gone\[0\]/older_q <= gone[1]/
// @break line_offers s/else if \(there_q == 2'd0\) older_q <= 1'b0/else if (there_q == 2'd1) older_q <= 1'b1/
// @break line_offers s/older_q \? \{taken_i\[0\], taken_i\[1\]\} : taken_i/taken_i/
// @break line_offers s/gone_q\[1\] \? high_q : low_q/gone_q[0] ? high_q : low_q/
// @break line_offers s/\(there_q \| comes\) & ~gone/(there_q \& ~gone) | (comes \& {2{!(|gone)}})/
`default_nettype none
module check (input wire clk_i, valid_i, choose_i, input wire [1:0] taken_i, input wire [1:0] data_i);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire ready, asked;
  wire [1:0] valid, asked_data;
  wire [3:0] data;
  rp_line_offers #(.WIDTH(2)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .valid_i(valid_i), .ready_o(ready), .data_i(data_i), .valid_o(valid), .data_o(data),
    .taken_i(taken_i), .asked_o(asked), .asked_data_o(asked_data));

  wire push = rst_n && valid_i && ready;
  wire pop = rst_n && |taken_i;
  reg [1:0] held_q = 0;
  reg tracked_q = 1'b0, younger_q, leaves_q = 1'b0, pop_q = 1'b0;   // younger: one is before the tracked one
  reg [1:0] value_q;
  wire choose = push && choose_i && !tracked_q && !leaves_q;
  wire leaves = rst_n && tracked_q && taken_i[younger_q];
  always @(posedge clk_i) begin
    held_q <= held_q + push - pop;
    pop_q <= pop;
    leaves_q <= leaves;
    if (choose) begin
      tracked_q <= 1'b1;
      younger_q <= held_q != 2'd0 && !pop;
      value_q <= data_i;
    end else if (tracked_q && pop) begin
      tracked_q <= !leaves;
      younger_q <= 1'b0;
    end
  end
  always @* begin
    assume ((taken_i & ~valid) == 2'd0 && taken_i != 2'b11);
    if (rst_n) begin
      assert (ready == (held_q < 2));
      assert (valid == {held_q == 2, held_q != 0});
      assert (asked == pop_q);
      if (tracked_q) assert (valid[younger_q] && data[2*younger_q +: 2] == value_q);
      if (leaves_q) assert (asked && asked_data == value_q);
    end
  end
endmodule
`default_nettype wire
