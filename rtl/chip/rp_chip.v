// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The chip: compute units, pools, controller, memory port and frame port, and with TRAVERSER the traverser. Outside
// remain the memory, the frame buffer, a host that writes what stays for a frame and starts it, and a traverser at the
// chip's ports; with one inside these are tied off. docs/machine/chip.md has its ports.
// Promises: those of its blocks at its ports; of several units the one with a fault stops, and the frame does not end;
// nor does it after a fault of the traverser. It takes a frame only while it is ready, when nothing of another one is
// left in it. The traverser is in reset then, so that it begins each frame without a line in its caches.
// No output depends combinationally on an input, counter_o excepted, which depends on its selection.
// Must be given: what its blocks must; while it is ready an argument before each frame, as memories may have changed,
// and all that stays for a frame from start_i on.
`default_nettype none
module rp_chip #(
  parameter integer UNITS = 1,
`include "rp_unit_parameters.vh"
`include "rp_chip_parameters.vh"
  parameter integer WARP_BITS = (WARPS > 1) ? $clog2(WARPS) : 1,
  parameter integer KINDS = 2 + CULLING,
  parameter integer PLACE_BITS = (RAY_POOL_SIZE > 1) ? $clog2(RAY_POOL_SIZE) : 1
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  // the host's: for the units, and for a frame
  input  wire [15:0]           program_length_i,       // instructions
  input  wire [31:0]           memory_limit_i,         // bytes
  input  wire                  argument_write_i,       // while ready_o; invalidates the units' caches
  input  wire [4:0]            argument_index_i,
  input  wire [31:0]           argument_data_i,
  output wire                  ready_o,                // nothing of a frame is left inside: the next one may begin
  input  wire                  start_i,                // it does, in a cycle with ready_o; refused in others
  input  wire [15:0]           width_i,                // pixels, 1 or more
  input  wire [15:0]           height_i,
  input  wire [7:0]            depth_limit_i,          // of normal rays: deeper ones are dropped
  input  wire                  reflections_i,          // normal intersections are for the kernel that reflects
  input  wire [15:0]           eye_pc_i,
  input  wire [15:0]           secondary_pc_i,         // of the kernel that reflects
  input  wire [15:0]           direct_pc_i,            // of the one that does not
  input  wire [15:0]           shade_pc_i,
  // the same for a traverser inside: where its memory has the tree, and what leaves of its hits
  input  wire [31:0]           tree_root_i,            // node or leaf; all ones: an empty tree
  input  wire [95:0]           tree_lower_i,           // bounds of all vertices; x in the low word
  input  wire [95:0]           tree_upper_i,
  input  wire [25:0]           triangles_line_i,       // of 64 bytes; nodes are the lines from 0 to here
  input  wire [25:0]           triangle_lines_i,       // that triangles take
  input  wire [25:0]           stacks_line_i,
  input  wire [31:0]           material_base_i,        // bytes, in the units' memory
  input  wire [104:0]          record_i,               // of each place of an intersection its word, 5 bits; 31: zero
  output wire                  busy_o,                 // a frame is drawn: something is still to leave the units
  // memory: accesses, and beats of the lines that are read, in their order
  output wire                  memory_request_valid_o,
  input  wire                  memory_request_ready_i,
  output wire                  memory_request_traverser_o,   // in the traverser's memory
  output wire                  memory_request_write_o,
  output wire [31:0]           memory_request_address_o,
  output wire [127:0]          memory_request_data_o,
  output wire [3:0]            memory_request_mask_o,
  input  wire                  memory_beat_valid_i,
  output wire                  memory_beat_ready_o,
  input  wire [127:0]          memory_beat_data_i,
  // frame buffer
  output wire                  frame_valid_o,
  input  wire                  frame_ready_i,
  output wire [31:0]           frame_pixel_o,
  output wire [95:0]           frame_color_o,          // red in the low word
  // traverser: its rays, and places of those that have left it
  output wire                  ray_valid_o,
  input  wire                  ray_ready_i,
  output wire [127:0]          ray_data_o,
  output wire                  ray_last_o,
  output wire [PLACE_BITS-1:0] ray_place_o,
  input  wire                  free_valid_i,
  input  wire [PLACE_BITS-1:0] free_place_i,
  input  wire                  free_shadow_i,
  // what becomes of them: beats of intersections, contributions
  input  wire                  put_valid_i,
  output wire [KINDS-1:0]      put_ready_o,            // of each kind
  input  wire [1:0]            put_kind_i,
  input  wire [127:0]          put_data_i,
  input  wire                  contribution_valid_i,
  output wire                  contribution_ready_o,
  input  wire [31:0]           contribution_pixel_i,
  input  wire [95:0]           contribution_color_i,
  // its memory
  input  wire                  tree_request_valid_i,
  output wire                  tree_request_ready_o,
  input  wire                  tree_request_write_i,
  input  wire                  tree_request_second_i,  // and the line, or quadword, behind it
  input  wire [31:0]           tree_request_address_i,
  input  wire [255:0]          tree_request_data_i,
  output wire                  tree_response_valid_o,
  output wire [1:0]            tree_response_beat_o,
  output wire [127:0]          tree_response_data_o,
  // the first unit's fault, sticky
  output wire                  fault_valid_o,
  output wire [3:0]            fault_code_o,
  output wire [WARP_BITS-1:0]  fault_warp_o,
  output wire [15:0]           fault_pc_o,
  output wire [1:0]            fault_unit_o,
  // that of a traverser inside, sticky: codes as in rtl/traverser/rp_traverser.v, and the line of its memory
  output wire                  tree_fault_valid_o,
  output wire [2:0]            tree_fault_code_o,
  output wire [25:0]           tree_fault_line_o,
  // performance counters of the units, docs/machine/architecture.md
  input  wire [1:0]            counter_unit_i,
  input  wire [5:0]            counter_select_i,
  output wire [63:0]           counter_o,              // the exception: depends on counter_*_i
  // for the report, since the reset, right two cycles after the last event
  output wire [47:0]           rays_taken_o,           // dropped ones too
  output wire [47:0]           ray_port_busy_o,        // cycles
  output wire [47:0]           packages_taken_o,
  output wire [47:0]           contributions_o,
  output wire [47:0]           memory_reads_o,         // lines, of the units
  output wire [47:0]           memory_writes_o,        // quadwords, likewise
  output wire [47:0]           memory_port_busy_o      // cycles
);
  localparam integer RAY_BITS = $clog2(RAY_POOL_SIZE + 1);
  localparam integer LEVEL_BITS = $clog2(INTERSECTION_POOL_SIZE + 1);
  generate
    if (MISS_RECORDS < 0 || MISS_RECORDS > 1 || (MISS_RECORDS != 0 && CULLING != 0)) begin : gen_bad_miss_records
      chip_MISS_RECORDS_must_be_0_or_1_and_0_with_CULLING_which_drops_rays_that_would_return illegal ();
    end
  endgenerate

  // ---- Between two frames: all that waits or is on its way has gone, and the traverser asks for nothing more. The
  // reset drops the prefetches of the frame before: no line comes back for a request of that frame.
  reg ready_q;
  wire idle;
  wire starts = start_i && ready_q;
  assign ready_o = ready_q;
  always @(posedge clk_i)
    if (!rst_ni) ready_q <= 1'b1;
    else ready_q <= idle && !starts;

  // ---- Controller and units
  wire launch_valid, launch_ready;
  wire [1:0] launch_unit, launch_import;
  wire [15:0] launch_pc;
  wire [10:0] launch_threads;
  wire [31:0] launch_block;
  wire [UNITS-1:0] kernel_done, unit_busy, unit_idle;
  wire [UNITS*16-1:0] exports;

  // ---- Units and pools, memory port, frame port
  wire device_request_valid, device_request_ready, device_request_write, device_response_valid;
  wire [31:0] device_request_address;
  wire [127:0] device_request_data, device_response_data;
  wire [3:0] device_request_mask;
  wire [6:0] device_request_id, device_response_id;
  wire [1:0] device_response_beat;
  wire import_request_valid, import_request_ready, import_beat_valid;
  wire [1:0] import_request_kind, import_request_unit;
  wire [127:0] import_beat_data;
  wire export_valid, export_ready, export_last;
  wire [127:0] export_data;
  wire [1:0] export_unit;
  wire unit_frame_valid, unit_frame_ready;
  wire [31:0] unit_frame_pixel;
  wire [95:0] unit_frame_color;
  wire [1:0] unit_frame_unit;

  // ---- Controller, pools and frame port
  wire [RAY_BITS-1:0] rays, shadow_rays;
  wire outcome_valid, outcome_kept, outcome_deep, outcome_shadow, outcome_eye;
  wire [1:0] outcome_unit;
  wire [31:0] outcome_pixel;
  wire [KINDS*LEVEL_BITS-1:0] size, available;
  wire reserve_valid;
  wire [1:0] reserve_kind;
  wire [LEVEL_BITS-1:0] reserve_count;
  wire exported_valid;
  wire [1:0] exported_unit;
  wire [31:0] exported_pixel;

  // ---- The traverser, and pools, memory port and frame port
  wire ray_valid, ray_ready, ray_last, free_valid, free_shadow;
  wire [127:0] ray_data;
  wire [PLACE_BITS-1:0] ray_place, free_place;
  wire put_valid;
  wire [KINDS-1:0] put_ready;
  wire [1:0] put_kind;
  wire [127:0] put_data;
  wire contribution_valid, contribution_ready;
  wire [31:0] contribution_pixel;
  wire [95:0] contribution_color;
  wire tree_request_valid, tree_request_ready, tree_request_write, tree_request_second, tree_response_valid;
  wire [31:0] tree_request_address;
  wire [255:0] tree_request_data;
  wire [1:0] tree_response_beat;
  wire [127:0] tree_response_data;
  wire memory_idle, inside_asks;
  assign idle = !busy_o && &unit_idle && memory_idle && !frame_valid_o && !inside_asks;
  generate
    if (TRAVERSER != 0) begin : gen_inside
      wire request_valid;
      assign inside_asks = request_valid && !ready_q;
      assign tree_request_valid = inside_asks;
      rp_traverser #(
        .LANES(TRAVERSER_LANES), .SLOTS(TRAVERSER_SLOTS), .ENTRIES(TRAVERSER_ENTRIES), .BITS(TRAVERSER_BITS),
        .TRIANGLE_PIPES(TRAVERSER_TRIANGLE_PIPES), .NODE_LINES(TRAVERSER_NODE_LINES),
        .NODE_WAYS(TRAVERSER_NODE_WAYS), .NODE_MSHRS(TRAVERSER_NODE_MSHRS), .NODE_BANKS(TRAVERSER_BANKS),
        .TRIANGLE_LINES(TRAVERSER_TRIANGLE_LINES), .TRIANGLE_WAYS(TRAVERSER_TRIANGLE_WAYS),
        .TRIANGLE_MSHRS(TRAVERSER_TRIANGLE_MSHRS), .TRIANGLE_BANKS(TRAVERSER_BANKS), .POOL(RAY_POOL_SIZE),
        .RECORD_WORDS(INTERSECTION_WORDS), .SHADING(SHADING), .CULLING(CULLING), .MISS_RECORDS(MISS_RECORDS),
        .KINDS(KINDS), .PLACE_BITS(PLACE_BITS)
      ) traverser (
        .clk_i(clk_i),
        .rst_ni(rst_ni && !ready_q),
        .root_i(tree_root_i),
        .lower_i(tree_lower_i),
        .upper_i(tree_upper_i),
        .triangles_line_i(triangles_line_i),
        .triangle_lines_i(triangle_lines_i),
        .stacks_line_i(stacks_line_i),
        .material_base_i(material_base_i),
        .fault_valid_o(tree_fault_valid_o),
        .fault_code_o(tree_fault_code_o),
        .fault_line_o(tree_fault_line_o),
        .record_i(record_i),
        .depth_limit_i(depth_limit_i),
        .reflections_i(reflections_i),
        .ray_valid_i(ray_valid),
        .ray_ready_o(ray_ready),
        .ray_data_i(ray_data),
        .ray_last_i(ray_last),
        .ray_place_i(ray_place),
        .free_valid_o(free_valid),
        .free_place_o(free_place),
        .free_shadow_o(free_shadow),
        .put_valid_o(put_valid),
        .put_ready_i(put_ready),
        .put_kind_o(put_kind),
        .put_data_o(put_data),
        .contribution_valid_o(contribution_valid),
        .contribution_ready_i(contribution_ready),
        .contribution_pixel_o(contribution_pixel),
        .contribution_color_o(contribution_color),
        .request_valid_o(request_valid),
        .request_ready_i(tree_request_ready),
        .request_write_o(tree_request_write),
        .request_second_o(tree_request_second),
        .request_address_o(tree_request_address),
        .request_data_o(tree_request_data),
        .response_valid_i(tree_response_valid),
        .response_beat_i(tree_response_beat),
        .response_data_i(tree_response_data)
      );
      assign {ray_valid_o, ray_last_o, ray_place_o, ray_data_o} = {{2 + PLACE_BITS{1'b0}}, 128'd0};
      assign {put_ready_o, contribution_ready_o, tree_request_ready_o} = {KINDS + 2{1'b0}};
      assign {tree_response_valid_o, tree_response_beat_o, tree_response_data_o} = {3'd0, 128'd0};
      wire unused = &{1'b0, ray_ready_i, free_valid_i, free_place_i, free_shadow_i, put_valid_i, put_kind_i, put_data_i,
                      contribution_valid_i, contribution_pixel_i, contribution_color_i, tree_request_valid_i,
                      tree_request_write_i, tree_request_second_i, tree_request_address_i, tree_request_data_i};
    end else begin : gen_outside
      assign inside_asks = 1'b0;
      assign ray_ready = ray_ready_i;
      assign {free_valid, free_place, free_shadow} = {free_valid_i, free_place_i, free_shadow_i};
      assign {put_valid, put_kind, put_data} = {put_valid_i, put_kind_i, put_data_i};
      assign {contribution_valid, contribution_pixel, contribution_color} =
        {contribution_valid_i, contribution_pixel_i, contribution_color_i};
      assign {tree_request_valid, tree_request_write, tree_request_second} =
        {tree_request_valid_i, tree_request_write_i, tree_request_second_i};
      assign {tree_request_address, tree_request_data} = {tree_request_address_i, tree_request_data_i};
      assign {ray_valid_o, ray_last_o, ray_place_o, ray_data_o} = {ray_valid, ray_last, ray_place, ray_data};
      assign {put_ready_o, contribution_ready_o} = {put_ready, contribution_ready};
      assign {tree_request_ready_o, tree_response_valid_o} = {tree_request_ready, tree_response_valid};
      assign {tree_response_beat_o, tree_response_data_o} = {tree_response_beat, tree_response_data};
      assign {tree_fault_valid_o, tree_fault_code_o, tree_fault_line_o} = 30'd0;
      wire unused = &{1'b0, tree_root_i, tree_lower_i, tree_upper_i, triangles_line_i, triangle_lines_i, stacks_line_i,
                      material_base_i, record_i};
    end
  endgenerate

  // For simulation only: traces, and those events of rays and pixels that are not needed here.
  wire ray_held_up, pixel_valid;
  wire [1:0] pixel_unit;
  wire [3:0] quiet;
  wire [UNITS*WARPS-1:0] retire_valid;
  wire [UNITS*WARPS*16-1:0] retire_pc;
  wire [UNITS*WARPS*64-1:0] retire_instruction;
  wire [UNITS*WARPS*LANES-1:0] retire_mask, retire_predicate;
  wire [UNITS*WARPS*LANES*32-1:0] retire_data;
  wire [UNITS-1:0] store_trace_valid, ray_trace_valid;
  wire [UNITS*WARP_BITS-1:0] store_trace_warp, ray_trace_warp;
  wire [UNITS*32-1:0] store_trace_address;
  wire [UNITS*128-1:0] store_trace_data;
  wire [UNITS*4-1:0] store_trace_mask;
  wire [UNITS*5-1:0] ray_trace_word;
  wire [UNITS*LANES-1:0] ray_trace_mask;
  wire [UNITS*LANES*32-1:0] ray_trace_data;
  wire unused = &{1'b0, ray_held_up, pixel_valid, pixel_unit, quiet, outcome_kept, outcome_deep, outcome_eye,
                  outcome_pixel, exported_pixel, unit_busy, retire_valid, retire_pc, retire_instruction,
                  retire_mask, retire_predicate, retire_data, store_trace_valid, store_trace_warp, store_trace_address,
                  store_trace_data, store_trace_mask, ray_trace_valid, ray_trace_warp, ray_trace_word, ray_trace_mask,
                  ray_trace_data};

  // A launch has the block of the next tile, which eye rays need; kernels are given no number of blocks.
  rp_multiprocessor #(
    .UNITS(UNITS),
`include "rp_unit_parameter_map.vh"
    .WARP_BITS(WARP_BITS)
  ) multiprocessor (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .program_length_i(program_length_i),
    .memory_limit_i(memory_limit_i),
    .argument_write_i(argument_write_i),
    .argument_index_i(argument_index_i),
    .argument_data_i(argument_data_i),
    .launch_valid_i(launch_valid),
    .launch_ready_o(launch_ready),
    .launch_unit_o(launch_unit),
    .launch_pc_i(launch_pc),
    .launch_threads_i(launch_threads),
    .launch_block_i(launch_block),
    .launch_blocks_i(32'd1),
    .launch_import_i(launch_import),
    .kernel_done_o(kernel_done),
    .busy_o(unit_busy),
    .idle_o(unit_idle),
    .exports_o(exports),
    .memory_request_valid_o(device_request_valid),
    .memory_request_ready_i(device_request_ready),
    .memory_request_write_o(device_request_write),
    .memory_request_address_o(device_request_address),
    .memory_request_data_o(device_request_data),
    .memory_request_mask_o(device_request_mask),
    .memory_request_id_o(device_request_id),
    .memory_response_valid_i(device_response_valid),
    .memory_response_id_i(device_response_id),
    .memory_response_beat_i(device_response_beat),
    .memory_response_data_i(device_response_data),
    .import_request_valid_o(import_request_valid),
    .import_request_kind_o(import_request_kind),
    .import_request_unit_o(import_request_unit),
    .import_request_ready_i(import_request_ready),
    .import_beat_valid_i(import_beat_valid),
    .import_beat_data_i(import_beat_data),
    .export_valid_o(export_valid),
    .export_ready_i(export_ready),
    .export_data_o(export_data),
    .export_last_o(export_last),
    .export_unit_o(export_unit),
    .frame_valid_o(unit_frame_valid),
    .frame_ready_i(unit_frame_ready),
    .frame_pixel_o(unit_frame_pixel),
    .frame_color_o(unit_frame_color),
    .frame_unit_o(unit_frame_unit),
    .fault_valid_o(fault_valid_o),
    .fault_code_o(fault_code_o),
    .fault_warp_o(fault_warp_o),
    .fault_pc_o(fault_pc_o),
    .fault_unit_o(fault_unit_o),
    .counter_unit_i(counter_unit_i),
    .counter_select_i(counter_select_i),
    .counter_o(counter_o),
    .retire_valid_o(retire_valid),
    .retire_pc_o(retire_pc),
    .retire_instruction_o(retire_instruction),
    .retire_mask_o(retire_mask),
    .retire_data_o(retire_data),
    .retire_predicate_o(retire_predicate),
    .store_trace_valid_o(store_trace_valid),
    .store_trace_warp_o(store_trace_warp),
    .store_trace_address_o(store_trace_address),
    .store_trace_data_o(store_trace_data),
    .store_trace_mask_o(store_trace_mask),
    .ray_trace_valid_o(ray_trace_valid),
    .ray_trace_warp_o(ray_trace_warp),
    .ray_trace_word_o(ray_trace_word),
    .ray_trace_mask_o(ray_trace_mask),
    .ray_trace_data_o(ray_trace_data)
  );

  rp_controller #(
    .UNITS(UNITS), .CONTENTS(WARPS * LANES), .RAY_POOL_SIZE(RAY_POOL_SIZE),
    .INTERSECTION_POOL_SIZE(INTERSECTION_POOL_SIZE), .HELD_LIMIT(HELD_LIMIT), .WINDOW_REMEDY(WINDOW_REMEDY),
    .LAUNCH_AHEAD(LAUNCH_AHEAD), .POLICY(POLICY), .RAY_THRESHOLD(THRESHOLDS_RAYS),
    .INTERSECTION_THRESHOLD(THRESHOLDS_INTERSECTIONS), .BATCH(STATIC_TRAVERSER_BATCH), .TRAVERSER_SHADES(SHADING),
    .CULLING(CULLING), .TILE_ORDER(TILE_ORDER), .KINDS(KINDS), .RAY_BITS(RAY_BITS), .LEVEL_BITS(LEVEL_BITS)
  ) controller (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i(starts),
    .width_i(width_i),
    .height_i(height_i),
    .reflections_i(reflections_i),
    .eye_pc_i(eye_pc_i),
    .secondary_pc_i(secondary_pc_i),
    .direct_pc_i(direct_pc_i),
    .shade_pc_i(shade_pc_i),
    .busy_o(busy_o),
    .launch_valid_o(launch_valid),
    .launch_ready_i(launch_ready),
    .launch_unit_i(launch_unit),
    .launch_pc_o(launch_pc),
    .launch_threads_o(launch_threads),
    .launch_block_o(launch_block),
    .launch_import_o(launch_import),
    .kernel_done_i(kernel_done),
    .exports_i(exports),
    .rays_i(rays),
    .shadow_rays_i(shadow_rays),
    .outcome_valid_i(outcome_valid),
    .outcome_shadow_i(outcome_shadow),
    .outcome_unit_i(outcome_unit),
    .exported_valid_i(exported_valid),
    .exported_unit_i(exported_unit),
    .size_i(size),
    .available_i(available),
    .reserve_valid_o(reserve_valid),
    .reserve_kind_o(reserve_kind),
    .reserve_count_o(reserve_count)
  );

  rp_ray_pool #(
    .SIZE(RAY_POOL_SIZE), .OVERHEAD(RAY_POOL_OVERHEAD), .CYCLES_PER_BEAT(RAY_POOL_CYCLES_PER_BEAT),
    .PIPELINED(RAY_POOL_PIPELINED), .CULLING(CULLING), .PLACE_BITS(PLACE_BITS), .LEVEL_BITS(RAY_BITS)
  ) ray_pool (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .depth_limit_i(depth_limit_i),
    .export_valid_i(export_valid),
    .export_ready_o(export_ready),
    .export_data_i(export_data),
    .export_last_i(export_last),
    .export_unit_i(export_unit),
    .outcome_valid_o(outcome_valid),
    .outcome_kept_o(outcome_kept),
    .outcome_deep_o(outcome_deep),
    .outcome_shadow_o(outcome_shadow),
    .outcome_eye_o(outcome_eye),
    .outcome_unit_o(outcome_unit),
    .outcome_pixel_o(outcome_pixel),
    .rays_o(rays),
    .shadow_rays_o(shadow_rays),
    .held_up_o(ray_held_up),
    .ray_valid_o(ray_valid),
    .ray_ready_i(ray_ready),
    .ray_data_o(ray_data),
    .ray_last_o(ray_last),
    .ray_place_o(ray_place),
    .free_valid_i(free_valid),
    .free_place_i(free_place),
    .free_shadow_i(free_shadow),
    .taken_o(rays_taken_o),
    .busy_cycles_o(ray_port_busy_o)
  );

  rp_intersection_pool #(
    .SIZE(INTERSECTION_POOL_SIZE), .INTERSECTION_WORDS(INTERSECTION_WORDS), .OVERHEAD(INTERSECTION_POOL_OVERHEAD),
    .CYCLES_PER_BEAT(INTERSECTION_POOL_CYCLES_PER_BEAT), .PIPELINED(INTERSECTION_POOL_PIPELINED), .CULLING(CULLING),
    .SHADOWS(1 - SHADING), .KINDS(KINDS), .LEVEL_BITS(LEVEL_BITS)
  ) intersection_pool (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .put_valid_i(put_valid),
    .put_ready_o(put_ready),
    .put_kind_i(put_kind),
    .put_data_i(put_data),
    .request_valid_i(import_request_valid),
    .request_ready_o(import_request_ready),
    .request_kind_i(import_request_kind),
    .request_unit_i(import_request_unit),
    .beat_valid_o(import_beat_valid),
    .beat_data_o(import_beat_data),
    .pixel_valid_o(pixel_valid),
    .pixel_unit_o(pixel_unit),
    .size_o(size),
    .available_o(available),
    .reserve_valid_i(reserve_valid),
    .reserve_kind_i(reserve_kind),
    .reserve_count_i(reserve_count),
    .taken_o(packages_taken_o)
  );

  rp_memory_port #(
    .QUEUE(MEMORY_QUEUE), .TRAVERSER_QUEUE(TRAVERSER_QUEUE), .CYCLES_PER_BEAT(MEMORY_CYCLES_PER_BEAT),
    .LATENCY(MEMORY_LATENCY)
  ) memory_port (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .device_request_valid_i(device_request_valid),
    .device_request_ready_o(device_request_ready),
    .device_request_write_i(device_request_write),
    .device_request_address_i(device_request_address),
    .device_request_data_i(device_request_data),
    .device_request_mask_i(device_request_mask),
    .device_request_id_i(device_request_id),
    .device_response_valid_o(device_response_valid),
    .device_response_id_o(device_response_id),
    .device_response_beat_o(device_response_beat),
    .device_response_data_o(device_response_data),
    .traverser_request_valid_i(tree_request_valid),
    .traverser_request_ready_o(tree_request_ready),
    .traverser_request_write_i(tree_request_write),
    .traverser_request_second_i(tree_request_second),
    .traverser_request_address_i(tree_request_address),
    .traverser_request_data_i(tree_request_data),
    .traverser_response_valid_o(tree_response_valid),
    .traverser_response_beat_o(tree_response_beat),
    .traverser_response_data_o(tree_response_data),
    .memory_request_valid_o(memory_request_valid_o),
    .memory_request_ready_i(memory_request_ready_i),
    .memory_request_traverser_o(memory_request_traverser_o),
    .memory_request_write_o(memory_request_write_o),
    .memory_request_address_o(memory_request_address_o),
    .memory_request_data_o(memory_request_data_o),
    .memory_request_mask_o(memory_request_mask_o),
    .memory_beat_valid_i(memory_beat_valid_i),
    .memory_beat_ready_o(memory_beat_ready_o),
    .memory_beat_data_i(memory_beat_data_i),
    .quiet_o(quiet),
    .idle_o(memory_idle),
    .reads_o(memory_reads_o),
    .writes_o(memory_writes_o),
    .busy_cycles_o(memory_port_busy_o)
  );

  rp_frame_port frame_port (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .unit_valid_i(unit_frame_valid),
    .unit_ready_o(unit_frame_ready),
    .unit_pixel_i(unit_frame_pixel),
    .unit_color_i(unit_frame_color),
    .unit_number_i(unit_frame_unit),
    .traverser_valid_i(contribution_valid),
    .traverser_ready_o(contribution_ready),
    .traverser_pixel_i(contribution_pixel),
    .traverser_color_i(contribution_color),
    .frame_valid_o(frame_valid_o),
    .frame_ready_i(frame_ready_i),
    .frame_pixel_o(frame_pixel_o),
    .frame_color_o(frame_color_o),
    .exported_valid_o(exported_valid),
    .exported_unit_o(exported_unit),
    .exported_pixel_o(exported_pixel),
    .taken_o(contributions_o)
  );
endmodule
`default_nettype wire
