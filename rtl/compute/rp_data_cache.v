// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The L1 data cache: 2-way, 64-byte lines, least recently used, write-through, no write-allocate, one quadword (16
// bytes) a cycle, loads that miss do not block. Tags and data are single-port memories: a cycle reads (lookup), or
// writes (a store that hits, a refill beat).
// Use: a lookup in one cycle, with the ready of its kind high; in the next cycle, and only in it, its
// access with access_i. An access never stalls, so the user must keep a free entry in its request queue for
// each lookup: push_o is always taken.
// An inval is an access of a store that writes nothing: it removes its line from the cache. It is refused while a
// miss-status holding register has the line: its waiters are to be served, and it may have been asked for too early.
// Promises: hit, refuse or accept answers an access, or none of them: then its line is being fetched, the warp is noted
// as a waiter, and the line stays in the cache until all its waiters are served.
// Must be given: the beats of a line in order; invalidate_i only while no access is
// under way and no line is being fetched.
`default_nettype none
module rp_data_cache #(
`include "rp_data_cache_parameters.vh"
  parameter integer SHARING = 0,   // there are accesses with access_inval_i
  parameter integer WARPS = 8,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer MSHR_BITS = (DATA_CACHE_MSHRS > 1) ? $clog2(DATA_CACHE_MSHRS) : 1
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   invalidate_i,          // forget all lines
  // lookup
  output wire                   load_ready_o,          // a load may look up in this cycle
  output wire                   store_ready_o,
  input  wire                   lookup_i,
  input  wire                   lookup_store_i,
  input  wire [27:0]            lookup_quad_i,         // byte address / 16
  // access, one cycle after its lookup
  input  wire                   access_i,
  input  wire                   access_store_i,
  input  wire                   access_inval_i,        // with access_store_i
  input  wire                   access_may_allocate_i, // a miss may take a miss-status holding register
  input  wire [WARP_BITS-1:0]   access_warp_i,
  input  wire [127:0]           access_data_i,
  input  wire [3:0]             access_mask_i,
  output wire                   hit_o,                 // load: data_o is its quadword
  output wire [127:0]           data_o,
  output wire                   allocate_o,            // load: its line is being fetched from now on
  output wire                   refuse_o,              // load: needs a fetch, and none may begin now; inval: later
  output wire                   accept_o,              // store: done
  // request of this access, to the queue
  output wire                   push_o,
  output wire                   push_write_o,
  output wire [27:0]            push_quad_o,
  output wire [MSHR_BITS-1:0]   push_id_o,
  // refill
  input  wire                   response_valid_i,
  input  wire [MSHR_BITS-1:0]   response_id_i,
  input  wire [1:0]             response_beat_i,
  input  wire [127:0]           response_data_i,
  // miss-status holding registers, for the replay of waiters
  input  wire                   served_i,
  input  wire [MSHR_BITS-1:0]   served_id_i,
  input  wire [WARP_BITS-1:0]   served_warp_i,
  output wire                   freed_o,
  output wire                   idle_o,
  output wire [DATA_CACHE_MSHRS-1:0]       filled_o,
  output wire [DATA_CACHE_MSHRS*26-1:0]    line_o,
  output wire [DATA_CACHE_MSHRS*WARPS-1:0] waiters_o
);
  localparam integer SETS = DATA_CACHE_BYTES / 128;
  localparam integer SET_BITS = $clog2(SETS);
  localparam integer TAG_BITS = 26 - SET_BITS;

