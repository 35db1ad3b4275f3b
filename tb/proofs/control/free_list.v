// @long 10
// @modules free_list ram_queue ram_1r1w
// @proves a number is offered if and only if one is free; it is below SIZE, and not in use
// @proves a number that has come back is offered again after SIZE - 1 others at most
// @parameters SIZE=4
// @parameters SIZE=3
// @parameters SIZE=1
// @break free_list s/used_q != SIZE\[COUNT_BITS-1:0\]/used_q <= SIZE[COUNT_BITS-1:0]/
// @break free_list s/ready_i && !unused_left\)/ready_i)/
// @break free_list s/if \(ready_i && unused_left\)/if (ready_i)/
// @break free_list s/push_i\(free_i\)/push_i(free_i \&\& !ready_i)/
// @break ram_queue s/push_i && \(pop \? !more_q : !some_q\)/push_i \&\& !some_q/
`default_nettype none
module check #(parameter SIZE = 4, parameter BITS = SIZE > 1 ? $clog2(SIZE) : 1) (
  input wire clk_i, ready_i, free_i, input wire [BITS-1:0] number_i);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire valid;
  wire [BITS-1:0] number;
  rp_free_list #(.SIZE(SIZE)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .valid_o(valid), .ready_i(ready_i), .number_o(number), .free_i(free_i),
    .free_number_i(number_i));

  reg [SIZE-1:0] taken_q = 0;
  wire take = rst_n && valid && ready_i;
  wire back = rst_n && free_i;
  (* anyconst *) wire [BITS-1:0] watched;
  reg [3:0] others_q = 0;       // taken since it came back
  reg waits_q = 1'b0;
  always @(posedge clk_i) begin
    if (back) taken_q[number_i] <= 1'b0;
    if (take) taken_q[number] <= 1'b1;
    if (back && number_i == watched) begin
      waits_q <= 1'b1;
      others_q <= 0;
    end else if (take && number == watched) waits_q <= 1'b0;
    else if (take) others_q <= others_q + 1;
  end
  always @* begin
    assume (!ready_i || valid);
    assume (!free_i || (number_i < SIZE && taken_q[number_i]));
    assume (watched < SIZE);
    if (rst_n) begin
      assert (valid == (taken_q != {SIZE{1'b1}}));
      assert (!valid || (number < SIZE && !taken_q[number]));
      assert (!(waits_q && take && number != watched && others_q == SIZE - 1));
    end
  end
endmodule
`default_nettype wire
