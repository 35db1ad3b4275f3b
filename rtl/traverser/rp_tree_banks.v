// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A cache of the traverser, read only, of banks: a line's last bits choose its bank. In a cycle each bank looks up one
// line, for all lanes that want it (rp_bank_arbiter.v, rp_tree_cache.v), and each lane has one of two wants looked up.
// A lane for which a line has come for which its ray has waited takes that, if it has room, and its wants are not
// looked at. Promises: a lane is given one line in a cycle at most, two cycles after it took one that was there or had
// come. waited_valid_o, given_* and the request depend on registers alone; a request may give way to another bank's
// until it is taken. Must be given: a slot waits for one line at a time; a line comes once for each request.
`default_nettype none
module rp_tree_banks #(
  parameter integer LANES = 8,
  parameter integer SLOTS = 24,        // of rays in a lane
  parameter integer LINES = 1024,      // of all banks: a power of two
  parameter integer WAYS = 16,         // a power of two
  parameter integer MSHRS = 64,        // lines that may be on their way, a multiple of BANKS
  parameter integer BANKS = 8,         // a power of two
  parameter integer LINE_BITS = 26,    // of a line's number
  parameter integer DATA_BITS = 512,
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1,
  parameter integer ID_BITS = $clog2(BANKS) + ((MSHRS > BANKS) ? $clog2(MSHRS / BANKS) : 1)
) (
  input  wire                         clk_i,
  input  wire                         rst_ni,
  // of each lane two lines to look up, of which one can be taken, the first rather; the first one below
  input  wire [2*LANES-1:0]           want_valid_i,
  input  wire [2*LANES*LINE_BITS-1:0] want_line_i,
  input  wire [2*LANES*SLOT_BITS-1:0] want_slot_i,
  input  wire [2*LANES-1:0]           want_prefetch_i,   // no ray waits for it yet: the lane is not given it
  output wire [2*LANES-1:0]           taken_o,
  // of each lane: there is a line for which it has waited
  output wire [LANES-1:0]             waited_valid_o,
  input  wire [LANES-1:0]             waited_ready_i,
  // lanes that get a line
  output wire [LANES-1:0]             given_valid_o,
  output wire [LANES*SLOT_BITS-1:0]   given_slot_o,
  output wire [LANES*DATA_BITS-1:0]   given_data_o,
  // to the memory
  output wire                         request_valid_o,
  input  wire                         request_ready_i,
  output wire [LINE_BITS-1:0]         request_line_o,
  output wire [ID_BITS-1:0]           request_id_o,
  input  wire                         fill_valid_i,
  output wire                         fill_ready_o,
  input  wire [ID_BITS-1:0]           fill_id_i,
  input  wire [DATA_BITS-1:0]         fill_data_i
);
  generate
    if (LANES < 1 || LANES > 32 || SLOTS < 1 || SLOTS > 256) begin : gen_bad_lanes
      tree_banks_LANES_must_be_from_1_to_32_and_SLOTS_from_1_to_256 illegal ();
    end
    if (BANKS < 1 || BANKS > 16 || (BANKS & (BANKS - 1)) != 0) begin : gen_bad_banks
      tree_banks_BANKS_must_be_a_power_of_two_from_1_to_16 illegal ();
    end
    if (LINES < 2 * WAYS * BANKS || (LINES & (LINES - 1)) != 0) begin : gen_bad_lines
      tree_banks_LINES_must_be_a_power_of_two_and_at_least_2_WAYS_in_each_bank illegal ();
    end
    if (MSHRS < BANKS || MSHRS > 32 * BANKS || MSHRS % BANKS != 0) begin : gen_bad_mshrs
      tree_banks_MSHRS_must_be_a_multiple_of_BANKS_and_from_1_to_32_in_each illegal ();
    end
  endgenerate
  localparam integer BANK_BITS = $clog2(BANKS);
  localparam integer BANK_LINE_BITS = LINE_BITS - BANK_BITS;
  localparam integer MSHR_BITS = ID_BITS - BANK_BITS;
`include "rp_onehot.vh"
  genvar b, l;

  // ---- Lines for which lanes have waited: a lane takes one, of its banks in rotation

  wire [BANKS-1:0] offer_valid, offer_ready;
  wire [BANKS*LANES-1:0] offer_lane;
  wire [LANES*BANKS-1:0] offer_taken;             // [lane][bank]
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_waited
      wire [BANKS-1:0] offers, grant;
      for (b = 0; b < BANKS; b = b + 1) begin : gen_from
        assign offers[b] = offer_valid[b] && offer_lane[b*LANES+l];
      end
      assign waited_valid_o[l] = |offers;
      rp_round_robin #(.COUNT(BANKS)) turn (
        .clk_i(clk_i), .rst_ni(rst_ni), .request_i(offers), .advance_i(waited_ready_i[l]), .grant_o(grant));
      assign offer_taken[l*BANKS +: BANKS] = grant & {BANKS{waited_ready_i[l]}};
    end
  endgenerate

  // ---- Lookups

  wire [BANKS-1:0] look_valid, look_ready;
  wire [BANKS*BANK_LINE_BITS-1:0] look_line;
  wire [BANKS*LANES-1:0] look_lanes;
  wire [BANKS*LANES*SLOT_BITS-1:0] look_slots;
  rp_bank_arbiter #(.LANES(LANES), .BANKS(BANKS), .LINE_BITS(LINE_BITS), .SLOT_BITS(SLOT_BITS)) arbiter (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .want_valid_i(want_valid_i),
    .want_line_i(want_line_i),
    .want_slot_i(want_slot_i),
    .want_prefetch_i(want_prefetch_i),
    .silent_i(waited_valid_o),
    .taken_o(taken_o),
    .valid_o(look_valid),
    .ready_i(look_ready),
    .line_o(look_line),
    .lanes_o(look_lanes),
    .slots_o(look_slots)
  );

  // ---- Banks

  wire [BANKS*LANES-1:0] given_lanes;
  wire [BANKS*LANES*SLOT_BITS-1:0] given_slots;
  wire [BANKS*DATA_BITS-1:0] given_data;
  wire [BANKS-1:0] request_valid, request_grant, fill_bank, fill_ready;
  wire [BANKS*LINE_BITS-1:0] request_line;         // the bank in its low bits
  wire [BANKS*ID_BITS-1:0] request_id;             // the bank in its high bits
  generate
    for (b = 0; b < BANKS; b = b + 1) begin : gen_bank
      wire [LANES-1:0] taken_of;
      for (l = 0; l < LANES; l = l + 1) begin : gen_by
        assign taken_of[l] = offer_taken[l*BANKS+b];
      end
      assign offer_ready[b] = |taken_of;
      if (BANKS > 1) begin : gen_choose
        assign fill_bank[b] = fill_id_i[ID_BITS-1:MSHR_BITS] == b[BANK_BITS-1:0];
        assign request_line[b*LINE_BITS +: BANK_BITS] = b[BANK_BITS-1:0];
        assign request_id[b*ID_BITS+MSHR_BITS +: BANK_BITS] = b[BANK_BITS-1:0];
      end else begin : gen_only
        assign fill_bank[b] = 1'b1;
      end
      rp_tree_cache #(.LANES(LANES), .SLOTS(SLOTS), .LINES(LINES / BANKS), .WAYS(WAYS), .MSHRS(MSHRS / BANKS),
        .LINE_BITS(BANK_LINE_BITS), .DATA_BITS(DATA_BITS)) bank (
          .clk_i(clk_i),
          .rst_ni(rst_ni),
          .valid_i(look_valid[b]),
          .ready_o(look_ready[b]),
          .line_i(look_line[b*BANK_LINE_BITS +: BANK_LINE_BITS]),
          .lanes_i(look_lanes[b*LANES +: LANES]),
          .slots_i(look_slots[b*LANES*SLOT_BITS +: LANES*SLOT_BITS]),
          .given_lanes_o(given_lanes[b*LANES +: LANES]),
          .given_slots_o(given_slots[b*LANES*SLOT_BITS +: LANES*SLOT_BITS]),
          .given_data_o(given_data[b*DATA_BITS +: DATA_BITS]),
          .offer_valid_o(offer_valid[b]),
          .offer_ready_i(offer_ready[b]),
          .offer_lane_o(offer_lane[b*LANES +: LANES]),
          .offer_slot_o(),
          .request_valid_o(request_valid[b]),
          .request_ready_i(request_grant[b] && request_ready_i),
          .request_line_o(request_line[b*LINE_BITS+BANK_BITS +: BANK_LINE_BITS]),
          .request_id_o(request_id[b*ID_BITS +: MSHR_BITS]),
          .fill_valid_i(fill_valid_i && fill_bank[b]),
          .fill_ready_o(fill_ready[b]),
          .fill_id_i(fill_id_i[MSHR_BITS-1:0]),
          .fill_data_i(fill_data_i)
        );
    end
  endgenerate

  // ---- The memory

  assign request_valid_o = |request_valid;
  assign fill_ready_o = |(fill_bank & fill_ready);
  rp_round_robin #(.COUNT(BANKS)) request_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(request_valid), .advance_i(request_ready_i), .grant_o(request_grant));
  `ONEHOT_SELECT(line_among, BANKS, LINE_BITS)
  `ONEHOT_SELECT(id_among, BANKS, ID_BITS)
  assign request_line_o = line_among(request_grant, request_line);
  assign request_id_o = id_among(request_grant, request_id);

  // ---- Lanes that get a line: of one bank at most

  `ONEHOT_SELECT(slot_among, BANKS, SLOT_BITS)
  `ONEHOT_SELECT(data_among, BANKS, DATA_BITS)
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_given
      wire [BANKS-1:0] from;
      wire [BANKS*SLOT_BITS-1:0] slots;
      for (b = 0; b < BANKS; b = b + 1) begin : gen_of
        assign from[b] = given_lanes[b*LANES+l];
        assign slots[b*SLOT_BITS +: SLOT_BITS] = given_slots[(b*LANES+l)*SLOT_BITS +: SLOT_BITS];
      end
      assign given_valid_o[l] = |from;
      assign given_slot_o[l*SLOT_BITS +: SLOT_BITS] = slot_among(from, slots);
      assign given_data_o[l*DATA_BITS +: DATA_BITS] = data_among(from, given_data);
    end
  endgenerate
endmodule
`default_nettype wire
