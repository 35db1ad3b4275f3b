// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The two rules that keep the chip from locking up, whatever a policy proposes (docs/machine/deadlock.md), and
// the rounds of tiles without the remedy of the window effect.
`default_nettype none
module rp_launch_rules #(
  parameter integer CONTENTS = 64,                 // threads of a full kernel
  parameter integer UNITS = 1,
  parameter integer RAY_POOL_SIZE = 512,
  parameter integer INTERSECTION_POOL_SIZE = 512,  // of each kind
  parameter integer HELD_LIMIT = 512,              // pixels, at most INTERSECTION_POOL_SIZE
  parameter integer WINDOW_REMEDY = 1,             // tiles are cast while pixels are held
  parameter integer TRAVERSER_SHADES = 0,          // no shadow ray ever waits for room
  parameter integer COUNT_BITS = 24,
  parameter integer ROUND_BITS = $clog2(UNITS + 1)
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire                  tile_left_i,        // one is still to be cast
  input  wire [COUNT_BITS-1:0] tile_pixels_i,      // of the next one, inside the picture
  input  wire                  cast_i,             // it is cast
  input  wire [COUNT_BITS-1:0] cast_held_i,        // pixels that were held when that was decided
  input  wire [COUNT_BITS-1:0] held_i,             // pixels that are being worked on
  input  wire [COUNT_BITS-1:0] shadow_rays_i,      // in the ray pool
  input  wire [COUNT_BITS-1:0] shadow_to_come_i,   // most that kernels may still export
  input  wire [COUNT_BITS-1:0] shadow_i,           // intersections that no kernel has been promised
  output wire                  eye_possible_o,
  output wire [COUNT_BITS-1:0] secondary_room_o    // most threads of a secondary kernel
);
  localparam integer LIMIT = INTERSECTION_POOL_SIZE + RAY_POOL_SIZE - 1;
  localparam [COUNT_BITS-1:0] NONE = {COUNT_BITS{1'b0}};
  localparam [ROUND_BITS-1:0] NO_TILE = {ROUND_BITS{1'b0}};

  // ---- Eye rays. A round of as many tiles as units begins when no pixel is held.
  reg [ROUND_BITS-1:0] round_q;                    // tiles left in it
  wire idle = held_i == NONE;
  wire in_round = WINDOW_REMEDY != 0 || idle || round_q != NO_TILE;
  wire [COUNT_BITS-1:0] held_then = held_i + tile_pixels_i;
  assign eye_possible_o = tile_left_i && in_round && held_then <= HELD_LIMIT[COUNT_BITS-1:0];
  always @(posedge clk_i)
    if (!rst_ni) round_q <= NO_TILE;
    else if (cast_i) round_q <= (cast_held_i == NONE ? UNITS[ROUND_BITS-1:0] : round_q) - 1'b1;

  // ---- Secondary rays.
  wire [COUNT_BITS-1:0] shadows = shadow_rays_i + shadow_to_come_i + shadow_i;
  wire room = shadows < LIMIT[COUNT_BITS-1:0];
  assign secondary_room_o = (TRAVERSER_SHADES != 0) ? CONTENTS[COUNT_BITS-1:0]
                            : room ? LIMIT[COUNT_BITS-1:0] - shadows : NONE;
endmodule
`default_nettype wire
