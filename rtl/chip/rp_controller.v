// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The controller: cuts a picture into tiles, and launches on the units what the policy proposes, as far as it is safe.
// docs/machine/controller.md and deadlock.md.
// What it sees of a cycle, levels and events, is counted in the next one; rules and launch take one each, the policy
// two: so a launch is made five cycles after what it was decided on, and until it is counted nothing else is decided.
// Promises: a kernel imports only what has been reserved for it; the two rules of deadlock.md; every tile is cast once;
// no output depends on an input of the same cycle but that a tile is taken with its launch.
// Must be given: levels of pools as rtl/chip/rp_ray_pool.v and rtl/chip/rp_intersection_pool.v have them; a unit that
// is ready stays ready until it is given a kernel; a ray leaves the ray pool when what it becomes is in the
// intersection pool, or later; a picture of 1 pixel or more each way; start_i only while busy_o is low.
`default_nettype none
module rp_controller #(
  parameter integer UNITS = 1,
  parameter integer CONTENTS = 64,                 // threads of a full kernel
  parameter integer RAY_POOL_SIZE = 512,
  parameter integer INTERSECTION_POOL_SIZE = 512,  // of each kind
  parameter integer HELD_LIMIT = 512,
  parameter integer WINDOW_REMEDY = 1,
  parameter integer LAUNCH_AHEAD = 1,
  parameter integer POLICY = 0,                    // 0: thesis, 1: fill
  parameter integer RAY_THRESHOLD = 48,
  parameter integer INTERSECTION_THRESHOLD = 8,
  parameter integer BATCH = 64,
  parameter integer TRAVERSER_SHADES = 0,
  parameter integer CULLING = 0,
  parameter integer TILE_ORDER = 0,                // 0: rows, 1: along a Hilbert curve
  parameter integer EXPORT_BITS = 16,              // of a unit's count of exports, as in rp_launch_records.v
  parameter integer KINDS = 2 + CULLING,
  parameter integer RAY_BITS = $clog2(RAY_POOL_SIZE + 1),
  parameter integer LEVEL_BITS = $clog2(INTERSECTION_POOL_SIZE + 1)
) (
  input  wire                        clk_i,
  input  wire                        rst_ni,
  // from the host: a frame begins; the rest as it is while one is drawn
  input  wire                        start_i,
  input  wire [15:0]                 width_i,
  input  wire [15:0]                 height_i,
  input  wire                        reflections_i,         // normal intersections are for the kernel that reflects
  input  wire [15:0]                 eye_pc_i,
  input  wire [15:0]                 secondary_pc_i,        // of the kernel that reflects
  input  wire [15:0]                 direct_pc_i,           // of the one that does not
  input  wire [15:0]                 shade_pc_i,
  output reg                         busy_o,                // a frame is being drawn
  // to the units
  output reg                         launch_valid_o,
  input  wire                        launch_ready_i,
  input  wire [1:0]                  launch_unit_i,
  output reg  [15:0]                 launch_pc_o,
  output reg  [10:0]                 launch_threads_o,
  output wire [31:0]                 launch_block_o,
  output reg  [1:0]                  launch_import_o,
  input  wire [UNITS-1:0]            kernel_done_i,
  input  wire [UNITS*EXPORT_BITS-1:0] exports_i,
  // from the ray pool: levels, and what has become of a ray
  input  wire [RAY_BITS-1:0]         rays_i,
  input  wire [RAY_BITS-1:0]         shadow_rays_i,
  input  wire                        outcome_valid_i,
  input  wire                        outcome_shadow_i,
  input  wire [1:0]                  outcome_unit_i,
  // from the frame port: a contribution of a unit has been taken
  input  wire                        exported_valid_i,
  input  wire [1:0]                  exported_unit_i,
  // the intersection pool's levels
  input  wire [KINDS*LEVEL_BITS-1:0] size_i,
  input  wire [KINDS*LEVEL_BITS-1:0] available_i,
  output reg                         reserve_valid_o,
  output reg  [1:0]                  reserve_kind_o,
  output reg  [LEVEL_BITS-1:0]       reserve_count_o
);
  generate
    if (UNITS != 1 && UNITS != 2 && UNITS != 4) begin : gen_bad_units
      controller_UNITS_must_be_1_2_or_4 illegal ();
    end
    if (HELD_LIMIT > INTERSECTION_POOL_SIZE) begin : gen_bad_limit
      controller_HELD_LIMIT_must_be_INTERSECTION_POOL_SIZE_at_most illegal ();
    end
    if (POLICY < 0 || POLICY > 1) begin : gen_bad_policy
      controller_POLICY_must_be_0_or_1 illegal ();
    end
  endgenerate
  localparam [1:0] HALT = 2'd0, EYE = 2'd1, SECONDARY = 2'd2, SHADE = 2'd3;
  localparam [1:0] NORMAL = 2'd1, SHADOW = 2'd2, DIRECT = 2'd3;
  localparam integer RECORDS = 4;                             // of a unit, in launch_records
  localparam integer THREAD_BITS = $clog2(CONTENTS + 1);
  localparam integer RECORD_BITS = $clog2(RECORDS * CONTENTS + 1);
  localparam integer KERNEL_BITS = $clog2(RECORDS * UNITS + 1) + 1;
  // Of whatever is counted, and of their sums.
  localparam integer MOST = RAY_POOL_SIZE + KINDS * INTERSECTION_POOL_SIZE + UNITS * RECORDS * (2 * CONTENTS + BATCH);
  localparam integer COUNT_BITS = $clog2(MOST + 1) + 2;
  localparam [COUNT_BITS-1:0] NONE = {COUNT_BITS{1'b0}};
  localparam integer TILE_LOG2 = ($clog2(CONTENTS) + 1) / 2;  // its width's
  localparam integer TILE_HEIGHT = ((CONTENTS < HELD_LIMIT) ? CONTENTS : HELD_LIMIT) >> TILE_LOG2;
  localparam integer TILE_THREADS = TILE_HEIGHT << TILE_LOG2;

  // ---- Launches: offered until a unit takes it, with its tile, if it is of eye rays.
  reg [1:0] kind_q;                       // of the one that is offered
  reg [THREAD_BITS-1:0] normal_q, shadow_q;   // rays that it may export
  reg [COUNT_BITS-1:0] held_then_q;       // when it was decided
  wire accepted = launch_valid_o && launch_ready_i;
  wire cast = accepted && kind_q == EYE;

  // ---- What is seen of a cycle c is registered in c+1, as events of rays are by the blocks that report them.
  reg ready_1_q, ready_2_q;
  reg [UNITS-1:0] done_q;
  reg [UNITS*EXPORT_BITS-1:0] exports_q;
  always @(posedge clk_i) begin
    done_q <= rst_ni ? kernel_done_i : {UNITS{1'b0}};
    exports_q <= exports_i;
    {ready_2_q, ready_1_q} <= {ready_1_q, rst_ni && launch_ready_i};
  end

  // ---- It is counted.
  wire [UNITS-1:0] full, empty;
  wire [UNITS*RECORD_BITS-1:0] normal_to_come, shadow_to_come;
  reg [UNITS*3-1:0] kernels_q;            // of each unit: launched, and not ended
  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      localparam [1:0] UNIT = u;
      wire launched = accepted && launch_unit_i == UNIT;
      rp_launch_records #(.CONTENTS(CONTENTS), .EXPORT_BITS(EXPORT_BITS)) launch_records (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .launch_valid_i(launched),
        .launch_normal_i(normal_q),
        .launch_shadow_i(shadow_q),
        .ray_valid_i(outcome_valid_i && outcome_unit_i == UNIT),
        .ray_shadow_i(outcome_shadow_i),
        .contribution_valid_i(exported_valid_i && exported_unit_i == UNIT),
        .ended_valid_i(done_q[u]),
        .ended_exports_i(exports_q[u*EXPORT_BITS +: EXPORT_BITS]),
        .full_o(full[u]),
        .empty_o(empty[u]),
        .normal_o(normal_to_come[u*RECORD_BITS +: RECORD_BITS]),
        .shadow_o(shadow_to_come[u*RECORD_BITS +: RECORD_BITS])
      );
      always @(posedge clk_i)
        if (!rst_ni) kernels_q[u*3 +: 3] <= 3'd0;
        else kernels_q[u*3 +: 3] <= kernels_q[u*3 +: 3] + {2'd0, launched} - {2'd0, done_q[u]};
    end
  endgenerate
  reg [RAY_BITS-1:0] rays_q, shadow_rays_q;
  reg [KINDS*LEVEL_BITS-1:0] size_q, available_q;
  always @(posedge clk_i) begin
    rays_q <= rays_i;
    shadow_rays_q <= shadow_rays_i;
    size_q <= size_i;
    available_q <= available_i;
  end

  // ---- Tiles
  wire tiles_left, tile_valid;
  wire [THREAD_BITS-1:0] tile_pixels;
  wire unused_last;
  rp_tile_walk #(.CONTENTS(CONTENTS), .HELD_LIMIT(HELD_LIMIT), .TILE_ORDER(TILE_ORDER)) tile_walk (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i(start_i),
    .width_i(width_i),
    .height_i(height_i),
    .busy_o(tiles_left),
    .tile_valid_o(tile_valid),
    .tile_ready_i(cast),
    .tile_block_o(launch_block_o),
    .tile_pixels_o(tile_pixels),
    .tile_last_o(unused_last)
  );

  // ---- Sums and rules
  wire take_direct;
  wire [COUNT_BITS-1:0] size_normal, size_shadow, size_direct, normal, shadow, direct;
  generate
    if (CULLING != 0) begin : gen_direct
      assign size_direct = {{COUNT_BITS-LEVEL_BITS{1'b0}}, size_q[2*LEVEL_BITS +: LEVEL_BITS]};
      assign direct = {{COUNT_BITS-LEVEL_BITS{1'b0}}, available_q[2*LEVEL_BITS +: LEVEL_BITS]};
      assign take_direct = direct > normal;
    end else begin : gen_no_direct
      assign size_direct = NONE;
      assign direct = NONE;
      assign take_direct = 1'b0;
    end
  endgenerate
  assign size_normal = {{COUNT_BITS-LEVEL_BITS{1'b0}}, size_q[0 +: LEVEL_BITS]};
  assign size_shadow = {{COUNT_BITS-LEVEL_BITS{1'b0}}, size_q[LEVEL_BITS +: LEVEL_BITS]};
  assign normal = {{COUNT_BITS-LEVEL_BITS{1'b0}}, available_q[0 +: LEVEL_BITS]};
  assign shadow = {{COUNT_BITS-LEVEL_BITS{1'b0}}, available_q[LEVEL_BITS +: LEVEL_BITS]};
  wire [COUNT_BITS-1:0] rays = {{COUNT_BITS-RAY_BITS{1'b0}}, rays_q};
  wire [COUNT_BITS-1:0] shadow_rays = {{COUNT_BITS-RAY_BITS{1'b0}}, shadow_rays_q};
  reg [COUNT_BITS-1:0] normal_low, normal_high, shadow_low, shadow_high;   // of two and two units: sums take long
  reg [KERNEL_BITS-1:0] kernels;
  reg ahead;
  integer i;
  always @* begin
    {normal_low, normal_high, shadow_low, shadow_high} = {4{NONE}};
    kernels = {KERNEL_BITS{1'b0}};
    ahead = 1'b1;                         // the unit that takes the launch runs a kernel: each of them does
    for (i = 0; i < UNITS; i = i + 1) begin
      if (i < 2) begin
        normal_low = normal_low + {{COUNT_BITS-RECORD_BITS{1'b0}}, normal_to_come[i*RECORD_BITS +: RECORD_BITS]};
        shadow_low = shadow_low + {{COUNT_BITS-RECORD_BITS{1'b0}}, shadow_to_come[i*RECORD_BITS +: RECORD_BITS]};
      end else begin
        normal_high = normal_high + {{COUNT_BITS-RECORD_BITS{1'b0}}, normal_to_come[i*RECORD_BITS +: RECORD_BITS]};
        shadow_high = shadow_high + {{COUNT_BITS-RECORD_BITS{1'b0}}, shadow_to_come[i*RECORD_BITS +: RECORD_BITS]};
      end
      kernels = kernels + {{KERNEL_BITS-3{1'b0}}, kernels_q[i*3 +: 3]};
      if (kernels_q[i*3 +: 3] == 3'd0) ahead = 1'b0;
    end
  end
  wire [COUNT_BITS-1:0] all_normal = normal_low + normal_high;
  wire [COUNT_BITS-1:0] all_shadow = shadow_low + shadow_high;
  // Ways of light that are under way: a pixel has one at most.
  wire [COUNT_BITS-1:0] held = rays - shadow_rays + normal + direct + all_normal;
  wire eye_possible;
  wire [COUNT_BITS-1:0] secondary_room;
  rp_launch_rules #(
    .CONTENTS(CONTENTS), .UNITS(UNITS), .RAY_POOL_SIZE(RAY_POOL_SIZE), .INTERSECTION_POOL_SIZE(INTERSECTION_POOL_SIZE),
    .HELD_LIMIT(HELD_LIMIT), .WINDOW_REMEDY(WINDOW_REMEDY), .TRAVERSER_SHADES(TRAVERSER_SHADES),
    .COUNT_BITS(COUNT_BITS)
  ) launch_rules (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .tile_left_i(tile_valid),
    .tile_pixels_i({{COUNT_BITS-THREAD_BITS{1'b0}}, tile_pixels}),
    .cast_i(cast),
    .cast_held_i(held_then_q),
    .held_i(held),
    .shadow_rays_i(shadow_rays),
    .shadow_to_come_i(all_shadow),
    .shadow_i(shadow),
    .eye_possible_o(eye_possible),
    .secondary_room_o(secondary_room)
  );

  // ---- What the policy sees
  reg [COUNT_BITS-1:0] view_rays_q, view_normal_q, view_shadow_q, view_room_q, view_to_come_q, view_promised_q;
  reg [COUNT_BITS-1:0] view_held_q;
  reg [KERNEL_BITS-1:0] view_kernels_q;
  reg [THREAD_BITS-1:0] view_pixels_q;
  reg view_direct_q, view_eye_q, view_more_q, view_ahead_q, view_launch_q, view_done_q;
  wire [COUNT_BITS-1:0] size = size_normal + size_shadow + size_direct;
  wire any_rays = rays != NONE;
  wire [COUNT_BITS-1:0] to_come = all_normal + all_shadow;
  always @(posedge clk_i) begin
    view_rays_q <= rays;
    view_normal_q <= take_direct ? direct : normal;
    view_direct_q <= take_direct;
    view_shadow_q <= shadow;
    view_room_q <= secondary_room;
    view_to_come_q <= to_come;
    view_promised_q <= size - normal - shadow - direct;
    view_held_q <= held;
    view_kernels_q <= kernels;
    view_pixels_q <= tile_pixels;
    view_eye_q <= eye_possible;
    view_more_q <= any_rays || to_come != NONE;
    view_ahead_q <= ahead;
    view_launch_q <= ready_2_q && full == {UNITS{1'b0}} && !(ahead && LAUNCH_AHEAD == 0);
    view_done_q <= !tiles_left && !any_rays && size == NONE && kernels == {KERNEL_BITS{1'b0}} && &empty;
  end

  // ---- The policy, and what else a launch is made of, as it stood when the policy saw it
  reg [COUNT_BITS-1:0] held_q;
  reg [THREAD_BITS-1:0] pixels_q;
  reg direct_q, may_launch_q, all_done_q;
  always @(posedge clk_i) begin
    held_q <= view_held_q;
    pixels_q <= view_pixels_q;
    direct_q <= view_direct_q;
    may_launch_q <= view_launch_q;
    all_done_q <= view_done_q;
  end
  wire [1:0] kind;
  wire [THREAD_BITS-1:0] threads;
  generate
    if (POLICY == 0) begin : gen_thesis
      wire unused = &{1'b0, view_to_come_q, view_promised_q, view_kernels_q};
      rp_thesis_policy #(
        .CONTENTS(CONTENTS), .UNITS(UNITS), .RAY_POOL_SIZE(RAY_POOL_SIZE),
        .INTERSECTION_POOL_SIZE(INTERSECTION_POOL_SIZE), .RAY_THRESHOLD(RAY_THRESHOLD),
        .INTERSECTION_THRESHOLD(INTERSECTION_THRESHOLD), .COUNT_BITS(COUNT_BITS)
      ) policy (
        .clk_i(clk_i),
        .rays_i(view_rays_q),
        .normal_i(view_normal_q),
        .shadow_i(view_shadow_q),
        .secondary_room_i(view_room_q),
        .eye_possible_i(view_eye_q),
        .more_to_come_i(view_more_q),
        .ahead_i(view_ahead_q),
        .kind_o(kind),
        .threads_o(threads)
      );
    end else begin : gen_fill
      rp_fill_policy #(
        .CONTENTS(CONTENTS), .UNITS(UNITS), .RAY_POOL_SIZE(RAY_POOL_SIZE),
        .INTERSECTION_POOL_SIZE(INTERSECTION_POOL_SIZE), .BATCH(BATCH), .COUNT_BITS(COUNT_BITS),
        .KERNEL_BITS(KERNEL_BITS)
      ) policy (
        .clk_i(clk_i),
        .rays_i(view_rays_q),
        .normal_i(view_normal_q),
        .shadow_i(view_shadow_q),
        .secondary_room_i(view_room_q),
        .rays_to_come_i(view_to_come_q),
        .promised_i(view_promised_q),
        .kernels_i(view_kernels_q),
        .two_rays_i(reflections_i),
        .eye_possible_i(view_eye_q),
        .more_to_come_i(view_more_q),
        .ahead_i(view_ahead_q),
        .kind_o(kind),
        .threads_o(threads)
      );
    end
  endgenerate

  // ---- The launch. The first cycle that is decided on after one is that behind the one in which it is taken.
  reg [2:0] hold_q;
  wire may_decide = busy_o && hold_q == 3'd0;
  wire decided = may_decide && may_launch_q && !all_done_q && kind != HALT;
  wire reflects = reflections_i && !direct_q;
  wire [THREAD_BITS+LEVEL_BITS-1:0] threads_reserved = {{LEVEL_BITS{1'b0}}, threads};
  wire [THREAD_BITS+10:0] threads_launched = {11'd0, threads};
  wire unused_threads = &{1'b0, threads_reserved[LEVEL_BITS +: THREAD_BITS], threads_launched[11 +: THREAD_BITS]};
  wire makes_normal = kind == EYE || (kind == SECONDARY && reflects);
  always @(posedge clk_i) begin
    if (!rst_ni) begin
      busy_o <= 1'b0;
      launch_valid_o <= 1'b0;
      reserve_valid_o <= 1'b0;
      hold_q <= 3'd0;
    end else begin
      if (start_i) busy_o <= 1'b1;
      else if (may_decide && all_done_q) busy_o <= 1'b0;
      launch_valid_o <= decided || (launch_valid_o && !launch_ready_i);
      reserve_valid_o <= decided && kind != EYE;
      // The cycle in which a frame begins is the first one that is decided on.
      if (start_i) hold_q <= 3'd3;
      else if (decided || (launch_valid_o && !launch_ready_i)) hold_q <= 3'd5;
      else if (hold_q != 3'd0) hold_q <= hold_q - 3'd1;
    end
    // What is offered, if anything is: it stays as it is while it waits, and `decided` comes late.
    if (may_decide) begin
      kind_q <= kind;
      held_then_q <= held_q;
      launch_threads_o <= (kind == EYE) ? TILE_THREADS[10:0] : threads_launched[10:0];
      launch_import_o <= (kind == EYE) ? 2'd0 : (kind == SHADE) ? SHADOW : direct_q ? DIRECT : NORMAL;
      launch_pc_o <= (kind == EYE) ? eye_pc_i : (kind == SHADE) ? shade_pc_i : reflects ? secondary_pc_i : direct_pc_i;
      reserve_kind_o <= (kind == SHADE) ? SHADOW : direct_q ? DIRECT : NORMAL;
      reserve_count_o <= threads_reserved[LEVEL_BITS-1:0];
      normal_q <= !makes_normal ? {THREAD_BITS{1'b0}} : (kind == EYE) ? pixels_q : threads;
      shadow_q <= (kind == SECONDARY) ? threads : {THREAD_BITS{1'b0}};
    end
  end
endmodule
`default_nettype wire
