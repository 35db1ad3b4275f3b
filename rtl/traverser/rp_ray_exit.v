// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What becomes of rays that have visited everything. A normal ray that has hit nothing, and a shadow ray that has met
// something, frees its place; a shadow ray that has not leaves a contribution, with SHADING, or a package. A hit is
// finished: its triangle is read through the triangle cache and rp_ray_finish.v computes what the package carries. With
// MISS_RECORDS a ray that returns leaves a package in every case, a plain one without a hit if it has met nothing or
// any hit would do. What a ray came with, and its hit, lie by its place in the ray pool until the package leaves; so
// its slot in the lane is free at once, and rays that wait for room in the intersection pool hold up no others. A plain
// package waits in a cycle in which a hit has been finished. Promises: each ray that is done
// frees its place once, when what it has become has left; packages of a kind leave in the order in which they were
// finished; a kind is begun only when there is room for it; no output depends on an input of the same cycle but
// done_ready_o and slot_free_*, which depend on done_valid_i alone. Must be given: a ray's words and its set-up before
// it is done; what leaf_reader must of the cache.
`default_nettype none
module rp_ray_exit #(
  parameter integer LANES = 8,
  parameter integer SLOTS = 24,                  // of a lane; as many hits can wait for their triangles
  parameter integer POOL = 512,                  // places
  parameter integer RECORD_WORDS = 21,           // of a package
  parameter integer SHADING = 0,
  parameter integer CULLING = 0,
  parameter integer MISS_RECORDS = 0,            // not with CULLING
  parameter integer KINDS = 2 + CULLING,
  parameter integer PLACE_BITS = (POOL > 1) ? $clog2(POOL) : 1,
  parameter integer SLOT_BITS = (SLOTS > 1) ? $clog2(SLOTS) : 1
) (
  input  wire                       clk_i,
  input  wire                       rst_ni,
  // what stays for a frame
  input  wire [31:0]                material_base_i,  // bytes
  input  wire [104:0]               record_i,         // of each place of the record its word, 5 bits; 31: zero
  input  wire [7:0]                 depth_limit_i,    // deeper normal rays there are none
  input  wire                       reflections_i,    // normal packages are for the kernel that reflects
  // a ray that comes: its words
  input  wire                       ray_valid_i,
  input  wire [PLACE_BITS-1:0]      ray_place_i,
  input  wire [383:0]               ray_words_i,
  // it is set up, for a lane
  input  wire [LANES-1:0]           set_valid_i,
  input  wire [SLOT_BITS-1:0]       set_slot_i,
  input  wire [PLACE_BITS-1:0]      set_place_i,
  input  wire [7:0]                 set_depth_i,
  input  wire                       set_shadow_i,
  input  wire                       set_returns_i,    // with MISS_RECORDS: no shadow ray, and it returns
  input  wire                       set_first_i,      // the same, and any hit ends it
  input  wire [95:0]                set_origin_i,
  input  wire [1:0]                 set_main_axis_i,
  input  wire [63:0]                set_shear_i,
  input  wire [8:0]                 set_scale_i,
  // it is done, in a lane
  input  wire [LANES-1:0]           done_valid_i,
  output wire [LANES-1:0]           done_ready_o,
  input  wire [LANES*SLOT_BITS-1:0] done_slot_i,
  input  wire [LANES-1:0]           done_hit_i,
  input  wire [LANES*32-1:0]        done_t_i,
  input  wire [LANES*29-1:0]        done_place_i,     // of the triangle in the tree
  output wire [LANES-1:0]           slot_free_o,
  output wire [SLOT_BITS-1:0]       slot_free_slot_o,
  // the triangle cache, as leaf_reader has it
  output wire [1:0]                 want_o,
  output wire [1:0]                 want_prefetch_o,
  output wire [51:0]                want_line_o,
  output wire [2*SLOT_BITS-1:0]     want_slot_o,
  input  wire [1:0]                 taken_i,
  output wire                       room_o,
  input  wire                       waited_i,
  input  wire                       given_i,
  input  wire [SLOT_BITS-1:0]       given_slot_i,
  input  wire [511:0]               given_data_i,
  // places that are free
  output wire                       free_valid_o,
  output wire [PLACE_BITS-1:0]      free_place_o,
  output wire                       free_shadow_o,
  // beats of packages; kinds are 1 normal, 2 shadow, 3 direct, with normal in the low bit
  output wire                       put_valid_o,
  input  wire [KINDS-1:0]           put_ready_i,
  output reg  [1:0]                 put_kind_o,
  output reg  [127:0]               put_data_o,
  // contributions
  output wire                       contribution_valid_o,
  input  wire                       contribution_ready_i,
  output wire [31:0]                contribution_pixel_o,
  output wire [95:0]                contribution_color_o
);
  localparam integer BEATS = (RECORD_WORDS + 3) / 4;
  localparam [2:0] LAST_BEAT = BEATS[2:0] - 3'd1;
`include "rp_onehot.vh"
`include "rp_records.vh"
  localparam integer FINISH_BITS = PLACE_BITS + 8 + 96 + 2 + 64 + 9;
  localparam integer RETURN_BITS = (MISS_RECORDS != 0) ? 2 : 0;
  localparam integer SET_BITS = RETURN_BITS + 1 + FINISH_BITS;
  genvar g;

  // ---- 1: a ray that is done
  wire fate_ready;
  reg fate_q;
  reg [LANES-1:0] fate_lane_q;
  reg [SLOT_BITS-1:0] fate_slot_q;
  reg fate_hit_q;
  reg [31:0] fate_t_q;
  reg [28:0] fate_triangle_q;
  wire [LANES-1:0] done_grant;
  rp_round_robin #(.COUNT(LANES)) done_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(done_valid_i), .advance_i(fate_ready), .grant_o(done_grant));
  assign done_ready_o = done_grant & {LANES{fate_ready}};
  `ONEHOT_SELECT(slot_among, LANES, SLOT_BITS)
  `ONEHOT_SELECT(t_among, LANES, 32)
  `ONEHOT_SELECT(triangle_among, LANES, 29)
  always @(posedge clk_i)
    if (!rst_ni) fate_q <= 1'b0;
    else if (fate_ready) fate_q <= |done_valid_i;
  always @(posedge clk_i)
    if (fate_ready) begin
      fate_lane_q <= done_grant;
      fate_slot_q <= slot_among(done_grant, done_slot_i);
      fate_hit_q <= |(done_grant & done_hit_i);
      fate_t_q <= t_among(done_grant, done_t_i);
      fate_triangle_q <= triangle_among(done_grant, done_place_i);
    end

  // ---- 2: what it becomes, by what is kept in its slot
  wire [LANES*SET_BITS-1:0] sets;
  wire [FINISH_BITS+2:0] set_words = {set_returns_i, set_first_i, set_shadow_i, set_place_i, set_depth_i, set_origin_i,
                                      set_main_axis_i, set_shear_i, set_scale_i};
  generate
    for (g = 0; g < LANES; g = g + 1) begin : gen_set
      rp_ram_1r1w #(.WIDTH(SET_BITS), .DEPTH(SLOTS)) set (
        .clk_i(clk_i),
        .read_i(done_ready_o[g]),
        .read_address_i(done_slot_i[g*SLOT_BITS +: SLOT_BITS]),
        .read_data_o(sets[g*SET_BITS +: SET_BITS]),
        .write_i(set_valid_i[g]),
        .write_address_i(set_slot_i),
        .write_data_i(set_words[SET_BITS-1:0])
      );
    end
  endgenerate
  `ONEHOT_SELECT(set_among, LANES, SET_BITS)
  wire [SET_BITS-1:0] set_of = set_among(fate_lane_q, sets);
  wire returns = MISS_RECORDS != 0 && set_of[SET_BITS-1];
  wire first = MISS_RECORDS != 0 && set_of[SET_BITS-2];
  wire shadow = set_of[FINISH_BITS];
  wire [PLACE_BITS-1:0] place = set_of[179 +: PLACE_BITS];
  wire plain = fate_hit_q ? first : returns;
  wire drops = shadow == fate_hit_q && !plain;
  wire finishes = !shadow && fate_hit_q && !plain;
  wire unblocked = fate_q && shadow && !fate_hit_q;

  wire entry_valid, drop_freed;
  wire finished, finished_direct;
  // What kind of ray it is is read, and so known last: it chooses between what each would do.
  wire shadow_moves = !fate_hit_q || drop_freed, normal_moves = fate_hit_q ? entry_valid : drop_freed;
  wire plain_moves = !finished;                  // a finished hit goes first
  wire fate_moves = plain ? plain_moves : shadow ? shadow_moves : normal_moves;
  assign fate_ready = plain ? !fate_q || plain_moves : shadow ? !fate_q || shadow_moves : !fate_q || normal_moves;
  assign slot_free_o = fate_lane_q & {LANES{fate_q && fate_moves}};
  assign slot_free_slot_o = fate_slot_q;

  // ---- A hit's triangle is read, and what the package carries computed
  wire [SLOT_BITS-1:0] entry, load_slot, read_slot;
  wire begins = fate_q && finishes && entry_valid;
  wire load, triangle_valid, triangle_last;
  wire [28:0] triangle_place;
  wire [TRIANGLE_BITS-1:0] triangle;
  reg [1:0] pause_q;                             // cycles until the next hit may be finished
  wire starts = triangle_valid && pause_q == 2'd0;
  rp_free_list #(.SIZE(SLOTS), .NUMBER_BITS(SLOT_BITS)) entries (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_o(entry_valid),
    .ready_i(begins),
    .number_o(entry),
    .free_i(starts),
    .free_number_i(read_slot)
  );
  wire [PLACE_BITS-1:0] hit_place;
  wire [7:0] hit_depth;
  wire [95:0] hit_origin;
  wire [1:0] hit_main_axis;
  wire [63:0] hit_shear;
  wire [8:0] hit_scale;
  wire [31:0] hit_t;
  rp_ram_1r1w #(.WIDTH(FINISH_BITS+32), .DEPTH(SLOTS)) hits (
    .clk_i(clk_i),
    .read_i(load),
    .read_address_i(load_slot),
    .read_data_o({hit_place, hit_depth, hit_origin, hit_main_axis, hit_shear, hit_scale, hit_t}),
    .write_i(begins),
    .write_address_i(entry),
    .write_data_i({set_of[FINISH_BITS-1:0], fate_t_q})
  );
  rp_leaf_reader #(.SLOTS(SLOTS), .LINE_BITS(26)) reader (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .start_i({1'b0, begins}),
    .start_slot_i({{SLOT_BITS{1'b0}}, entry}),
    .start_leaf_i({31'd0, 2'd0, fate_triangle_q}),
    .want_o(want_o),
    .want_prefetch_o(want_prefetch_o),
    .want_line_o(want_line_o),
    .want_slot_o(want_slot_o),
    .taken_i(taken_i),
    .room_o(room_o),
    .waited_i(waited_i),
    .given_i(given_i),
    .given_slot_i(given_slot_i),
    .given_data_i(given_data_i),
    .load_o(load),
    .load_slot_o(load_slot),
    .triangle_valid_o(triangle_valid),
    .triangle_ready_i(pause_q == 2'd0),
    .triangle_slot_o(read_slot),
    .triangle_last_o(triangle_last),
    .triangle_place_o(triangle_place),
    .triangle_o(triangle)
  );
  always @(posedge clk_i)
    if (!rst_ni) pause_q <= 2'd0;
    else if (starts) pause_q <= 2'd2;
    else if (pause_q != 2'd0) pause_q <= pause_q - 2'd1;
  wire [31:0] number = triangle[TRIANGLE_NUMBER +: TRIANGLE_NUMBER_BITS];
  wire [31:0] material = triangle[TRIANGLE_MATERIAL +: TRIANGLE_MATERIAL_BITS];
  wire direct = CULLING != 0 && reflections_i && !(hit_depth < depth_limit_i && material[31]);
  wire unused = &{1'b0, triangle_last, triangle_place, material[30:27], set_words};

  wire [PLACE_BITS-1:0] finished_place;
  wire [31:0] t, u, v;
  wire [95:0] normal;
  rp_ray_finish #(.TAG_BITS(1+PLACE_BITS)) finish (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_i(starts),
    .tag_i({direct, hit_place}),
    .corners_i(triangle[TRIANGLE_CORNERS +: TRIANGLE_CORNERS_BITS]),
    .origin_i(hit_origin),
    .main_axis_i(hit_main_axis),
    .shear_i(hit_shear),
    .t_i(hit_t),
    .scale_i(hit_scale),
    .valid_o(finished),
    .tag_o({finished_direct, finished_place}),
    .t_o(t),
    .u_o(u),
    .v_o(v),
    .normal_o(normal)
  );

  // ---- Packages that wait, by kind, and what they are made of, by place. Of a normal one also: it is plain, and of a
  // ray that returns whether it has met something.
  wire [KINDS-1:0] waits, chosen;
  wire [KINDS*PLACE_BITS-1:0] oldest;
  wire oldest_plain, oldest_met;
  generate
    for (g = 0; g < KINDS; g = g + 1) begin : gen_kind
      if (g == 1 && SHADING != 0) begin : gen_none
        assign waits[g] = 1'b0;
        assign oldest[g*PLACE_BITS +: PLACE_BITS] = {PLACE_BITS{1'b0}};
      end else if (g == 0 && MISS_RECORDS != 0) begin : gen_returning
        rp_ram_queue #(.WIDTH(PLACE_BITS + 2), .DEPTH(POOL)) queue (
          .clk_i(clk_i),
          .rst_ni(rst_ni),
          .push_i(finished || (fate_q && plain)),
          .data_i(finished ? {2'b01, finished_place} : {1'b1, fate_hit_q, place}),
          .valid_o(waits[g]),
          .ready_i(chosen[g]),
          .data_o({oldest_plain, oldest_met, oldest[g*PLACE_BITS +: PLACE_BITS]})
        );
      end else begin : gen_queue
        rp_ram_queue #(.WIDTH(PLACE_BITS), .DEPTH(POOL)) queue (
          .clk_i(clk_i),
          .rst_ni(rst_ni),
          .push_i((g == 1) ? unblocked : finished && finished_direct == (g == 2)),
          .data_i((g == 1) ? place : finished_place),
          .valid_o(waits[g]),
          .ready_i(chosen[g]),
          .data_o(oldest[g*PLACE_BITS +: PLACE_BITS])
        );
      end
    end
    if (MISS_RECORDS == 0) begin : gen_no_plain
      assign {oldest_plain, oldest_met} = 2'd0;
    end
  endgenerate
  reg puts_q;
  reg [2:0] beat_q;
  reg [PLACE_BITS-1:0] put_place_q;
  reg put_plain_q, put_met_q;
  wire [KINDS-1:0] kind_grant;
  // Only between two packages is it known whether there is room for another.
  rp_round_robin #(.COUNT(KINDS)) kind_turn (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(waits & put_ready_i), .advance_i(!puts_q), .grant_o(kind_grant));
  assign chosen = kind_grant & {KINDS{!puts_q}};
  `ONEHOT_SELECT(place_among, KINDS, PLACE_BITS)
  `ONEHOT_NUMBER(kind_among, KINDS + 1, 2)
  wire [PLACE_BITS-1:0] chosen_place = place_among(chosen, oldest);
  wire [1:0] chosen_kind = kind_among({chosen, 1'b0});   // from 1
  wire [3:0] put_ready_kind = {{3-KINDS{1'b0}}, put_ready_i, 1'b0};
  wire beat_goes = puts_q && put_ready_kind[put_kind_o];
  wire ends = beat_goes && beat_q == LAST_BEAT;
  assign put_valid_o = puts_q;
  always @(posedge clk_i)
    if (!rst_ni) puts_q <= 1'b0;
    else if (!puts_q) puts_q <= |chosen;
    else if (ends) puts_q <= 1'b0;
  always @(posedge clk_i)
    if (!puts_q) begin
      beat_q <= 3'd0;
      put_kind_o <= chosen_kind;
      put_place_q <= chosen_place;
      put_plain_q <= chosen[0] && oldest_plain;
      put_met_q <= oldest_met;
    end else if (beat_goes) begin
      beat_q <= beat_q + 3'd1;
    end

  wire [383:0] put_ray;
  wire [191:0] put_hit;
  wire [58:0] put_triangle;
  rp_ram_1r1w #(.WIDTH(384), .DEPTH(POOL)) rays (
    .clk_i(clk_i),
    .read_i(|chosen),
    .read_address_i(chosen_place),
    .read_data_o(put_ray),
    .write_i(ray_valid_i),
    .write_address_i(ray_place_i),
    .write_data_i(ray_words_i)
  );
  rp_ram_1r1w #(.WIDTH(59), .DEPTH(POOL)) triangles (
    .clk_i(clk_i),
    .read_i(|chosen),
    .read_address_i(chosen_place),
    .read_data_o(put_triangle),
    .write_i(starts),
    .write_address_i(hit_place),
    .write_data_i({number, material[26:0]})
  );
  rp_ram_1r1w #(.WIDTH(192), .DEPTH(POOL)) finishes_of (
    .clk_i(clk_i),
    .read_i(|chosen),
    .read_address_i(chosen_place),
    .read_data_o(put_hit),
    .write_i(finished),
    .write_address_i(finished_place),
    .write_data_i({normal, v, u, t})
  );
  wire [31:0] material_word = material_base_i + {put_triangle[26:0], 5'd0};
  wire [255:0] hit_words = {put_triangle[58:27], material_word, put_hit};
  wire put_met = (MISS_RECORDS != 0 && put_ray[RAY_RETURNS] && !put_ray[RAY_SHADOW]) ? put_met_q : put_ray[RAY_MET];
  wire put_plain = MISS_RECORDS != 0 && put_plain_q;
  wire [1023:0] words = {384'd0, (put_kind_o == 2'd2 || put_plain) ? 256'd0 : hit_words, put_ray[383:RAY_FIRST],
                         put_met, put_ray[RAY_MET-1:0]};
  integer w;
  always @* begin
    put_data_o = 128'd0;
    for (w = 0; w < 4; w = w + 1)
      put_data_o[32*w +: 32] = words[32*record_word(record_i, beat_q, w[1:0]) +: 32];
  end
  function [4:0] record_word;
    input [104:0] record;
    input [2:0] beat;
    input [1:0] number_in;
    reg [159:0] all;
    begin
      all = {55'h7fffffffffffff, record};
      record_word = all[5*{beat, number_in} +: 5];
    end
  endfunction

  // ---- Contributions: one at a time, until its place is free
  wire contribution_freed;
  wire contributes, contributed;                 // it is offered, or has been taken; its place is not free
  wire [PLACE_BITS-1:0] contribution_place;
  generate
    if (SHADING != 0) begin : gen_contributions
      reg contributes_q, contributed_q;
      reg [PLACE_BITS-1:0] place_q;
      assign contributes = contributes_q;
      assign contributed = contributed_q;
      assign contribution_place = place_q;
      wire waiting;
      wire [PLACE_BITS-1:0] next;
      wire reads = waiting && !contributes_q;
      rp_ram_queue #(.WIDTH(PLACE_BITS), .DEPTH(POOL)) queue (
        .clk_i(clk_i),
        .rst_ni(rst_ni),
        .push_i(unblocked),
        .data_i(place),
        .valid_o(waiting),
        .ready_i(reads),
        .data_o(next)
      );
      rp_ram_1r1w #(.WIDTH(128), .DEPTH(POOL)) colors (
        .clk_i(clk_i),
        .read_i(reads),
        .read_address_i(next),
        .read_data_o({contribution_color_o, contribution_pixel_o}),
        .write_i(ray_valid_i),
        .write_address_i(ray_place_i),
        .write_data_i({ray_words_i[RAY_COLOR +: RAY_COLOR_BITS], ray_words_i[RAY_PIXEL +: RAY_PIXEL_BITS]})
      );
      always @(posedge clk_i)
        if (!rst_ni) {contributes_q, contributed_q} <= 2'd0;
        else begin
          contributes_q <= reads || (contributes_q && !contribution_freed);
          contributed_q <= (contribution_valid_o && contribution_ready_i) || (contributed_q && !contribution_freed);
        end
      always @(posedge clk_i) if (reads) place_q <= next;
    end else begin : gen_none
      assign {contributes, contributed, contribution_place} = {2+PLACE_BITS{1'b0}};
      assign {contribution_color_o, contribution_pixel_o} = 128'd0;
      wire unused_ready = &{1'b0, contribution_ready_i, contribution_freed};
    end
  endgenerate
  assign contribution_valid_o = contributes && !contributed;

  // ---- Places that are free: of a package, a contribution, a ray of which nothing is left
  reg put_free_q, put_free_shadow_q;
  always @(posedge clk_i) put_free_q <= rst_ni && ends;
  always @(posedge clk_i) put_free_shadow_q <= put_kind_o == 2'd2;
  reg [PLACE_BITS-1:0] put_free_place_q;
  always @(posedge clk_i) put_free_place_q <= put_place_q;
  assign contribution_freed = contributed && !put_free_q;
  assign drop_freed = !put_free_q && !contributed;
  assign free_valid_o = put_free_q || contributed || (fate_q && drops);
  assign free_place_o = put_free_q ? put_free_place_q : contributed ? contribution_place : place;
  assign free_shadow_o = put_free_q ? put_free_shadow_q : contributed || shadow;
endmodule
`default_nettype wire
