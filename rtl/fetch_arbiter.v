// Grants one of the requesting warps a cycle, in rotation: the search starts behind the warp granted last, so that every request is
// granted within WARPS cycles.
`default_nettype none
module fetch_arbiter #(
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = 3
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  input  wire [WARPS-1:0]     request_i,
  output wire [WARPS-1:0]     grant_o,   // one-hot, or zero without a request
  output wire                 valid_o,
  output reg  [WARP_BITS-1:0] warp_o
);
  integer w;
  assign valid_o = |request_i;

  round_robin #(.COUNT(WARPS)) round_robin (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(request_i), .advance_i(1'b1), .grant_o(grant_o));

  always @* begin
    warp_o = {WARP_BITS{1'b0}};
    for (w = 0; w < WARPS; w = w + 1)
      if (grant_o[w]) warp_o = w[WARP_BITS-1:0];
  end
endmodule
`default_nettype wire
