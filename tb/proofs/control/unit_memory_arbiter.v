// @modules unit_memory_arbiter port_arbiter round_robin
// @zeros
// @slow
// @proves a request at the memory port is that of exactly one unit, unchanged, its id grown by the unit's
//   number, and stays until it is taken
// @proves a request that stays is taken after UNITS - 1 others at most; the port is not idle while a unit asks
// @proves a response goes to the unit that its id names, and to no other
// @parameters UNITS=2
// @parameters UNITS=4
// @break unit_memory_arbiter s/response_unit_i == UNIT/response_unit_i >= UNIT/
// @break unit_memory_arbiter s/unit_request_mask_i\[u\*4 \+: 4\]/4'hF/
// @break port_arbiter s/locked_q \? choice_q : next/next/
// @break round_robin s/\|behind \? first_behind : first/first/
`default_nettype none
module check #(parameter UNITS = 4) (
  input wire clk_i, ready_i, response_i, input wire [1:0] response_unit_i,
  input wire [UNITS-1:0] valid_i, write_i, input wire [UNITS*32-1:0] address_i, input wire [UNITS*128-1:0] quad_i,
  input wire [UNITS*4-1:0] mask_i, input wire [UNITS*5-1:0] id_i
);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [UNITS-1:0] ready, response;
  wire valid, write;
  wire [31:0] address;
  wire [127:0] quad;
  wire [3:0] mask;
  wire [6:0] id;
  rp_unit_memory_arbiter #(.UNITS(UNITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .unit_request_valid_i(valid_i), .unit_request_ready_o(ready),
    .unit_request_write_i(write_i), .unit_request_address_i(address_i), .unit_request_data_i(quad_i),
    .unit_request_mask_i(mask_i), .unit_request_id_i(id_i), .unit_response_valid_o(response), .request_valid_o(valid),
    .request_ready_i(ready_i), .request_write_o(write), .request_address_o(address), .request_data_o(quad),
    .request_mask_o(mask), .request_id_o(id), .response_valid_i(response_i), .response_unit_i(response_unit_i));

  (* anyconst *) wire [1:0] waiter;
  wire [1:0] unit = id[6:5];
  wire taken = rst_n && valid && ready_i;
  wire asks = rst_n && valid_i[waiter] && !(taken && unit == waiter);
  reg [2:0] passed_q = 0;
  reg [UNITS-1:0] waiting_q = 0;
  reg [UNITS-1:0] bits_q;
  reg offered_q = 1'b0, offer_q;
  reg [1:0] unit_q;
  // Any one bit of the requests stands for all.
  (* anyconst *) wire [7:0] number;
  wire [169:0] offer = {write, address, quad, mask, id[4:0]};
  reg [UNITS-1:0] bits;
  integer u, b;
  always @* for (b = 0; b < UNITS; b = b + 1) bits[b] = requests[b*170 + number];
  wire [UNITS*170-1:0] requests;
  genvar g;
  generate
    for (g = 0; g < UNITS; g = g + 1) begin : gen_unit
      assign requests[g*170 +: 170] = {write_i[g], address_i[g*32 +: 32], quad_i[g*128 +: 128], mask_i[g*4 +: 4],
                                       id_i[g*5 +: 5]};
    end
  endgenerate
  always @(posedge clk_i) begin
    passed_q <= asks ? passed_q + taken : 0;
    waiting_q <= rst_n ? valid_i & ~ready : 0;
    bits_q <= bits;
    offered_q <= rst_n && valid && !ready_i;
    offer_q <= offer[number];
    unit_q <= unit;
  end
  always @* begin
    assume (waiter < UNITS && number < 170);
    for (u = 0; u < UNITS; u = u + 1) assume (!waiting_q[u] || (valid_i[u] && bits[u] == bits_q[u]));
    if (rst_n) begin
      assert (valid == |valid_i);
      for (u = 0; u < UNITS; u = u + 1) begin
        assert ((valid_i[u] && ready[u]) == (taken && unit == u));
        assert (!(valid && unit == u) || offer == requests[u*170 +: 170]);
        assert (response[u] == (response_i && response_unit_i == u));
      end
      assert (!valid || (unit < UNITS && valid_i[unit]));
      assert (!offered_q || (valid && offer[number] == offer_q && unit == unit_q));
      assert (!(asks && taken && passed_q == UNITS - 1));
    end
  end
endmodule
`default_nettype wire
