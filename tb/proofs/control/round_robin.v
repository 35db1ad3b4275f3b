// @modules round_robin
// @proves chooses one requester if there is one, and only a requester
// @proves a requester that keeps asking is chosen before any other is chosen twice, so after COUNT - 1 others at most
// @parameters COUNT=4
// @parameters COUNT=7
// @parameters COUNT=1
// @break round_robin s/ \| \(grant_o - ONE\)//
// @break round_robin s/\|behind \? first_behind : first/first/
// @break round_robin s/\(~request_i \+ ONE\)/~(request_i << 1)/
// @break round_robin s/\(~behind \+ ONE\)/~(behind << 1)/
`default_nettype none
module check #(parameter COUNT = 4) (input wire clk_i, advance_i, input wire [COUNT-1:0] request_i);
  localparam [COUNT-1:0] NONE = 0, ONE = 1;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [COUNT-1:0] grant;
  rp_round_robin #(.COUNT(COUNT)) dut (.clk_i(clk_i), .rst_ni(rst_n), .request_i(request_i), .advance_i(advance_i),
                                    .grant_o(grant));

  (* anyconst *) wire [3:0] waiter;
  (* anyconst *) wire [3:0] other;
  wire asks = request_i[waiter] && rst_n;
  wire passed = asks && advance_i && !grant[waiter];
  wire other_chosen = advance_i && grant[other];
  reg chosen_q = 1'b0;
  reg [3:0] passed_q = 4'd0;
  always @(posedge clk_i) begin
    chosen_q <= passed && (chosen_q || other_chosen);
    passed_q <= passed ? passed_q + 4'd1 : asks && !advance_i ? passed_q : 4'd0;
    if (asks && !advance_i) chosen_q <= chosen_q;
  end
  always @* begin
    assume (waiter < COUNT && other < COUNT && waiter != other || COUNT == 1 && waiter == 0 && other == 0);
    if (rst_n) begin
      assert ((grant & (grant - ONE)) == NONE);
      assert ((grant & ~request_i) == NONE);
      assert ((grant == NONE) == (request_i == NONE));
      assert (!(passed && chosen_q && other_chosen));
      assert (!(passed && passed_q >= COUNT - 1));
    end
  end
endmodule
`default_nettype wire
