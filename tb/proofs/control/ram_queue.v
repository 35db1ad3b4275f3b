// @modules ram_queue ram_1r1w
// @proves loses nothing, duplicates nothing, keeps the order: any one entry comes out as it went in, after as many as
//   were before it
// @proves something is offered if and only if something is in it; what is offered stays until it is taken
// @parameters DEPTH=4
// @parameters DEPTH=3
// @parameters DEPTH=1
// @break ram_queue s/read_i\(pop \? more_q : fresh_q\)/read_i(pop \? more_q \&\& !push_i : fresh_q)/
// @break ram_queue s/read_i\(pop \? more_q : fresh_q\)/read_i(pop \&\& more_q)/
// @break ram_queue s/push_i && \(pop \? !more_q : !some_q\)/push_i \&\& !some_q/
// @break ram_queue s/pop \? behind_head : head_q/behind_head/
// @break ram_queue s/push_i \? more_q : many/push_i \? more_q : more_q/
// @break ram_queue s/some_q <= push_i \|\| \(pop \? more_q : some_q\)/some_q <= pop \? more_q : push_i || some_q/
// @break ram_queue s/LAST = DEPTH - 1/LAST = DEPTH - 3/
`default_nettype none
module check #(parameter DEPTH = 4) (input wire clk_i, push_i, ready_i, choose_i, input wire [1:0] data_i);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire valid;
  wire [1:0] data;
  rp_ram_queue #(.WIDTH(2), .DEPTH(DEPTH)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .push_i(push_i), .data_i(data_i), .valid_o(valid), .ready_i(ready_i), .data_o(data));

  wire push = rst_n && push_i;
  wire pop = rst_n && valid && ready_i;
  reg [3:0] held_q = 0;
  reg tracked_q = 1'b0, offered_q = 1'b0;
  reg [3:0] before_q = 0;       // entries before the tracked one
  reg [1:0] value_q, data_q;
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
    assume (!push_i || held_q < DEPTH);
    if (rst_n) begin
      assert (held_q <= DEPTH);
      assert (valid == (held_q != 0));
      assert (!(tracked_q && before_q == 0) || (valid && data == value_q));
      assert (!offered_q || (valid && data == data_q));
    end
  end
endmodule
`default_nettype wire
