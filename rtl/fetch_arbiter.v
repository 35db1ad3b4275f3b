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
  output reg  [WARPS-1:0]     grant_o,   // one-hot, or zero without a request
  output reg                  valid_o,
  output reg  [WARP_BITS-1:0] warp_o
);
  reg [WARPS-1:0] behind_q;  // the warps behind the one granted last
  reg [WARPS-1:0] candidates;
  integer w;
  localparam [WARPS-1:0] ONE = 1;

  always @* begin
    grant_o = {WARPS{1'b0}};
    valid_o = 1'b0;
    warp_o = {WARP_BITS{1'b0}};
    candidates = |(request_i & behind_q) ? (request_i & behind_q) : request_i;
    if (|request_i) begin
      valid_o = 1'b1;
      grant_o = candidates & (~candidates + ONE);
      for (w = 0; w < WARPS; w = w + 1)
        if (grant_o[w]) warp_o = w[WARP_BITS-1:0];
    end
  end

  always @(posedge clk_i)
    if (!rst_ni) behind_q <= {WARPS{1'b1}};
    else if (valid_o) behind_q <= ~(grant_o | (grant_o - ONE));
endmodule
`default_nettype wire
