// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The policy of the thesis (its figure 5.3): which kernel a unit that can take one gets. docs/machine/controller.md.
// What is seen in a cycle is decided in the next one. Promises: threads of a kernel are at most CONTENTS and what
// there is of its intersections, for a secondary kernel secondary_room_i too, and at least one; eye rays are cast only
// if a tile may be.
`default_nettype none
module rp_thesis_policy #(
  parameter integer CONTENTS = 64,                 // threads of a full kernel
  parameter integer UNITS = 1,
  parameter integer RAY_POOL_SIZE = 512,
  parameter integer INTERSECTION_POOL_SIZE = 512,  // of each kind
  parameter integer RAY_THRESHOLD = 48,            // for 64 contents and one unit
  parameter integer INTERSECTION_THRESHOLD = 8,    // for 64 contents
  parameter integer COUNT_BITS = 24,
  parameter integer THREAD_BITS = $clog2(CONTENTS + 1)
) (
  input  wire                   clk_i,
  input  wire [COUNT_BITS-1:0]  rays_i,            // in the ray pool
  input  wire [COUNT_BITS-1:0]  normal_i,          // intersections that no kernel has been promised
  input  wire [COUNT_BITS-1:0]  shadow_i,
  input  wire [COUNT_BITS-1:0]  secondary_room_i,  // most threads of a secondary kernel that are safe
  input  wire                   eye_possible_i,    // a tile may be cast
  input  wire                   more_to_come_i,    // rays in the pool or in the units
  input  wire                   ahead_i,           // the unit still runs a kernel
  output reg  [1:0]             kind_o,            // 0: halt, 1: cast eye rays, 2: secondary, 3: shade
  output wire [THREAD_BITS-1:0] threads_o          // 0 of eye rays: their tile decides
);
  `include "rp_policy_functions.vh"
  localparam integer SCALE = larger(1, CONTENTS / 64);
  // Above it the traverser is behind: make no more rays.
  localparam integer RAYS = smaller(RAY_THRESHOLD * SCALE * UNITS, RAY_POOL_SIZE * 3 / 4);
  // Above it there is work for a kernel that consumes.
  localparam integer INTERSECTIONS =
    smaller(INTERSECTION_THRESHOLD * SCALE, smaller(CONTENTS - 1, INTERSECTION_POOL_SIZE - 1));

  wire [COUNT_BITS-1:0] load = least(CONTENTS[COUNT_BITS-1:0], normal_i);
  // What is seen, and what follows from it at once.
  reg [COUNT_BITS-1:0] shade_q, secondary_q;
  reg any_shadow_q, more_normal_q, safe_q, behind_q, work_q, eye_possible_q, more_to_come_q, ahead_q;
  always @(posedge clk_i) begin
    shade_q <= least(CONTENTS[COUNT_BITS-1:0], shadow_i);
    secondary_q <= least(load, secondary_room_i);
    any_shadow_q <= shadow_i != {COUNT_BITS{1'b0}};
    more_normal_q <= shadow_i < normal_i;
    safe_q <= secondary_room_i >= load;
    behind_q <= rays_i > RAYS[COUNT_BITS-1:0];
    work_q <= {1'b0, normal_i} + {1'b0, shadow_i} > INTERSECTIONS[COUNT_BITS:0];
    eye_possible_q <= eye_possible_i;
    more_to_come_q <= more_to_come_i;
    ahead_q <= ahead_i;
  end

  // Shade instead where a full secondary kernel would not be safe, so that room comes back; in the tail, where nothing
  // comes by itself, one that is not full will do.
  reg [1:0] wanted;
  always @* begin
    wanted = HALT;
    if (behind_q) begin
      if (any_shadow_q) wanted = SHADE;
    end else if (work_q) begin
      if (more_normal_q && safe_q) wanted = SECONDARY;
      else if (any_shadow_q) wanted = SHADE;
    end else if (eye_possible_q) wanted = EYE;
    else if (!more_to_come_q) begin
      if (more_normal_q && secondary_q != {COUNT_BITS{1'b0}}) wanted = SECONDARY;
      else if (any_shadow_q) wanted = SHADE;
    end
  end

  wire [COUNT_BITS-1:0] threads =
    (wanted == SECONDARY) ? secondary_q : (wanted == SHADE) ? shade_q : {COUNT_BITS{1'b0}};
  // A kernel is launched ahead only to import a full load: any other decision is better made when the unit is free.
  wire waits = ahead_q && threads != CONTENTS[COUNT_BITS-1:0];
  assign threads_o = waits ? {THREAD_BITS{1'b0}} : threads[THREAD_BITS-1:0];
  always @* kind_o = waits ? HALT : wanted;
endmodule
`default_nettype wire
