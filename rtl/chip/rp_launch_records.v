// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the kernels of a compute unit may still export. Each launch has a record until everything that its kernel has
// exported has left the unit: the unit itself reports how many packages there are when the kernel ends.
// docs/machine/controller.md. Promises: what it shows is never less than what kernels may still export, and exact when
// nothing is on record; all outputs are registers, and follow an event by a cycle, or a record's end by two. Must be
// given: no launch while full_o; the packages of a unit in the order in which it has counted them.
`default_nettype none
module rp_launch_records #(
  parameter integer CONTENTS = 64,                    // threads of a full kernel
  parameter integer EXPORT_BITS = 16,                 // of the unit's count: it has fewer than half of 2^this packages
  parameter integer THREAD_BITS = $clog2(CONTENTS + 1),
  parameter integer COUNT_BITS = $clog2(4 * CONTENTS + 1)
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  // a kernel is launched that may export so many rays
  input  wire                   launch_valid_i,
  input  wire [THREAD_BITS-1:0] launch_normal_i,
  input  wire [THREAD_BITS-1:0] launch_shadow_i,
  // packages have left the unit
  input  wire                   ray_valid_i,
  input  wire                   ray_shadow_i,
  input  wire                   contribution_valid_i,
  // the oldest kernel that runs has ended, and the unit has counted so many packages, modulo 2^EXPORT_BITS
  input  wire                   ended_valid_i,
  input  wire [EXPORT_BITS-1:0] ended_exports_i,
  output wire                   full_o,
  output wire                   empty_o,
  output reg  [COUNT_BITS-1:0]  normal_o,             // rays that may still come, at most
  output reg  [COUNT_BITS-1:0]  shadow_o              // shadow rays, likewise
);
  localparam integer RECORDS = 4;
  localparam [THREAD_BITS-1:0] NONE = {THREAD_BITS{1'b0}};
  localparam [THREAD_BITS-1:0] ONE = 1;
  localparam [COUNT_BITS-1:0] ONE_RAY = 1;
  localparam [EXPORT_BITS-1:0] NO_EXPORT = 0, ONE_EXPORT = 1;

  // Oldest first.
  reg [RECORDS-1:0] used_q, ended_q;
  reg [RECORDS*THREAD_BITS-1:0] normal_q, shadow_q;
  reg [RECORDS*EXPORT_BITS-1:0] mark_q;
  reg [EXPORT_BITS-1:0] left_q;

  // A record is drained when all exports of its kernel have left: nothing that leaves now is of it. The first one goes.
  reg [RECORDS-1:0] drained;
  reg [EXPORT_BITS-1:0] beyond;
  // Which record a ray is of, and which kernel ends.
  reg [RECORDS-1:0] of_normal, of_shadow, ends;
  reg found_normal, found_shadow, found_end;
  integer i;
  always @* begin
    found_normal = 1'b0;
    found_shadow = 1'b0;
    found_end = 1'b0;
    for (i = 0; i < RECORDS; i = i + 1) begin
      beyond = left_q - mark_q[i*EXPORT_BITS +: EXPORT_BITS];
      drained[i] = used_q[i] && ended_q[i] && !beyond[EXPORT_BITS-1];
      of_normal[i] = used_q[i] && !drained[i] && !found_normal && normal_q[i*THREAD_BITS +: THREAD_BITS] != NONE;
      of_shadow[i] = used_q[i] && !drained[i] && !found_shadow && shadow_q[i*THREAD_BITS +: THREAD_BITS] != NONE;
      ends[i] = used_q[i] && !ended_q[i] && !found_end;
      found_normal = found_normal || of_normal[i];
      found_shadow = found_shadow || of_shadow[i];
      found_end = found_end || ends[i];
    end
  end
  wire gone = drained[0];
  wire normal_left = ray_valid_i && !ray_shadow_i, shadow_left = ray_valid_i && ray_shadow_i;
  assign full_o = used_q[RECORDS-1];
  assign empty_o = !used_q[0];

  // What each is after this cycle's events, and, where the first one goes, moved up.
  reg [RECORDS:0] used, ended;
  reg [(RECORDS+1)*THREAD_BITS-1:0] normal, shadow;
  reg [(RECORDS+1)*EXPORT_BITS-1:0] mark;
  reg free_before;
  always @* begin
    used = {1'b0, used_q};
    ended = {1'b0, ended_q};
    normal = {NONE, normal_q};
    shadow = {NONE, shadow_q};
    mark = {NO_EXPORT, mark_q};
    free_before = 1'b0;
    for (i = 0; i < RECORDS; i = i + 1) begin
      if (normal_left && of_normal[i])
        normal[i*THREAD_BITS +: THREAD_BITS] = normal_q[i*THREAD_BITS +: THREAD_BITS] - ONE;
      if (shadow_left && of_shadow[i])
        shadow[i*THREAD_BITS +: THREAD_BITS] = shadow_q[i*THREAD_BITS +: THREAD_BITS] - ONE;
      if (ended_valid_i && ends[i]) begin
        ended[i] = 1'b1;
        mark[i*EXPORT_BITS +: EXPORT_BITS] = ended_exports_i;
      end
      if (launch_valid_i && !used_q[i] && !free_before) begin
        used[i] = 1'b1;
        ended[i] = 1'b0;
        normal[i*THREAD_BITS +: THREAD_BITS] = launch_normal_i;
        shadow[i*THREAD_BITS +: THREAD_BITS] = launch_shadow_i;
      end
      free_before = free_before || !used_q[i];
    end
    if (gone) begin
      used = used >> 1;
      ended = ended >> 1;
      normal = normal >> THREAD_BITS;
      shadow = shadow >> THREAD_BITS;
      mark = mark >> EXPORT_BITS;
    end
  end
  wire unused = &{1'b0, beyond[EXPORT_BITS-2:0], used[RECORDS], ended[RECORDS],
                  normal[RECORDS*THREAD_BITS +: THREAD_BITS], shadow[RECORDS*THREAD_BITS +: THREAD_BITS],
                  mark[RECORDS*EXPORT_BITS +: EXPORT_BITS]};

  localparam integer WIDER = COUNT_BITS - THREAD_BITS;
  wire [COUNT_BITS-1:0] more_normal = launch_valid_i ? {{WIDER{1'b0}}, launch_normal_i} : {COUNT_BITS{1'b0}};
  wire [COUNT_BITS-1:0] more_shadow = launch_valid_i ? {{WIDER{1'b0}}, launch_shadow_i} : {COUNT_BITS{1'b0}};
  wire [COUNT_BITS-1:0] gone_normal = gone ? {{WIDER{1'b0}}, normal_q[THREAD_BITS-1:0]} : {COUNT_BITS{1'b0}};
  wire [COUNT_BITS-1:0] gone_shadow = gone ? {{WIDER{1'b0}}, shadow_q[THREAD_BITS-1:0]} : {COUNT_BITS{1'b0}};
  always @(posedge clk_i)
    if (!rst_ni) begin
      used_q <= {RECORDS{1'b0}};
      left_q <= NO_EXPORT;
      normal_o <= {COUNT_BITS{1'b0}};
      shadow_o <= {COUNT_BITS{1'b0}};
    end else begin
      used_q <= used[RECORDS-1:0];
      left_q <= left_q + (ray_valid_i ? ONE_EXPORT : NO_EXPORT) + (contribution_valid_i ? ONE_EXPORT : NO_EXPORT);
      normal_o <= normal_o + more_normal - gone_normal - (normal_left && found_normal ? ONE_RAY : {COUNT_BITS{1'b0}});
      shadow_o <= shadow_o + more_shadow - gone_shadow - (shadow_left && found_shadow ? ONE_RAY : {COUNT_BITS{1'b0}});
    end
  always @(posedge clk_i) begin
    ended_q <= ended[RECORDS-1:0];
    normal_q <= normal[RECORDS*THREAD_BITS-1:0];
    shadow_q <= shadow[RECORDS*THREAD_BITS-1:0];
    mark_q <= mark[RECORDS*EXPORT_BITS-1:0];
  end
endmodule
`default_nettype wire
