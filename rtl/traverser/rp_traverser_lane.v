// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A lane of the traverser: slots for rays, a box pipe, the stacks, and what is kept of each ray and its best hit. Nodes
// and leaves come from two caches that lanes share, and triangles go to a triangle pipe, which may be shared too. A
// slot is given to a ray, which comes when it is set up; visits what its nodes, stack and hits lead to; and is offered
// with its best hit when it has visited everything, or, if it is a shadow ray, has found a blocker.
// Whatever lies in the memory, a ray's walk ends, with the ray done or with a fault. A way back to a node has a step to
// a number that is not above the one before it: that is looked for in each node that comes, so the fault has the node
// with that step. Ways that meet again, and entries that come back wrong from the memory of the stacks, are no such
// step: a ray that has come to as many nodes as there are may come to none. Leaves need no count, as each is a child of
// such a node.
// Promises: what a ray hits is what triangle_pipe hits of all triangles in the tree, whatever comes in which order. No
// output depends on an input of the same cycle, but what the triangle pipe is given.
// Must be given: a ray once for a slot that was taken, and the slot back once after the ray was taken; what leaf_reader
// must be of each cache; triangle_pipe's results.
`default_nettype none
module rp_traverser_lane #(
  parameter integer SLOTS = 24,
  parameter integer ENTRIES = 16,                // of a slot's stack
  parameter integer BITS = 12,                   // of the box test
  parameter integer LINE_BITS = 26,
  parameter integer BLOCK_BITS = 7,
  parameter integer KEY_BITS = BITS + 9,
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1,
  parameter integer TAG_BITS = 29 + 1 + SLOT_BITS,   // of a triangle's test: place, whether its leaf's last, slot
  parameter integer ENTRY_BITS = KEY_BITS + 32
) (
  input  wire                    clk_i,
  input  wire                    rst_ni,
  input  wire [31:0]             root_i,         // node or leaf; all ones: an empty tree
  input  wire [LINE_BITS-1:0]    nodes_i,        // that there are
  // a node that no tree has, or to which a ray comes too late, for a cycle, and then perhaps others
  output reg                     fault_valid_o,
  output reg  [1:0]              fault_reason_o, // 0 children, 1 order, 2 visits
  output reg  [LINE_BITS-1:0]    fault_line_o,   // of the node
  input  wire                    stop_i,         // no more nodes are tested
  // a slot for a ray
  output wire                    slot_valid_o,
  input  wire                    slot_ready_i,
  output wire [SLOT_BITS-1:0]    slot_o,
  // the ray, set up
  input  wire                    ray_valid_i,
  input  wire [SLOT_BITS-1:0]    ray_slot_i,
  input  wire                    ray_meets_i,    // it may hit something
  input  wire                    ray_shadow_i,   // any hit ends it
  input  wire [95:0]             origin_i,
  input  wire [2:0]              backwards_i,
  input  wire [2:0]              still_i,
  input  wire [3*BITS-1:0]       reciprocal_i,
  input  wire [29:0]             exponent_i,
  input  wire [29:0]             padding_i,
  input  wire [KEY_BITS-1:0]     limit_key_i,
  input  wire [95:0]             padded_lower_i,
  input  wire [95:0]             padded_upper_i,
  input  wire [95:0]             inverse_i,
  input  wire [1:0]              main_axis_i,
  input  wire [63:0]             shear_i,
  input  wire [104:0]            direction_i,
  input  wire [31:0]             limit_i,
  input  wire [8:0]              scale_i,
  // the node cache: two nodes to look up, of which one can be taken; a node
  output wire [1:0]              node_want_o,
  output wire [2*LINE_BITS-1:0]  node_want_line_o,
  output wire [2*SLOT_BITS-1:0]  node_want_slot_o,
  input  wire [1:0]              node_taken_i,
  input  wire                    node_given_i,
  input  wire [SLOT_BITS-1:0]    node_given_slot_i,
  input  wire [511:0]            node_given_data_i,
  // the triangle cache, as leaf_reader has it
  output wire [1:0]              leaf_want_o,
  output wire [1:0]              leaf_want_prefetch_o,
  output wire [2*LINE_BITS-1:0]  leaf_want_line_o,
  output wire [2*SLOT_BITS-1:0]  leaf_want_slot_o,
  input  wire [1:0]              leaf_taken_i,
  output wire                    leaf_room_o,
  input  wire                    leaf_waited_i,
  input  wire                    leaf_given_i,
  input  wire [SLOT_BITS-1:0]    leaf_given_slot_i,
  input  wire [511:0]            leaf_given_data_i,
  // the stacks' memory, as lane_stacks has it
  output wire                    request_valid_o,
  input  wire                    request_ready_i,
  output wire                    request_write_o,
  output wire [SLOT_BITS-1:0]    request_slot_o,
  output wire [BLOCK_BITS-1:0]   request_block_o,
  output wire [4*ENTRY_BITS-1:0] request_entries_o,
  input  wire                    fill_valid_i,
  input  wire [4*ENTRY_BITS-1:0] fill_entries_i,
  // the triangle pipe
  output wire                    test_valid_o,
  input  wire                    test_ready_i,
  output wire [TAG_BITS-1:0]     test_tag_o,
  output wire [287:0]            test_corners_o,
  output wire [31:0]             test_number_o,
  output wire [95:0]             test_origin_o,
  output wire [95:0]             test_padded_lower_o,
  output wire [95:0]             test_padded_upper_o,
  output wire [95:0]             test_inverse_o,
  output wire [1:0]              test_main_axis_o,
  output wire [63:0]             test_shear_o,
  output wire [104:0]            test_direction_o,
  input  wire [SLOT_BITS-1:0]    limit_slot_i,   // a cycle before it is given
  output wire [31:0]             limit_o,
  output wire [8:0]              scale_o,
  input  wire [SLOT_BITS-1:0]    best_slot_i,    // a cycle before it is given
  output wire [31:0]             best_t_o,
  output wire [31:0]             best_number_o,
  input  wire                    result_valid_i,
  input  wire [TAG_BITS-1:0]     result_tag_i,
  input  wire [31:0]             result_number_i,
  input  wire                    result_hit_i,
  input  wire [31:0]             result_t_i,
  // a ray is done
  output wire                    done_valid_o,
  input  wire                    done_ready_i,
  output wire [SLOT_BITS-1:0]    done_slot_o,
  output wire                    done_hit_o,
  output wire [31:0]             done_t_o,       // internal, as the next ones where it hits something
  output wire [31:0]             done_number_o,
  output wire [28:0]             done_place_o,
  // its slot is free
  input  wire                    free_valid_i,
  input  wire [SLOT_BITS-1:0]    free_slot_i
);
`include "rp_records.vh"
  rp_free_list #(.SIZE(SLOTS), .NUMBER_BITS(SLOT_BITS)) slots (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_o(slot_valid_o),
    .ready_i(slot_ready_i),
    .number_o(slot_o),
    .free_i(free_valid_i),
    .free_number_i(free_slot_i)
  );

  // ---- Rays that come, until their stack can be begun

  wire begin_valid, begin_ready, begin_meets;
  wire [SLOT_BITS-1:0] begin_slot;
  rp_ram_queue #(.WIDTH(SLOT_BITS+1), .DEPTH(SLOTS)) begins (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(ray_valid_i),
    .data_i({ray_slot_i, ray_meets_i && root_i != 32'hffffffff}),
    .valid_o(begin_valid),
    .ready_i(begin_ready),
    .data_o({begin_slot, begin_meets})
  );
  wire begins_now = begin_valid && begin_ready;

  // ---- Where a ray goes on: from a node's result with the nearest child; from its stack, or at the root

  wire goes_on, next_valid, done;
  wire [SLOT_BITS-1:0] next_slot, done_slot;
  wire [31:0] next_reference;
  reg node_valid_q;
  reg [SLOT_BITS-1:0] node_slot_q;
  reg [KEY_BITS-1:0] node_limit_q;
  wire [2:0] children;
  wire [31:0] nearest;
  wire [3*ENTRY_BITS-1:0] others;
  wire starts = begins_now && begin_meets;
  wire [1:0] go = {next_valid || starts, goes_on};
  // No ray begins while another one goes on, and that is known earlier.
  wire [2*SLOT_BITS-1:0] go_slot = {next_valid ? next_slot : begin_slot, node_slot_q};
  wire [63:0] go_reference = {next_valid ? next_reference : root_i, nearest};

  // ---- Nodes that are wanted

  localparam integer WANT_BITS = SLOT_BITS + LINE_BITS;
  wire fill_waits;
  wire [1:0] node_waits, node_popped;
  wire [2*WANT_BITS-1:0] node_heads;
  genvar g;
  generate
    for (g = 0; g < 2; g = g + 1) begin : gen_nodes
      // The ray that goes on is known late in a cycle.
      reg go_q;
      reg [WANT_BITS-1:0] go_node_q;
      always @(posedge clk_i) go_q <= rst_ni && go[g] && !go_reference[32*g+31];
      always @(posedge clk_i) go_node_q <= {go_slot[g*SLOT_BITS+:SLOT_BITS], go_reference[32*g+:LINE_BITS]};
      rp_ram_queue #(.WIDTH(WANT_BITS), .DEPTH(SLOTS)) queue (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .push_i(go_q),
        .data_i(go_node_q),
        .valid_o(node_waits[g]),
        .ready_i(node_popped[g]),
        .data_o(node_heads[g*WANT_BITS+:WANT_BITS])
      );
    end
  endgenerate
  reg node_turn_q;                               // the queue that comes next
  wire node_second = node_waits[node_turn_q] ? node_turn_q : !node_turn_q;
  wire offers_ready, asked;                      // asked: in the cycle before
  wire [1:0] offered;
  wire [2*WANT_BITS-1:0] offers;
  wire [SLOT_BITS-1:0] asked_slot;
  wire [LINE_BITS-1:0] asked_line;
  rp_line_offers #(.WIDTH(WANT_BITS)) node_offers (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(|node_waits),
    .ready_o(offers_ready),
    .data_i(node_second ? node_heads[WANT_BITS+:WANT_BITS] : node_heads[0+:WANT_BITS]),
    .valid_o(offered),
    .data_o(offers),
    .taken_i(node_taken_i),
    .asked_o(asked),
    .asked_data_o({asked_slot, asked_line})
  );
  assign node_popped = offers_ready ? {node_second, !node_second} & node_waits : 2'd0;
  always @(posedge clk_i)
    if (!rst_ni) node_turn_q <= 1'b0;
    else if (|node_popped) node_turn_q <= !node_second;
  assign node_want_o = fill_waits ? 2'd0 : offered;
  generate
    for (g = 0; g < 2; g = g + 1) begin : gen_want
      assign {node_want_slot_o[g*SLOT_BITS+:SLOT_BITS], node_want_line_o[g*LINE_BITS+:LINE_BITS]} =
        offers[g*WANT_BITS+:WANT_BITS];
    end
  endgenerate

  // ---- A node has come: its boxes are tested in the next cycle, when what the ray's slot has is known

  localparam integer BOX_WIDTH = 96 + 6 + 3 * BITS + 60 + KEY_BITS;
  wire [95:0] box_origin;
  wire [2:0] box_backwards, box_still;
  wire [3*BITS-1:0] box_reciprocal;
  wire [29:0] box_exponent, box_padding;
  wire [KEY_BITS-1:0] box_limit, best_key;
  wire best_key_valid;
  rp_ram_1r1w #(.WIDTH(BOX_WIDTH), .DEPTH(SLOTS)) box_rays (
    .clk_i(clk_i),
    .read_i(node_given_i),
    .read_address_i(node_given_slot_i),
    .read_data_o({box_origin, box_backwards, box_still, box_reciprocal, box_exponent, box_padding, box_limit}),
    .write_i(ray_valid_i),
    .write_address_i(ray_slot_i),
    .write_data_i({origin_i, backwards_i, still_i, reciprocal_i, exponent_i, padding_i, limit_key_i})
  );
  reg given_q;
  reg [SLOT_BITS-1:0] given_slot_q;
  reg [NODE_BITS-1:0] node_q;
  always @(posedge clk_i) given_q <= rst_ni && node_given_i && !stop_i;
  always @(posedge clk_i)
    if (node_given_i) begin
      given_slot_q <= node_given_slot_i;
      node_q <= node_given_data_i[NODE_BITS-1:0];
    end

  // Meanwhile it is looked at: its number is that of the line that was looked up, and visits are those before it.
  wire [LINE_BITS-1:0] number, counted;
  rp_ram_1r1w #(.WIDTH(LINE_BITS), .DEPTH(SLOTS)) numbers (
    .clk_i(clk_i),
    .read_i(node_given_i),
    .read_address_i(node_given_slot_i),
    .read_data_o(number),
    .write_i(asked),
    .write_address_i(asked_slot),
    .write_data_i(asked_line)
  );
  reg [SLOTS-1:0] fresh_q;                       // slots with a ray that has come to no node yet
  wire [LINE_BITS-1:0] visits = fresh_q[given_slot_q] ? {LINE_BITS{1'b0}} : counted;
  wire [LINE_BITS-1:0] visits_then = visits + {{LINE_BITS-1{1'b0}}, 1'b1};
  rp_ram_1r1w #(.WIDTH(LINE_BITS), .DEPTH(SLOTS)) counts (
    .clk_i(clk_i),
    .read_i(node_given_i),
    .read_address_i(node_given_slot_i),
    .read_data_o(counted),
    .write_i(given_q),
    .write_address_i(given_slot_q),
    .write_data_i(visits_then)
  );
  integer s;
  always @(posedge clk_i)
    for (s = 0; s < SLOTS; s = s + 1)
      if (ray_valid_i && ray_slot_i == s[SLOT_BITS-1:0]) fresh_q[s] <= 1'b1;
      else if (given_q && given_slot_q == s[SLOT_BITS-1:0]) fresh_q[s] <= 1'b0;
  wire [7:0] node_children = node_q[NODE_CHILDREN +: NODE_CHILDREN_BITS];
  wire bad_children = node_children == 8'd0 || node_children > 8'd4;
  wire [3:0] backward;                           // a child is a node, and not of a higher number
  generate
    for (g = 0; g < 4; g = g + 1) begin : gen_child
      wire [31:0] reference = node_q[NODE_REFERENCES+32*g +: 32];
      assign backward[g] = node_children > g && !reference[31] &&
                           (|reference[30:LINE_BITS] || reference[LINE_BITS-1:0] <= number);
    end
  endgenerate
  wire bad_order = |backward;
  wire too_many = visits == nodes_i;
  always @(posedge clk_i) fault_valid_o <= rst_ni && given_q && (bad_children || bad_order || too_many);
  always @(posedge clk_i) begin
    fault_reason_o <= bad_children ? 2'd0 : bad_order ? 2'd1 : 2'd2;
    fault_line_o <= number;
  end

  wire [KEY_BITS-1:0] test_limit = best_key_valid ? best_key : box_limit;
  wire boxes_valid, boxes_ready;
  wire [3:0] met;
  wire [4*KEY_BITS-1:0] entry;
  rp_box_pipe #(.BITS(BITS)) boxes (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(given_q),
    .ready_o(boxes_ready),
    .grid_i(node_q[NODE_GRID +: NODE_GRID_BITS]),
    .step_i(node_q[NODE_STEP +: NODE_STEP_BITS]),
    .children_i(node_children[2:0]),
    .lower_i(node_q[NODE_LOWER +: NODE_LOWER_BITS]),
    .upper_i(node_q[NODE_UPPER +: NODE_UPPER_BITS]),
    .origin_i(box_origin),
    .backwards_i(box_backwards),
    .still_i(box_still),
    .reciprocal_i(box_reciprocal),
    .exponent_i(box_exponent),
    .padding_i(box_padding),
    .limit_i(test_limit),
    .valid_o(boxes_valid),
    .ready_i(1'b1),
    .met_o(met),
    .entry_o(entry)
  );
  wire [SLOT_BITS-1:0] boxes_slot;
  wire [KEY_BITS-1:0] boxes_limit;
  wire [127:0] boxes_references;
  rp_ram_delay #(.WIDTH(SLOT_BITS+KEY_BITS+128), .CYCLES(8)) along (
    .clk_i(clk_i), .rst_ni(rst_ni),
    .data_i({given_slot_q, test_limit, node_q[NODE_REFERENCES +: NODE_REFERENCES_BITS]}),
    .data_o({boxes_slot, boxes_limit, boxes_references}));
  rp_child_order #(.KEY_BITS(KEY_BITS), .REFERENCE_BITS(32)) order (
    .clk_i(clk_i),
    .met_i(met),
    .entry_i(entry),
    .reference_i(boxes_references),
    .children_o(children),
    .nearest_o(nearest),
    .others_o(others)
  );
  always @(posedge clk_i) node_valid_q <= rst_ni && boxes_valid;
  always @(posedge clk_i) begin
    node_slot_q <= boxes_slot;
    node_limit_q <= boxes_limit;
  end
  wire unused = &{1'b0, boxes_ready, node_given_data_i[511:NODE_BITS], triangle_material, result_t_i[31]};

  // ---- The stacks

  wire leaf_valid, leaf_over;
  wire [SLOT_BITS-1:0] leaf_slot;
  wire [KEY_BITS-1:0] leaf_limit;
  rp_lane_stacks #(.SLOTS(SLOTS), .ENTRIES(ENTRIES), .KEY_BITS(KEY_BITS), .REFERENCE_BITS(32), .BLOCK_BITS(BLOCK_BITS))
  stacks (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .ray_valid_i(begin_valid),
    .ray_ready_o(begin_ready),
    .ray_slot_i(begin_slot),
    .node_slot_i(boxes_slot),
    .node_valid_i(node_valid_q),
    .node_children_i(children),
    .node_nearest_i(nearest),
    .node_others_i(others),
    .node_limit_i(node_limit_q),
    .node_goes_on_o(goes_on),
    .leaf_slot_i(leaf_slot),
    .leaf_valid_i(leaf_valid),
    .leaf_limit_i(leaf_limit),
    .leaf_over_i(leaf_over),
    .next_valid_o(next_valid),
    .next_slot_o(next_slot),
    .next_reference_o(next_reference),
    .done_valid_o(done),
    .done_slot_o(done_slot),
    .request_valid_o(request_valid_o),
    .request_ready_i(request_ready_i),
    .request_write_o(request_write_o),
    .request_slot_o(request_slot_o),
    .request_block_o(request_block_o),
    .request_entries_o(request_entries_o),
    .fill_valid_i(fill_valid_i),
    .fill_entries_i(fill_entries_i),
    .fill_waits_o(fill_waits)
  );

  // ---- Leaves and their triangles

  wire load;
  wire [SLOT_BITS-1:0] load_slot, triangle_slot;
  wire triangle_last;
  wire [28:0] triangle_place;
  wire [31:0] triangle_material;
  rp_leaf_reader #(.SLOTS(SLOTS), .LINE_BITS(LINE_BITS)) leaves (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i({go[1] && go_reference[63], go[0] && go_reference[31]}),
    .start_slot_i(go_slot),
    .start_leaf_i({go_reference[62:32], go_reference[30:0]}),
    .want_o(leaf_want_o),
    .want_prefetch_o(leaf_want_prefetch_o),
    .want_line_o(leaf_want_line_o),
    .want_slot_o(leaf_want_slot_o),
    .taken_i(leaf_taken_i),
    .room_o(leaf_room_o),
    .waited_i(leaf_waited_i),
    .given_i(leaf_given_i),
    .given_slot_i(leaf_given_slot_i),
    .given_data_i(leaf_given_data_i),
    .load_o(load),
    .load_slot_o(load_slot),
    .triangle_valid_o(test_valid_o),
    .triangle_ready_i(test_ready_i),
    .triangle_slot_o(triangle_slot),
    .triangle_last_o(triangle_last),
    .triangle_place_o(triangle_place),
    .triangle_o({triangle_material, test_number_o, test_corners_o})
  );
  assign test_tag_o = {triangle_place, triangle_last, triangle_slot};
  rp_ram_1r1w #(.WIDTH(555), .DEPTH(SLOTS)) triangle_rays (
    .clk_i(clk_i),
    .read_i(load),
    .read_address_i(load_slot),
    .read_data_o({test_origin_o, test_padded_lower_o, test_padded_upper_o, test_inverse_o, test_main_axis_o,
                  test_shear_o, test_direction_o}),
    .write_i(ray_valid_i),
    .write_address_i(ray_slot_i),
    .write_data_i({origin_i, padded_lower_i, padded_upper_i, inverse_i, main_axis_i, shear_i, direction_i})
  );

  // ---- Rays that are done, and the hits

  wire ends_valid, ends_ready;
  wire [SLOT_BITS-1:0] ends_slot;
  rp_ram_queue #(.WIDTH(SLOT_BITS), .DEPTH(SLOTS)) ends (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(done || (begins_now && !begin_meets)),
    .data_i(done ? done_slot : begin_slot),
    .valid_o(ends_valid),
    .ready_i(ends_ready),
    .data_o(ends_slot)
  );
  reg done_q;
  reg [SLOT_BITS-1:0] done_slot_q;
  assign ends_ready = !done_q || done_ready_i;
  always @(posedge clk_i)
    if (!rst_ni) done_q <= 1'b0;
    else if (ends_ready) done_q <= ends_valid;
  always @(posedge clk_i) if (ends_ready) done_slot_q <= ends_slot;
  assign done_valid_o = done_q;
  assign done_slot_o = done_slot_q;
  assign done_t_o[31] = 1'b0;
  rp_lane_hits #(.SLOTS(SLOTS), .BITS(BITS)) hits (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .ray_valid_i(ray_valid_i),
    .ray_slot_i(ray_slot_i),
    .ray_shadow_i(ray_shadow_i),
    .ray_limit_i(limit_i),
    .ray_scale_i(scale_i),
    .limit_slot_i(limit_slot_i),
    .limit_o(limit_o),
    .scale_o(scale_o),
    .best_slot_i(best_slot_i),
    .best_t_o(best_t_o),
    .best_number_o(best_number_o),
    .result_valid_i(result_valid_i),
    .result_slot_i(result_tag_i[SLOT_BITS-1:0]),
    .result_last_i(result_tag_i[SLOT_BITS]),
    .result_place_i(result_tag_i[SLOT_BITS+1+:29]),
    .result_number_i(result_number_i),
    .result_hit_i(result_hit_i),
    .result_t_i(result_t_i[30:0]),
    .leaf_slot_o(leaf_slot),
    .leaf_valid_o(leaf_valid),
    .leaf_limit_o(leaf_limit),
    .leaf_over_o(leaf_over),
    .key_slot_i(node_given_slot_i),
    .key_valid_o(best_key_valid),
    .key_o(best_key),
    .done_slot_i(ends_ready ? ends_slot : done_slot_q),
    .done_hit_o(done_hit_o),
    .done_t_o(done_t_o[30:0]),
    .done_number_o(done_number_o),
    .done_place_o(done_place_o)
  );
endmodule
`default_nettype wire
