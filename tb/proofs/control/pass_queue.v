// @modules pass_queue ram_1r1w
// @proves loses nothing, duplicates nothing, keeps the order: any one entry comes out as it went in, after as many as
//   were before it, and in the same cycle if nothing was
// @proves something is offered if and only if something is in it or comes; what is offered stays until it is taken
// @parameters DEPTH=4
// @parameters DEPTH=3
// @parameters DEPTH=1
// @break pass_queue s/read_i\(more_q && ready_i\)/read_i(more_q \&\& ready_i \&\& !push_i)/
// @break pass_queue s/if \(ready_i \|\| !some_q\) alone_data_q/if (1'b1) alone_data_q/
// @break pass_queue s/alone_taken = some_q && !more_q && push_i/alone_taken = 1'b0/
// @break pass_queue s/some_taken = more_q \|\| \(some_q && push_i\)/some_taken = more_q || push_i/
// @break pass_queue s/if \(ready_i && valid_o\) head_q/if (ready_i \&\& some_q) head_q/
// @break pass_queue s/LAST = DEPTH - 1/LAST = DEPTH - 3/
`default_nettype none
module check #(parameter DEPTH = 4) (input wire clk_i, push_i, ready_i, choose_i, input wire [1:0] data_i);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire valid, passes;
  wire [1:0] data;
  rp_pass_queue #(.WIDTH(2), .DEPTH(DEPTH)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .push_i(push_i), .data_i(data_i), .valid_o(valid), .passes_o(passes),
    .ready_i(ready_i), .data_o(data));

  wire push = rst_n && push_i;
  wire pop = rst_n && valid && ready_i;
  reg [3:0] held_q = 0;
  reg tracked_q = 1'b0, offered_q = 1'b0;
  reg [3:0] before_q = 0;       // entries before the tracked one
  reg [1:0] value_q, data_q;
  wire choose = push && choose_i && !tracked_q && !(pop && held_q == 0);
  always @(posedge clk_i) begin
    held_q <= held_q + push - pop;
    if (choose) begin
      tracked_q <= 1'b1;
      before_q <= held_q - pop;
      value_q <= data_i;
    end else if (tracked_q && pop) begin
      tracked_q <= before_q != 0;
      before_q <= before_q - 1;
    end
    offered_q <= rst_n && valid && !ready_i;
    data_q <= data;
  end
  always @* begin
    assume (!push_i || held_q < DEPTH);
    if (rst_n) begin
      assert (held_q <= DEPTH);
      assert (passes == (held_q == 0));
      assert (valid == (held_q != 0 || push_i));
      assert (!(passes && push_i) || data == data_i);
      assert (!(tracked_q && before_q == 0) || (valid && data == value_q));
      assert (!offered_q || (valid && data == data_q));
    end
  end
endmodule
`default_nettype wire
