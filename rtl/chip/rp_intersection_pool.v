// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The intersection pool: a queue for each kind of intersection behind a port of 128 bits. docs/machine/pools.md gives
// its cycles. Promises: the oldest package of the kind that is asked for leaves, once, its beats in the order of the
// requests; its place is free from the cycle after its request has been taken on; no output depends on an input of the
// same cycle. Must be given: the beats of a package one after the other, of one kind; a request that stays until it is
// taken; reservations of what is available only, and requests of what has been reserved. Kinds are 1 normal, 2 shadow,
// 3 direct; buses with something for each kind have normal in the low bits. 2 only with SHADOWS, 3 only with CULLING.
`default_nettype none
module rp_intersection_pool #(
  parameter integer SIZE = 512,               // packages of each kind
  parameter integer INTERSECTION_WORDS = 21,
  parameter integer OVERHEAD = 2,             // cycles of the port for a package, before its beats
  parameter integer CYCLES_PER_BEAT = 1,
  parameter integer PIPELINED = 0,            // the next request is served while the beats of the last package move
  parameter integer CULLING = 0,
  parameter integer SHADOWS = 1,              // there are packages of shadow rays; without, no room for them
  parameter integer KINDS = 2 + CULLING,
  parameter integer LEVEL_BITS = $clog2(SIZE + 1)
) (
  input  wire                        clk_i,
  input  wire                        rst_ni,
  // from the traverser: beats of a package
  input  wire                        put_valid_i,
  output wire [KINDS-1:0]            put_ready_o,      // of each kind
  input  wire [1:0]                  put_kind_i,
  input  wire [127:0]                put_data_i,
  // to the units
  input  wire                        request_valid_i,
  output wire                        request_ready_o,
  input  wire [1:0]                  request_kind_i,
  input  wire [1:0]                  request_unit_i,
  output reg                         beat_valid_o,
  output wire [127:0]                beat_data_o,
  // the pixel that the package is of: word 3 of the beat that is shown
  output reg                         pixel_valid_o,
  output reg  [1:0]                  pixel_unit_o,
  // levels, for the controller
  output wire [KINDS*LEVEL_BITS-1:0] size_o,
  output wire [KINDS*LEVEL_BITS-1:0] available_o,      // not reserved
  input  wire                        reserve_valid_i,
  input  wire [1:0]                  reserve_kind_i,
  input  wire [LEVEL_BITS-1:0]       reserve_count_i,
  // for the report, right two cycles after the last event
  output wire [47:0]                 taken_o           // packages
);
  generate
    if (SIZE < 1 || SIZE > 1048576) begin : gen_bad_size
      intersection_pool_SIZE_must_be_from_1_to_1048576 illegal ();
    end
    if (INTERSECTION_WORDS < 12 || INTERSECTION_WORDS > 21) begin : gen_bad_words
      intersection_pool_INTERSECTION_WORDS_must_be_from_12_to_21 illegal ();
    end
    if (OVERHEAD < 1 || OVERHEAD > 64 || CYCLES_PER_BEAT < 1 || CYCLES_PER_BEAT > 64) begin : gen_bad_cycles
      intersection_pool_OVERHEAD_and_CYCLES_PER_BEAT_must_be_from_1_to_64 illegal ();
    end
    if (PIPELINED < 0 || PIPELINED > 1 || CULLING < 0 || CULLING > 1 || SHADOWS < 0 || SHADOWS > 1) begin : gen_bad_mode
      intersection_pool_PIPELINED_CULLING_and_SHADOWS_must_be_0_or_1 illegal ();
    end
  endgenerate
  localparam integer BEATS = (INTERSECTION_WORDS + 3) / 4;
  localparam integer LAST_BEAT = BEATS - 1;
  // A package that is leaving is still in the RAM, in a place that is none of SIZE.
  localparam integer SLOTS = SIZE + 1 + PIPELINED;
  localparam integer REGIONS = KINDS - 1 + SHADOWS;
  localparam integer DEPTH = REGIONS * SLOTS * BEATS;
  localparam integer ADDRESS_BITS = $clog2(DEPTH);
  // From a request's turn until it is taken, and from then on until the next turn.
  localparam integer REQUEST_CYCLES = (OVERHEAD > 2) ? OVERHEAD - 1 : 1;
  localparam integer REQUEST_WAIT = REQUEST_CYCLES - 1;
  localparam integer NEXT_WAIT = (PIPELINED != 0) ? 0 : OVERHEAD + BEATS * CYCLES_PER_BEAT - REQUEST_CYCLES - 1;
  localparam integer WAIT_BITS = $clog2(NEXT_WAIT + REQUEST_WAIT + 2);
  localparam integer GAP_BITS = (CYCLES_PER_BEAT > 1) ? $clog2(CYCLES_PER_BEAT) : 1;
  localparam integer GAP = CYCLES_PER_BEAT - 1;

  // ---- Requests. Pending: it is taken when wait_q is 0 and the register for the next package is free. Else the next
  // turn begins wait_q cycles from now at the earliest. As a request stays, registers have what it asks for by then.
  reg pending_q;
  reg [1:0] asked_kind_q, asked_unit_q;
  reg [WAIT_BITS-1:0] wait_q;
  reg next_valid_q;                    // a package has been taken, and none of its beats read
  reg [1:0] next_kind_q, next_unit_q;
  wire [KINDS-1:0] filled;             // there is a package of the kind, or its last beat comes in this cycle
  wire waits = wait_q != {WAIT_BITS{1'b0}};
  wire taken = pending_q && !waits && !next_valid_q;
  assign request_ready_o = taken;
  wire [3:0] filled_kind = {{3-KINDS{1'b0}}, filled, 1'b0};
  wire turn = request_valid_i && !pending_q && filled_kind[request_kind_i];

  always @(posedge clk_i)
    if (!rst_ni) begin
      pending_q <= 1'b0;
      wait_q <= {WAIT_BITS{1'b0}};
    end else begin
      if (turn) pending_q <= 1'b1;
      else if (taken) pending_q <= 1'b0;
      if (turn) wait_q <= wait_q + REQUEST_WAIT[WAIT_BITS-1:0];
      else if (taken) wait_q <= NEXT_WAIT[WAIT_BITS-1:0];
      else if (waits) wait_q <= wait_q - 1'b1;
    end
  always @(posedge clk_i)
    if (!pending_q) begin
      asked_kind_q <= request_kind_i;
      asked_unit_q <= request_unit_i;
    end

  // ---- Beats. One is read a cycle before it is shown: of the package that moves, or else of the next one.
  reg [2:0] left_q;                    // beats of the package that moves
  reg [1:0] kind_q, unit_q;            // its
  reg [GAP_BITS-1:0] gap_q;
  wire moving = left_q != 3'd0;
  wire first = !moving && (next_valid_q || taken);
  wire read = gap_q == {GAP_BITS{1'b0}} && (moving || first);
  wire begins = read && first;
  wire [1:0] kind = moving ? kind_q : next_valid_q ? next_kind_q : asked_kind_q;
  wire [1:0] unit = next_valid_q ? next_unit_q : asked_unit_q;

  always @(posedge clk_i)
    if (!rst_ni) begin
      next_valid_q <= 1'b0;
      left_q <= 3'd0;
      gap_q <= {GAP_BITS{1'b0}};
      beat_valid_o <= 1'b0;
      pixel_valid_o <= 1'b0;
    end else begin
      next_valid_q <= (next_valid_q || taken) && !begins;
      if (read) left_q <= (moving ? left_q : BEATS[2:0]) - 3'd1;
      gap_q <= read ? GAP[GAP_BITS-1:0] : (gap_q == {GAP_BITS{1'b0}}) ? gap_q : gap_q - 1'b1;
      beat_valid_o <= read;
      pixel_valid_o <= read && left_q == LAST_BEAT[2:0];
    end
  always @(posedge clk_i) begin
    if (taken) begin
      next_kind_q <= asked_kind_q;
      next_unit_q <= asked_unit_q;
    end
    if (begins) begin
      kind_q <= kind;
      unit_q <= unit;
    end
    if (read) pixel_unit_o <= unit_q;
  end

  // ---- The traverser's port. A package that has begun to come has its place.
  reg [2:0] put_beat_q;
  wire begun = put_beat_q != 3'd0;
  wire [3:0] put_ready_kind = {{3-KINDS{1'b0}}, put_ready_o, 1'b0};
  wire put = put_valid_i && put_ready_kind[put_kind_i];
  wire put_last = put && put_beat_q == LAST_BEAT[2:0];
  always @(posedge clk_i)
    if (!rst_ni) put_beat_q <= 3'd0;
    else if (put) put_beat_q <= put_last ? 3'd0 : put_beat_q + 3'd1;

  // ---- The queues: a region of the RAM for each kind that there is.
  wire [KINDS*ADDRESS_BITS-1:0] heads, tails;
  genvar k;
  generate
    for (k = 0; k < KINDS; k = k + 1) begin : gen_kind
      localparam integer REGION = (k == 0 || SHADOWS != 0) ? k : k - 1;
      localparam integer FIRST = REGION * SLOTS * BEATS;
      localparam integer LAST = FIRST + SLOTS * BEATS - 1;
      localparam [1:0] KIND = k + 1;
      if (k == 1 && SHADOWS == 0) begin : gen_none
        assign filled[k] = 1'b0;
        assign put_ready_o[k] = 1'b1;
        assign size_o[k*LEVEL_BITS +: LEVEL_BITS] = {LEVEL_BITS{1'b0}};
        assign available_o[k*LEVEL_BITS +: LEVEL_BITS] = {LEVEL_BITS{1'b0}};
        assign heads[k*ADDRESS_BITS +: ADDRESS_BITS] = {ADDRESS_BITS{1'b0}};
        assign tails[k*ADDRESS_BITS +: ADDRESS_BITS] = {ADDRESS_BITS{1'b0}};
      end else begin : gen_queue
        reg [ADDRESS_BITS-1:0] head_q, tail_q;   // of the next beat to be read, and to be written
        reg [LEVEL_BITS-1:0] size_q, available_q;
        wire comes = put_last && put_kind_i == KIND;
        wire goes = taken && asked_kind_q == KIND;
        wire reads = read && kind == KIND;
        assign filled[k] = size_q != {LEVEL_BITS{1'b0}} || comes;
        assign put_ready_o[k] = size_q != SIZE[LEVEL_BITS-1:0] || begun;
        assign size_o[k*LEVEL_BITS +: LEVEL_BITS] = size_q;
        assign available_o[k*LEVEL_BITS +: LEVEL_BITS] = available_q;
        assign heads[k*ADDRESS_BITS +: ADDRESS_BITS] = head_q;
        assign tails[k*ADDRESS_BITS +: ADDRESS_BITS] = tail_q;
        always @(posedge clk_i)
          if (!rst_ni) begin
            head_q <= FIRST[ADDRESS_BITS-1:0];
            tail_q <= FIRST[ADDRESS_BITS-1:0];
            size_q <= {LEVEL_BITS{1'b0}};
            available_q <= {LEVEL_BITS{1'b0}};
          end else begin
            if (reads)
              head_q <= (head_q == LAST[ADDRESS_BITS-1:0]) ? FIRST[ADDRESS_BITS-1:0] : head_q + 1'b1;
            if (put && put_kind_i == KIND)
              tail_q <= (tail_q == LAST[ADDRESS_BITS-1:0]) ? FIRST[ADDRESS_BITS-1:0] : tail_q + 1'b1;
            if (comes != goes) size_q <= comes ? size_q + 1'b1 : size_q - 1'b1;
            available_q <= available_q + {{LEVEL_BITS-1{1'b0}}, comes}
                         - ((reserve_valid_i && reserve_kind_i == KIND) ? reserve_count_i : {LEVEL_BITS{1'b0}});
          end
      end
    end
  endgenerate

  reg [ADDRESS_BITS-1:0] head, tail;
  integer n;
  always @* begin
    head = heads[ADDRESS_BITS-1:0];
    tail = tails[ADDRESS_BITS-1:0];
    for (n = 1; n < KINDS; n = n + 1) begin
      if (kind == n[1:0] + 2'd1) head = heads[n*ADDRESS_BITS +: ADDRESS_BITS];
      if (put_kind_i == n[1:0] + 2'd1) tail = tails[n*ADDRESS_BITS +: ADDRESS_BITS];
    end
  end
  rp_ram_1r1w #(.WIDTH(128), .DEPTH(DEPTH)) packages (
    .clk_i(clk_i),
    .read_i(read),
    .read_address_i(head),
    .read_data_o(beat_data_o),
    .write_i(put),
    .write_address_i(tail),
    .write_data_i(put_data_i)
  );

  wire [12:0] unused;
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) packages_taken (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(taken), .value_o(taken_o), .pending_o(unused));
endmodule
`default_nettype wire