`include "rp_data_cache_parameter_checks.vh"

  // Refill beats wait one cycle here; then they own the memories.
  reg                 refill_q;
  reg [MSHR_BITS-1:0] refill_id_q;
  reg [1:0]           refill_beat_q;
  reg [127:0]         refill_data_q;
  wire [25:0]         refill_line;
  wire                refill_way;
  wire                refill_first = refill_q && refill_beat_q == 2'd0;
  wire                refill_last = refill_q && refill_beat_q == 2'd3;

  always @(posedge clk_i) begin
    if (!rst_ni) refill_q <= 1'b0;
    else refill_q <= response_valid_i;
    if (response_valid_i) begin
      refill_id_q <= response_id_i;
      refill_beat_q <= response_beat_i;
      refill_data_q <= response_data_i;
    end
  end

  // The access of a store writes the data memories, so nothing else may need them then:
  // no load reads, no refill beat writes.
  assign load_ready_o = !refill_q && !(access_i && access_store_i);
  assign store_ready_o = !refill_q && !response_valid_i;

  // Lookup: tags and data are read; the valid bits are taken along, so that both are of the same cycle.
  reg [SETS-1:0] valid_0_q;
  reg [SETS-1:0] valid_1_q;
  reg [SETS-1:0] older_q;   // the way of a set that was used less recently
  reg [27:0]     quad_q;
  reg [1:0]      valid_q;
  wire [SET_BITS-1:0] lookup_set = lookup_quad_i[2 +: SET_BITS];
  wire [SET_BITS-1:0] access_set = quad_q[2 +: SET_BITS];
  wire [SET_BITS-1:0] refill_set = refill_line[SET_BITS-1:0];

  always @(posedge clk_i) begin
    if (lookup_i) begin
      quad_q <= lookup_quad_i;
      valid_q <= {valid_1_q[lookup_set], valid_0_q[lookup_set]};
    end
  end

  // Access: what becomes of it.
  wire [TAG_BITS-1:0] tag_0;
  wire [TAG_BITS-1:0] tag_1;
  wire                match;
  wire                available;
  wire [1:0]          locked;
  wire hit_0 = valid_q[0] && tag_0 == quad_q[27 -: TAG_BITS];
  wire hit_1 = valid_q[1] && tag_1 == quad_q[27 -: TAG_BITS];
  wire found = hit_0 || hit_1;
  wire older = older_q[access_set];
  wire victim = locked[older] ? !older : older;

  assign hit_o = access_i && !access_store_i && found;
  assign allocate_o = access_i && !access_store_i && !found && !match && access_may_allocate_i && available &&
                      locked != 2'b11;
  wire inval = SHARING != 0 && access_i && access_inval_i;
  wire held = match || (hit_0 && locked[0]) || (hit_1 && locked[1]);
  wire removes = inval && !held;
  assign refuse_o = (access_i && !access_store_i && !found && !match && !allocate_o) || (inval && held);
  assign accept_o = access_i && access_store_i && (inval ? !held : !match);
  assign push_o = (accept_o && !inval) || allocate_o;
  assign push_write_o = access_store_i;
  assign push_quad_o = access_store_i ? quad_q : {quad_q[27:2], 2'b00};

  // A line in the cache is never being fetched: its way is valid from the last beat on, and
  // from then its register does not match.
  always @(posedge clk_i) begin
    if (!rst_ni) older_q <= {SETS{1'b0}};
    else if (access_i && found) older_q[access_set] <= removes ? hit_1 : hit_0;
  end

  always @(posedge clk_i) begin
    if (!rst_ni || invalidate_i) begin
      valid_0_q <= {SETS{1'b0}};
      valid_1_q <= {SETS{1'b0}};
    end else if (refill_first || refill_last) begin
      if (refill_way) valid_1_q[refill_set] <= refill_last;
      else valid_0_q[refill_set] <= refill_last;
    end else if (removes) begin
      if (hit_0) valid_0_q[access_set] <= 1'b0;
      if (hit_1) valid_1_q[access_set] <= 1'b0;
    end
  end

  rp_miss_status #(.WARPS(WARPS), .WARP_BITS(WARP_BITS), .MSHRS(DATA_CACHE_MSHRS), .MSHR_BITS(MSHR_BITS),
      .SET_BITS(SET_BITS)) u_miss_status (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .access_i(access_i),
        .access_line_i(quad_q[27:2]),
        .access_warp_i(access_warp_i),
        .match_o(match),
        .available_o(available),
        .available_id_o(push_id_o),
        .locked_o(locked),
        .join_i(access_i && match && !inval),
        .allocate_i(allocate_o),
        .allocate_way_i(victim),
        .fill_i(refill_q),
        .fill_id_i(refill_id_q),
        .fill_last_i(refill_last),
        .fill_line_o(refill_line),
        .fill_way_o(refill_way),
        .served_i(served_i),
        .served_id_i(served_id_i),
        .served_warp_i(served_warp_i),
        .freed_o(freed_o),
        .idle_o(idle_o),
        .filled_o(filled_o),
        .line_o(line_o),
        .waiters_o(waiters_o)
      );

  // Memories. The cycle of refill_q has no lookup and no access of a store.
  wire [SET_BITS-1:0] tag_address = refill_q ? refill_set : lookup_set;
  wire [TAG_BITS-1:0] refill_tag = refill_line[25 -: TAG_BITS];

  rp_ram_1rw #(.WIDTH(TAG_BITS), .DEPTH(SETS)) u_tag_0 (
    .clk_i(clk_i),
    .enable_i(lookup_i || (refill_last && !refill_way)),
    .write_i(refill_q),
    .address_i(tag_address),
    .data_i(refill_tag),
    .data_o(tag_0)
  );
  rp_ram_1rw #(.WIDTH(TAG_BITS), .DEPTH(SETS)) u_tag_1 (
    .clk_i(clk_i),
    .enable_i(lookup_i || (refill_last && refill_way)),
    .write_i(refill_q),
    .address_i(tag_address),
    .data_i(refill_tag),
    .data_o(tag_1)
  );

  wire read_data = lookup_i && !lookup_store_i;
  wire write_store = access_i && access_store_i && !inval;
  wire [SET_BITS+1:0] data_address = refill_q ? {refill_set, refill_beat_q} : write_store ? quad_q[SET_BITS+1:0] :
                                     lookup_quad_i[SET_BITS+1:0];
  wire [127:0] data_in = refill_q ? refill_data_q : access_data_i;
  wire [127:0] data_0;
  wire [127:0] data_1;
  wire [3:0] write_0 = refill_q ? {4{!refill_way}} : (write_store && hit_0) ? access_mask_i : 4'd0;
  wire [3:0] write_1 = refill_q ? {4{refill_way}} : (write_store && hit_1) ? access_mask_i : 4'd0;
  assign data_o = hit_1 ? data_1 : data_0;

  genvar word;
  generate
    for (word = 0; word < 4; word = word + 1) begin : gen_word
      rp_ram_1rw #(.WIDTH(32), .DEPTH(SETS * 4)) u_data_0 (
        .clk_i(clk_i),
        .enable_i(read_data || write_0[word]),
        .write_i(write_0[word]),
        .address_i(data_address),
        .data_i(data_in[word*32 +: 32]),
        .data_o(data_0[word*32 +: 32])
      );
      rp_ram_1rw #(.WIDTH(32), .DEPTH(SETS * 4)) u_data_1 (
        .clk_i(clk_i),
        .enable_i(read_data || write_1[word]),
        .write_i(write_1[word]),
        .address_i(data_address),
        .data_i(data_in[word*32 +: 32]),
        .data_o(data_1[word*32 +: 32])
      );
    end
  endgenerate

`ifndef SYNTHESIS
  // A broken rule of use is worth a loud stop rather than a wrong picture.
  always @(posedge clk_i) begin
    if (rst_ni && access_i && found && match) begin
      $display("data_cache: a line is in the cache and being fetched");
      $stop;
    end
    if (rst_ni && refill_q && (lookup_i || write_store)) begin
      $display("data_cache: a lookup or a store met a refill beat");
      $stop;
    end
  end
`endif
endmodule
`default_nettype wire
