// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The leaves that a lane's rays come to: which of their lines are wanted from the cache, and the triangles in them, one
// in a cycle. A leaf's triangles are 11 words each, one behind the other, so some lie in two lines: the next line is
// wanted when one has come, and of a line that does not end with a triangle the last words are kept by slot. Where a
// line is missed, those of the leaf behind it are prefetched: looked up at once, with no ray waiting.
// Promises: of each leaf that a ray comes to all triangles are begun, in their order; lines leave in the order in which
// they came. No output depends on an input of the same cycle.
// Must be given: a slot that starts a leaf has begun all triangles of the one before; an offer that is taken is valid,
// and one at most; a line two cycles after its lookup if the cache has it; waited_i only while room_o, and not with
// taken_i; a line for each.
`default_nettype none
module rp_leaf_reader #(
  parameter integer SLOTS = 24,
  parameter integer LINE_BITS = 26,              // of a line's number, 28 at most
  parameter integer LINES = 5,                   // that it holds, and that are on their way
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  // rays go on with a leaf, from a node, and from the stack: its number of triangles and the place of the first
  input  wire [1:0]             start_i,
  input  wire [2*SLOT_BITS-1:0] start_slot_i,
  input  wire [2*31-1:0]        start_leaf_i,
  // two lines to look up, of which one can be taken, the first rather; either may be a prefetch
  output wire [1:0]             want_o,
  output wire [1:0]             want_prefetch_o,
  output wire [2*LINE_BITS-1:0] want_line_o,
  output wire [2*SLOT_BITS-1:0] want_slot_o,
  input  wire [1:0]             taken_i,
  output wire                   room_o,
  input  wire                   waited_i,            // a line is taken for which a ray has waited
  input  wire                   given_i,
  input  wire [SLOT_BITS-1:0]   given_slot_i,
  input  wire [511:0]           given_data_i,
  // the ray that gets the triangles from the next cycle on
  output wire                   load_o,
  output wire [SLOT_BITS-1:0]   load_slot_o,
  // a triangle
  output wire                   triangle_valid_o,
  input  wire                   triangle_ready_i,
  output wire [SLOT_BITS-1:0]   triangle_slot_o,
  output wire                   triangle_last_o,     // of its leaf
  output wire [28:0]            triangle_place_o,
  output wire [351:0]           triangle_o           // corners, number, material
);
  generate
    if (LINE_BITS > 28) begin : gen_bad_line_bits
      leaf_reader_LINE_BITS_must_be_28_or_less illegal ();
    end
  endgenerate
  // What is still to be read of a leaf: its next line, where in it the next triangle begins, in words, which may be
  // before it; how many triangles; the place of the first.
  localparam integer LEAF_BITS = LINE_BITS + 5 + 3 + 29;
  localparam integer QUEUED_BITS = SLOT_BITS + LEAF_BITS;
  localparam integer HELD_BITS = $clog2(LINES + 1);
  localparam [31:0] MOST = LINES;
  localparam [HELD_BITS-1:0] ALL_LINES = MOST[HELD_BITS-1:0];

  // ---- Rays that want a line: those that come from a node, from the stack, and those that go on in a leaf

  wire further;
  wire [QUEUED_BITS-1:0] further_data;
  wire [2:0] waits, popped;
  wire [3*QUEUED_BITS-1:0] waiting;
  genvar g;
  generate
    for (g = 0; g < 3; g = g + 1) begin : gen_queue
      wire push;
      wire [QUEUED_BITS-1:0] data;
      if (g < 2) begin : gen_start
        // The ray that starts is known late in a cycle: the leaf's first word is found in the next one.
        reg start_q;
        reg [SLOT_BITS-1:0] start_slot_q;
        reg [1:0] more_q;
        reg [28:0] start_place_q;
        always @(posedge clk_i) start_q <= rst_ni && start_i[g];
        always @(posedge clk_i) begin
          start_slot_q <= start_slot_i[g*SLOT_BITS+:SLOT_BITS];
          {more_q, start_place_q} <= start_leaf_i[g*31+:31];
        end
        wire [32:0] word = {1'b0, start_place_q, 3'd0} + {3'd0, start_place_q, 1'b0} + {4'd0, start_place_q};
        // A place beyond the last line has that line's number, so that it is not taken for another.
        wire [LINE_BITS-1:0] start_line = word[4+:LINE_BITS] | {LINE_BITS{|word[32:LINE_BITS+4]}};
        assign push = start_q;
        assign data = {start_slot_q, start_line, 1'b0, word[3:0], {1'b0, more_q} + 3'd1, start_place_q};
      end else begin : gen_further
        assign push = further;
        assign data = further_data;
      end
      rp_ram_queue #(.WIDTH(QUEUED_BITS), .DEPTH(SLOTS)) queue (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .push_i(push),
        .data_i(data),
        .valid_o(waits[g]),
        .ready_i(popped[g]),
        .data_o(waiting[g*QUEUED_BITS+:QUEUED_BITS])
      );
    end
  endgenerate

  reg [1:0] turn_q;                              // the queue that is offered first
  reg [2:0] next;
  always @*
    case (turn_q)
      2'd0: next = waits[0] ? 3'd1 : waits[1] ? 3'd2 : waits & 3'd4;
      2'd1: next = waits[1] ? 3'd2 : waits[2] ? 3'd4 : waits & 3'd1;
      default: next = waits[2] ? 3'd4 : waits[0] ? 3'd1 : waits & 3'd2;
    endcase

  // Lines that will be wanted; of the oldest leaf so many have been offered. They go before the others.
  wire ahead;
  wire [LINE_BITS-1:0] ahead_line;
  wire [1:0] ahead_count;
  reg [1:0] ahead_step_q;
  wire ahead_last = ahead_step_q + 2'd1 == ahead_count;

  localparam integer OFFER_BITS = QUEUED_BITS + 1;   // one more bit: a prefetch
  wire [1:0] offered;
  wire [2*OFFER_BITS-1:0] offers;
  wire offers_ready, was_taken, was_prefetch;
  wire [QUEUED_BITS-1:0] next_data =
    ({QUEUED_BITS{next[0]}} & waiting[0+:QUEUED_BITS]) |
    ({QUEUED_BITS{next[1]}} & waiting[QUEUED_BITS+:QUEUED_BITS]) |
    ({QUEUED_BITS{next[2]}} & waiting[2*QUEUED_BITS+:QUEUED_BITS]);
  wire [QUEUED_BITS-1:0] ahead_data =
    {{SLOT_BITS{1'b0}}, ahead_line + {{LINE_BITS-2{1'b0}}, ahead_step_q}, {LEAF_BITS-LINE_BITS{1'b0}}};
  wire asked;                                    // in the cycle before
  wire [SLOT_BITS-1:0] asked_slot;
  wire [LINE_BITS-1:0] asked_line;
  wire [4:0] asked_at;
  wire [2:0] asked_left;
  wire [28:0] asked_place;
  rp_line_offers #(.WIDTH(OFFER_BITS)) line_offers (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(ahead || |waits),
    .ready_o(offers_ready),
    .data_i({ahead, ahead ? ahead_data : next_data}),
    .valid_o(offered),
    .data_o(offers),
    .taken_i(taken_i),
    .asked_o(was_taken),
    .asked_data_o({was_prefetch, asked_slot, asked_line, asked_at, asked_left, asked_place})
  );
  assign asked = was_taken && !was_prefetch;
  assign popped = (offers_ready && !ahead) ? next : 3'd0;
  wire ahead_taken = offers_ready && ahead;
  always @(posedge clk_i)
    if (!rst_ni) begin
      turn_q <= 2'd0;
      ahead_step_q <= 2'd0;
    end else begin
      if (|popped) turn_q <= next[0] ? 2'd1 : next[1] ? 2'd2 : 2'd0;
      if (ahead_taken) ahead_step_q <= ahead_last ? 2'd0 : ahead_step_q + 2'd1;
    end
  generate
    for (g = 0; g < 2; g = g + 1) begin : gen_want
      localparam integer TOP = (g + 1) * OFFER_BITS - 1;
      assign want_prefetch_o[g] = offers[TOP];
      assign {want_slot_o[g*SLOT_BITS+:SLOT_BITS], want_line_o[g*LINE_BITS+:LINE_BITS]} =
        offers[TOP-1-:SLOT_BITS+LINE_BITS];
      assign want_o[g] = offered[g] && (want_prefetch_o[g] || room_o);
    end
  endgenerate

  // ---- What has been looked up: two cycles later it comes, or it was not there

  wire [LEAF_BITS-1:0] pending;                  // of the ray that is given a line, one cycle later
  rp_ram_1r1w #(.WIDTH(LEAF_BITS), .DEPTH(SLOTS)) pending_ram (
    .clk_i(clk_i),
    .read_i(given_i),
    .read_address_i(given_slot_i),
    .read_data_o(pending),
    .write_i(asked),
    .write_address_i(asked_slot),
    .write_data_i({asked_line, asked_at, asked_left, asked_place})
  );
  wire [6:0] asked_end = {{2{asked_at[4]}}, asked_at} + {4'd0, asked_left} + {3'd0, asked_left, 1'b0} +
                         {1'b0, asked_left, 3'd0} - 7'd1;   // the leaf's last word, from this line's first one on
  reg due_q;
  reg [LINE_BITS-1:0] due_line_q;                // the one behind it
  reg [1:0] due_behind_q;
  always @(posedge clk_i)
    if (!rst_ni) due_q <= 1'b0;
    else due_q <= asked;
  always @(posedge clk_i) begin
    due_line_q <= asked_line + 1'b1;
    due_behind_q <= asked_end[5:4];
  end
  wire missed = due_q && !given_i;
  reg [2:0] ahead_size_q;                        // further ones are forgotten
  wire remember = missed && due_behind_q != 2'd0 && !ahead_size_q[2];
  wire forget = ahead_taken && ahead_last;
  always @(posedge clk_i)
    if (!rst_ni) ahead_size_q <= 3'd0;
    else ahead_size_q <= ahead_size_q + {2'd0, remember} - {2'd0, forget};
  rp_ram_queue #(.WIDTH(LINE_BITS+2), .DEPTH(4)) ahead_queue (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(remember),
    .data_i({due_line_q, due_behind_q}),
    .valid_o(ahead),
    .ready_i(forget),
    .data_o({ahead_line, ahead_count})
  );

  // ---- A line has come: which triangles end in it, and what is left of the leaf

  reg come_q;
  reg [SLOT_BITS-1:0] come_slot_q;
  reg [511:0] come_data_q;
  always @(posedge clk_i) come_q <= rst_ni && given_i;
  always @(posedge clk_i)
    if (given_i) begin
      come_slot_q <= given_slot_i;
      come_data_q <= given_data_i;
    end
  wire [LINE_BITS-1:0] come_line = pending[LEAF_BITS-1-:LINE_BITS];
  wire signed [4:0] come_at = pending[32+:5];
  wire [2:0] come_left = pending[29+:3];
  wire [28:0] come_place = pending[28:0];
  wire two = come_at <= -5'sd6 && come_left != 3'd1, none = come_at >= 5'sd6;
  wire [1:0] come_tests = two ? 2'd2 : none ? 2'd0 : 2'd1;
  wire [2:0] left_behind = come_left - {1'b0, come_tests};
  assign further = come_q && left_behind != 3'd0;
  wire [4:0] at_behind = come_at + (two ? 5'd6 : none ? 5'd16 : 5'd27);   // 22, 0, 11 - 16, modulo 32
  assign further_data = {come_slot_q, come_line + 1'b1, at_behind, left_behind,
                         come_place + {27'd0, come_tests}};

  localparam integer LINE_WIDTH = SLOT_BITS + 2 + 5 + 3 + 29 + 512;
  wire line_valid, line_passes, line_taken;
  wire [LINE_WIDTH-1:0] line;
  rp_pass_queue #(.WIDTH(LINE_WIDTH), .DEPTH(LINES)) lines (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(come_q),
    .data_i({come_slot_q, come_tests, come_at, come_left, come_place, come_data_q}),
    .valid_o(line_valid),
    .passes_o(line_passes),
    .ready_i(line_taken),
    .data_o(line)
  );

  // ---- The oldest line

  reg held_line_q;
  reg [SLOT_BITS-1:0] slot_q;
  reg [1:0] tests_q;                             // that are to be begun
  reg [4:0] at_q;
  reg [2:0] left_q;
  reg [28:0] place_q;
  reg [511:0] data_q;
  wire [319:0] kept;                             // the last words of the line before
  assign triangle_valid_o = held_line_q && tests_q != 2'd0;
  wire begin_one = triangle_valid_o && triangle_ready_i;
  wire line_leaves = held_line_q && (tests_q == 2'd0 || (tests_q == 2'd1 && triangle_ready_i));
  wire [2:0] left_then = left_q - {2'd0, tests_q != 2'd0};
  wire [SLOT_BITS-1:0] line_slot = line[LINE_WIDTH-1-:SLOT_BITS];
  // A ray's next line waits for what is kept of this one.
  assign line_taken = !held_line_q || (line_leaves && line_slot != slot_q);
  wire load = line_valid && line_taken;
  rp_ram_1r1w #(.WIDTH(320), .DEPTH(SLOTS)) kept_ram (
    .clk_i(clk_i),
    .read_i(load),
    .read_address_i(line_slot),
    .read_data_o(kept),
    .write_i(line_leaves && left_then != 3'd0),
    .write_address_i(slot_q),
    .write_data_i(data_q[511:192])
  );
  always @(posedge clk_i)
    if (!rst_ni) held_line_q <= 1'b0;
    else if (load) held_line_q <= 1'b1;
    else if (line_leaves) held_line_q <= 1'b0;
  always @(posedge clk_i)
    if (load) {slot_q, tests_q, at_q, left_q, place_q, data_q} <= line;
    else if (begin_one) begin
      tests_q <= tests_q - 2'd1;
      at_q <= at_q + 5'd11;
      left_q <= left_then;
      place_q <= place_q + 29'd1;
    end
  assign load_o = load;
  assign load_slot_o = line_slot;
  assign triangle_slot_o = slot_q;
  assign triangle_last_o = left_q == 3'd1;
  assign triangle_place_o = place_q;
  wire [4:0] moved = at_q + 5'd10;               // 0 .. 15 where a triangle is complete
  wire [831:0] words = {data_q, kept};
  assign triangle_o = words[{1'b0, moved[3:0], 5'd0} +: 352];
  wire unused = &{1'b0, line_passes, moved[4], asked_end[6], asked_end[3:0]};

  // ---- Lines that it holds, and that are on their way: one that was taken is counted in the next cycle

  reg [HELD_BITS-1:0] held_q;
  assign room_o = held_q != ALL_LINES && !(asked && held_q == ALL_LINES - 1'b1);
  always @(posedge clk_i)
    if (!rst_ni) held_q <= {HELD_BITS{1'b0}};
    else held_q <= held_q + {{HELD_BITS-1{1'b0}}, asked} + {{HELD_BITS-1{1'b0}}, waited_i} -
                   {{HELD_BITS-1{1'b0}}, missed} - {{HELD_BITS-1{1'b0}}, line_leaves};
endmodule
`default_nettype wire
