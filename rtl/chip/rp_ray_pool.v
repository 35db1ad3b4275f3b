// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray pool: rays that units have exported and the traverser has not finished, behind a port of 128 bits.
// docs/machine/pools.md gives its cycles.
// Promises: a full pool takes nothing; a ray that stays keeps its place until the traverser frees it; the traverser
// gets each ray once, in the order in which they came; no output depends on an input of the same cycle.
// Must be given: three beats a ray, each as it is until it is taken, the third marked as the last; a place is freed
// once for each ray that was there, after its last beat has been read; depth_limit_i constant while rays come.
`default_nettype none
module rp_ray_pool #(
  parameter integer SIZE = 512,
  parameter integer OVERHEAD = 2,          // cycles of the port for a ray, before its beats
  parameter integer CYCLES_PER_BEAT = 1,
  parameter integer PIPELINED = 0,         // the next ray's overhead runs while the beats of the last one move
  parameter integer CULLING = 0,           // rays without weight are dropped
  parameter integer PLACE_BITS = (SIZE > 1) ? $clog2(SIZE) : 1,
  parameter integer LEVEL_BITS = $clog2(SIZE + 1)
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire [7:0]            depth_limit_i,     // of normal rays: deeper ones are dropped
  // from the units: beats of a ray
  input  wire                  export_valid_i,
  output wire                  export_ready_o,
  input  wire [127:0]          export_data_i,
  input  wire                  export_last_i,
  input  wire [1:0]            export_unit_i,
  // what has become of a ray: the cycle after its last beat
  output reg                   outcome_valid_o,
  output reg                   outcome_kept_o,
  output reg                   outcome_deep_o,    // too deep, whatever its weight
  output reg                   outcome_shadow_o,
  output reg                   outcome_eye_o,     // a normal ray of depth 1
  output reg  [1:0]            outcome_unit_o,
  output reg  [31:0]           outcome_pixel_o,
  // levels, for the controller
  output wire [LEVEL_BITS-1:0] rays_o,
  output wire [LEVEL_BITS-1:0] shadow_rays_o,     // among them
  output wire                  held_up_o,         // a ray that is offered waits for room
  // to the traverser: beats of the oldest ray that it has not had
  output reg                   ray_valid_o,
  input  wire                  ray_ready_i,
  output wire [127:0]          ray_data_o,
  output reg                   ray_last_o,
  output reg  [PLACE_BITS-1:0] ray_place_o,
  // a ray has left the traverser
  input  wire                  free_valid_i,
  input  wire [PLACE_BITS-1:0] free_place_i,
  input  wire                  free_shadow_i,
  // for the report, right two cycles after the last event
  output wire [47:0]           taken_o,           // rays, dropped ones too
  output wire [47:0]           busy_cycles_o      // of the port
);
  generate
    if (SIZE < 1 || SIZE > 1048576) begin : gen_bad_size
      ray_pool_SIZE_must_be_from_1_to_1048576 illegal ();
    end
    if (OVERHEAD < 1 || OVERHEAD > 64 || CYCLES_PER_BEAT < 1 || CYCLES_PER_BEAT > 64) begin : gen_bad_cycles
      ray_pool_OVERHEAD_and_CYCLES_PER_BEAT_must_be_from_1_to_64 illegal ();
    end
    if (PIPELINED < 0 || PIPELINED > 1 || CULLING < 0 || CULLING > 1) begin : gen_bad_mode
      ray_pool_PIPELINED_and_CULLING_must_be_0_or_1 illegal ();
    end
  endgenerate
`include "rp_records.vh"
  localparam integer LONGER = (CYCLES_PER_BEAT > OVERHEAD) ? CYCLES_PER_BEAT : OVERHEAD;
  localparam integer WAIT_BITS = $clog2(LONGER + OVERHEAD);
  localparam integer OVERHEAD_WAIT = OVERHEAD - 1;
  localparam integer BEAT_WAIT = CYCLES_PER_BEAT - 1;
  localparam integer LAST_PLACE = SIZE - 1;

  // ---- The port. Open: a ray has its turn, and its next beat is taken when wait_q is 0. Else the next turn begins
  // wait_q cycles from now at the earliest.
  reg open_q, ahead_q;              // ahead: the turn was given before the ray came
  reg [1:0] beat_q;                 // the next one
  reg [WAIT_BITS-1:0] wait_q;
  reg [LEVEL_BITS-1:0] rays_q, shadow_rays_q;
  wire waits = wait_q != {WAIT_BITS{1'b0}};
  wire full = rays_q == SIZE[LEVEL_BITS-1:0];
  assign export_ready_o = open_q && !waits;
  assign held_up_o = full;
  wire take = export_valid_i && export_ready_o;
  wire last = take && export_last_i;
  // Room that is made in this cycle cannot be taken by another ray.
  wire turn = export_valid_i && !open_q && (!full || free_valid_i);

  // The flags and the weight are all in the last beat, of the bits from 256 on.
  wire shadow = export_data_i[RAY_SHADOW-256];
  wire [7:0] depth = export_data_i[RAY_DEPTH-256 +: RAY_DEPTH_BITS];
  wire deep = !shadow && depth > depth_limit_i;
  wire black = CULLING != 0 && {export_data_i[94:64], export_data_i[62:32], export_data_i[30:0]} == 93'd0;
  wire kept = !deep && !black;
  wire keep = last && kept;
  wire ahead = PIPELINED != 0 && !(kept && rays_q == LAST_PLACE[LEVEL_BITS-1:0]);

  wire [WAIT_BITS-1:0] after_ray;   // until the next turn, from the cycle after the last beat on
  generate
    if (PIPELINED != 0) begin : gen_pipelined
      reg [WAIT_BITS-1:0] overhead_q;   // what the ray's first beat leaves of the next ray's overhead
      wire [WAIT_BITS-1:0] overhead_left = (overhead_q == {WAIT_BITS{1'b0}}) ? overhead_q : overhead_q - 1'b1;
      assign after_ray = (overhead_left > BEAT_WAIT[WAIT_BITS-1:0]) ? overhead_left : BEAT_WAIT[WAIT_BITS-1:0];
      always @(posedge clk_i)
        overhead_q <= (take && beat_q == 2'd0) ? OVERHEAD_WAIT[WAIT_BITS-1:0] : overhead_left;
    end else begin : gen_one_by_one
      assign after_ray = BEAT_WAIT[WAIT_BITS-1:0];
    end
  endgenerate

  always @(posedge clk_i)
    if (!rst_ni) begin
      open_q <= 1'b0;
      ahead_q <= 1'b0;
      beat_q <= 2'd0;
      wait_q <= {WAIT_BITS{1'b0}};
    end else begin
      if (turn) begin
        open_q <= 1'b1;
        ahead_q <= 1'b0;
        wait_q <= wait_q + OVERHEAD_WAIT[WAIT_BITS-1:0];
      end else if (last) begin
        open_q <= ahead;
        ahead_q <= ahead;
        beat_q <= 2'd0;
        wait_q <= after_ray;
      end else if (take) begin
        beat_q <= beat_q + 2'd1;
        wait_q <= BEAT_WAIT[WAIT_BITS-1:0];
      end else if (waits) wait_q <= wait_q - 1'b1;
    end

  // ---- What has become of the ray, and levels
  always @(posedge clk_i)
    if (!rst_ni) begin
      outcome_valid_o <= 1'b0;
      rays_q <= {LEVEL_BITS{1'b0}};
      shadow_rays_q <= {LEVEL_BITS{1'b0}};
    end else begin
      outcome_valid_o <= last;
      if (keep != free_valid_i) rays_q <= keep ? rays_q + 1'b1 : rays_q - 1'b1;
      if ((keep && shadow) != (free_valid_i && free_shadow_i))
        shadow_rays_q <= (keep && shadow) ? shadow_rays_q + 1'b1 : shadow_rays_q - 1'b1;
    end
  reg [31:0] pixel_q;
  always @(posedge clk_i) begin
    if (take && beat_q == 2'd1) pixel_q <= export_data_i[RAY_PIXEL-128 +: RAY_PIXEL_BITS];
    if (last) begin
      outcome_kept_o <= kept;
      outcome_deep_o <= deep;
      outcome_shadow_o <= shadow;
      outcome_eye_o <= !shadow && depth == 8'd1;
      outcome_unit_o <= export_unit_i;
      outcome_pixel_o <= pixel_q;
    end
  end
  assign rays_o = rays_q;
  assign shadow_rays_o = shadow_rays_q;

  // ---- Places. The arriving ray is written to the next free one, which is its own once it is kept. All that is about
  // them is a cycle later than the port, since it is known late whether the ray is.
  localparam integer ADDRESS_BITS = $clog2(3 * SIZE);
  reg take_q, keep_q;
  reg [1:0] take_beat_q;
  reg [127:0] take_data_q;
  always @(posedge clk_i) begin
    take_q <= rst_ni && take;
    keep_q <= rst_ni && keep;
    take_beat_q <= beat_q;
    take_data_q <= export_data_i;
  end
  wire [PLACE_BITS-1:0] place, oldest;
  wire place_free, ray_waits;
  wire read, read_last;
  rp_free_list #(.SIZE(SIZE)) free_list (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .valid_o(place_free),
    .ready_i(keep_q),
    .number_o(place),
    .free_i(free_valid_i),
    .free_number_i(free_place_i)
  );
  rp_ram_queue #(.WIDTH(PLACE_BITS), .DEPTH(SIZE)) order (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(keep_q),
    .data_i(place),
    .valid_o(ray_waits),
    .ready_i(read && read_last),
    .data_o(oldest)
  );

  function [ADDRESS_BITS-1:0] address_of(input [PLACE_BITS-1:0] of_place, input [1:0] of_beat);
    begin
      address_of = (of_beat == 2'd0) ? {ADDRESS_BITS{1'b0}}
                 : (of_beat == 2'd1) ? SIZE[ADDRESS_BITS-1:0] : {SIZE[ADDRESS_BITS-2:0], 1'b0};
      address_of = address_of + {{ADDRESS_BITS-PLACE_BITS{1'b0}}, of_place};
    end
  endfunction

  // ---- The traverser's port: the RAM's word is the beat that is offered.
  reg [1:0] read_beat_q;
  wire moves = !ray_valid_o || ray_ready_i;
  assign read = moves && ray_waits;
  assign read_last = read_beat_q == 2'd2;
  rp_ram_1r1w #(.WIDTH(128), .DEPTH(3 * SIZE)) rays (
    .clk_i(clk_i),
    .read_i(read),
    .read_address_i(address_of(oldest, read_beat_q)),
    .read_data_o(ray_data_o),
    .write_i(take_q && place_free),
    .write_address_i(address_of(place, take_beat_q)),
    .write_data_i(take_data_q)
  );
  always @(posedge clk_i)
    if (!rst_ni) begin
      ray_valid_o <= 1'b0;
      read_beat_q <= 2'd0;
    end else begin
      if (moves) ray_valid_o <= ray_waits;
      if (read) read_beat_q <= read_last ? 2'd0 : read_beat_q + 2'd1;
    end
  always @(posedge clk_i)
    if (read) begin
      ray_last_o <= read_last;
      ray_place_o <= oldest;
    end

  // ---- For the report. A turn that was given ahead keeps the port busy from the ray's first beat on.
  wire busy = turn || waits || take || beat_q != 2'd0 || (open_q && !ahead_q);
  wire [25:0] unused;
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) taken (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(last), .value_o(taken_o), .pending_o(unused[12:0]));
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) busy_cycles (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(busy), .value_o(busy_cycles_o), .pending_o(unused[25:13]));
endmodule
`default_nettype wire
