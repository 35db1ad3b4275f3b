// @long 20
// @modules bank_arbiter
// @proves of a lane one want is taken at most, one that it has, of a bank that is ready, and none of a silent lane
// @proves a bank that is ready looks up a line if and only if a want of it is taken; all that are taken there are of
//   this line, for just the lanes with rays that wait for it, with their slots
// @proves a lane takes its first want if its bank looks up that line; it takes its second one likewise, unless the
//   first one is taken
// @proves a first want that stays is taken when its bank has been ready LANES times at the latest, if its lane is not
//   silent meanwhile
// @parameters LANES=3 BANKS=2
// @parameters LANES=4 BANKS=2
// @parameters LANES=2 BANKS=4
// @parameters LANES=3 BANKS=1
// @break bank_arbiter s/behind_q\[k\] \|\| !behind_q\[l\]/1'b1/
// @break bank_arbiter s/if \(ready_i\[b\] && \|asks\)/if (|asks)/
// @break bank_arbiter s/&& !first_taken\[l\], first_taken\[l\]\}/, first_taken[l]}/
// @break bank_arbiter s/\(matches\[b\*WANTS\+2\*l\+1\] && !first_taken\[l\]\)/matches[b*WANTS+2*l+1]/
// @break bank_arbiter s/first\[b\] \? 2\*l : 2\*l\+1/first_taken[l] ? 2*l+1 : 2*l/
// @break bank_arbiter s/&& !silent_i\[i\/2\] //
// @break bank_arbiter s/wire first = want_valid_i\[2\*l\] && /wire first = /
// @break bank_arbiter s/assign first_taken\[l\] = \|\(first & ready_i\)/assign first_taken[l] = |first/
`default_nettype none
module check #(parameter LANES = 3, BANKS = 2) (
  input wire clk_i, input wire [2*LANES-1:0] valid_i, prefetch_i, input wire [2*LANES*3-1:0] lines_i,
  input wire [2*LANES-1:0] slots_i, input wire [LANES-1:0] silent_i, input wire [BANKS-1:0] ready_i);
  localparam BANK_LINE_BITS = 3 - $clog2(BANKS);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [2*LANES-1:0] taken;
  wire [BANKS-1:0] looks;
  wire [BANKS*BANK_LINE_BITS-1:0] looked;
  wire [BANKS*LANES-1:0] lanes, slots;
  rp_bank_arbiter #(.LANES(LANES), .BANKS(BANKS), .LINE_BITS(3), .SLOT_BITS(1)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .want_valid_i(valid_i), .want_line_i(lines_i), .want_slot_i(slots_i),
    .want_prefetch_i(prefetch_i), .silent_i(silent_i), .taken_o(taken), .valid_o(looks), .ready_i(ready_i),
    .line_o(looked), .lanes_o(lanes), .slots_o(slots));

  // A lane's want that stays the first one: what holds for any lane holds for all.
  (* anyconst *) wire [1:0] waiter;
  (* anyconst *) wire [2:0] line;
  wire [2:0] bank = line & (BANKS - 1);
  wire waits = rst_n && valid_i[2*waiter] && lines_i[6*waiter +: 3] == line && !silent_i[waiter] && !taken[2*waiter];
  reg [2:0] passed_q = 0;       // how often its bank was ready
  always @(posedge clk_i) passed_q <= waits ? passed_q + ready_i[bank] : 0;

  integer l, i, b;
  reg [2:0] want, here;
  reg [BANKS-1:0] some;
  always @* begin
    some = 0;
    want = 0;
    here = 0;
    assume (waiter < LANES);
    if (rst_n) begin
      for (l = 0; l < LANES; l = l + 1) begin
        assert (!(taken[2*l] && taken[2*l+1]));
        for (i = 2 * l; i < 2 * l + 2; i = i + 1) begin
          want = lines_i[3*i +: 3];
          b = want & (BANKS - 1);
          here = looked[b*BANK_LINE_BITS +: BANK_LINE_BITS] * BANKS + b;
          if (taken[i]) begin
            some[b] = 1'b1;
            assert (valid_i[i] && !silent_i[l] && ready_i[b] && looks[b] && here == want);
            assert (lanes[b*LANES+l] == !prefetch_i[i]);
            assert (prefetch_i[i] || slots[b*LANES+l] == slots_i[i]);
          end else if (valid_i[i] && !silent_i[l] && ready_i[b] && looks[b] && here == want)
            assert (i == 2 * l + 1 && taken[2*l]);
        end
        for (b = 0; b < BANKS; b = b + 1)
          if (looks[b] && ready_i[b] && lanes[b*LANES+l])
            assert ((taken[2*l] && (lines_i[6*l +: 3] & (BANKS - 1)) == b) ||
                    (taken[2*l+1] && (lines_i[6*l+3 +: 3] & (BANKS - 1)) == b));
      end
      assert ((looks & ready_i) == some);
      assert (!(waits && ready_i[bank] && passed_q == LANES - 1));
    end
  end
endmodule
`default_nettype wire
