// The access is as data_cache makes it: it allocates only where match_o, available_o and locked_o allow, and the line
// of a register that is filled is in the cache, so that it hits.
// @modules miss_status
// @zeros
// @proves a line has at most one register; a way of a set is promised once
// @proves match_o, available_o, locked_o, freed_o and idle_o are right; a register taken was free; a refill finds its
//   line and way
// @proves any one warp that waits is a waiter of its register until it is served, and the register is busy so long
// @parameters MSHRS=3 WARPS=2 MSHR_BITS=2
// @parameters MSHRS=1 WARPS=2 MSHR_BITS=1
// @break miss_status s/match\[a\] = !filled_q\[a\] && /match[a] = filled_q[a] \&\& /
// @break miss_status s/locked_o\[way_q\[a\]\] = 1'b1/locked_o[0] = way_q[a]/
// @break miss_status s/waiters_q\[w\*WARPS \+: WARPS\] \| \(ONE/(ONE/
// @break miss_status s/if \(\|waiters_q\[n\*WARPS \+: WARPS\]\) finished/if (waiters_q[n*WARPS]) finished/
// @break miss_status s/busy_q\[available_id_o\] <= 1'b1/busy_q[0] <= 1'b1/
`default_nettype none
module check #(parameter MSHRS = 3, WARPS = 2, MSHR_BITS = 2) (
  input wire clk_i, access_i, join_i, allocate_i, way_i, fill_i, last_i, served_i, warp_i, served_warp_i,
  input wire [3:0] some_line_i, input wire [MSHR_BITS-1:0] fill_id_i, served_id_i
);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  // Lines of four sets, four of each
  wire [25:0] line_i = {22'd0, some_line_i};
  wire match, available, fill_way, freed, idle;
  wire [MSHR_BITS-1:0] available_id;
  wire [1:0] locked;
  wire [25:0] fill_line;
  wire [MSHRS-1:0] filled;
  wire [MSHRS*26-1:0] lines;
  wire [MSHRS*WARPS-1:0] waiters;
  rp_miss_status #(.WARPS(WARPS), .MSHRS(MSHRS), .SET_BITS(2)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .access_i(access_i), .access_line_i(line_i), .access_warp_i(warp_i), .match_o(match),
    .available_o(available), .available_id_o(available_id), .locked_o(locked), .join_i(join_i), .allocate_i(allocate_i),
    .allocate_way_i(way_i), .fill_i(fill_i), .fill_id_i(fill_id_i), .fill_last_i(last_i), .fill_line_o(fill_line),
    .fill_way_o(fill_way), .served_i(served_i), .served_id_i(served_id_i), .served_warp_i(served_warp_i),
    .freed_o(freed), .idle_o(idle), .filled_o(filled), .line_o(lines), .waiters_o(waiters));

  // What each register should hold
  reg [MSHRS-1:0] busy_q = 0, filled_q = 0, ways_q = 0;
  reg [MSHRS*26-1:0] lines_q = 0;
  reg [MSHRS*WARPS-1:0] waiters_q = 0;
  reg [MSHRS-1:0] empty, matching;
  reg [1:0] promised;
  reg in_cache;
  integer r, m, n;
  always @* begin
    promised = 0;
    in_cache = 1'b0;
    for (m = 0; m < MSHRS; m = m + 1) begin
      empty[m] = busy_q[m] && filled_q[m] && waiters_q[m*WARPS +: WARPS] == 0;
      matching[m] = busy_q[m] && !filled_q[m] && lines_q[m*26 +: 26] == line_i;
      if (busy_q[m] && filled_q[m] && lines_q[m*26 +: 26] == line_i) in_cache = 1'b1;
      if (busy_q[m] && lines_q[m*26 +: 2] == line_i[1:0]) promised[ways_q[m]] = 1'b1;
    end
  end
  always @(posedge clk_i)
    if (rst_n)
      for (r = 0; r < MSHRS; r = r + 1) begin
        if (empty[r]) {busy_q[r], filled_q[r]} <= 2'b00;
        if (fill_i && last_i && fill_id_i == r) filled_q[r] <= 1'b1;
        if (served_i && served_id_i == r) waiters_q[r*WARPS + served_warp_i] <= 1'b0;
        if (join_i && matching[r]) waiters_q[r*WARPS + warp_i] <= 1'b1;
        if (allocate_i && available_id == r) begin
          busy_q[r] <= 1'b1;
          ways_q[r] <= way_i;
          lines_q[r*26 +: 26] <= line_i;
          waiters_q[r*WARPS +: WARPS] <= 1 << warp_i;
        end
      end

  (* anyconst *) wire [MSHR_BITS-1:0] one;
  (* anyconst *) wire [MSHR_BITS-1:0] other;
  wire two = one < MSHRS && other < MSHRS && one != other && busy_q[one] && busy_q[other];
  always @* begin
    assume (!allocate_i || (access_i && !match && !in_cache && available && !locked[way_i]));
    assume (!join_i || (access_i && match));
    assume (!fill_i || (fill_id_i < MSHRS && busy_q[fill_id_i] && !filled_q[fill_id_i]));
    assume (!served_i || (served_id_i < MSHRS && filled_q[served_id_i] &&
                          waiters_q[served_id_i*WARPS + served_warp_i]));
    if (rst_n) begin
      assert (!two || lines_q[one*26 +: 26] != lines_q[other*26 +: 26]);
      assert (!two || lines_q[one*26 +: 2] != lines_q[other*26 +: 2] || ways_q[one] != ways_q[other]);
      assert (match == (access_i && matching != 0));
      assert (available == (access_i && busy_q != {MSHRS{1'b1}}));
      assert (!available || (available_id < MSHRS && !busy_q[available_id]));
      assert (locked == (access_i ? promised : 2'b00));
      assert (freed == (empty != 0) && idle == (busy_q == 0) && filled == (busy_q & filled_q));
      assert (!fill_i || (fill_line == lines_q[fill_id_i*26 +: 26] && fill_way == ways_q[fill_id_i]));
      for (n = 0; n < MSHRS; n = n + 1)
        assert (!busy_q[n] || (lines[n*26 +: 26] == lines_q[n*26 +: 26] &&
                               waiters[n*WARPS +: WARPS] == waiters_q[n*WARPS +: WARPS]));
    end
  end
endmodule
`default_nettype wire
