// @modules fetch_arbiter round_robin
// @proves grants one warp if one asks, only one that asks, and names it
// @proves a request that has precedence is granted at once
// @proves every request that stays is granted within WARPS cycles, those not counted in which another has precedence
// @parameters WARPS=8 WARP_BITS=3
// @parameters WARPS=4 WARP_BITS=2
// @break fetch_arbiter s/advance_i\(!\(\|first\)\)/advance_i(1'b0)/
// @break fetch_arbiter s/advance_i\(!\(\|first\)\)/advance_i(1'b1)/
// @break fetch_arbiter s/\|first \? first : turn/turn/
// @break fetch_arbiter s/if \(grant_o\[w\]\)/if (request_i[w])/
// @break round_robin s/ \| \(grant_o - ONE\)//
`default_nettype none
module check #(parameter WARPS = 8, WARP_BITS = 3) (
  input wire clk_i, input wire [WARPS-1:0] request_i, input wire first_valid_i, input wire [WARP_BITS-1:0] first_i);
  localparam [WARPS-1:0] ONE = 1;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [WARPS-1:0] first = first_valid_i ? ONE << first_i : 0;
  wire [WARPS-1:0] grant;
  wire valid;
  wire [WARP_BITS-1:0] warp;
  rp_fetch_arbiter #(.WARPS(WARPS), .WARP_BITS(WARP_BITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .request_i(request_i), .first_i(first), .grant_o(grant), .valid_o(valid),
    .warp_o(warp));

  (* anyconst *) wire [WARP_BITS-1:0] waiter;
  wire waits = rst_n && request_i[waiter] && !grant[waiter];
  reg [WARP_BITS-1:0] waited_q = 0;   // cycles
  wire precedence = |(request_i & first);
  always @(posedge clk_i) waited_q <= !waits ? 0 : precedence ? waited_q : waited_q + 1'b1;
  always @*
    if (rst_n) begin
      assert (valid == |request_i);
      assert (grant == (valid ? ONE << warp : 0));
      assert ((grant & ~request_i) == 0);
      assert (!precedence || grant == first);
      assert (!(waits && !precedence && waited_q == WARPS - 1));
    end
endmodule
`default_nettype wire
