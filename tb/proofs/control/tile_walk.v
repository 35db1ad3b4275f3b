// @long 20
// @modules tile_walk request_queue
// @proves each tile that has a pixel in the picture comes once, and no other one; its pixels are those in the picture
// @proves the last one is marked, and only that; from its taking on until a start nothing is offered
// @proves a tile that is offered stays until it is taken, or until another walk begins
// @proves a tile comes within a bound of cycles: 5 for each doubling of a square until it holds the picture, and 4
// @parameters TILE_ORDER=1 SIZE_BITS=2 CONTENTS=1
// @parameters TILE_ORDER=1 SIZE_BITS=2 CONTENTS=4
// @parameters TILE_ORDER=0 SIZE_BITS=2 CONTENTS=1
// @parameters TILE_ORDER=0 SIZE_BITS=3 CONTENTS=4
// @break tile_walk s/count != 2'd1 \|\| !searching_q/1'b1/
// @break tile_walk s/outside = beyond_right \|\| below/outside = beyond_right/
// @break tile_walk s/room = count != 2'd3/room = 1'b1/
// @break tile_walk s/fits = beyond_right && below/fits = beyond_right/
// @break tile_walk s/rst_ni && !start_i/rst_ni/
// @break tile_walk s/tile_valid_o && !tile_ready_i\)/1'b0)/
`default_nettype none
module check #(parameter TILE_ORDER = 1, parameter SIZE_BITS = 2, parameter CONTENTS = 1) (
  input wire clk_i, start, ready, input wire [SIZE_BITS-1:0] width, height);
  localparam PIXEL_BITS = $clog2(CONTENTS + 1);
  localparam WIDE = 1 << ($clog2(CONTENTS) + 1) / 2, HIGH = CONTENTS / WIDE;
  localparam BOUND = 5 * (SIZE_BITS + 1 - $clog2(HIGH + 1)) + 4;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire busy, valid, last;
  wire [31:0] block;
  wire [PIXEL_BITS-1:0] pixels;
  rp_tile_walk #(.CONTENTS(CONTENTS), .TILE_ORDER(TILE_ORDER), .SIZE_BITS(SIZE_BITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .start_i(start), .width_i(width), .height_i(height), .busy_o(busy),
    .tile_valid_o(valid), .tile_ready_i(ready), .tile_block_o(block), .tile_pixels_o(pixels), .tile_last_o(last));

  (* anyconst *) wire [SIZE_BITS-1:0] some_left;   // of one tile
  (* anyconst *) wire [SIZE_BITS-1:0] some_top;
  wire [SIZE_BITS-1:0] left = block[SIZE_BITS-1:0];
  wire [SIZE_BITS-1:0] top = block[16 +: SIZE_BITS];
  reg [SIZE_BITS-1:0] width_q, height_q;
  wire some = some_left < width_q && some_top < height_q;
  wire [SIZE_BITS:0] columns = (width_q - left < WIDE) ? width_q - left : WIDE;
  wire [SIZE_BITS:0] rows = (height_q - top < HIGH) ? height_q - top : HIGH;
  reg walks_q = 1'b0, ended_q = 1'b0, seen_q = 1'b0, offered_q = 1'b0;
  reg [31:0] block_q;
  reg [PIXEL_BITS-1:0] pixels_q;
  reg last_q;
  reg [7:0] waited_q = 0;
  wire taken = valid && ready;
  wire is_some = left == some_left && top == some_top;
  always @(posedge clk_i) if (rst_n) begin
    offered_q <= valid && !ready && !start;
    block_q <= block;
    pixels_q <= pixels;
    last_q <= last;
    if (start) begin
      walks_q <= 1'b1;
      ended_q <= 1'b0;
      seen_q <= 1'b0;
      width_q <= width;
      height_q <= height;
      waited_q <= 0;
    end else begin
      if (taken && last) ended_q <= 1'b1;
      if (taken && is_some) seen_q <= 1'b1;
      waited_q <= valid ? 0 : waited_q + 1;
    end
  end
  always @* begin
    assume (width != 0 && height != 0);
    assume (some_left % WIDE == 0 && some_top % HIGH == 0);
    if (rst_n) begin
      assert (busy == (walks_q && !ended_q));
      assert (!valid || busy);
      if (valid) begin
        assert (left < width_q && top < height_q && left % WIDE == 0 && top % HIGH == 0);
        assert (block == (left | top << 16));
        assert (pixels == columns * rows);
        assert (!(is_some && seen_q));
        assert (!last || !some || seen_q || is_some);
      end
      assert (!ended_q || !some || seen_q);
      assert (!offered_q || (valid && block == block_q && pixels == pixels_q && last == last_q));
      assert (!busy || waited_q < BOUND);
    end
  end
endmodule
`default_nettype wire
