// @modules fill_policy
// @proves what is proposed is possible: eye rays if a tile may be cast, else a thread or more, as many as there are of
//   its intersections and as are safe
// @proves while no kernel is on the units it never halts for good: not while shadow intersections fill their pool, nor
//   when nothing is to come and intersections are there or a tile may be cast
// @proves unless nothing is to come, what secondary kernels export has room in the ray pool
// @parameters CONTENTS=2 RAYS=1 INTERSECTIONS=5 BATCH=3
// @parameters CONTENTS=4 RAYS=7 INTERSECTIONS=5 BATCH=3
// @parameters CONTENTS=1 RAYS=1 INTERSECTIONS=1 BATCH=1
// @parameters CONTENTS=16 RAYS=40 INTERSECTIONS=20 BATCH=8
// @break fill_policy s/alone_q && safe_q/alone_q \&\& secondary/
// @break fill_policy s/: safe_q\[/: secondary[/
// @break fill_policy s/any_kernel && promised_i/1'b1 || promised_i/
// @break fill_policy s/room >> 1 : room/room : room/
// @break fill_policy s/least\(least\(CONTENTS\[COUNT_BITS-1:0\], normal_i\), secondary_room_i\)/
//   least(CONTENTS[COUNT_BITS-1:0], normal_i)/
// @break fill_policy s/!any_kernel && !more/any_kernel \&\& !more/
`default_nettype none
module check #(parameter CONTENTS = 4, parameter RAYS = 7, parameter INTERSECTIONS = 5, parameter BATCH = 3) (
  input wire clk_i, input wire [7:0] rays, normal, shadow, others, to_come, promised, input wire [1:0] kernels,
  input wire eye_possible, two_rays, ahead);
  localparam BITS = 12;
  localparam LIMIT = RAYS + INTERSECTIONS - 1;
  wire more_to_come = rays != 0 || to_come != 0;
  wire [BITS-1:0] shadows = shadow + (more_to_come ? others : 0);
  wire [BITS-1:0] safe = shadows < LIMIT ? LIMIT - shadows : 0;
  wire [1:0] kind;
  wire [$clog2(CONTENTS + 1)-1:0] threads;
  rp_fill_policy #(.CONTENTS(CONTENTS), .RAY_POOL_SIZE(RAYS), .INTERSECTION_POOL_SIZE(INTERSECTIONS), .BATCH(BATCH),
                .COUNT_BITS(BITS)) dut (
    .clk_i(clk_i), .rays_i({4'd0, rays}), .normal_i({4'd0, normal}), .shadow_i({4'd0, shadow}),
    .secondary_room_i(safe), .rays_to_come_i({4'd0, to_come}), .promised_i({4'd0, promised}), .kernels_i(kernels),
    .two_rays_i(two_rays), .eye_possible_i(eye_possible), .more_to_come_i(more_to_come), .ahead_i(ahead),
    .kind_o(kind), .threads_o(threads));
  // What it has seen in the cycle before.
  reg decided_q = 1'b0;
  reg [7:0] rays_q, normal_q, shadow_q, to_come_q;
  reg [1:0] kernels_q;
  reg [BITS-1:0] safe_q;
  reg eye_possible_q, two_rays_q, more_to_come_q;
  always @(posedge clk_i) begin
    decided_q <= 1'b1;
    {rays_q, normal_q, shadow_q, to_come_q, kernels_q} <= {rays, normal, shadow, to_come, kernels};
    {safe_q, eye_possible_q, two_rays_q, more_to_come_q} <= {safe, eye_possible, two_rays, more_to_come};
  end
  wire [BITS-1:0] exported = threads << two_rays_q;
  always @* begin
    assume (rays <= RAYS && normal <= INTERSECTIONS && shadow <= INTERSECTIONS && kernels <= 2);
    assume (!ahead || kernels != 0);
    assume (kernels != 0 || promised == 0);
    if (decided_q) begin
      if (kind == 0 || kind == 1) assert (threads == 0);
      if (kind == 1) assert (eye_possible_q);
      if (kind == 2) assert (threads != 0 && threads <= CONTENTS && threads <= normal_q && threads <= safe_q);
      if (kind == 3) assert (threads != 0 && threads <= CONTENTS && threads <= shadow_q);
      if (kind == 0 && kernels_q == 0) begin
        assert (shadow_q != INTERSECTIONS);
        assert (more_to_come_q || (!eye_possible_q && normal_q == 0 && shadow_q == 0));
      end
      if (kind == 2 && (more_to_come_q || kernels_q != 0))
        assert (rays_q + to_come_q + exported <= RAYS + BATCH * kernels_q);
    end
  end
endmodule
`default_nettype wire
