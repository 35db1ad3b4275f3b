// The policy of the thesis (its figure 5.3): which kernel a unit that can take one gets. docs/chip.md, section 3.
// Promises: threads of a kernel are at most CONTENTS and what there is of its intersections, for a secondary kernel
// secondary_room_i too, and at least one; eye rays are cast only if a tile may be.
`default_nettype none
module thesis_policy #(
  parameter integer CONTENTS = 64,                 // threads of a full kernel
  parameter integer UNITS = 1,
  parameter integer RAY_POOL_SIZE = 512,
  parameter integer INTERSECTION_POOL_SIZE = 512,  // of each kind
  parameter integer RAY_THRESHOLD = 48,            // for 64 contents and one unit
  parameter integer INTERSECTION_THRESHOLD = 8,    // for 64 contents
  parameter integer COUNT_BITS = 24,
  parameter integer THREAD_BITS = $clog2(CONTENTS + 1)
) (
  input  wire [COUNT_BITS-1:0]  rays_i,            // in the ray pool
  input  wire [COUNT_BITS-1:0]  normal_i,          // intersections that no kernel has been promised
  input  wire [COUNT_BITS-1:0]  shadow_i,
  input  wire [COUNT_BITS-1:0]  secondary_room_i,  // most threads of a secondary kernel that are safe
  input  wire                   eye_possible_i,    // a tile may be cast
  input  wire                   more_to_come_i,    // rays in the pool or in the units
  input  wire                   ahead_i,           // the unit still runs a kernel
  output reg  [1:0]             kind_o,            // 0: halt, 1: cast eye rays, 2: secondary, 3: shade
  output wire [THREAD_BITS-1:0] threads_o          // 0 of eye rays, whose tile decides
);
  `include "policy_functions.vh"
  localparam integer SCALE = larger(1, CONTENTS / 64);
  // Above it the traverser is behind: make no more rays.
  localparam integer RAYS = smaller(RAY_THRESHOLD * SCALE * UNITS, RAY_POOL_SIZE * 3 / 4);
  // Above it there is work for a kernel that consumes.
  localparam integer INTERSECTIONS =
    smaller(INTERSECTION_THRESHOLD * SCALE, smaller(CONTENTS - 1, INTERSECTION_POOL_SIZE - 1));

  wire [COUNT_BITS-1:0] shade = least(CONTENTS[COUNT_BITS-1:0], shadow_i);
  wire [COUNT_BITS-1:0] load = least(CONTENTS[COUNT_BITS-1:0], normal_i);
  wire [COUNT_BITS-1:0] secondary = least(load, secondary_room_i);
  wire any_shadow = shadow_i != {COUNT_BITS{1'b0}};
  wire more_normal = shadow_i < normal_i;
  wire behind = rays_i > RAYS[COUNT_BITS-1:0];
  wire work = {1'b0, normal_i} + {1'b0, shadow_i} > INTERSECTIONS[COUNT_BITS:0];

  // Shade instead where a full secondary kernel would not be safe, so that room comes back; in the tail, where nothing
  // comes by itself, one that is not full will do.
  reg [1:0] wanted;
  always @* begin
    wanted = HALT;
    if (behind) begin
      if (any_shadow) wanted = SHADE;
    end else if (work) begin
      if (more_normal && secondary_room_i >= load) wanted = SECONDARY;
      else if (any_shadow) wanted = SHADE;
    end else if (eye_possible_i) wanted = EYE;
    else if (!more_to_come_i) begin
      if (more_normal && secondary != {COUNT_BITS{1'b0}}) wanted = SECONDARY;
      else if (any_shadow) wanted = SHADE;
    end
  end

  wire [COUNT_BITS-1:0] threads = (wanted == SECONDARY) ? secondary : (wanted == SHADE) ? shade : {COUNT_BITS{1'b0}};
  // A kernel is launched ahead only to import a full load: any other decision is better made when the unit is free.
  wire waits = ahead_i && threads != CONTENTS[COUNT_BITS-1:0];
  assign threads_o = waits ? {THREAD_BITS{1'b0}} : threads[THREAD_BITS-1:0];
  always @* kind_o = waits ? HALT : wanted;
endmodule
`default_nettype wire
