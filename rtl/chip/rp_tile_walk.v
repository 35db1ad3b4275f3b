// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The tiles of a picture in the order in which they are cast: row for row, or along a Hilbert curve, which stays longer
// among neighbours. docs/machine/controller.md.
// Promises: each tile that has a pixel in the picture once; what is offered stays until it is taken, or until another
// walk begins; no output depends on an input of the same cycle. Must be given: a picture of 1 pixel or more each way.
`default_nettype none
module rp_tile_walk #(
  parameter integer CONTENTS = 64,       // threads of a full kernel: pixels of a tile, a power of two
  parameter integer HELD_LIMIT = 512,    // pixels: a tile that would have more is cut into bands of whole rows
  parameter integer TILE_ORDER = 0,      // 0: rows from the top, 1: a Hilbert curve
  parameter integer SIZE_BITS = 16,      // of the picture's width and height
  parameter integer PIXEL_BITS = $clog2(CONTENTS + 1)
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  // from the host: a walk begins, whatever was under way
  input  wire                  start_i,
  input  wire [SIZE_BITS-1:0]  width_i,
  input  wire [SIZE_BITS-1:0]  height_i,
  output reg                   busy_o,          // a tile is still to be taken
  // the next tile
  output reg                   tile_valid_o,
  input  wire                  tile_ready_i,
  output reg  [31:0]           tile_block_o,    // its upper left pixel, x | y << 16: the word that its launch has
  output reg  [PIXEL_BITS-1:0] tile_pixels_o,   // of it that lie in the picture
  output reg                   tile_last_o
);
  localparam integer WIDTH_LOG2 = ($clog2(CONTENTS) + 1) / 2;
  localparam integer TILE_HEIGHT = ((CONTENTS < HELD_LIMIT) ? CONTENTS : HELD_LIMIT) >> WIDTH_LOG2;
  generate
    if (CONTENTS < 1 || CONTENTS > 1024 || CONTENTS != 1 << $clog2(CONTENTS)) begin : gen_bad_contents
      tile_walk_CONTENTS_must_be_a_power_of_two_from_1_to_1024 illegal ();
    end
    if (TILE_HEIGHT < 1) begin : gen_bad_limit
      tile_walk_HELD_LIMIT_must_be_the_width_of_a_tile_or_more illegal ();
    end
    if (TILE_ORDER < 0 || TILE_ORDER > 1) begin : gen_bad_order
      tile_walk_TILE_ORDER_must_be_0_or_1 illegal ();
    end
    if (SIZE_BITS < 1 || SIZE_BITS > 16) begin : gen_bad_size
      tile_walk_SIZE_BITS_must_be_from_1_to_16 illegal ();
    end
  endgenerate
  // Squares of 1 to 2^LEVELS tiles each way: the largest holds any picture. Tiles are no higher than wide.
  localparam integer HEIGHT_LOG2 = $clog2(TILE_HEIGHT + 1) - 1;
  localparam integer LEVELS = (SIZE_BITS > HEIGHT_LOG2 + 2) ? SIZE_BITS - HEIGHT_LOG2 : 2;
  localparam integer AT_BITS = LEVELS + 1;         // of columns and rows
  localparam integer CORNER_BITS = AT_BITS + 8;    // of pixels, outside the picture and in a tile too
  localparam [CORNER_BITS-1:0] WIDE = {{CORNER_BITS-1{1'b0}}, 1'b1} << WIDTH_LOG2;
  localparam [CORNER_BITS-1:0] HIGH = TILE_HEIGHT[CORNER_BITS-1:0];

  // ---- The picture
  reg [SIZE_BITS-1:0] width_q, height_q;
  always @(posedge clk_i)
    if (start_i) begin
      width_q <= width_i;
      height_q <= height_i;
    end
  wire [CORNER_BITS-1:0] width = {{CORNER_BITS-SIZE_BITS{1'b0}}, width_q};
  wire [CORNER_BITS-1:0] height = {{CORNER_BITS-SIZE_BITS{1'b0}}, height_q};

  // ---- The search: a step a cycle
  reg searching_q;
  reg [AT_BITS-1:0] column_q, row_q;       // of the tile, or of the upper left one of the square, that is looked at
  wire [CORNER_BITS-1:0] left = {{CORNER_BITS-AT_BITS{1'b0}}, column_q} << WIDTH_LOG2;
  wire [CORNER_BITS-1:0] top = {{CORNER_BITS-AT_BITS{1'b0}}, row_q} * HIGH;
  wire beyond_right = left >= width;
  wire below = top >= height;

  wire found, over;                        // a tile; and no other one behind it
  wire [AT_BITS-1:0] next_column, next_row;
  wire [1:0] count;                        // tiles found and not offered
  wire room = count != 2'd3;
  wire step = searching_q && (room || !found);
  localparam [AT_BITS-1:0] FIRST = TILE_ORDER[AT_BITS-1:0];   // along the curve it sees how large the square is
  always @(posedge clk_i)
    if (!rst_ni) searching_q <= 1'b0;
    else if (start_i) searching_q <= 1'b1;
    else if (step) searching_q <= !over;
  always @(posedge clk_i)
    if (start_i) begin
      column_q <= FIRST;
      row_q <= FIRST;
    end else if (step) begin
      column_q <= next_column;
      row_q <= next_row;
    end

  generate
    if (TILE_ORDER == 0) begin : gen_rows
      wire row_ends = left + WIDE >= width;
      assign found = 1'b1;
      assign over = row_ends && top + HIGH >= height;
      assign next_column = row_ends ? {AT_BITS{1'b0}} : column_q + 1'b1;
      assign next_row = row_ends ? row_q + 1'b1 : row_q;
      wire unused = beyond_right || below;
    end else begin : gen_curve
      localparam [1:0] LAST_QUARTER = 2'd3;
      reg sizing_q;                        // the square is to be doubled until the picture fits into it
      reg [LEVELS:0] here_q;               // the size of the square that is looked at: bit 0: one tile
      // Of each size which quarter it is of the square around it, below here_q the last one; and how the curve is
      // turned inside: bit 0: columns and rows exchanged, bit 1: both counted from the other end.
      reg [2*LEVELS-1:0] quarters_q;
      reg [2*LEVELS-1:2] turns_q;
      wire [2*LEVELS+1:2] turns = {2'd0, turns_q};

      // One that is outside, or one tile, is done with: the next quarter of the smallest square around it comes that
      // has one left. Of another one its first quarter comes.
      wire outside = beyond_right || below;
      wire enter = !outside && !here_q[0];
      wire [LEVELS:0] smaller = here_q - 1'b1;
      reg [LEVELS-1:0] left_over;          // sizes from here on of which a quarter is left
      wire [LEVELS-1:0] up = left_over & (~left_over + 1'b1);
      wire [LEVELS-1:0] to = enter ? here_q[LEVELS:1] : up;
      wire [LEVELS-1:0] above = ~(to | (to - 1'b1));
      reg [1:0] quarter, turn;
      integer l;
      always @* begin
        quarter = 2'd0;
        turn = 2'd0;
        for (l = 0; l < LEVELS; l = l + 1) begin
          left_over[l] = quarters_q[2*l +: 2] != LAST_QUARTER && !smaller[l];
          if (to[l]) begin
            quarter = quarter | (quarters_q[2*l +: 2] + 2'd1);
            turn = turn | turns[2*l+2 +: 2];
          end
        end
      end
      // Upper left, lower left, lower right, upper right.
      wire right = quarter[1];
      wire down = quarter[1] ^ quarter[0];
      wire in_column = turn[1] ^ (turn[0] ? down : right);
      wire in_row = turn[1] ^ (turn[0] ? right : down);
      wire [1:0] inner = {turn[1] ^ (right && !down), turn[0] ^ !down};

      wire fits = beyond_right && below;
      assign found = !sizing_q && !outside && here_q[0];
      assign over = !sizing_q && to == {LEVELS{1'b0}};
      assign next_column = sizing_q ? (fits ? {AT_BITS{1'b0}} : column_q << 1)
                           : {1'b0, (column_q[LEVELS-1:0] & above) | (in_column ? to : {LEVELS{1'b0}})};
      assign next_row = sizing_q ? (fits ? {AT_BITS{1'b0}} : row_q << 1)
                        : {1'b0, (row_q[LEVELS-1:0] & above) | (in_row ? to : {LEVELS{1'b0}})};

      integer m;
      always @(posedge clk_i)
        if (start_i) begin
          sizing_q <= 1'b1;
          here_q <= {{LEVELS{1'b0}}, 1'b1};
          quarters_q <= {LEVELS{LAST_QUARTER}};
          turns_q <= {2*LEVELS-2{1'b0}};
        end else if (step && sizing_q) begin
          sizing_q <= !fits;
          if (!fits) here_q <= here_q << 1;
        end else if (step) begin
          here_q <= {1'b0, to};
          for (m = 0; m < LEVELS; m = m + 1)
            if (to[m]) quarters_q[2*m +: 2] <= quarter;
          for (m = 1; m < LEVELS; m = m + 1)
            if (to[m]) turns_q[2*m +: 2] <= inner;
        end
    end
  endgenerate

  // ---- Tiles ahead. Whether one is the last is known when there is another one, or the search is over.
  wire found_valid;
  wire [SIZE_BITS-1:0] corner_left, corner_top;
  wire moves = (!tile_valid_o || tile_ready_i) && found_valid && (count != 2'd1 || !searching_q);
  rp_request_queue #(.WIDTH(2 * SIZE_BITS), .DEPTH(3)) ahead (
    .clk_i(clk_i),
    .rst_ni(rst_ni && !start_i),
    .push_i(step && found),
    .data_i({top[SIZE_BITS-1:0], left[SIZE_BITS-1:0]}),
    .valid_o(found_valid),
    .ready_i(moves),
    .data_o({corner_top, corner_left}),
    .count_o(count)
  );

  // ---- The one that is offered
  wire [CORNER_BITS-1:0] right_of = width - {{CORNER_BITS-SIZE_BITS{1'b0}}, corner_left};
  wire [CORNER_BITS-1:0] below_of = height - {{CORNER_BITS-SIZE_BITS{1'b0}}, corner_top};
  wire [PIXEL_BITS-1:0] columns = (right_of < WIDE) ? right_of[PIXEL_BITS-1:0] : WIDE[PIXEL_BITS-1:0];
  wire [PIXEL_BITS-1:0] rows = (below_of < HIGH) ? below_of[PIXEL_BITS-1:0] : HIGH[PIXEL_BITS-1:0];
  wire taken = tile_valid_o && tile_ready_i;
  always @(posedge clk_i)
    if (!rst_ni) begin
      busy_o <= 1'b0;
      tile_valid_o <= 1'b0;
    end else if (start_i) begin
      busy_o <= 1'b1;
      tile_valid_o <= 1'b0;
    end else begin
      if (taken && tile_last_o) busy_o <= 1'b0;
      tile_valid_o <= moves || (tile_valid_o && !tile_ready_i);
    end
  always @(posedge clk_i)
    if (moves) begin
      tile_block_o <= {{16-SIZE_BITS{1'b0}}, corner_top, {16-SIZE_BITS{1'b0}}, corner_left};
      tile_pixels_o <= columns * rows;
      tile_last_o <= count == 2'd1 && !searching_q;
    end
endmodule
`default_nettype wire
