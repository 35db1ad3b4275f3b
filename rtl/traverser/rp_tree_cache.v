// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A bank of a cache of the traverser, read only: a lookup a cycle, of a line for all lanes that ask for it. A hit gives
// them the line two cycles later. A miss asks the memory for the line; lanes wait in a list and are offered the line,
// oldest first, once it has come. A lookup for no lane prefetches a line that will be wanted, if a register is free.
// Promises: a line that lanes wait for stays until the last one has it; a line is in one way at most, and in one
// register; requests leave in the order of the misses. ready_o depends on fill_valid_i of the same cycle, and no other
// output on any input; and it does not depend on whether the lookup before hits. A line that comes is taken in the next
// cycle at the latest; lookups go on unless no register is free, or a lane does not take what it is offered.
// Must be given: a slot waits for one line at a time; a line comes once for each request; a lane that has had a lookup
// taken takes no offer in that cycle, so that it is given one line in a cycle.
`default_nettype none
module rp_tree_cache #(
  parameter integer LANES = 8,
  parameter integer SLOTS = 24,        // of rays in a lane
  parameter integer LINES = 128,       // a power of two
  parameter integer WAYS = 16,         // a power of two
  parameter integer MSHRS = 8,         // lines that may be on their way
  parameter integer LINE_BITS = 23,    // of a line's number, without those that choose the bank
  parameter integer DATA_BITS = 512,
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1,
  parameter integer MSHR_BITS = (MSHRS > 1) ? $clog2(MSHRS) : 1
) (
  input  wire                       clk_i,
  input  wire                       rst_ni,
  // a lookup
  input  wire                       valid_i,
  output wire                       ready_o,
  input  wire [LINE_BITS-1:0]       line_i,
  input  wire [LANES-1:0]           lanes_i,
  input  wire [LANES*SLOT_BITS-1:0] slots_i,
  // lanes that get a line
  output reg  [LANES-1:0]           given_lanes_o,
  output reg  [LANES*SLOT_BITS-1:0] given_slots_o,
  output wire [DATA_BITS-1:0]       given_data_o,
  // an offer to a lane that has waited: given two cycles after it was taken
  output wire                       offer_valid_o,
  input  wire                       offer_ready_i,
  output wire [LANES-1:0]           offer_lane_o,     // one bit
  output wire [SLOT_BITS-1:0]       offer_slot_o,
  // to the memory
  output wire                       request_valid_o,
  input  wire                       request_ready_i,
  output wire [LINE_BITS-1:0]       request_line_o,
  output wire [MSHR_BITS-1:0]       request_id_o,
  input  wire                       fill_valid_i,
  output wire                       fill_ready_o,
  input  wire [MSHR_BITS-1:0]       fill_id_i,
  input  wire [DATA_BITS-1:0]       fill_data_i
);
  generate
    if (LANES < 1 || LANES > 32 || SLOTS < 1 || SLOTS > 256) begin : gen_bad_lanes
      tree_cache_LANES_must_be_from_1_to_32_and_SLOTS_from_1_to_256 illegal ();
    end
    if (WAYS < 2 || WAYS > 16 || (WAYS & (WAYS - 1)) != 0) begin : gen_bad_ways
      tree_cache_WAYS_must_be_a_power_of_two_from_2_to_16 illegal ();
    end
    if (LINES < 2 * WAYS || (LINES & (LINES - 1)) != 0) begin : gen_bad_lines
      tree_cache_LINES_must_be_a_power_of_two_and_at_least_2_WAYS illegal ();
    end
    if (MSHRS < 1 || MSHRS > 32) begin : gen_bad_mshrs
      tree_cache_MSHRS_must_be_from_1_to_32 illegal ();
    end
  endgenerate
  localparam integer SETS = LINES / WAYS;
  localparam integer SET_BITS = $clog2(SETS);
  localparam integer TAG_BITS = LINE_BITS - SET_BITS;
  localparam integer WAY_BITS = $clog2(WAYS);
  localparam integer ROW_BITS = SET_BITS + WAY_BITS;   // of set and way
  localparam integer LANE_BITS = (LANES > 1) ? $clog2(LANES) : 1;
  localparam integer WAITER_BITS = LANE_BITS + SLOT_BITS;
  localparam [LANES-1:0] NO_LANE = 0, ONE_LANE = 1;
  localparam [MSHRS-1:0] NO_MSHR = 0, ONE_MSHR = 1;
  localparam [WAYS-1:0] NO_WAY = 0;
  localparam [SETS-1:0] ONE_SET = 1;

  // ---- State

  reg looks_q;                                    // a lookup: its tags have been read
  reg fresh_q;                                    // it has, in the cycle before: later they may be out of date
  reg [LINE_BITS-1:0] line_q;
  reg [SETS-1:0] set_q;                           // its set, a bit: line_q has enough to drive
  reg [LANES-1:0] lanes_q;
  reg [LANES*SLOT_BITS-1:0] slots_q;
  reg [LANES-1:0] join_lanes_q;                   // that have missed, and are not in a register's list yet: one a cycle
  reg [LANES*SLOT_BITS-1:0] join_slots_q;
  reg [MSHR_BITS-1:0] join_id_q;                  // the register
  reg [LINES-1:0] valid_q;
  // A tree of bits, each of which points to the half that was used less recently. Bit 0 stays 0.
  reg [SETS*WAYS-1:0] order_q;
  reg [MSHRS-1:0] busy_q, filled_q, waited_for_q;
  reg [MSHRS*LINE_BITS-1:0] mshr_line_q;
  reg [MSHRS*WAY_BITS-1:0] mshr_way_q;
  reg [MSHRS*WAITER_BITS-1:0] head_q, tail_q;     // first and last of the list: lane and slot
`include "rp_onehot.vh"
  localparam [1:0] IDLE = 2'd0, CHOSEN = 2'd1, OFFERED = 2'd2;
  reg [1:0] serving_q;
  reg [MSHR_BITS-1:0] serve_id_q;

  // ---- Tags

  wire [SET_BITS-1:0] set = line_q[SET_BITS-1:0];
  wire [WAYS*TAG_BITS-1:0] tags;
  wire take = valid_i && ready_o;
  wire fill = fill_valid_i && fill_ready_o;
  wire [LINE_BITS-1:0] fill_line = mshr_line_q[fill_id_i*LINE_BITS +: LINE_BITS];
  wire [SET_BITS-1:0] fill_set = fill_line[SET_BITS-1:0];
  wire [WAY_BITS-1:0] fill_way = mshr_way_q[fill_id_i*WAY_BITS +: WAY_BITS];
  genvar g;
  generate
    for (g = 0; g < WAYS; g = g + 1) begin : gen_way
      rp_ram_1r1w #(.WIDTH(TAG_BITS), .DEPTH(SETS)) ram (
        .clk_i(clk_i),
        .read_i(ready_o),
        .read_address_i(line_i[SET_BITS-1:0]),
        .read_data_o(tags[g*TAG_BITS +: TAG_BITS]),
        .write_i(fill && fill_way == g[WAY_BITS-1:0]),
        .write_address_i(fill_set),
        .write_data_i(fill_line[LINE_BITS-1:SET_BITS])
      );
    end
  endgenerate
  `ONEHOT_SELECT(ways_among, SETS, WAYS)
  wire [WAYS-1:0] set_valid = ways_among(set_q, valid_q), order = ways_among(set_q, order_q);   // of the set

  // ---- What the lookup comes to: of registers and tags alone

  reg [WAYS-1:0] hits, locked;
  reg [MSHRS-1:0] match;
  reg [MSHR_BITS-1:0] free_id;
  `ONEHOT_NUMBER(way_among, WAYS, WAY_BITS)
  `ONEHOT_NUMBER(mshr_among, MSHRS, MSHR_BITS)
  wire [WAY_BITS-1:0] hit_way = way_among(hits);
  wire [MSHR_BITS-1:0] match_id = mshr_among(match);
  integer w, m;
  always @*
    for (w = 0; w < WAYS; w = w + 1)
      hits[w] = set_valid[w] && tags[w*TAG_BITS +: TAG_BITS] == line_q[LINE_BITS-1:SET_BITS];
  // Ways of the set that are promised to a register, and the line's own register.
  always @* begin
    locked = NO_WAY;
    match = NO_MSHR;
    free_id = {MSHR_BITS{1'b0}};
    for (m = MSHRS - 1; m >= 0; m = m - 1) begin
      if (!busy_q[m]) free_id = m[MSHR_BITS-1:0];
      else begin
        match[m] = mshr_line_q[m*LINE_BITS +: LINE_BITS] == line_q;
        if (mshr_line_q[m*LINE_BITS +: SET_BITS] == set) locked[mshr_way_q[m*WAY_BITS +: WAY_BITS]] = 1'b1;
      end
    end
  end
  // The less recently used half, unless all its ways are promised. Each half decides for itself which of its own two
  // is, as which of them lead to the victim is known late.
  integer n;
  reg [2*WAYS-1:0] unlocked, leads;               // a way of this half is not promised; the victim is of this half
  reg [WAYS-1:0] upper;                           // the less recently used one of its halves is the upper one
  always @* begin
    unlocked = {~locked, NO_WAY};
    upper = NO_WAY;
    leads = {{2*WAYS-2{1'b0}}, 2'd2};
    for (n = WAYS - 1; n > 0; n = n - 1) begin
      unlocked[n] = unlocked[2*n] || unlocked[2*n+1];
      upper[n] = order[n] ? unlocked[2*n+1] : !unlocked[2*n];
    end
    for (n = 1; n < WAYS; n = n + 1) begin
      leads[2*n] = leads[n] && !upper[n];
      leads[2*n+1] = leads[n] && upper[n];
    end
  end
  wire [WAY_BITS-1:0] victim = way_among(leads[2*WAYS-1:WAYS]);

  wire hit = fresh_q && |hits;
  wire miss = looks_q && !hit;
  wire asked = lanes_q != NO_LANE;
  wire known = |match;
  wire room = !(&busy_q) && !(&locked);
  wire joins = join_lanes_q != NO_LANE;
  wire [LANES-1:0] behind = join_lanes_q & (join_lanes_q - ONE_LANE);
  wire last = behind == NO_LANE;                  // the next lanes can join from the next cycle on
  // Would the lookup wait if it were a miss? Tags are compared last, and the next lookup is taken without that.
  wire stuck = asked && !(last && (known || room));
  wire allocate = miss && (last || !asked) && !known && room;
  wire blocked = miss && stuck;
  wire will_join = miss && asked && !stuck;
  wire [MSHRS-1:0] waits = filled_q & waited_for_q;
  wire choose = serving_q == IDLE && waits != NO_MSHR;
  assign ready_o = serving_q == IDLE && !choose && !fill_valid_i && !(looks_q && stuck);
  assign fill_ready_o = !hit;

  always @(posedge clk_i)
    if (!rst_ni) looks_q <= 1'b0;
    else looks_q <= take || blocked;
  always @(posedge clk_i) fresh_q <= rst_ni && take;
  // What is there is kept, if it is a lookup or not: so valid_i may come late.
  always @(posedge clk_i)
    if (ready_o) begin
      line_q <= line_i;
      set_q <= ONE_SET << line_i[SET_BITS-1:0];
      lanes_q <= lanes_i;
      slots_q <= slots_i;
    end

  // The lane that is next to wait.
  reg [LANE_BITS-1:0] lane;
  integer l;
  always @* begin
    lane = {LANE_BITS{1'b0}};
    for (l = LANES - 1; l >= 0; l = l - 1) if (join_lanes_q[l]) lane = l[LANE_BITS-1:0];
  end
  wire [WAITER_BITS-1:0] waiter = {lane, join_slots_q[lane*SLOT_BITS +: SLOT_BITS]};
  // As above: whether they are lanes that have missed is known last.
  always @(posedge clk_i)
    if (!rst_ni) join_lanes_q <= NO_LANE;
    else join_lanes_q <= will_join ? lanes_q : behind;
  always @(posedge clk_i)
    if (last) begin
      join_slots_q <= slots_q;
      join_id_q <= known ? match_id : free_id;
    end

  always @(posedge clk_i)
    if (!rst_ni) valid_q <= {LINES{1'b0}};
    else if (fill) valid_q[{fill_set, fill_way}] <= 1'b1;

  // The way that is used, or promised, becomes the most recently used one. Tags are compared last: so of a hit each way
  // decides for itself in which halves it is, and of a miss it is known which order follows.
  reg [WAYS-1:0] order_hit, order_miss, lower_hit, upper_hit;   // lower: a way of that half is hit
  integer o, u;
  always @* begin
    lower_hit = NO_WAY;
    upper_hit = NO_WAY;
    for (u = 0; u < WAYS; u = u + 1)
      for (o = 0; o < WAY_BITS; o = o + 1)
        if (u[o]) upper_hit[(u + WAYS) >> (o + 1)] = upper_hit[(u + WAYS) >> (o + 1)] || hits[u];
        else lower_hit[(u + WAYS) >> (o + 1)] = lower_hit[(u + WAYS) >> (o + 1)] || hits[u];
    order_hit = (order | lower_hit) & ~upper_hit;
    order_miss = (order & ~leads[WAYS-1:0]) | (leads[WAYS-1:0] & ~upper);
  end
  integer r;
  always @(posedge clk_i)
    if (!rst_ni) order_q <= {SETS*WAYS{1'b0}};
    else if (hit || allocate)
      for (r = 0; r < SETS; r = r + 1) if (set_q[r]) order_q[r*WAYS +: WAYS] <= hit ? order_hit : order_miss;

  // ---- Registers of lines that are on their way

  wire hand_on = serving_q == OFFERED && offer_ready_i;
  wire [WAITER_BITS-1:0] head = head_q[serve_id_q*WAITER_BITS +: WAITER_BITS];
  wire the_last = head == tail_q[serve_id_q*WAITER_BITS +: WAITER_BITS];
  wire [MSHRS-1:0] joined = joins ? ONE_MSHR << join_id_q : NO_MSHR;
  // A lookup from before the line came may wait for lanes that join another list, and then joins that of the line.
  wire [MSHRS-1:0] late = (looks_q && !fresh_q) ? match : NO_MSHR;
  wire [MSHRS-1:0] freed = filled_q & ~waited_for_q & ~joined & ~late;
  wire [MSHRS-1:0] allocated = allocate ? ONE_MSHR << free_id : NO_MSHR;
  wire [MSHRS-1:0] has_come = fill ? ONE_MSHR << fill_id_i : NO_MSHR;
  wire [MSHRS-1:0] left = (hand_on && the_last) ? ONE_MSHR << serve_id_q : NO_MSHR;
  always @(posedge clk_i)
    if (!rst_ni) begin
      busy_q <= NO_MSHR;
      filled_q <= NO_MSHR;
      waited_for_q <= NO_MSHR;
    end else begin
      busy_q <= (busy_q & ~freed) | allocated;
      filled_q <= (filled_q & ~freed) | has_come;
      waited_for_q <= (waited_for_q & ~left) | joined;
    end

  wire [MSHRS-1:0] choice;
  rp_round_robin #(.COUNT(MSHRS)) turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(waits), .advance_i(choose), .grant_o(choice));
  wire [MSHR_BITS-1:0] choice_id = mshr_among(choice);
  wire [WAITER_BITS-1:0] choice_head = head_q[choice_id*WAITER_BITS +: WAITER_BITS];

  // The lists of lanes that wait. Lanes that join a line's list when it has come do so in one cycle after another from
  // that in which it came on: so the next one is read when none joins.
  wire [WAITER_BITS-1:0] next;
  wire append = joins && waited_for_q[join_id_q];
  rp_ram_1r1w #(.WIDTH(WAITER_BITS), .DEPTH(1 << WAITER_BITS)) waiters (
    .clk_i(clk_i),
    .read_i(!joins && (choose || serving_q == CHOSEN)),
    .read_address_i(choose ? choice_head : head),
    .read_data_o(next),
    .write_i(append),
    .write_address_i(tail_q[join_id_q*WAITER_BITS +: WAITER_BITS]),
    .write_data_i(waiter)
  );
  integer i;
  always @(posedge clk_i)
    for (i = 0; i < MSHRS; i = i + 1) begin
      if (allocated[i]) begin
        mshr_line_q[i*LINE_BITS +: LINE_BITS] <= line_q;
        mshr_way_q[i*WAY_BITS +: WAY_BITS] <= victim;
      end
      if (joined[i]) tail_q[i*WAITER_BITS +: WAITER_BITS] <= waiter;
      if (joined[i] && !waited_for_q[i]) head_q[i*WAITER_BITS +: WAITER_BITS] <= waiter;
      else if (hand_on && serve_id_q == i[MSHR_BITS-1:0]) head_q[i*WAITER_BITS +: WAITER_BITS] <= next;
    end

  // Their requests.
  rp_ram_queue #(.WIDTH(MSHR_BITS), .DEPTH(MSHRS)) requests (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(allocate),
    .data_i(free_id),
    .valid_o(request_valid_o),
    .ready_i(request_ready_i),
    .data_o(request_id_o)
  );
  assign request_line_o = mshr_line_q[request_id_o*LINE_BITS +: LINE_BITS];

  // Serving a list. Meanwhile no lookup is taken: so no lane joins the list after its head has been read, and no hit
  // wants the data in the cycle in which it is read.
  always @(posedge clk_i)
    if (!rst_ni) serving_q <= IDLE;
    else if (choose) serving_q <= joins ? CHOSEN : OFFERED;
    else if (serving_q == CHOSEN && !joins) serving_q <= OFFERED;
    else if (hand_on) serving_q <= the_last ? IDLE : CHOSEN;
  always @(posedge clk_i) if (choose) serve_id_q <= choice_id;
  // The lane to be offered the line is kept in the cycle before, in which the head does not change any more: lanes
  // answer late.
  wire [WAITER_BITS-1:0] next_offer = choose ? choice_head : head;
  reg [LANES-1:0] offer_lane_q;
  reg [SLOT_BITS-1:0] offer_slot_q;
  always @(posedge clk_i)
    if (serving_q != OFFERED) begin
      offer_lane_q <= ONE_LANE << next_offer[SLOT_BITS +: LANE_BITS];
      offer_slot_q <= next_offer[SLOT_BITS-1:0];
    end
  assign offer_valid_o = serving_q == OFFERED;
  assign offer_lane_o = offer_lane_q;
  assign offer_slot_o = offer_slot_q;

  // ---- Data

  reg read_q;                                     // for the lane that took the offer
  reg [LANES-1:0] read_lane_q;
  reg [SLOT_BITS-1:0] read_slot_q;
  reg [ROW_BITS-1:0] read_row_q;
  always @(posedge clk_i) read_q <= rst_ni && hand_on;
  always @(posedge clk_i)
    if (hand_on) begin
      read_lane_q <= offer_lane_o;
      read_slot_q <= head[SLOT_BITS-1:0];
      read_row_q <= {mshr_line_q[serve_id_q*LINE_BITS +: SET_BITS], mshr_way_q[serve_id_q*WAY_BITS +: WAY_BITS]};
    end
  rp_ram_1r1w #(.WIDTH(DATA_BITS), .DEPTH(LINES)) data (
    .clk_i(clk_i),
    .read_i(hit || read_q),
    .read_address_i(read_q ? read_row_q : {set, hit_way}),
    .read_data_o(given_data_o),
    .write_i(fill),
    .write_address_i({fill_set, fill_way}),
    .write_data_i(fill_data_i)
  );
  always @(posedge clk_i)
    if (!rst_ni) given_lanes_o <= NO_LANE;
    else given_lanes_o <= read_q ? read_lane_q : (hit ? lanes_q : NO_LANE);
  always @(posedge clk_i)
    if (read_q || hit) given_slots_o <= read_q ? {LANES{read_slot_q}} : slots_q;
endmodule
`default_nettype wire
