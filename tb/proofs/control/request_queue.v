// @modules request_queue
// @proves loses nothing, duplicates nothing, keeps the order: any one entry comes out as it went in,
//   after as many others as were before it
// @proves count_o is what went in less what came out; what is offered stays until it is taken
// @parameters DEPTH=3
// @parameters DEPTH=2
// @parameters DEPTH=1
// @break request_queue s/wire \[1:0\] place = .*/wire [1:0] place = count_q;/
// @break request_queue s/if \(pop\) entries_q/if (pop \&\& !push_i) entries_q/
// @break request_queue s/count_q <= place \+ .*/count_q <= pop ? place : place + {1'b0, push_i};/
`default_nettype none
module check #(parameter DEPTH = 3) (input wire clk_i, push_i, ready_i, choose_i, input wire [3:0] data_i);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire valid;
  wire [3:0] data;
  wire [1:0] count;
  rp_request_queue #(.WIDTH(4), .DEPTH(DEPTH)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .push_i(push_i), .data_i(data_i), .valid_o(valid), .ready_i(ready_i), .data_o(data),
    .count_o(count));

  wire push = rst_n && push_i;
  wire pop = rst_n && valid && ready_i;
  reg [2:0] held_q = 0;
  reg tracked_q = 1'b0, offered_q = 1'b0;
  reg [2:0] before_q = 0;       // entries before the tracked one
  reg [3:0] value_q, data_q;
  wire choose = push && choose_i && !tracked_q;
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
    assume (!push_i || count < DEPTH);
    if (rst_n) begin
      assert (count == held_q && held_q <= DEPTH);
      assert (valid == (held_q != 0));
      assert (!(tracked_q && before_q == 0) || (valid && data == value_q));
      assert (!offered_q || (valid && data == data_q));
    end
  end
endmodule
`default_nettype wire
