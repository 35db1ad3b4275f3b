// @modules launch_rules
// @proves whatever is proposed, no more than HELD_LIMIT pixels are held
// @proves whatever is proposed, shadow rays, those to come and shadow intersections that are not promised are at most C
//   + P - 1: when the intersections fill their pool, a place of the ray pool is left
// @proves when no pixel is held, a tile that is left may be cast
// @proves without the remedy no more tiles than units are cast from one moment without held pixels to the next
// @parameters WINDOW_REMEDY=0
// @parameters WINDOW_REMEDY=1
// @parameters WINDOW_REMEDY=0 UNITS=1
// @break launch_rules s/RAY_POOL_SIZE - 1;/RAY_POOL_SIZE;/
// @break launch_rules s/ \+ shadow_to_come_i \+ shadow_i/ + shadow_i/
// @break launch_rules s/held_then <= HELD/held_i <= HELD/
// @break launch_rules s/held_then <= HELD/held_then < HELD/
// @break launch_rules s/idle \|\| round_q/round_q/
// @break launch_rules s/\(cast_held_i == NONE \? UNITS\[ROUND_BITS-1:0\] : round_q\)/UNITS[ROUND_BITS-1:0]/
`default_nettype none
module check #(parameter WINDOW_REMEDY = 1, parameter UNITS = 2) (
  input wire clk_i, tile_left, cast, secondary, shade, exported, dropped, traced, input wire [4:0] finished, pixels,
  threads);
  localparam RAYS = 5, INTERSECTIONS = 6, HELD = 6, BITS = 6;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  reg [BITS-1:0] held_q = 0, rays_q = 0, to_come_q = 0, shadow_q = 0;
  wire eye_possible;
  wire [BITS-1:0] room;
  rp_launch_rules #(.CONTENTS(4), .UNITS(UNITS), .RAY_POOL_SIZE(RAYS), .INTERSECTION_POOL_SIZE(INTERSECTIONS),
                 .HELD_LIMIT(HELD), .WINDOW_REMEDY(WINDOW_REMEDY), .COUNT_BITS(BITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .tile_left_i(tile_left), .tile_pixels_i({1'b0, pixels}), .cast_i(cast),
    .cast_held_i(held_q), .held_i(held_q), .shadow_rays_i(rays_q), .shadow_to_come_i(to_come_q), .shadow_i(shadow_q),
    .eye_possible_o(eye_possible), .secondary_room_o(room));

  // The chip around it: one thing of each kind in a cycle.
  reg [3:0] cast_q = 0;         // tiles since no pixel was held
  always @(posedge clk_i) if (rst_n) begin
    held_q <= held_q - finished + (cast ? pixels : 0);
    to_come_q <= to_come_q + (secondary ? threads : 0) - exported - dropped;
    rays_q <= rays_q + exported - traced;
    shadow_q <= shadow_q + traced - shade;
    if (cast) cast_q <= (held_q == 0 ? 0 : cast_q) + 1;
  end
  always @* begin
    assume (rst_n || !(cast || secondary));
    assume (!cast || eye_possible);
    assume (!secondary || threads <= room);
    assume (finished <= held_q);
    assume (exported + dropped <= to_come_q && (!exported || rays_q < RAYS));
    assume (!traced || (rays_q != 0 && shadow_q < INTERSECTIONS));
    assume (!shade || shadow_q != 0);
    assume (pixels != 0 && pixels <= HELD);
    assert (held_q <= HELD);
    assert (rays_q + to_come_q + shadow_q <= INTERSECTIONS + RAYS - 1);
    assert (shadow_q != INTERSECTIONS || rays_q < RAYS);
    assert (held_q != 0 || !tile_left || eye_possible);
    assert (WINDOW_REMEDY != 0 || cast_q <= UNITS);
  end
endmodule
`default_nettype wire
