// @modules port_arbiter round_robin
// @proves a transfer at the port is that of exactly one requester, with its data
// @proves what is offered stays until it is taken; packages are never mixed
// @proves the port is not idle while a requester asks and no package is under way
// @proves a requester that keeps asking is served before any other is served twice, after COUNT - 1 packages of others
//   at most
// @parameters COUNT=4
// @parameters COUNT=3
// @parameters COUNT=2
// @break port_arbiter s/locked_q \? choice_q : next/next/
// @break port_arbiter s/locked_q <= !\(ready_i && \|\(last_i & grant\)\)/locked_q <= !ready_i/
// @break port_arbiter s/grant & \{COUNT\{ready_i\}\}/valid_i \& {COUNT{ready_i}}/
// @break port_arbiter s/number_o = n\[1:0\]/number_o = n[1:0] ^ 2'd1/
// @break round_robin s/\|behind \? first_behind : first/first/
`default_nettype none
module check #(parameter COUNT = 4) (input wire clk_i, ready_i, input wire [COUNT-1:0] valid_i, last_i,
                                     input wire [COUNT*2-1:0] data_i);
  reg rst_n = 1'b0, seen_q = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [COUNT-1:0] ready;
  wire valid;
  wire [1:0] data, number;
  rp_port_arbiter #(.COUNT(COUNT), .WIDTH(2)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .valid_i(valid_i), .ready_o(ready), .data_i(data_i), .last_i(last_i),
    .valid_o(valid), .ready_i(ready_i), .data_o(data), .number_o(number));

  // The cycle before
  reg offered_q = 1'b0;
  reg [1:0] data_q, number_q;
  reg [COUNT-1:0] waiting_q = 0, last_q;
  reg [COUNT*2-1:0] requests_q;
  wire taken = rst_n && valid && ready_i;
  wire last = last_i[number];
  reg open_q = 1'b0;            // a package is under way
  reg [1:0] owner_q;
  always @(posedge clk_i) begin
    offered_q <= rst_n && valid && !ready_i;
    data_q <= data;
    number_q <= number;
    waiting_q <= rst_n ? valid_i & ~ready : 0;
    last_q <= last_i;
    requests_q <= data_i;
    if (taken) begin
      open_q <= !last;
      owner_q <= number;
    end
  end

  (* anyconst *) wire [1:0] waiter;
  (* anyconst *) wire [1:0] other;
  wire asks = rst_n && valid_i[waiter] && !ready[waiter] && !(open_q && owner_q == waiter);
  wire other_begins = taken && !open_q && number == other;
  wire package_ends = taken && last;
  reg begun_q = 1'b0;
  reg [2:0] ended_q = 0;        // packages of others, while the waiter asks
  always @(posedge clk_i) begin
    begun_q <= asks && (begun_q || other_begins);
    ended_q <= asks ? ended_q + package_ends : 0;
  end

  integer r;
  always @* begin
    assume (waiter < COUNT && other < COUNT && waiter != other);
    for (r = 0; r < COUNT; r = r + 1)
      assume (!waiting_q[r] || (valid_i[r] && last_i[r] == last_q[r] && data_i[r*2 +: 2] == requests_q[r*2 +: 2]));
    if (rst_n) begin
      assert (!valid || (number < COUNT && valid_i[number] && data == data_i[number*2 +: 2]));
      for (r = 0; r < COUNT; r = r + 1) assert ((valid_i[r] && ready[r]) == (taken && number == r));
      assert (!offered_q || (valid && data == data_q && number == number_q));
      assert (!(open_q && valid) || number == owner_q);
      assert (open_q || valid == |valid_i);
      assert (!(asks && begun_q && other_begins));
      assert (!(asks && package_ends && ended_q == COUNT - 1));
    end
  end
endmodule
`default_nettype wire
