// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The stacks of a lane of the traverser: of each slot's ray the youngest entries in RAMs of one read and one write a
// cycle, and how many blocks of four older ones are in the memory. A visit's result decides how the ray goes on: with
// the nearest child, once its stack has room for three more; else with the youngest entry that does not lie behind the
// best hit. One entry is taken off in a cycle.
// Promises: a ray gets the entries that were put on its stack, youngest first, without those with a key above the
// limit; each result is answered once, by node_goes_on_o, next or done, whatever keys and limits are; a request stays
// as it is until it is taken, and the next one that reads comes after its fill; a fill is taken at once, and has been
// written when fill_waits_o is low. node_goes_on_o, done and ray_ready_o depend on inputs of the same cycle, no other
// output does.
// Must be given: the slot of a result a cycle ahead, of a ray that has begun or gone on before; one result each time;
// no node's test begins from a fill until fill_waits_o is low, so that there is a cycle for it; a fill for each request
// that reads, after that was taken; a ray that begins in a slot only after the slot's last one is done; fewer than
// 2**BLOCK_BITS blocks of a ray.
`default_nettype none
module rp_lane_stacks #(
  parameter integer SLOTS = 24,
  parameter integer ENTRIES = 16,                // of a slot, in the RAMs
  parameter integer KEY_BITS = 32,               // of the time at which an entry's box is entered
  parameter integer REFERENCE_BITS = 32,         // of its node or leaf
  parameter integer BLOCK_BITS = 7,              // of a block's number
  parameter integer ENTRY_BITS = KEY_BITS + REFERENCE_BITS,   // the reference in the lower bits
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1
) (
  input  wire                      clk_i,
  input  wire                      rst_ni,
  // a ray begins: its stack is empty
  input  wire                      ray_valid_i,
  output wire                      ray_ready_o,         // there is neither next nor done in this cycle
  input  wire [SLOT_BITS-1:0]      ray_slot_i,
  // a node's result
  input  wire [SLOT_BITS-1:0]      node_slot_i,         // of the result that may come in the next cycle
  input  wire                      node_valid_i,
  input  wire [2:0]                node_children_i,     // that the ray meets, 0 to 4
  input  wire [REFERENCE_BITS-1:0] node_nearest_i,
  input  wire [3*ENTRY_BITS-1:0]   node_others_i,       // in the order in which they are put on the stack
  input  wire [KEY_BITS-1:0]       node_limit_i,        // of entries, when no child is met
  output wire                      node_goes_on_o,      // with the nearest, at once
  // a leaf's
  input  wire [SLOT_BITS-1:0]      leaf_slot_i,         // of the result that may come in the next cycle
  input  wire                      leaf_valid_i,
  input  wire [KEY_BITS-1:0]       leaf_limit_i,
  input  wire                      leaf_over_i,         // the ray is done, whatever its stack has
  // a ray goes on, or is done
  output wire                      next_valid_o,
  output wire [SLOT_BITS-1:0]      next_slot_o,
  output wire [REFERENCE_BITS-1:0] next_reference_o,
  output wire                      done_valid_o,
  output wire [SLOT_BITS-1:0]      done_slot_o,
  // to the memory: a block of a slot, its oldest entry in the lowest bits
  output reg                       request_valid_o,
  input  wire                      request_ready_i,
  output reg                       request_write_o,
  output reg  [SLOT_BITS-1:0]      request_slot_o,
  output wire [BLOCK_BITS-1:0]     request_block_o,
  output wire [4*ENTRY_BITS-1:0]   request_entries_o,   // of one that writes
  input  wire                      fill_valid_i,
  input  wire [4*ENTRY_BITS-1:0]   fill_entries_i,
  output reg                       fill_waits_o
);
  generate
    if (SLOTS < 1 || SLOTS > 256) begin : gen_bad_slots
      lane_stacks_SLOTS_must_be_from_1_to_256 illegal ();
    end
    if (ENTRIES < 8 || ENTRIES > 64) begin : gen_bad_entries
      lane_stacks_ENTRIES_must_be_from_8_to_64 illegal ();
    end
    if (BLOCK_BITS < 1 || BLOCK_BITS > 16) begin : gen_bad_blocks
      lane_stacks_BLOCK_BITS_must_be_from_1_to_16 illegal ();
    end
  endgenerate
  localparam integer ROWS = (ENTRIES + 3) / 4;   // of a slot, of four entries each
  localparam integer ROW_BITS = $clog2(ROWS);
  localparam [ROW_BITS-1:0] FIRST_ROW = 0;
  localparam integer HERE_BITS = $clog2(ENTRIES + 1);
  localparam integer ADDRESS_BITS = $clog2(SLOTS * ROWS);
  localparam integer MOST = ENTRIES - 3;         // entries with which there is room for the children of another node
  localparam integer KEPT_BITS = (KEY_BITS > REFERENCE_BITS) ? KEY_BITS : REFERENCE_BITS;
  localparam [HERE_BITS-1:0] NONE = 0, ONE = 1, TWO = 2, BLOCK = 4;
  localparam [BLOCK_BITS-1:0] NO_BLOCK = 0;

  // ---- State

  reg [SLOTS*HERE_BITS-1:0] here_q;              // entries in the RAM
  reg [SLOTS*BLOCK_BITS-1:0] blocks_q;           // in the memory
  reg [SLOTS*ROW_BITS-1:0] base_q;               // row of the oldest entries in the RAM
  localparam [1:0] NOTHING = 2'd0, ENTRY = 2'd1, SPILL = 2'd2;
  reg [1:0] read_q;                              // what the RAM has read in the cycle before, and for which slot
  reg [SLOT_BITS-1:0] read_slot_q;
  reg [1:0] read_place_q;
  reg read_leaf_q, read_fresh_q;                 // after a leaf; it came in the cycle before
  reg [KEPT_BITS-1:0] fresh_kept_q;
  reg pop_turn_q;                                // leaves before nodes
  reg fetching_q, retry_q;                       // a block is asked for; it has come
  reg [SLOT_BITS-1:0] fetch_slot_q;
  reg fetch_leaf_q;

  function [ADDRESS_BITS-1:0] address_of(input [SLOT_BITS-1:0] slot, input [ROW_BITS-1:0] row);
    address_of = {{ADDRESS_BITS-SLOT_BITS{1'b0}}, slot} * ROWS[ADDRESS_BITS-1:0] +
                 {{ADDRESS_BITS-ROW_BITS{1'b0}}, row};
  endfunction
  // The row that lies so many behind another one of its slot.
  function [ROW_BITS-1:0] row_behind(input [ROW_BITS-1:0] row, input [HERE_BITS-3:0] rows);
    reg [HERE_BITS-1:0] sum;
    begin
      sum = {{HERE_BITS-ROW_BITS{1'b0}}, row} + {2'd0, rows};
      if (sum >= ROWS[HERE_BITS-1:0]) sum = sum - ROWS[HERE_BITS-1:0];
      row_behind = sum[ROW_BITS-1:0];
    end
  endfunction

  // ---- The slots of the next results, a cycle ahead: nothing changes their stacks meanwhile

  reg [SLOT_BITS-1:0] node_slot_q, leaf_slot_q;
  reg [HERE_BITS-1:0] node_here_q, leaf_here_q;
  reg [ROW_BITS-1:0] node_base_q, leaf_base_q;
  reg node_blocks_q, leaf_blocks_q;              // it has some in the memory
  always @(posedge clk_i) begin
    node_slot_q <= node_slot_i;
    node_here_q <= here_q[node_slot_i*HERE_BITS +: HERE_BITS];
    node_base_q <= base_q[node_slot_i*ROW_BITS +: ROW_BITS];
    node_blocks_q <= blocks_q[node_slot_i*BLOCK_BITS +: BLOCK_BITS] != NO_BLOCK;
    leaf_slot_q <= leaf_slot_i;
    leaf_here_q <= here_q[leaf_slot_i*HERE_BITS +: HERE_BITS];
    leaf_base_q <= base_q[leaf_slot_i*ROW_BITS +: ROW_BITS];
    leaf_blocks_q <= blocks_q[leaf_slot_i*BLOCK_BITS +: BLOCK_BITS] != NO_BLOCK;
  end

  // What is known of a ray that wants an entry: whether it is done, or has none in the RAM; where the youngest is.
  localparam integer WANT_BITS = SLOT_BITS + 2 + ADDRESS_BITS + 2;
  function [WANT_BITS-1:0] want_of(
    input [SLOT_BITS-1:0] slot, input over, input has_blocks, input [HERE_BITS-1:0] here, input [ROW_BITS-1:0] base);
    reg [HERE_BITS-1:0] last;
    begin
      last = here - ONE;
      want_of = {slot, over || (here == NONE && !has_blocks), here == NONE,
                 address_of(slot, row_behind(base, last[HERE_BITS-1:2])), last[1:0]};
    end
  endfunction

  // ---- A node's result: its children but the nearest are put on the stack

  wire meets = node_valid_i && node_children_i != 3'd0;
  wire [2:0] others = node_children_i - 3'd1;
  wire pushes = meets && others != 3'd0;
  wire [HERE_BITS-1:0] node_here_then = node_here_q + {{HERE_BITS-3{1'b0}}, others};
  wire full = (others == 3'd1 && node_here_q >= MOST[HERE_BITS-1:0]) ||
              (others == 3'd2 && node_here_q >= MOST[HERE_BITS-1:0] - ONE) ||
              (others == 3'd3 && node_here_q >= MOST[HERE_BITS-1:0] - TWO);
  assign node_goes_on_o = meets && !full;

  // ---- Slots that wait: none is in two queues, or twice in one

  wire [1:0] pop_there, pop_passes, pop_ready;   // of nodes, of leaves
  wire [WANT_BITS-1:0] node_want, leaf_want;
  rp_pass_queue #(.WIDTH(WANT_BITS), .DEPTH(SLOTS)) node_pops (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(node_valid_i && !meets),
    .data_i(want_of(node_slot_q, 1'b0, node_blocks_q, node_here_q, node_base_q)),
    .valid_o(pop_there[0]),
    .passes_o(pop_passes[0]),
    .ready_i(pop_ready[0]),
    .data_o(node_want)
  );
  rp_pass_queue #(.WIDTH(WANT_BITS), .DEPTH(SLOTS)) leaf_pops (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(leaf_valid_i),
    .data_i(want_of(leaf_slot_q, leaf_over_i, leaf_blocks_q, leaf_here_q, leaf_base_q)),
    .valid_o(pop_there[1]),
    .passes_o(pop_passes[1]),
    .ready_i(pop_ready[1]),
    .data_o(leaf_want)
  );
  wire spill_there, spill_passes, spill_ready;
  wire [SLOT_BITS-1:0] spill_slot;
  wire [ADDRESS_BITS-1:0] spill_address;         // of its oldest entries
  rp_pass_queue #(.WIDTH(SLOT_BITS + ADDRESS_BITS), .DEPTH(SLOTS)) spills (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(meets && full),
    .data_i({node_slot_q, address_of(node_slot_q, node_base_q)}),
    .valid_o(spill_there),
    .passes_o(spill_passes),
    .ready_i(spill_ready),
    .data_o({spill_slot, spill_address})
  );
  // The slot that comes to want a block is known late: if it cannot be asked for at once, it is put into the queue a
  // cycle later.
  wire fetch_comes, fetch_waits, fetch_ready, unused;
  wire fetch_begins = fetch_ready && (fetch_waits || fetch_comes);
  reg fetch_late_q;
  reg [SLOT_BITS:0] fetch_want_q;
  wire [SLOT_BITS:0] fetch_want_comes, fetch_want_waits;   // after a leaf; slot
  wire [SLOT_BITS:0] fetch_want = fetch_waits ? fetch_want_waits : fetch_want_comes;
  wire [SLOT_BITS-1:0] fetch_slot = fetch_want[SLOT_BITS-1:0];
  always @(posedge clk_i) fetch_late_q <= rst_ni && fetch_comes && (fetch_waits || !fetch_ready);
  always @(posedge clk_i) fetch_want_q <= fetch_want_comes;
  rp_pass_queue #(.WIDTH(1 + SLOT_BITS), .DEPTH(SLOTS)) fetches (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(fetch_late_q),
    .data_i(fetch_want_q),
    .valid_o(fetch_waits),
    .passes_o(unused),
    .ready_i(fetch_ready),
    .data_o(fetch_want_waits)
  );

  // What is kept of a slot that waits: the limit, or the nearest child; read with the entry.
  wire keep_reads;
  wire [SLOT_BITS-1:0] keep_slot;
  wire [KEPT_BITS-1:0] node_keeps = meets ? {{KEPT_BITS-REFERENCE_BITS{1'b0}}, node_nearest_i}
                                          : {{KEPT_BITS-KEY_BITS{1'b0}}, node_limit_i};
  wire [KEPT_BITS-1:0] node_kept;
  wire [KEY_BITS-1:0] leaf_kept;
  rp_ram_1r1w #(.WIDTH(KEPT_BITS), .DEPTH(SLOTS)) node_keep (
    .clk_i(clk_i),
    .read_i(keep_reads),
    .read_address_i(keep_slot),
    .read_data_o(node_kept),
    .write_i(node_valid_i),
    .write_address_i(node_slot_q),
    .write_data_i(node_keeps)
  );
  rp_ram_1r1w #(.WIDTH(KEY_BITS), .DEPTH(SLOTS)) leaf_keep (
    .clk_i(clk_i),
    .read_i(keep_reads),
    .read_address_i(keep_slot),
    .read_data_o(leaf_kept),
    .write_i(leaf_valid_i),
    .write_address_i(leaf_slot_q),
    .write_data_i(leaf_limit_i)
  );

  // ---- What was read in the cycle before

  wire [4*ENTRY_BITS-1:0] word;
  wire [ENTRY_BITS-1:0] entry = word[read_place_q*ENTRY_BITS +: ENTRY_BITS];
  wire [KEY_BITS-1:0] limit = read_fresh_q ? fresh_kept_q[KEY_BITS-1:0]
                                           : (read_leaf_q ? leaf_kept : node_kept[KEY_BITS-1:0]);
  wire [REFERENCE_BITS-1:0] nearest = read_fresh_q ? fresh_kept_q[REFERENCE_BITS-1:0] : node_kept[REFERENCE_BITS-1:0];
  wire [HERE_BITS-1:0] read_here = here_q[read_slot_q*HERE_BITS +: HERE_BITS] - ONE;   // without this entry
  wire read_none = read_here == NONE;
  wire read_ends = read_none && blocks_q[read_slot_q*BLOCK_BITS +: BLOCK_BITS] == NO_BLOCK;
  wire behind = read_q == ENTRY && entry[ENTRY_BITS-1:REFERENCE_BITS] > limit;
  wire onward = behind && !read_ends;            // the same ray's next entry is wanted
  assign next_valid_o = read_q == SPILL || (read_q == ENTRY && !behind);
  assign next_slot_o = read_slot_q;
  assign next_reference_o = (read_q == SPILL) ? nearest : entry[REFERENCE_BITS-1:0];

  // ---- The next slot, unless the same ray goes on: of a block that has come, of a stack that spills, or one that
  // wants an entry. Whether a request is taken is known last: so it chooses between what is with a spill and what is
  // without.

  wire request_free = !request_valid_o || request_ready_i;
  wire spill_wants = !retry_q && spill_there;
  wire spill_next = spill_wants && request_free;
  wire leaf_first = pop_turn_q ? pop_there[1] : !pop_there[0];
  wire [SLOT_BITS-1:0] pop_slot;
  wire pop_ends, pop_none;
  wire [ADDRESS_BITS-1:0] pop_address;           // of its youngest entry
  wire [1:0] pop_place;
  assign {pop_slot, pop_ends, pop_none, pop_address, pop_place} = leaf_first ? leaf_want : node_want;
  wire pop_wants = !retry_q && (!pop_ends || read_q == NOTHING);
  wire pop_may = pop_wants && !spill_next;
  wire pop_next = pop_may && pop_there != 2'd0;

  assign pop_ready = {pop_may && !onward && leaf_first, pop_may && !onward && !leaf_first};
  assign spill_ready = !retry_q && request_free && !onward;
  wire spill_taken = spill_next && !onward;
  wire pop_would_end = pop_wants && pop_there != 2'd0 && pop_ends;
  wire pop_done = pop_would_end && !spill_next;  // so that nothing was read
  assign done_valid_o = (behind && read_ends) || pop_done;
  assign done_slot_o = (read_q == NOTHING) ? pop_slot : read_slot_q;
  assign ray_ready_o = read_q == NOTHING && (!pop_would_end || spill_next);

  // ---- The read: the row of the youngest entry, or of the oldest four

  wire [HERE_BITS-1:0] onward_last = read_here - ONE;
  wire [ROW_BITS-1:0] read_base = base_q[read_slot_q*ROW_BITS +: ROW_BITS];
  wire [ADDRESS_BITS-1:0] onward_address =
    address_of(read_slot_q, row_behind(read_base, onward_last[HERE_BITS-1:2]));
  wire [ADDRESS_BITS-1:0] retry_address = address_of(fetch_slot_q, FIRST_ROW);
  wire [ADDRESS_BITS-1:0] next_address = retry_q ? retry_address : (spill_next ? spill_address : pop_address);
  wire takes = onward ? !read_none : (retry_q || (pop_next && !pop_ends && !pop_none));
  wire reads = takes || spill_taken;
  assign keep_slot = retry_q ? fetch_slot_q : (spill_next ? spill_slot : pop_slot);
  assign keep_reads = !onward;

  always @(posedge clk_i)
    if (!rst_ni) read_q <= NOTHING;
    else read_q <= takes ? ENTRY : (spill_taken ? SPILL : NOTHING);
  always @(posedge clk_i) read_place_q <= onward ? onward_last[1:0] : (retry_q ? 2'd3 : pop_place);
  always @(posedge clk_i)
    if (!onward) begin
      read_slot_q <= keep_slot;
      read_leaf_q <= retry_q ? fetch_leaf_q : leaf_first;
      read_fresh_q <= !retry_q && (spill_next ? spill_passes : (leaf_first ? pop_passes[1] : pop_passes[0]));
      fresh_kept_q <= (leaf_first && !spill_next) ? {{KEPT_BITS-KEY_BITS{1'b0}}, leaf_limit_i} : node_keeps;
    end
  always @(posedge clk_i)
    if (!rst_ni) pop_turn_q <= 1'b0;
    else if (pop_next && !onward) pop_turn_q <= !leaf_first;

  // ---- Blocks that come back

  assign fetch_comes = onward ? read_none : (pop_next && !pop_ends && pop_none);
  assign fetch_want_comes = onward ? {read_leaf_q, read_slot_q} : {leaf_first, pop_slot};
  assign fetch_ready = !fetching_q && !(retry_q && onward) && request_free && !spill_taken;
  wire fill = (fill_valid_i || fill_waits_o) && !pushes;
  reg [4*ENTRY_BITS-1:0] fill_q;
  always @(posedge clk_i)
    if (!rst_ni) begin
      fetching_q <= 1'b0;
      retry_q <= 1'b0;
      fill_waits_o <= 1'b0;
    end else begin
      if (fetch_begins) fetching_q <= 1'b1;
      else if (fill) fetching_q <= 1'b0;
      retry_q <= fill || (retry_q && onward);
      fill_waits_o <= (fill_valid_i || fill_waits_o) && pushes;
    end
  always @(posedge clk_i)
    if (fetch_begins) begin
      fetch_slot_q <= fetch_slot;
      fetch_leaf_q <= fetch_want[SLOT_BITS];
    end
  always @(posedge clk_i) if (fill_valid_i) fill_q <= fill_entries_i;

  // ---- What goes to the memory: the RAM's word and the slot's count, in registers from the next cycle on

  reg request_fresh_q;
  reg [BLOCK_BITS-1:0] request_block_q;
  wire [BLOCK_BITS-1:0] request_blocks = blocks_q[request_slot_o*BLOCK_BITS +: BLOCK_BITS];
  assign request_block_o = !request_fresh_q ? request_block_q
                                            : (request_write_o ? request_blocks : request_blocks - 1'b1);
  always @(posedge clk_i)
    if (!rst_ni) request_valid_o <= 1'b0;
    else if (request_free) request_valid_o <= spill_taken || fetch_begins;
  always @(posedge clk_i) begin
    request_fresh_q <= spill_taken || fetch_begins;
    request_block_q <= request_block_o;
  end
  always @(posedge clk_i)
    if (request_free) begin
      request_write_o <= spill_taken;
      request_slot_o <= spill_taken ? spill_slot : fetch_slot;
    end
  wire [4*ENTRY_BITS-1:0] spilled;
  reg [4*ENTRY_BITS-1:0] spilled_q;
  assign request_entries_o = (read_q == SPILL) ? spilled : spilled_q;
  always @(posedge clk_i) if (read_q == SPILL) spilled_q <= spilled;

  // ---- The RAMs: place g of every row. A block that comes finds no entry there, and gets the slot's first row.

  wire [ROW_BITS-1:0] push_row = row_behind(node_base_q, node_here_q[HERE_BITS-1:2]);
  wire [ADDRESS_BITS-1:0] push_address = address_of(node_slot_q, push_row);
  wire [ADDRESS_BITS-1:0] push_address_behind = address_of(node_slot_q, row_behind(push_row, ONE[HERE_BITS-3:0]));
  wire [1:0] first = node_here_q[1:0];            // place of the first entry that is put on the stack
  wire [4*ENTRY_BITS-1:0] others_padded = {{ENTRY_BITS{1'b0}}, node_others_i};
  genvar g;
  generate
    for (g = 0; g < 4; g = g + 1) begin : gen_place
      localparam [1:0] PLACE = g;
      wire [2:0] which = {1'b0, PLACE} - {1'b0, first};   // of the others; first bit: in the row behind
      wire [ENTRY_BITS-1:0] other = others_padded[which[1:0]*ENTRY_BITS +: ENTRY_BITS];
      wire [ENTRY_BITS-1:0] filled = fill_valid_i ? fill_entries_i[g*ENTRY_BITS +: ENTRY_BITS]
                                                  : fill_q[g*ENTRY_BITS +: ENTRY_BITS];
      wire [ADDRESS_BITS-1:0] other_address = which[2] ? push_address_behind : push_address;
      wire pushed = pushes && {1'b0, which[1:0]} < others;
      rp_ram_1r1w #(.WIDTH(ENTRY_BITS), .DEPTH(SLOTS * ROWS)) entries (
        .clk_i(clk_i),
        .read_i(reads),
        .read_address_i(onward ? onward_address : next_address),
        .read_data_o(word[g*ENTRY_BITS +: ENTRY_BITS]),
        .write_i(pushed || fill),
        .write_address_i(pushes ? other_address : retry_address),
        .write_data_i(pushes ? other : filled)
      );
    end
    // With eight entries an oldest one can be put on the stack in the cycle in which it is read: the last of its row.
    if (ENTRIES == 8) begin : gen_forward
      reg forward_q;
      reg [ENTRY_BITS-1:0] forward_entry_q;
      always @(posedge clk_i) begin
        forward_q <= spill_passes && node_here_q == BLOCK - ONE;
        if (pushes) forward_entry_q <= node_others_i[ENTRY_BITS-1:0];
      end
      assign spilled = {forward_q ? forward_entry_q : word[3*ENTRY_BITS +: ENTRY_BITS], word[3*ENTRY_BITS-1:0]};
    end else begin : gen_no_forward
      assign spilled = word;
    end
  endgenerate

  // ---- Counts: of what was read in the cycle before. For the slot of the cycle before use read_here. A ray that has
  // not begun yet has an empty stack too.

  wire [HERE_BITS-1:0] spilled_here = read_here - (BLOCK - ONE);
  wire [BLOCK_BITS-1:0] spilled_blocks = blocks_q[read_slot_q*BLOCK_BITS +: BLOCK_BITS] + 1'b1;
  wire [ROW_BITS-1:0] spilled_base = row_behind(read_base, ONE[HERE_BITS-3:0]);
  wire [BLOCK_BITS-1:0] filled_blocks = blocks_q[fetch_slot_q*BLOCK_BITS +: BLOCK_BITS] - 1'b1;
  integer s;
  always @(posedge clk_i)
    for (s = 0; s < SLOTS; s = s + 1) begin
      if (!rst_ni || (ray_valid_i && ray_slot_i == s[SLOT_BITS-1:0])) begin
        here_q[s*HERE_BITS +: HERE_BITS] <= NONE;
        blocks_q[s*BLOCK_BITS +: BLOCK_BITS] <= NO_BLOCK;
        base_q[s*ROW_BITS +: ROW_BITS] <= FIRST_ROW;
      end else if (read_q != NOTHING && read_slot_q == s[SLOT_BITS-1:0]) begin
        here_q[s*HERE_BITS +: HERE_BITS] <= (read_q == SPILL) ? spilled_here : read_here;
        if (read_q == SPILL) begin
          blocks_q[s*BLOCK_BITS +: BLOCK_BITS] <= spilled_blocks;
          base_q[s*ROW_BITS +: ROW_BITS] <= spilled_base;
        end
      end else if (pushes && node_slot_q == s[SLOT_BITS-1:0]) here_q[s*HERE_BITS +: HERE_BITS] <= node_here_then;
      else if (fill && fetch_slot_q == s[SLOT_BITS-1:0]) begin
        here_q[s*HERE_BITS +: HERE_BITS] <= BLOCK;
        blocks_q[s*BLOCK_BITS +: BLOCK_BITS] <= filled_blocks;
        base_q[s*ROW_BITS +: ROW_BITS] <= FIRST_ROW;
      end
    end
endmodule
`default_nettype wire
