// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a lane knows of its rays' hits: each ray's limit, and its best hit so far. The triangle pipe is given both by
// slot, a cycle after it asks; its results are taken into account at once. When the last triangle of a leaf has its
// result, the ray goes on, with the time of its best hit as a key.
// Must be given: a ray enters before it is asked for; results of the pipe four cycles after it was given the limit, and
// one after it was given the best hit.
`default_nettype none
module rp_lane_hits #(
  parameter integer SLOTS = 24,
  parameter integer BITS = 12,                   // of a key's significand
  parameter integer KEY_BITS = BITS + 9,
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  // a ray enters
  input  wire                 ray_valid_i,
  input  wire [SLOT_BITS-1:0] ray_slot_i,
  input  wire                 ray_shadow_i,
  input  wire [31:0]          ray_limit_i,
  input  wire [8:0]           ray_scale_i,
  // the triangle pipe asks, and is answered in the next cycle
  input  wire [SLOT_BITS-1:0] limit_slot_i,
  output wire [31:0]          limit_o,
  output wire [8:0]           scale_o,
  input  wire [SLOT_BITS-1:0] best_slot_i,
  output wire [31:0]          best_t_o,
  output wire [31:0]          best_number_o,
  // its results
  input  wire                 result_valid_i,
  input  wire [SLOT_BITS-1:0] result_slot_i,
  input  wire                 result_last_i,     // of its leaf
  input  wire [28:0]          result_place_i,
  input  wire [31:0]          result_number_i,
  input  wire                 result_hit_i,
  input  wire [30:0]          result_t_i,
  // a leaf's result; its slot a cycle ahead
  output wire [SLOT_BITS-1:0] leaf_slot_o,
  output wire                 leaf_valid_o,
  output wire [KEY_BITS-1:0]  leaf_limit_o,
  output wire                 leaf_over_o,       // a shadow ray has found a blocker
  // a box test asks for the best hit's key, and is answered in the next cycle
  input  wire [SLOT_BITS-1:0] key_slot_i,
  output wire                 key_valid_o,       // there is a hit
  output wire [KEY_BITS-1:0]  key_o,
  // so does the block that takes a finished ray, for the hit
  input  wire [SLOT_BITS-1:0] done_slot_i,
  output wire                 done_hit_o,
  output wire [30:0]          done_t_o,
  output wire [31:0]          done_number_o,
  output wire [28:0]          done_place_o
);
  localparam [SLOTS-1:0] NO_SLOT = 0, ONE_SLOT = 1;

  // ---- The ray's own

  reg [SLOTS-1:0] shadow_q, hit_q;
  wire hit = result_valid_i && result_hit_i;
  always @(posedge clk_i)
    if (ray_valid_i) shadow_q[ray_slot_i] <= ray_shadow_i;
  always @(posedge clk_i)
    if (!rst_ni) hit_q <= NO_SLOT;
    else hit_q <= (hit_q & ~(ray_valid_i ? ONE_SLOT << ray_slot_i : NO_SLOT)) |
                  (hit ? ONE_SLOT << result_slot_i : NO_SLOT);
  rp_ram_1r1w #(.WIDTH(41), .DEPTH(SLOTS)) limits (
    .clk_i(clk_i),
    .read_i(1'b1),
    .read_address_i(limit_slot_i),
    .read_data_o({scale_o, limit_o}),
    .write_i(ray_valid_i),
    .write_address_i(ray_slot_i),
    .write_data_i({ray_scale_i, ray_limit_i})
  );

  // ---- The best hit: what came in the cycle in which it was asked for is not in the RAM's word, nor what comes in
  // that in which it is given

  reg written_q;
  reg [SLOT_BITS-1:0] written_slot_q, best_slot_q;
  reg [62:0] written_best_q;
  always @(posedge clk_i) begin
    written_q <= hit;
    written_slot_q <= result_slot_i;
    written_best_q <= {result_t_i, result_number_i};
    best_slot_q <= best_slot_i;
  end
  wire [91:0] best_word, done_word;
  rp_ram_2r1w #(.WIDTH(92), .DEPTH(SLOTS), .GRANULE(92)) best (
    .clk_i(clk_i),
    .read_i(1'b1),
    .read_address_a_i(best_slot_i),
    .read_address_b_i(done_slot_i),
    .read_data_a_o(best_word),
    .read_data_b_o(done_word),
    .write_mask_i(hit),
    .write_address_i(result_slot_i),
    .write_data_i({result_place_i, result_t_i, result_number_i})
  );
  wire now = hit && result_slot_i == best_slot_q, before = written_q && written_slot_q == best_slot_q;
  wire [62:0] best_so_far = now ? {result_t_i, result_number_i} : before ? written_best_q :
                            hit_q[best_slot_q] ? best_word[62:0] : {31'h7f800000, 32'd0};
  assign best_t_o = {1'b0, best_so_far[62:32]};
  assign best_number_o = best_so_far[31:0];
  wire unused = &{1'b0, best_word[91:63]};
  reg [SLOT_BITS-1:0] done_slot_q;
  always @(posedge clk_i) done_slot_q <= done_slot_i;
  assign done_hit_o = hit_q[done_slot_q];
  assign {done_place_o, done_t_o, done_number_o} = done_word;

  // ---- Its time as a key: the exponent of the ray's time above what is kept behind the first bit

  wire [8:0] scale;
  rp_steady_delay #(.WIDTH(9), .CYCLES(4)) scale_delay (.clk_i(clk_i), .data_i(scale_o), .data_o(scale));
  // As normaliser does it: mapped in one piece with what is added it is faster.
  reg [23:0] moved;
  reg [4:0] places;
  integer step;
  always @* begin
    moved = {result_t_i[30:23] != 8'd0, result_t_i[22:0]};
    places = 5'd0;
    for (step = 4; step >= 0; step = step - 1)
      if (moved >> (24 - (1 << step)) == 24'd0) begin
        moved = moved << (1 << step);
        places[step] = 1'b1;
      end
  end
  // The places come last.
  wire [9:0] without_places = {2'd0, result_t_i[30:24], result_t_i[23] || result_t_i[30:23] == 8'd0} +
                              {scale[8], scale} + 10'd385;
  wire [9:0] exponent = without_places - {5'd0, places};
  reg ends_q, ends_hit_q, told_q;
  reg [SLOT_BITS-1:0] ends_slot_q, told_slot_q, key_slot_q;
  reg [KEY_BITS-1:0] ends_key_q, told_key_q;
  always @(posedge clk_i) begin
    ends_q <= rst_ni && result_valid_i && result_last_i;
    ends_hit_q <= rst_ni && hit;
    ends_slot_q <= result_slot_i;
    ends_key_q <= {exponent, moved[22-:BITS-1]};
    told_q <= ends_hit_q;
    told_slot_q <= ends_slot_q;
    told_key_q <= ends_key_q;
    key_slot_q <= key_slot_i;
  end
  wire unused_key = &{1'b0, moved};
  wire [KEY_BITS-1:0] ends_word;
  rp_ram_2r1w #(.WIDTH(KEY_BITS), .DEPTH(SLOTS), .GRANULE(KEY_BITS)) keys (
    .clk_i(clk_i),
    .read_i(1'b1),
    .read_address_a_i(key_slot_i),
    .read_address_b_i(result_slot_i),
    .read_data_a_o(key_o),
    .read_data_b_o(ends_word),
    .write_mask_i(ends_hit_q),
    .write_address_i(ends_slot_q),
    .write_data_i(ends_key_q)
  );
  assign key_valid_o = hit_q[key_slot_q];
  assign leaf_slot_o = result_slot_i;
  assign leaf_valid_o = ends_q;
  // Without a hit all entries are within the ray's limit, as their boxes were.
  assign leaf_limit_o = ends_hit_q ? ends_key_q : (told_q && told_slot_q == ends_slot_q) ? told_key_q :
                        hit_q[ends_slot_q] ? ends_word : {KEY_BITS{1'b1}};
  assign leaf_over_o = shadow_q[ends_slot_q] && hit_q[ends_slot_q];
endmodule
`default_nettype wire
