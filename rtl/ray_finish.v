// What a ray carries on of its hit, without double: time, place in the triangle and the triangle's normal.
// docs/traverser.md says what is computed. A ray's axes, corners and quotients follow each other through the units, and
// its results come a fixed number of cycles later: RayFinishPipe::kStages. It never waits.
// Must be given: rays three cycles apart or more; a hit's internal t, neither below zero nor infinite; finite
// coordinates, of which no two are further apart than 1e18 along an axis.
`default_nettype none
module ray_finish #(
  parameter integer BITS = 32,                // of the significands between
  parameter integer TAG_BITS = 16
) (
  input  wire                clk_i,
  input  wire                rst_ni,
  input  wire                valid_i,
  input  wire [TAG_BITS-1:0] tag_i,
  input  wire [287:0]        corners_i,       // of the triangle: corner 0 first, x first
  input  wire [95:0]         origin_i,        // of the ray
  input  wire [1:0]          main_axis_i,     // 0 .. 2
  input  wire [63:0]         shear_i,         // along the next axis, and the one after that
  input  wire [31:0]         t_i,             // internal
  input  wire [8:0]          scale_i,         // signed: the ray's t is internal t x 2^scale
  output wire                valid_o,
  output wire [TAG_BITS-1:0] tag_o,
  output wire [31:0]         t_o,
  output wire [31:0]         u_o,             // shares of corners 1 and 2
  output wire [31:0]         v_o,
  output wire [95:0]         normal_o         // x first
);
endmodule
`default_nettype wire
