// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The L1 instruction cache: 2-way, 64-byte lines of 8 instructions, least recently used, one
// lookup a cycle, one fetch at a time.
// A lookup in cycle c is answered in c+1 with hit_o and the instruction, or with miss_o. A miss begins a fetch when
// none is under way; lookups that hit go on meanwhile. refill_done_o: every warp that has missed in an earlier cycle
// must look up again; after a miss_o in cycle c a refill_done_o always comes in a later cycle. The warp that began the
// fetch is to look up before all others (first_o): else warps with lines in one set could take a line from each other
// for ever before any has used it. Must be given: the beats of a line in order.
`default_nettype none
module rp_instruction_cache #(
`include "rp_instruction_cache_parameters.vh"
  parameter integer WARPS = 8,
  parameter integer PC_BITS = 16,
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  input  wire                 invalidate_i,        // one cycle: forget all lines, that of a fetch under way too
  input  wire                 lookup_valid_i,
  input  wire [WARP_BITS-1:0] lookup_warp_i,
  input  wire [15:0]          lookup_pc_i,         // in instructions, below 2^PC_BITS
  output wire                 hit_o,
  output wire                 miss_o,
  output wire [WARP_BITS-1:0] result_warp_o,       // with hit_o or miss_o
  output wire [63:0]          instruction_o,       // with hit_o
  output wire                 refill_done_o,
  output reg  [WARPS-1:0]     first_o,             // in the cycle after refill_done_o: that warp, one-hot
  // memory port, instruction side
  output wire                 request_valid_o,
  input  wire                 request_ready_i,
  output wire [31:0]          request_address_o,
  input  wire                 response_valid_i,
  input  wire [1:0]           response_beat_i,
  input  wire [127:0]         response_data_i
);
  localparam [WARPS-1:0] ONE = 1;
  localparam integer SETS = INSTRUCTION_CACHE_BYTES / 128;
  localparam integer SET_BITS = $clog2(SETS);
  localparam integer TAG_BITS = (PC_BITS - 3 > SET_BITS) ? PC_BITS - 3 - SET_BITS : 1;
  localparam integer LINE_BITS = SET_BITS + TAG_BITS;

