// @long 8
// @modules import_arbiter port_arbiter round_robin request_queue
// @proves a request at the pool's port is that of exactly one unit, and stays until it is
//   taken; at most 3 packages are awaited
// @proves the beats of any one package, 6 or 4, go to the unit that asked for it, and to no other:
//   nothing lost, nothing twice, order kept
// @proves a request that stays is taken after UNITS - 1 others at most
// @parameters UNITS=4
// @parameters UNITS=2
// @parameters UNITS=2 INTERSECTION_WORDS=16
// @break import_arbiter s/count != PLACES\[1:0\]/1'b1/
// @break import_arbiter s/\/ 4 - 1;/\/ 4 - 2;/
// @break import_arbiter s/beat && receiver == UNIT/beat_valid_i \&\& request_unit_o == UNIT/
// @break request_queue s/if \(pop\) entries_q/if (pop \&\& !push_i) entries_q/
// @break round_robin s/\|behind \? first_behind : first/first/
`default_nettype none
module check #(parameter UNITS = 4, INTERSECTION_WORDS = 21) (
  input wire clk_i, ready_i, beat_i, choose_i, input wire [UNITS-1:0] request_i, input wire [UNITS*2-1:0] kind_i);
  localparam BEATS = INTERSECTION_WORDS == 16 ? 4 : 6;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [UNITS-1:0] ready, beats;
  wire valid;
  wire [1:0] kind, unit;
  rp_import_arbiter #(.UNITS(UNITS), .INTERSECTION_WORDS(INTERSECTION_WORDS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .unit_request_valid_i(request_i), .unit_request_ready_o(ready),
    .unit_request_kind_i(kind_i), .unit_beat_valid_o(beats), .request_valid_o(valid), .request_ready_i(ready_i),
    .request_kind_o(kind), .request_unit_o(unit), .beat_valid_i(beat_i));

  wire taken = rst_n && valid && ready_i;
  wire beat = rst_n && beat_i;
  reg [4:0] awaited_q = 0;      // beats of requests taken
  reg tracked_q = 1'b0;
  reg [4:0] before_q = 0;       // beats before the tracked package's first
  reg [2:0] left_q = 0;         // beats of the tracked package
  reg [1:0] unit_q;
  wire choose = taken && choose_i && !tracked_q;
  wire own = tracked_q && before_q == 0;
  reg [UNITS-1:0] waiting_q = 0;
  reg [UNITS*2-1:0] kinds_q;
  reg offered_q = 1'b0;
  reg [1:0] offered_kind_q, offered_unit_q;
  (* anyconst *) wire [1:0] waiter;
  wire asks = rst_n && request_i[waiter] && !(taken && unit == waiter);
  reg [2:0] passed_q = 0;
  always @(posedge clk_i) begin
    awaited_q <= awaited_q + (taken ? BEATS : 0) - beat;
    if (choose) begin
      tracked_q <= 1'b1;
      before_q <= awaited_q - beat;
      left_q <= BEATS;
      unit_q <= unit;
    end else if (beat && own) begin
      left_q <= left_q - 1;
      tracked_q <= left_q != 1;
    end else if (beat && tracked_q) before_q <= before_q - 1;
    waiting_q <= rst_n ? request_i & ~ready : 0;
    kinds_q <= kind_i;
    offered_q <= rst_n && valid && !ready_i;
    offered_kind_q <= kind;
    offered_unit_q <= unit;
    passed_q <= asks ? passed_q + taken : 0;
  end

  integer u;
  always @* begin
    assume (waiter < UNITS);
    assume (!beat_i || awaited_q != 0);
    for (u = 0; u < UNITS; u = u + 1) assume (!waiting_q[u] || (request_i[u] && kind_i[u*2 +: 2] == kinds_q[u*2 +: 2]));
    if (rst_n) begin
      assert (awaited_q <= 3 * BEATS);
      assert (!valid || (unit < UNITS && request_i[unit] && kind == kind_i[unit*2 +: 2]));
      for (u = 0; u < UNITS; u = u + 1) assert ((request_i[u] && ready[u]) == (taken && unit == u));
      assert (!offered_q || (valid && kind == offered_kind_q && unit == offered_unit_q));
      assert ((beats & (beats - 1'b1)) == 0 && |beats == beat_i);
      assert (!(own && beat) || beats[unit_q]);
      assert (!(asks && taken && passed_q == UNITS - 1));
      assert (awaited_q > 2 * BEATS || valid == |request_i);
    end
  end
endmodule
`default_nettype wire
