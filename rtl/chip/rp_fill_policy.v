// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The policy `fill`: full loads, a kernel ready behind the one that runs, and a look at what a kernel will produce and
// at what waits at the ports. docs/machine/controller.md.
// What is seen in a cycle is decided in the next one.
// Promises: as thesis_policy. Must be given: counts below 2^(COUNT_BITS - 2); kernels on record at most 2 x UNITS.
`default_nettype none
module rp_fill_policy #(
  parameter integer CONTENTS = 64,                 // threads of a full kernel
  parameter integer UNITS = 1,
  parameter integer RAY_POOL_SIZE = 512,
  parameter integer INTERSECTION_POOL_SIZE = 512,  // of each kind
  parameter integer BATCH = 64,                    // rays that the traverser takes when a kernel ends
  parameter integer COUNT_BITS = 24,
  parameter integer THREAD_BITS = $clog2(CONTENTS + 1),
  parameter integer KERNEL_BITS = $clog2(2 * UNITS + 1)
) (
  input  wire                   clk_i,
  input  wire [COUNT_BITS-1:0]  rays_i,            // in the ray pool
  input  wire [COUNT_BITS-1:0]  normal_i,          // intersections that no kernel has been promised
  input  wire [COUNT_BITS-1:0]  shadow_i,
  input  wire [COUNT_BITS-1:0]  secondary_room_i,  // most threads of a secondary kernel that are safe
  input  wire [COUNT_BITS-1:0]  rays_to_come_i,    // most that kernels may still export
  input  wire [COUNT_BITS-1:0]  promised_i,        // intersections that wait at their port for kernels launched
  input  wire [KERNEL_BITS-1:0] kernels_i,         // on all units: launched, and not ended
  input  wire                   two_rays_i,        // a thread of a secondary kernel exports two rays, else one
  input  wire                   eye_possible_i,    // a tile may be cast
  input  wire                   more_to_come_i,    // rays in the pool or in the units
  input  wire                   ahead_i,           // the unit still runs a kernel
  output reg  [1:0]             kind_o,            // 0: halt, 1: cast eye rays, 2: secondary, 3: shade
  output wire [THREAD_BITS-1:0] threads_o          // 0 of eye rays: their tile decides
);
  `include "rp_policy_functions.vh"
  // More than one batch of the traverser can seldom be there.
  localparam integer LOAD = smaller(CONTENTS, smaller(INTERSECTION_POOL_SIZE, BATCH));
  // While the traverser is behind, shading is worth it with a quarter of a load: it makes no rays, and its end starts
  // the traverser.
  localparam integer SMALL_LOAD = (LOAD + 3) / 4;
  localparam integer BACKLOG = BATCH * UNITS;
  localparam integer EYE_ROOM = smaller(CONTENTS, RAY_POOL_SIZE);
  localparam [COUNT_BITS-1:0] NONE = {COUNT_BITS{1'b0}};

  // What the ray pool has room for, if every kernel on the units exports as much as it can: each of them takes a batch
  // out when it ends.
  wire [COUNT_BITS-1:0] coming = rays_i + rays_to_come_i;
  wire [COUNT_BITS-1:0] kernels = {{COUNT_BITS - KERNEL_BITS{1'b0}}, kernels_i};
  wire [COUNT_BITS-1:0] capacity = RAY_POOL_SIZE[COUNT_BITS-1:0] + BATCH[COUNT_BITS-1:0] * kernels;
  wire [COUNT_BITS-1:0] room = (coming < capacity) ? capacity - coming : NONE;

  // What is seen, and what follows from it at once.
  reg [COUNT_BITS-1:0] room_q, shade_q, safe_q;
  reg [COUNT_BITS-1:0] makers_q;          // threads of a secondary kernel that have room for their rays
  reg behind_q, eye_possible_q;
  reg waits_q;                            // for a full load
  reg alone_q;                            // nothing will come by itself
  // Its packages would wait behind those at the port: later it will be fuller, and no later in the end.
  wire any_kernel = kernels_i != {KERNEL_BITS{1'b0}};
  wire port_waits = any_kernel && promised_i >= LOAD[COUNT_BITS-1:0];
  always @(posedge clk_i) begin
    room_q <= room;
    makers_q <= two_rays_i ? room >> 1 : room;
    shade_q <= least(CONTENTS[COUNT_BITS-1:0], shadow_i);
    safe_q <= least(least(CONTENTS[COUNT_BITS-1:0], normal_i), secondary_room_i);
    behind_q <= rays_i > BACKLOG[COUNT_BITS-1:0];
    eye_possible_q <= eye_possible_i;
    waits_q <= ahead_i || port_waits;
    alone_q <= !any_kernel && !more_to_come_i;
  end

  // ---- The decision
  wire [COUNT_BITS-1:0] secondary = least(safe_q, makers_q);
  wire secondary_full = secondary >= LOAD[COUNT_BITS-1:0];
  wire shade_full = shade_q >= (behind_q ? SMALL_LOAD[COUNT_BITS-1:0] : LOAD[COUNT_BITS-1:0]);
  wire shade_first = shade_full && (!secondary_full || behind_q || shade_q > secondary);
  wire eye = eye_possible_q && room_q >= EYE_ROOM[COUNT_BITS-1:0];
  // The empty ray pool has to take what is made, however small it is.
  wire tail = alone_q && safe_q != NONE;
  wire part_secondary = secondary != NONE && (shade_q == NONE || (!behind_q && secondary >= shade_q));

  always @* begin
    kind_o = HALT;
    if (shade_first) kind_o = SHADE;
    else if (secondary_full) kind_o = SECONDARY;
    else if (eye) kind_o = EYE;
    else if (!waits_q) begin
      if (part_secondary) kind_o = SECONDARY;
      else if (shade_q != NONE) kind_o = SHADE;
      else if (tail) kind_o = SECONDARY;
    end
  end
  assign threads_o = (kind_o == SHADE) ? shade_q[THREAD_BITS-1:0]
                     : (kind_o != SECONDARY) ? {THREAD_BITS{1'b0}}
                     : (secondary_full || part_secondary) ? secondary[THREAD_BITS-1:0] : safe_q[THREAD_BITS-1:0];
endmodule
`default_nettype wire
