// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The traverser's side of its memory: one request in a cycle, of nodes, of triangles and of the stacks in rotation, and
// lines that come back in the order of the reads. Nodes lie from line 0 on, triangles from triangles_line_i, the stacks
// from stacks_line_i: of a slot 2^BLOCK_BITS blocks of four entries of 64 bits, two blocks to a line.
// What lies beyond the tree is not asked for: it is a fault, as is the block of a stack that has no room for one more.
// That is found here, where all lines pass, and not where a lane comes to a node: that cycle is full.
// Promises: a request that is offered stays until it is taken; each line is given to its requester, once; no line
// beyond the tree is requested. Requests and faults depend on no input of the same cycle.
// Must be given: at most LINES reads on their way; lines of four beats, which receivers take before the last beat of
// the next one; stop_i from the cycle after a fault on.
`default_nettype none
module rp_tree_port #(
  parameter integer LANES = 8,
  parameter integer SLOTS = 24,
  parameter integer ENTRY_BITS = 53,             // of a stack's entry, 64 at most
  parameter integer BLOCK_BITS = 7,
  parameter integer NODE_ID_BITS = 6,
  parameter integer TRIANGLE_ID_BITS = 6,
  parameter integer LINES = 136,                 // that may be on their way
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1
) (
  input  wire                          clk_i,
  input  wire                          rst_ni,
  input  wire [25:0]                   triangles_line_i,   // and so many lines of nodes there are
  input  wire [25:0]                   triangle_lines_i,
  input  wire [25:0]                   stacks_line_i,
  // a fault, for a cycle; from then on nothing is taken over
  output reg                           fault_valid_o,
  output reg  [1:0]                    fault_source_o,     // 0 nodes, 1 triangles, 2 stacks
  output wire [25:0]                   fault_line_o,       // all ones where no address reaches it
  input  wire                          stop_i,
  // from the caches, as tree_banks has them
  input  wire                          node_request_valid_i,
  output wire                          node_request_ready_o,
  input  wire [25:0]                   node_request_line_i,
  input  wire [NODE_ID_BITS-1:0]       node_request_id_i,
  output wire                          node_fill_valid_o,
  input  wire                          node_fill_ready_i,
  output wire [NODE_ID_BITS-1:0]       node_fill_id_o,
  input  wire                          triangle_request_valid_i,
  output wire                          triangle_request_ready_o,
  input  wire [25:0]                   triangle_request_line_i,
  input  wire [TRIANGLE_ID_BITS-1:0]   triangle_request_id_i,
  output wire                          triangle_fill_valid_o,
  input  wire                          triangle_fill_ready_i,
  output wire [TRIANGLE_ID_BITS-1:0]   triangle_fill_id_o,
  output reg  [511:0]                  fill_data_o,
  // from each lane's stacks, as lane_stacks has them
  input  wire [LANES-1:0]              stack_request_valid_i,
  output wire [LANES-1:0]              stack_request_ready_o,
  input  wire [LANES-1:0]              stack_request_write_i,
  input  wire [LANES*SLOT_BITS-1:0]    stack_request_slot_i,
  input  wire [LANES*BLOCK_BITS-1:0]   stack_request_block_i,
  input  wire [LANES*4*ENTRY_BITS-1:0] stack_request_entries_i,
  output wire [LANES-1:0]              stack_fill_valid_o,
  output wire [4*ENTRY_BITS-1:0]       stack_fill_entries_o,
  // the memory port, as memory_port has it
  output reg                           request_valid_o,
  input  wire                          request_ready_i,
  output reg                           request_write_o,
  output wire                          request_second_o,
  output wire [31:0]                   request_address_o,
  output reg  [255:0]                  request_data_o,
  input  wire                          response_valid_i,
  input  wire [1:0]                    response_beat_i,
  input  wire [127:0]                  response_data_i
);
  localparam integer LANE_BITS = (LANES > 1) ? $clog2(LANES) : 1;
  localparam integer STACK_ID_BITS = LANE_BITS + 1;       // lane, and which half of the line
  localparam integer CACHE_ID_BITS = (NODE_ID_BITS > TRIANGLE_ID_BITS) ? NODE_ID_BITS : TRIANGLE_ID_BITS;
  localparam integer ID_BITS = (CACHE_ID_BITS > STACK_ID_BITS) ? CACHE_ID_BITS : STACK_ID_BITS;
  localparam integer STACK_LINE_BITS = LANE_BITS + SLOT_BITS + BLOCK_BITS - 1;
`include "rp_onehot.vh"
  localparam [1:0] NODES = 2'd0, TRIANGLES = 2'd1, STACKS = 2'd2;

  // ---- Requesters
  wire free = !request_valid_o || request_ready_i;
  wire takes = free && !fault_valid_o && !stop_i;
  wire [2:0] grant;
  wire [LANES-1:0] stack_grant, stack_heard;
  rp_round_robin #(.COUNT(3)) turn (
    .clk_i(clk_i), .rst_ni(rst_ni),
    .request_i({|stack_request_valid_i, triangle_request_valid_i, node_request_valid_i}), .advance_i(takes),
    .grant_o(grant));
  rp_round_robin #(.COUNT(LANES)) stack_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(stack_request_valid_i), .advance_i(takes && grant[2]),
    .grant_o(stack_grant));
  // The same choice once more, for what the lanes hear: behind the first one hangs all of a request, so that its grants
  // pass many buffers.
  rp_round_robin #(.COUNT(LANES)) heard_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(stack_request_valid_i), .advance_i(takes && grant[2]),
    .grant_o(stack_heard));
  assign node_request_ready_o = takes && grant[0];
  assign triangle_request_ready_o = takes && grant[1];
  assign stack_request_ready_o = stack_heard & {LANES{takes && grant[2]}};

  `ONEHOT_NUMBER(lane_among, LANES, LANE_BITS)
  `ONEHOT_SELECT(slot_among, LANES, SLOT_BITS)
  `ONEHOT_SELECT(block_among, LANES, BLOCK_BITS)
  `ONEHOT_SELECT(entries_among, LANES, 4*ENTRY_BITS)
  wire [LANE_BITS-1:0] lane = lane_among(stack_grant);
  wire [SLOT_BITS-1:0] slot = slot_among(stack_grant, stack_request_slot_i);
  wire [BLOCK_BITS-1:0] block = block_among(stack_grant, stack_request_block_i);
  wire [4*ENTRY_BITS-1:0] entries = entries_among(stack_grant, stack_request_entries_i);
  wire writes = grant[2] && |(stack_grant & stack_request_write_i);
  wire [25:0] stack_line = {{26-STACK_LINE_BITS{1'b0}}, lane, slot, block[BLOCK_BITS-1:1]};
  wire [25:0] offset = grant[0] ? node_request_line_i : grant[1] ? triangle_request_line_i : stack_line;

  // Compared as it comes, but added up behind registers: which line a stack asks for is known late. A stack has so many
  // blocks that the next one's number would be that of the first.
  wire node_beyond = node_request_line_i >= triangles_line_i;
  wire triangle_beyond = triangle_request_line_i >= triangle_lines_i;
  wire beyond = (grant[0] && node_beyond) || (grant[1] && triangle_beyond) || (writes && &block);

  always @(posedge clk_i)
    if (!rst_ni) request_valid_o <= 1'b0;
    else if (free) request_valid_o <= takes && |grant && !beyond;
  always @(posedge clk_i) fault_valid_o <= rst_ni && takes && beyond;
  always @(posedge clk_i) if (takes) fault_source_o <= grant[0] ? NODES : grant[1] ? TRIANGLES : STACKS;
  reg [25:0] offset_q;
  reg half_q;                                    // of a line, that a stack's block is written to
  wire [25:0] base = (fault_source_o == NODES) ? 26'd0 :
                     (fault_source_o == TRIANGLES) ? triangles_line_i : stacks_line_i;
  wire [26:0] line = {1'b0, base} + {1'b0, offset_q};
  assign request_address_o = {line[25:0], half_q, 5'd0};
  assign fault_line_o = line[25:0] | {26{line[26]}};
  integer e;
  always @(posedge clk_i)
    if (takes) begin
      request_write_o <= writes;
      offset_q <= offset;
      half_q <= writes && block[0];
      for (e = 0; e < 4; e = e + 1)
        request_data_o[64*e +: 64] <= {{64-ENTRY_BITS{1'b0}}, entries[e*ENTRY_BITS +: ENTRY_BITS]};
    end
  assign request_second_o = request_write_o;

  // ---- Requesters of the lines on their way; behind one beyond the tree, which never comes, there are none
  reg [ID_BITS-1:0] id;
  always @* begin
    id = {ID_BITS{1'b0}};
    if (grant[0]) id[NODE_ID_BITS-1:0] = node_request_id_i;
    else if (grant[1]) id[TRIANGLE_ID_BITS-1:0] = triangle_request_id_i;
    else id[STACK_ID_BITS-1:0] = {lane, block[0]};
  end
  wire last = response_valid_i && response_beat_i == 2'd3;
  wire comes;
  wire [1:0] source;
  wire [ID_BITS-1:0] come_id;
  rp_ram_queue #(.WIDTH(2+ID_BITS), .DEPTH(LINES)) on_way (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(takes && |grant && !writes),
    .data_i({grant[0] ? NODES : grant[1] ? TRIANGLES : STACKS, id}),
    .valid_o(comes),
    .ready_i(last),
    .data_o({source, come_id})
  );

  // ---- A line that has come, until it is taken
  reg [383:0] beats_q;                           // before the last
  reg valid_q;
  reg [1:0] source_q;
  reg [ID_BITS-1:0] id_q;
  assign node_fill_valid_o = valid_q && source_q == NODES;
  assign triangle_fill_valid_o = valid_q && source_q == TRIANGLES;
  assign node_fill_id_o = id_q[NODE_ID_BITS-1:0];
  assign triangle_fill_id_o = id_q[TRIANGLE_ID_BITS-1:0];
  wire waits = (node_fill_valid_o && !node_fill_ready_i) || (triangle_fill_valid_o && !triangle_fill_ready_i);
  always @(posedge clk_i)
    if (!rst_ni) valid_q <= 1'b0;
    else valid_q <= last || waits;
  always @(posedge clk_i) begin
    if (response_valid_i) beats_q <= {response_data_i, beats_q[383:128]};
    if (last) begin
      fill_data_o <= {response_data_i, beats_q};
      source_q <= source;
      id_q <= come_id;
    end
  end
  genvar g;
  generate
    for (g = 0; g < LANES; g = g + 1) begin : gen_lane
      assign stack_fill_valid_o[g] = valid_q && source_q == STACKS && id_q[STACK_ID_BITS-1:1] == g[LANE_BITS-1:0];
    end
    for (g = 0; g < 4; g = g + 1) begin : gen_entry
      assign stack_fill_entries_o[g*ENTRY_BITS +: ENTRY_BITS] =
        id_q[0] ? fill_data_o[256+64*g +: ENTRY_BITS] : fill_data_o[64*g +: ENTRY_BITS];
    end
  endgenerate
  wire unused = &{1'b0, comes};
endmodule
`default_nettype wire
