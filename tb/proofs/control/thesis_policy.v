// @modules thesis_policy
// @proves what is proposed is possible: eye rays if a tile may be cast, else a thread or more, as many as there are of
//   its intersections and as are safe
// @proves it never halts for good: not while shadow intersections fill their pool, nor when nothing is to come and
//   intersections are there or a tile may be cast
// @proves ahead of the unit only a full kernel that imports is launched
// @parameters CONTENTS=4 RAYS=7 INTERSECTIONS=5
// @parameters CONTENTS=1 RAYS=1 INTERSECTIONS=1
// @parameters CONTENTS=64 RAYS=100 INTERSECTIONS=60
// @break thesis_policy s/localparam integer INTERSECTIONS =/localparam integer INTERSECTIONS = 2 +/
// @break thesis_policy s/more_normal_q && safe_q/more_normal_q/
// @break thesis_policy s/else if \(any_shadow_q\) wanted = SHADE;//
// @break thesis_policy s/else if \(!more_to_come_q\) begin/else if (!more_to_come_q \&\& more_normal_q) begin/
// @break thesis_policy s/ahead_q && threads/ahead_q \&\& wanted != EYE \&\& threads/
`default_nettype none
module check #(parameter CONTENTS = 4, parameter RAYS = 7, parameter INTERSECTIONS = 5) (
  input wire clk_i, input wire [9:0] rays, normal, shadow, others, input wire eye_possible, to_come, ahead);
  localparam BITS = 12;
  localparam LIMIT = RAYS + INTERSECTIONS - 1;
  // What a controller can see: rule 2 leaves what shadow rays and intersections do not take.
  wire more_to_come = rays != 0 || to_come;
  wire [BITS-1:0] shadows = shadow + (more_to_come ? others : 0);
  wire [BITS-1:0] room = shadows < LIMIT ? LIMIT - shadows : 0;
  wire [1:0] kind;
  wire [$clog2(CONTENTS + 1)-1:0] threads;
  rp_thesis_policy #(.CONTENTS(CONTENTS), .RAY_POOL_SIZE(RAYS), .INTERSECTION_POOL_SIZE(INTERSECTIONS),
                  .COUNT_BITS(BITS)) dut (
    .clk_i(clk_i), .rays_i({2'd0, rays}), .normal_i({2'd0, normal}), .shadow_i({2'd0, shadow}),
    .secondary_room_i(room), .eye_possible_i(eye_possible), .more_to_come_i(more_to_come), .ahead_i(ahead),
    .kind_o(kind), .threads_o(threads));
  // What it has seen in the cycle before.
  reg decided_q = 1'b0;
  reg [9:0] normal_q, shadow_q;
  reg [BITS-1:0] room_q;
  reg eye_possible_q, more_to_come_q, ahead_q;
  always @(posedge clk_i) begin
    decided_q <= 1'b1;
    {normal_q, shadow_q, room_q} <= {normal, shadow, room};
    {eye_possible_q, more_to_come_q, ahead_q} <= {eye_possible, more_to_come, ahead};
  end
  always @* begin
    assume (rays <= RAYS && normal <= INTERSECTIONS && shadow <= INTERSECTIONS);
    if (decided_q) begin
      if (kind == 0 || kind == 1) assert (threads == 0);
      if (kind == 1) assert (eye_possible_q);
      if (kind == 2) assert (threads != 0 && threads <= CONTENTS && threads <= normal_q && threads <= room_q);
      if (kind == 3) assert (threads != 0 && threads <= CONTENTS && threads <= shadow_q);
      if (kind == 0 && !ahead_q) begin
        assert (shadow_q != INTERSECTIONS);
        assert (more_to_come_q || (!eye_possible_q && normal_q == 0 && shadow_q == 0));
      end
      if (ahead_q) assert (kind == 0 || (kind != 1 && threads == CONTENTS));
    end
  end
endmodule
`default_nettype wire
