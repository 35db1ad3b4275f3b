// A cache of two sets of two ways with two registers, asked by two lanes. The memory answers requests in any order,
// after any time; of a line it holds one bit. A reset may come in any cycle in which nothing is on its way, or in which
// the last line comes, and behind it the memory holds something else.
// @long 25
// @modules tree_cache round_robin ram_queue ram_1r1w
// @zeros
// @proves a lane that is given a line has asked for one, and it is that one, as the memory holds it; a line is asked
//   for by one register at a time, and a register that is asked for is free; an offer stays until it is taken, and is
//   to a lane that waits
// @proves behind a reset no lane is given a line as the memory held it before
// @proves no lane is forgotten: while the memory owes nothing and lanes take what they are offered, a lane that has
//   asked is given the line, and the cache takes lookups again, within 9 cycles
// @break tree_cache s/set_valid\[w\] && tags/tags/
// @break tree_cache s/if \(!rst_ni\) valid_q <= \{LINES\{1'b0\}\};/if (!rst_ni) valid_q <= valid_q;/
// @break tree_cache s/if \(!rst_ni\) valid_q <= \{LINES\{1'b0\}\};/if (!rst_ni) valid_q <= valid_q \& 4'b1010;/
// @break tree_cache s/if \(!rst_ni\) valid_q <= \{LINES\{1'b0\}\};/if (!rst_ni \&\& !fill) valid_q <= 0;/
// @break tree_cache s/if \(!rst_ni\) serving_q/if (1'b0) serving_q/
// @break tree_cache s/hit_way = way_among\(hits\)/hit_way = ~way_among(hits)/
// @break tree_cache s/locked\[mshr_way_q\[m\*WAY_BITS \+: WAY_BITS\]\] = 1'b1/locked = locked/
// @break tree_cache s/asked && !\(last && \(known \|\| room\)\)/1'b0/
// @break tree_cache s/!known && room/room/
// @break tree_cache s/hit = fresh_q && \|hits/hit = |hits/
// @break tree_cache s/filled_q & ~waited_for_q & ~joined & ~late/filled_q \& ~waited_for_q \& ~late/
// @break tree_cache s/known \? match_id : free_id/free_id/
// @break tree_cache s/\(waited_for_q & ~left\) \| joined/waited_for_q | joined/
// @break tree_cache s/append = joins && waited_for_q\[join_id_q\]/append = 1'b0/
// @break tree_cache s/if \(joined\[i\]\) tail_q/if (joined[i] \&\& !waited_for_q[i]) tail_q/
// @break tree_cache s/next_offer = choose \? choice_head : head/next_offer = head/
// @break tree_cache s/read_q \? read_row_q : \{set, hit_way\}/{set, hit_way}/
`default_nettype none
module check (
  input wire clk_i, restart, valid, takes, memory_ready, comes, come_id,
  input wire [2:0] line, input wire [1:0] lanes);
  reg begun_q = 1'b0, later_q = 1'b0;
  always @(posedge clk_i) begin
    begun_q <= 1'b1;
    later_q <= later_q ^ restart;
  end
  wire rst_n = begun_q && !restart;
  (* anyconst *) wire [7:0] one_tree, other_tree;
  wire [7:0] memory = later_q ? other_tree : one_tree;   // each line's bit

  wire ready, data, offers, asks, ask_id, fill_ready;
  wire [1:0] given, given_slots, offer_lane;
  wire [2:0] ask_line;
  wire offer_slot;
  reg [1:0] owed_q = 0;                          // registers that the memory owes lines
  reg [2:0] line_q [0:1];
  rp_tree_cache #(.LANES(2), .SLOTS(1), .LINES(4), .WAYS(2), .MSHRS(2), .LINE_BITS(3), .DATA_BITS(1)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .valid_i(valid), .ready_o(ready), .line_i(line), .lanes_i(lanes), .slots_i(2'd0),
    .given_lanes_o(given), .given_slots_o(given_slots), .given_data_o(data), .offer_valid_o(offers),
    .offer_ready_i(takes), .offer_lane_o(offer_lane), .offer_slot_o(offer_slot), .request_valid_o(asks),
    .request_ready_i(memory_ready), .request_line_o(ask_line), .request_id_o(ask_id), .fill_valid_i(comes),
    .fill_ready_o(fill_ready), .fill_id_i(come_id), .fill_data_i(memory[line_q[come_id]]));
  wire looks = rst_n && valid && ready;
  wire asked = rst_n && asks && memory_ready;
  wire filled = rst_n && comes && fill_ready;

  // What each lane waits for; whether it has taken an offer, and is given the line in the second cycle behind that.
  reg [1:0] waits_q = 0, taken_q = 0;
  reg [2:0] wanted_q [0:1];
  reg offered_q = 1'b0, blocked_q = 1'b0, come_id_q;
  reg [1:0] offered_lane_q;
  reg [4:0] idle_q [0:1];
  reg [4:0] busy_q = 0;
  initial {idle_q[0], idle_q[1]} = 0;
  integer l;
  always @(posedge clk_i) begin
    for (l = 0; l < 2; l = l + 1) begin
      if (rst_n && given[l]) waits_q[l] <= 1'b0;
      if (looks && lanes[l]) begin
        waits_q[l] <= 1'b1;
        wanted_q[l] <= line;
      end
      idle_q[l] <= (waits_q[l] && owed_q == 0 && !asks && !(offers && !takes)) ? idle_q[l] + 1 : 0;
    end
    busy_q <= (rst_n && !ready && owed_q == 0 && !asks && !(offers && !takes)) ? busy_q + 1 : 0;
    if (asked) begin
      owed_q[ask_id] <= 1'b1;
      line_q[ask_id] <= ask_line;
    end
    if (filled) owed_q[come_id] <= 1'b0;
    if (!rst_n) begin
      waits_q <= 2'd0;
      owed_q <= 2'd0;
      {idle_q[0], idle_q[1], busy_q} <= 15'd0;
    end
    taken_q <= (rst_n && offers && takes) ? offer_lane : 2'd0;
    {offered_q, offered_lane_q} <= {rst_n && offers && !takes, offer_lane};
    {blocked_q, come_id_q} <= {rst_n && comes && !fill_ready, come_id};
  end

  always @* begin
    assume (!comes || owed_q[come_id]);
    assume (!restart || owed_q == 2'd0 || (comes && owed_q == 2'd1 << come_id));
    assume (!blocked_q || (comes && come_id == come_id_q));
    assume (!(looks && |(lanes & waits_q)));
    assume (!(offers && takes && looks && |(offer_lane & lanes)));
    if (rst_n) begin
      for (l = 0; l < 2; l = l + 1) begin
        assert (!given[l] || (waits_q[l] && data == memory[wanted_q[l]]));
        assert (idle_q[l] <= 9);
      end
      assert (busy_q <= 9);
      assert (!asks || !owed_q[ask_id]);
      assert (!asks || !((owed_q[0] && line_q[0] == ask_line) || (owed_q[1] && line_q[1] == ask_line)));
      assert (!offers || offer_lane == 2'd1 || offer_lane == 2'd2);
      assert (!offers || |(offer_lane & waits_q));
      assert (!offers || !(|(offer_lane & taken_q)));
      assert (!offered_q || (offers && offer_lane == offered_lane_q));
    end
  end
endmodule
`default_nettype wire