`include "rp_instruction_cache_parameter_checks.vh"

  reg [SETS-1:0] valid_0_q;
  reg [SETS-1:0] valid_1_q;
  reg [SETS-1:0] older_q;   // the way of a set that was used less recently

  wire unused = &{1'b0, lookup_pc_i};   // bits that no PC has

  // Lookup. The valid bits are taken along, so that they and the tags are of the same cycle.
  wire [SET_BITS-1:0] lookup_set = lookup_pc_i[3 +: SET_BITS];
  reg                 result_q;
  reg [WARP_BITS-1:0] warp_q;
  reg [LINE_BITS-1:0] line_q;
  reg                 half_q;
  reg [1:0]           valid_q;

  always @(posedge clk_i) begin
    if (!rst_ni) result_q <= 1'b0;
    else result_q <= lookup_valid_i;
    if (lookup_valid_i) begin
      warp_q <= lookup_warp_i;
      {line_q, half_q} <= {lookup_pc_i[3 +: LINE_BITS], lookup_pc_i[0]};
      valid_q <= {valid_1_q[lookup_set], valid_0_q[lookup_set]};
    end
  end

  wire [TAG_BITS-1:0] tag_0;
  wire [TAG_BITS-1:0] tag_1;
  wire [127:0]        data_0;
  wire [127:0]        data_1;
  wire [SET_BITS-1:0] set = line_q[SET_BITS-1:0];
  wire hit_0 = valid_q[0] && tag_0 == line_q[SET_BITS +: TAG_BITS];
  wire hit_1 = valid_q[1] && tag_1 == line_q[SET_BITS +: TAG_BITS];
  wire [127:0] pair = hit_1 ? data_1 : data_0;
  assign hit_o = result_q && (hit_0 || hit_1);
  assign miss_o = result_q && !hit_0 && !hit_1;
  assign result_warp_o = warp_q;
  assign instruction_o = half_q ? pair[127:64] : pair[63:0];

  // Fetch. In FETCH_SETTLE a lookup that just missed the last beat gets its answer; it must not fetch the line a second
  // time, and refill_done_o must come after it.
  localparam [1:0] FETCH_NONE = 2'd0;
  localparam [1:0] FETCH_REQUEST = 2'd1;
  localparam [1:0] FETCH_BEATS = 2'd2;
  localparam [1:0] FETCH_SETTLE = 2'd3;
  reg [1:0]  fetch_q;
  reg [LINE_BITS-1:0] fetch_line_q;
  reg        fetch_way_q;
  reg        fetch_void_q;   // invalidated under way: the line is not entered
  reg        done_q;
  reg [WARP_BITS-1:0] fetch_warp_q;
  wire begin_fetch = miss_o && fetch_q == FETCH_NONE;
  wire last_beat = response_valid_i && response_beat_i == 2'd3;
  wire [SET_BITS-1:0] fetch_set = fetch_line_q[SET_BITS-1:0];

  assign refill_done_o = done_q;
  assign request_valid_o = fetch_q == FETCH_REQUEST;
  assign request_address_o = {{26-LINE_BITS{1'b0}}, fetch_line_q, 6'd0};

  always @(posedge clk_i) begin
    if (!rst_ni) begin
      fetch_q <= FETCH_NONE;
      done_q <= 1'b0;
      first_o <= {WARPS{1'b0}};
    end else begin
      done_q <= fetch_q == FETCH_SETTLE;
      first_o <= done_q ? ONE << fetch_warp_q : {WARPS{1'b0}};
      case (fetch_q)
        FETCH_NONE: if (miss_o) fetch_q <= FETCH_REQUEST;
        FETCH_REQUEST: if (request_ready_i) fetch_q <= FETCH_BEATS;
        FETCH_BEATS: if (last_beat) fetch_q <= FETCH_SETTLE;
        default: fetch_q <= FETCH_NONE;
      endcase
    end
    if (begin_fetch) begin
      fetch_line_q <= line_q;
      fetch_warp_q <= warp_q;
      fetch_way_q <= older_q[set];
    end
    if (begin_fetch || invalidate_i) fetch_void_q <= invalidate_i && !begin_fetch;
  end

  always @(posedge clk_i) begin
    if (!rst_ni) older_q <= {SETS{1'b0}};
    else if (hit_o) older_q[set] <= hit_0;
    else if (begin_fetch) older_q[set] <= !older_q[set];
  end

  // The way that is filled is invalid from the beginning of the fetch to the last beat.
  always @(posedge clk_i) begin
    if (!rst_ni || invalidate_i) begin
      valid_0_q <= {SETS{1'b0}};
      valid_1_q <= {SETS{1'b0}};
    end else begin
      if (begin_fetch) begin
        if (older_q[set]) valid_1_q[set] <= 1'b0;
        else valid_0_q[set] <= 1'b0;
      end
      if (last_beat && !fetch_void_q) begin
        if (fetch_way_q) valid_1_q[fetch_set] <= 1'b1;
        else valid_0_q[fetch_set] <= 1'b1;
      end
    end
  end

  wire write_0 = response_valid_i && !fetch_way_q;
  wire write_1 = response_valid_i && fetch_way_q;
  rp_ram_1r1w #(.WIDTH(TAG_BITS), .DEPTH(SETS)) u_tag_0 (
    .clk_i(clk_i),
    .read_i(lookup_valid_i),
    .read_address_i(lookup_set),
    .read_data_o(tag_0),
    .write_i(last_beat && !fetch_way_q),
    .write_address_i(fetch_set),
    .write_data_i(fetch_line_q[SET_BITS +: TAG_BITS])
  );
  rp_ram_1r1w #(.WIDTH(TAG_BITS), .DEPTH(SETS)) u_tag_1 (
    .clk_i(clk_i),
    .read_i(lookup_valid_i),
    .read_address_i(lookup_set),
    .read_data_o(tag_1),
    .write_i(last_beat && fetch_way_q),
    .write_address_i(fetch_set),
    .write_data_i(fetch_line_q[SET_BITS +: TAG_BITS])
  );
  rp_ram_1r1w #(.WIDTH(128), .DEPTH(SETS * 4)) u_data_0 (
    .clk_i(clk_i),
    .read_i(lookup_valid_i),
    .read_address_i(lookup_pc_i[SET_BITS+2:1]),
    .read_data_o(data_0),
    .write_i(write_0),
    .write_address_i({fetch_set, response_beat_i}),
    .write_data_i(response_data_i)
  );
  rp_ram_1r1w #(.WIDTH(128), .DEPTH(SETS * 4)) u_data_1 (
    .clk_i(clk_i),
    .read_i(lookup_valid_i),
    .read_address_i(lookup_pc_i[SET_BITS+2:1]),
    .read_data_o(data_1),
    .write_i(write_1),
    .write_address_i({fetch_set, response_beat_i}),
    .write_data_i(response_data_i)
  );
endmodule
`default_nettype wire
