// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The traverser: rays come from the ray pool, and leave as packages, contributions, or nothing, each freeing its place
// then. A ray is set up, given to a lane that has a slot for it, visits nodes and triangles there, and goes through
// rp_ray_exit.v. Lanes share two caches and the port to the traverser's memory, and some of them a triangle pipe.
// Promises: what a ray hits is what rp_triangle_pipe.v hits of all triangles in the tree; a ray in the traverser waits
// only for the memory and for those before it in ray_exit; whatever the memory holds, rays end or there is a fault,
// which stays until the reset: no more rays come in then, no node is tested, nothing is requested, and no ray is done,
// so that the one with the fault never leaves; what was done before still does. No output depends on an input of the
// same cycle. Must be given: a place that is not free for each ray; a tree as docs/use/tree-file.md has it, or a fault
// may be all that comes of it; all that stays for a frame before its first ray; a reset before another tree or other
// materials, while none of its requests is on its way.
`default_nettype none
module rp_traverser #(
  parameter integer LANES = 8,
  parameter integer SLOTS = 24,                  // of a lane
  parameter integer ENTRIES = 16,                // of a slot's stack
  parameter integer BITS = 12,                   // of the box test
  parameter integer TRIANGLE_PIPES = 4,          // lane l uses pipe l % TRIANGLE_PIPES
  parameter integer NODE_LINES = 1024,
  parameter integer NODE_WAYS = 16,
  parameter integer NODE_MSHRS = 64,
  parameter integer NODE_BANKS = 8,
  parameter integer TRIANGLE_LINES = 1024,
  parameter integer TRIANGLE_WAYS = 16,
  parameter integer TRIANGLE_MSHRS = 64,
  parameter integer TRIANGLE_BANKS = 8,
  parameter integer POOL = 512,                  // places of the ray pool
  parameter integer RECORD_WORDS = 21,           // of a package
  parameter integer SHADING = 0,                 // shadow rays that meet nothing are contributions
  parameter integer CULLING = 0,
  parameter integer MISS_RECORDS = 0,            // rays return that ask for it; not with CULLING
  parameter integer KINDS = 2 + CULLING,
  parameter integer PLACE_BITS = (POOL > 1) ? $clog2(POOL) : 1
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  // what stays for a frame
  input  wire [31:0]           root_i,               // node or leaf; all ones: an empty tree
  input  wire [95:0]           lower_i,              // bounds of the scene, x in the low word
  input  wire [95:0]           upper_i,
  input  wire [25:0]           triangles_line_i,     // where they begin; nodes are the lines from 0 to here
  input  wire [25:0]           triangle_lines_i,
  input  wire [25:0]           stacks_line_i,
  input  wire [31:0]           material_base_i,      // bytes
  input  wire [104:0]          record_i,             // of each place of a package its word, 5 bits; 31: zero
  input  wire [7:0]            depth_limit_i,
  input  wire                  reflections_i,        // normal packages are for the kernel that reflects
  // the first fault, sticky
  output reg                   fault_valid_o,
  output reg  [2:0]            fault_code_o,         // 0 node beyond the tree, 1 triangle beyond it, 2 no room in a
                                                     // stack; of a node 4 children, 5 order, 6 visits
  output reg  [25:0]           fault_line_o,
  // rays
  input  wire                  ray_valid_i,
  output wire                  ray_ready_o,
  input  wire [127:0]          ray_data_i,
  input  wire                  ray_last_i,
  input  wire [PLACE_BITS-1:0] ray_place_i,
  output wire                  free_valid_o,
  output wire [PLACE_BITS-1:0] free_place_o,
  output wire                  free_shadow_o,
  // what becomes of them
  output wire                  put_valid_o,
  input  wire [KINDS-1:0]      put_ready_i,
  output wire [1:0]            put_kind_o,
  output wire [127:0]          put_data_o,
  output wire                  contribution_valid_o,
  input  wire                  contribution_ready_i,
  output wire [31:0]           contribution_pixel_o,
  output wire [95:0]           contribution_color_o,
  // memory
  output wire                  request_valid_o,
  input  wire                  request_ready_i,
  output wire                  request_write_o,
  output wire                  request_second_o,
  output wire [31:0]           request_address_o,
  output wire [255:0]          request_data_o,
  input  wire                  response_valid_i,
  input  wire [1:0]            response_beat_i,
  input  wire [127:0]          response_data_i
);
  generate
    if (TRIANGLE_PIPES < 1 || TRIANGLE_PIPES > LANES || LANES > 31) begin : gen_bad_lanes
      traverser_LANES_must_be_31_or_less_and_TRIANGLE_PIPES_from_1_to_LANES illegal ();
    end
  endgenerate
`include "rp_onehot.vh"
`include "rp_records.vh"
  localparam integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1;
  localparam integer KEY_BITS = BITS + 9;
  localparam integer ENTRY_BITS = KEY_BITS + 32;
  localparam integer TAG_BITS = 30 + SLOT_BITS;
  localparam integer BLOCK_BITS = 7;
  localparam integer LINE_BITS = 26;
  localparam integer NODE_ID_BITS = $clog2(NODE_BANKS) +
    ((NODE_MSHRS > NODE_BANKS) ? $clog2(NODE_MSHRS / NODE_BANKS) : 1);
  localparam integer TRIANGLE_ID_BITS = $clog2(TRIANGLE_BANKS) +
    ((TRIANGLE_MSHRS > TRIANGLE_BANKS) ? $clog2(TRIANGLE_MSHRS / TRIANGLE_BANKS) : 1);
  genvar g;

  // ---- A ray comes, in beats; with the last one it gets a slot
  wire [LANES-1:0] slot_valid, enter_grant;
  wire [LANES*SLOT_BITS-1:0] slot_of;
  reg [1:0] beat_q;
  reg [255:0] beats_q;
  assign ray_ready_o = (|slot_valid && !fault_valid_o) || beat_q != 2'd0;
  wire beat_comes = ray_valid_i && ray_ready_o;
  wire enters = beat_comes && ray_last_i;
  always @(posedge clk_i)
    if (!rst_ni) beat_q <= 2'd0;
    else if (beat_comes) beat_q <= ray_last_i ? 2'd0 : beat_q + 2'd1;
  always @(posedge clk_i) if (beat_comes) beats_q <= {ray_data_i, beats_q[255:128]};
  wire [383:0] ray_words = {ray_data_i, beats_q};
  rp_round_robin #(.COUNT(LANES)) enter_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(slot_valid), .advance_i(enters), .grant_o(enter_grant));
  `ONEHOT_SELECT(slot_among, LANES, SLOT_BITS)
  wire [SLOT_BITS-1:0] enter_slot = slot_among(enter_grant, slot_of);

  // ---- It is set up, for all lanes to see
  wire set_valid, meets, set_shadow, set_returns, set_first;
  wire [PLACE_BITS-1:0] set_place;
  wire [7:0] set_depth;
  wire [LANES-1:0] set_lane;
  wire [SLOT_BITS-1:0] set_slot;
  wire [95:0] origin, padded_lower, padded_upper, inverse;
  wire [31:0] limit;
  wire [8:0] scale;
  wire [2:0] backwards, still;
  wire [3*BITS-1:0] reciprocal;
  wire [29:0] exponent, padding;
  wire [KEY_BITS-1:0] limit_key;
  wire [1:0] main_axis;
  wire [63:0] shear;
  wire [104:0] direction;
  localparam integer SET_TAG_BITS = ((MISS_RECORDS != 0) ? 2 : 0) + PLACE_BITS + 8 + 1 + LANES + SLOT_BITS;
  wire ray_returns = ray_words[RAY_RETURNS] && !ray_words[RAY_SHADOW];
  wire [PLACE_BITS+10+LANES+SLOT_BITS:0] ray_tag = {
    ray_returns, ray_returns && ray_words[RAY_FIRST],
    ray_place_i, ray_words[RAY_DEPTH +: RAY_DEPTH_BITS], ray_words[RAY_SHADOW], enter_grant, enter_slot};
  wire unused_tag = &{1'b0, ray_tag};
  wire [SET_TAG_BITS-1:0] set_tag;
  assign {set_place, set_depth, set_shadow, set_lane, set_slot} = set_tag[PLACE_BITS+8+LANES+SLOT_BITS:0];
  assign set_returns = MISS_RECORDS != 0 && set_tag[SET_TAG_BITS-1];
  assign set_first = MISS_RECORDS != 0 && set_tag[SET_TAG_BITS-2];
  rp_ray_setup #(.BITS(BITS), .TAG_BITS(SET_TAG_BITS)) setup (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(enters),
    .tag_i(ray_tag[SET_TAG_BITS-1:0]),
    .origin_i(ray_words[RAY_ORIGIN +: RAY_ORIGIN_BITS]),
    .direction_i(ray_words[RAY_DIRECTION +: RAY_DIRECTION_BITS]),
    .limit_i(ray_words[RAY_LIMIT +: RAY_LIMIT_BITS]),
    .lower_i(lower_i),
    .upper_i(upper_i),
    .valid_o(set_valid),
    .tag_o(set_tag),
    .hits_o(meets),
    .origin_o(origin),
    .limit_o(limit),
    .scale_o(scale),
    .backwards_o(backwards),
    .still_o(still),
    .reciprocal_o(reciprocal),
    .exponent_o(exponent),
    .padding_o(padding),
    .key_o(limit_key),
    .padded_lower_o(padded_lower),
    .padded_upper_o(padded_upper),
    .inverse_o(inverse),
    .main_axis_o(main_axis),
    .shear_o(shear),
    .direction_o(direction)
  );

  // ---- Lanes
  wire [LANES-1:0] slot_free, done_valid, done_ready, done_hit;
  wire [SLOT_BITS-1:0] slot_free_slot;
  wire [LANES-1:0] node_fault;
  wire [LANES*2-1:0] node_fault_reason;
  wire [LANES*LINE_BITS-1:0] node_fault_line;
  wire [LANES*SLOT_BITS-1:0] done_slot;
  wire [LANES*32-1:0] done_t, done_number;
  wire [LANES*29-1:0] done_place;
  wire [2*LANES-1:0] node_want, node_taken;
  wire [2*LANES*LINE_BITS-1:0] node_want_line;
  wire [2*LANES*SLOT_BITS-1:0] node_want_slot;
  wire [LANES-1:0] node_given, node_waited;
  wire [LANES*SLOT_BITS-1:0] node_given_slot;
  wire [LANES*512-1:0] node_given_data;
  // The triangle cache has one lane more, of those that read the triangle that they have hit.
  wire [2*LANES+1:0] leaf_want, leaf_prefetch, leaf_taken;
  wire [2*(LANES+1)*LINE_BITS-1:0] leaf_want_line;
  wire [2*(LANES+1)*SLOT_BITS-1:0] leaf_want_slot;
  wire [LANES:0] leaf_room, leaf_waited, leaf_given;
  wire [(LANES+1)*SLOT_BITS-1:0] leaf_given_slot;
  wire [(LANES+1)*512-1:0] leaf_given_data;
  wire [LANES-1:0] stack_request_valid, stack_request_ready, stack_request_write, stack_fill_valid;
  wire [LANES*SLOT_BITS-1:0] stack_request_slot;
  wire [LANES*BLOCK_BITS-1:0] stack_request_block;
  wire [LANES*4*ENTRY_BITS-1:0] stack_request_entries;
  wire [4*ENTRY_BITS-1:0] stack_fill_entries;
  wire [LANES-1:0] test_valid, test_ready;
  wire [LANES*TAG_BITS-1:0] test_tag, limit_tag, best_tag, result_tag;
  wire [LANES*TEST_BITS-1:0] test;
  wire [LANES*32-1:0] test_limit, best_t, best_number, result_number, result_t;
  wire [LANES*9-1:0] test_scale;
  wire [LANES-1:0] result_valid, result_hit;
  generate
    for (g = 0; g < LANES; g = g + 1) begin : gen_lane
      rp_traverser_lane #(.SLOTS(SLOTS), .ENTRIES(ENTRIES), .BITS(BITS), .LINE_BITS(LINE_BITS), .BLOCK_BITS(BLOCK_BITS))
      lane (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .root_i(root_i),
        .nodes_i(triangles_line_i),
        .fault_valid_o(node_fault[g]),
        .fault_reason_o(node_fault_reason[2*g +: 2]),
        .fault_line_o(node_fault_line[g*LINE_BITS +: LINE_BITS]),
        .stop_i(fault_valid_o),
        .slot_valid_o(slot_valid[g]),
        .slot_ready_i(enters && enter_grant[g]),
        .slot_o(slot_of[g*SLOT_BITS +: SLOT_BITS]),
        .ray_valid_i(set_valid && set_lane[g]),
        .ray_slot_i(set_slot),
        .ray_meets_i(meets),
        .ray_shadow_i(set_shadow || set_first),
        .origin_i(origin),
        .backwards_i(backwards),
        .still_i(still),
        .reciprocal_i(reciprocal),
        .exponent_i(exponent),
        .padding_i(padding),
        .limit_key_i(limit_key),
        .padded_lower_i(padded_lower),
        .padded_upper_i(padded_upper),
        .inverse_i(inverse),
        .main_axis_i(main_axis),
        .shear_i(shear),
        .direction_i(direction),
        .limit_i(limit),
        .scale_i(scale),
        .node_want_o(node_want[2*g +: 2]),
        .node_want_line_o(node_want_line[2*g*LINE_BITS +: 2*LINE_BITS]),
        .node_want_slot_o(node_want_slot[2*g*SLOT_BITS +: 2*SLOT_BITS]),
        .node_taken_i(node_taken[2*g +: 2]),
        .node_given_i(node_given[g]),
        .node_given_slot_i(node_given_slot[g*SLOT_BITS +: SLOT_BITS]),
        .node_given_data_i(node_given_data[g*512 +: 512]),
        .leaf_want_o(leaf_want[2*g +: 2]),
        .leaf_want_prefetch_o(leaf_prefetch[2*g +: 2]),
        .leaf_want_line_o(leaf_want_line[2*g*LINE_BITS +: 2*LINE_BITS]),
        .leaf_want_slot_o(leaf_want_slot[2*g*SLOT_BITS +: 2*SLOT_BITS]),
        .leaf_taken_i(leaf_taken[2*g +: 2]),
        .leaf_room_o(leaf_room[g]),
        .leaf_waited_i(leaf_waited[g] && leaf_room[g]),
        .leaf_given_i(leaf_given[g]),
        .leaf_given_slot_i(leaf_given_slot[g*SLOT_BITS +: SLOT_BITS]),
        .leaf_given_data_i(leaf_given_data[g*512 +: 512]),
        .request_valid_o(stack_request_valid[g]),
        .request_ready_i(stack_request_ready[g]),
        .request_write_o(stack_request_write[g]),
        .request_slot_o(stack_request_slot[g*SLOT_BITS +: SLOT_BITS]),
        .request_block_o(stack_request_block[g*BLOCK_BITS +: BLOCK_BITS]),
        .request_entries_o(stack_request_entries[g*4*ENTRY_BITS +: 4*ENTRY_BITS]),
        .fill_valid_i(stack_fill_valid[g]),
        .fill_entries_i(stack_fill_entries),
        .test_valid_o(test_valid[g]),
        .test_ready_i(test_ready[g]),
        .test_tag_o(test_tag[g*TAG_BITS +: TAG_BITS]),
        .test_corners_o(test[g*TEST_BITS+TEST_CORNERS +: TEST_CORNERS_BITS]),
        .test_number_o(test[g*TEST_BITS+TEST_NUMBER +: TEST_NUMBER_BITS]),
        .test_origin_o(test[g*TEST_BITS+TEST_ORIGIN +: TEST_ORIGIN_BITS]),
        .test_padded_lower_o(test[g*TEST_BITS+TEST_PADDED_LOWER +: TEST_PADDED_LOWER_BITS]),
        .test_padded_upper_o(test[g*TEST_BITS+TEST_PADDED_UPPER +: TEST_PADDED_UPPER_BITS]),
        .test_inverse_o(test[g*TEST_BITS+TEST_INVERSE +: TEST_INVERSE_BITS]),
        .test_main_axis_o(test[g*TEST_BITS+TEST_MAIN_AXIS +: TEST_MAIN_AXIS_BITS]),
        .test_shear_o(test[g*TEST_BITS+TEST_SHEAR +: TEST_SHEAR_BITS]),
        .test_direction_o(test[g*TEST_BITS+TEST_DIRECTION +: TEST_DIRECTION_BITS]),
        .limit_slot_i(limit_tag[g*TAG_BITS +: SLOT_BITS]),
        .limit_o(test_limit[g*32 +: 32]),
        .scale_o(test_scale[g*9 +: 9]),
        .best_slot_i(best_tag[g*TAG_BITS +: SLOT_BITS]),
        .best_t_o(best_t[g*32 +: 32]),
        .best_number_o(best_number[g*32 +: 32]),
        .result_valid_i(result_valid[g]),
        .result_tag_i(result_tag[g*TAG_BITS +: TAG_BITS]),
        .result_number_i(result_number[g*32 +: 32]),
        .result_hit_i(result_hit[g]),
        .result_t_i(result_t[g*32 +: 32]),
        .done_valid_o(done_valid[g]),
        .done_ready_i(done_ready[g]),
        .done_slot_o(done_slot[g*SLOT_BITS +: SLOT_BITS]),
        .done_hit_o(done_hit[g]),
        .done_t_o(done_t[g*32 +: 32]),
        .done_number_o(done_number[g*32 +: 32]),
        .done_place_o(done_place[g*29 +: 29]),
        .free_valid_i(slot_free[g]),
        .free_slot_i(slot_free_slot)
      );
    end
  endgenerate
  wire unused = &{1'b0, done_number, node_waited, limit_tag, best_tag};

  // ---- Triangle pipes, each with the lanes that share it
  generate
    for (g = 0; g < TRIANGLE_PIPES; g = g + 1) begin : gen_group
      localparam integer COUNT = (LANES - g + TRIANGLE_PIPES - 1) / TRIANGLE_PIPES;
      wire [COUNT-1:0] valid, ready, results;
      wire [COUNT*TAG_BITS-1:0] tags;
      wire [COUNT*TEST_BITS-1:0] tests;
      wire [COUNT*32-1:0] limits, ts, numbers;
      wire [COUNT*9-1:0] scales;
      wire [TAG_BITS-1:0] asks_limit, asks_best, tag;
      wire [31:0] number, t;
      wire hit;
      genvar m;
      for (m = 0; m < COUNT; m = m + 1) begin : gen_member
        localparam integer LANE = g + m * TRIANGLE_PIPES;
        assign valid[m] = test_valid[LANE];
        assign test_ready[LANE] = ready[m];
        assign tags[m*TAG_BITS +: TAG_BITS] = test_tag[LANE*TAG_BITS +: TAG_BITS];
        assign tests[m*TEST_BITS +: TEST_BITS] = test[LANE*TEST_BITS +: TEST_BITS];
        assign limits[m*32 +: 32] = test_limit[LANE*32 +: 32];
        assign scales[m*9 +: 9] = test_scale[LANE*9 +: 9];
        assign ts[m*32 +: 32] = best_t[LANE*32 +: 32];
        assign numbers[m*32 +: 32] = best_number[LANE*32 +: 32];
        assign limit_tag[LANE*TAG_BITS +: TAG_BITS] = asks_limit;
        assign best_tag[LANE*TAG_BITS +: TAG_BITS] = asks_best;
        assign result_valid[LANE] = results[m];
        assign result_tag[LANE*TAG_BITS +: TAG_BITS] = tag;
        assign result_number[LANE*32 +: 32] = number;
        assign result_hit[LANE] = hit;
        assign result_t[LANE*32 +: 32] = t;
      end
      rp_triangle_group #(.LANES(COUNT), .TAG_BITS(TAG_BITS), .WIDTH(TEST_BITS)) pipe (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .test_valid_i(valid),
        .test_ready_o(ready),
        .test_tag_i(tags),
        .test_i(tests),
        .limit_tag_o(asks_limit),
        .limit_i(limits),
        .scale_i(scales),
        .best_tag_o(asks_best),
        .best_t_i(ts),
        .best_number_i(numbers),
        .result_valid_o(results),
        .result_tag_o(tag),
        .result_number_o(number),
        .result_hit_o(hit),
        .result_t_o(t)
      );
    end
  endgenerate

  // ---- What becomes of rays
  rp_ray_exit #(
    .LANES(LANES), .SLOTS(SLOTS), .POOL(POOL), .RECORD_WORDS(RECORD_WORDS), .SHADING(SHADING), .CULLING(CULLING),
    .MISS_RECORDS(MISS_RECORDS), .KINDS(KINDS), .PLACE_BITS(PLACE_BITS), .SLOT_BITS(SLOT_BITS)
  ) exit (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .material_base_i(material_base_i),
    .record_i(record_i),
    .depth_limit_i(depth_limit_i),
    .reflections_i(reflections_i),
    .ray_valid_i(enters),
    .ray_place_i(ray_place_i),
    .ray_words_i(ray_words),
    .set_valid_i(set_lane & {LANES{set_valid}}),
    .set_slot_i(set_slot),
    .set_place_i(set_place),
    .set_depth_i(set_depth),
    .set_shadow_i(set_shadow),
    .set_returns_i(set_returns),
    .set_first_i(set_first),
    .set_origin_i(origin),
    .set_main_axis_i(main_axis),
    .set_shear_i(shear),
    .set_scale_i(scale),
    .done_valid_i(done_valid & {LANES{!fault_valid_o}}),
    .done_ready_o(done_ready),
    .done_slot_i(done_slot),
    .done_hit_i(done_hit),
    .done_t_i(done_t),
    .done_place_i(done_place),
    .slot_free_o(slot_free),
    .slot_free_slot_o(slot_free_slot),
    .want_o(leaf_want[2*LANES +: 2]),
    .want_prefetch_o(leaf_prefetch[2*LANES +: 2]),
    .want_line_o(leaf_want_line[2*LANES*LINE_BITS +: 2*LINE_BITS]),
    .want_slot_o(leaf_want_slot[2*LANES*SLOT_BITS +: 2*SLOT_BITS]),
    .taken_i(leaf_taken[2*LANES +: 2]),
    .room_o(leaf_room[LANES]),
    .waited_i(leaf_waited[LANES] && leaf_room[LANES]),
    .given_i(leaf_given[LANES]),
    .given_slot_i(leaf_given_slot[LANES*SLOT_BITS +: SLOT_BITS]),
    .given_data_i(leaf_given_data[LANES*512 +: 512]),
    .free_valid_o(free_valid_o),
    .free_place_o(free_place_o),
    .free_shadow_o(free_shadow_o),
    .put_valid_o(put_valid_o),
    .put_ready_i(put_ready_i),
    .put_kind_o(put_kind_o),
    .put_data_o(put_data_o),
    .contribution_valid_o(contribution_valid_o),
    .contribution_ready_i(contribution_ready_i),
    .contribution_pixel_o(contribution_pixel_o),
    .contribution_color_o(contribution_color_o)
  );

  // ---- Caches and memory
  wire node_request_valid, node_request_ready, node_fill_valid, node_fill_ready;
  wire triangle_request_valid, triangle_request_ready, triangle_fill_valid, triangle_fill_ready;
  wire [LINE_BITS-1:0] node_request_line, triangle_request_line;
  wire [NODE_ID_BITS-1:0] node_request_id, node_fill_id;
  wire [TRIANGLE_ID_BITS-1:0] triangle_request_id, triangle_fill_id;
  wire [511:0] fill_data;
  wire port_fault;
  wire [1:0] port_fault_source;
  wire [LINE_BITS-1:0] port_fault_line;
  rp_tree_banks #(
    .LANES(LANES), .SLOTS(SLOTS), .LINES(NODE_LINES), .WAYS(NODE_WAYS), .MSHRS(NODE_MSHRS), .BANKS(NODE_BANKS),
    .LINE_BITS(LINE_BITS)
  ) nodes (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .want_valid_i(node_want),
    .want_line_i(node_want_line),
    .want_slot_i(node_want_slot),
    .want_prefetch_i({2*LANES{1'b0}}),
    .taken_o(node_taken),
    .waited_valid_o(node_waited),
    .waited_ready_i({LANES{1'b1}}),
    .given_valid_o(node_given),
    .given_slot_o(node_given_slot),
    .given_data_o(node_given_data),
    .request_valid_o(node_request_valid),
    .request_ready_i(node_request_ready),
    .request_line_o(node_request_line),
    .request_id_o(node_request_id),
    .fill_valid_i(node_fill_valid),
    .fill_ready_o(node_fill_ready),
    .fill_id_i(node_fill_id),
    .fill_data_i(fill_data)
  );
  rp_tree_banks #(
    .LANES(LANES+1), .SLOTS(SLOTS), .LINES(TRIANGLE_LINES), .WAYS(TRIANGLE_WAYS), .MSHRS(TRIANGLE_MSHRS),
    .BANKS(TRIANGLE_BANKS), .LINE_BITS(LINE_BITS)
  ) triangles (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .want_valid_i(leaf_want),
    .want_line_i(leaf_want_line),
    .want_slot_i(leaf_want_slot),
    .want_prefetch_i(leaf_prefetch),
    .taken_o(leaf_taken),
    .waited_valid_o(leaf_waited),
    .waited_ready_i(leaf_room),
    .given_valid_o(leaf_given),
    .given_slot_o(leaf_given_slot),
    .given_data_o(leaf_given_data),
    .request_valid_o(triangle_request_valid),
    .request_ready_i(triangle_request_ready),
    .request_line_o(triangle_request_line),
    .request_id_o(triangle_request_id),
    .fill_valid_i(triangle_fill_valid),
    .fill_ready_o(triangle_fill_ready),
    .fill_id_i(triangle_fill_id),
    .fill_data_i(fill_data)
  );
  rp_tree_port #(
    .LANES(LANES), .SLOTS(SLOTS), .ENTRY_BITS(ENTRY_BITS), .BLOCK_BITS(BLOCK_BITS), .NODE_ID_BITS(NODE_ID_BITS),
    .TRIANGLE_ID_BITS(TRIANGLE_ID_BITS), .LINES(NODE_MSHRS + TRIANGLE_MSHRS + LANES)
  ) port (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .triangles_line_i(triangles_line_i),
    .triangle_lines_i(triangle_lines_i),
    .stacks_line_i(stacks_line_i),
    .fault_valid_o(port_fault),
    .fault_source_o(port_fault_source),
    .fault_line_o(port_fault_line),
    .stop_i(fault_valid_o),
    .node_request_valid_i(node_request_valid),
    .node_request_ready_o(node_request_ready),
    .node_request_line_i(node_request_line),
    .node_request_id_i(node_request_id),
    .node_fill_valid_o(node_fill_valid),
    .node_fill_ready_i(node_fill_ready),
    .node_fill_id_o(node_fill_id),
    .triangle_request_valid_i(triangle_request_valid),
    .triangle_request_ready_o(triangle_request_ready),
    .triangle_request_line_i(triangle_request_line),
    .triangle_request_id_i(triangle_request_id),
    .triangle_fill_valid_o(triangle_fill_valid),
    .triangle_fill_ready_i(triangle_fill_ready),
    .triangle_fill_id_o(triangle_fill_id),
    .fill_data_o(fill_data),
    .stack_request_valid_i(stack_request_valid),
    .stack_request_ready_o(stack_request_ready),
    .stack_request_write_i(stack_request_write),
    .stack_request_slot_i(stack_request_slot),
    .stack_request_block_i(stack_request_block),
    .stack_request_entries_i(stack_request_entries),
    .stack_fill_valid_o(stack_fill_valid),
    .stack_fill_entries_o(stack_fill_entries),
    .request_valid_o(request_valid_o),
    .request_ready_i(request_ready_i),
    .request_write_o(request_write_o),
    .request_second_o(request_second_o),
    .request_address_o(request_address_o),
    .request_data_o(request_data_o),
    .response_valid_i(response_valid_i),
    .response_beat_i(response_beat_i),
    .response_data_i(response_data_i)
  );

  // ---- The first fault: of the port's and the lanes' in one cycle the port's, then that of the lowest lane
  reg [2:0] first_code;
  reg [LINE_BITS-1:0] first_line;
  integer f;
  always @* begin
    first_code = {1'b0, port_fault_source};
    first_line = port_fault_line;
    for (f = LANES - 1; f >= 0; f = f - 1)
      if (node_fault[f] && !port_fault) begin
        first_code = {1'b1, node_fault_reason[2*f +: 2]};
        first_line = node_fault_line[f*LINE_BITS +: LINE_BITS];
      end
  end
  wire faults = port_fault || |node_fault;
  always @(posedge clk_i)
    if (!rst_ni) fault_valid_o <= 1'b0;
    else if (faults) fault_valid_o <= 1'b1;
  always @(posedge clk_i)
    if (faults && !fault_valid_o) begin
      fault_code_o <= first_code;
      fault_line_o <= first_line;
    end
endmodule
`default_nettype wire
