// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Import engine: requests a launch's packages, thread after thread, and writes their beats into the warps' input
// slices. Knows which input slices hold all their packages: full_o.
// Promises: at most two packages are requested and not yet received; one is only requested while its warp's input slice
// is not full; a beat is written in the cycle after its arrival, or with WIDE together with the next one of its
// package: each write has precedence at the memory's port.
// Must be given: for each request taken, in order, as many beats as INTERSECTION_WORDS need (words 4b ..
// 4b+3), any time after; the memory's port whenever write_o is high; no start while active_o is high; take_i only for a
// full slice.
`default_nettype none
module rp_ray_import #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter integer INTERSECTION_WORDS = 21,
  parameter [0:0] WIDE = 1'b0           // two beats are written at a time
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  input  wire                 start_i,           // one cycle; kind 0 starts nothing
  input  wire [1:0]           start_kind_i,
  input  wire [10:0]          start_threads_i,   // 1 .. WARPS*LANES
  output reg                  active_o,          // packages are left to be requested or received
  output reg                  request_valid_o,
  output reg  [1:0]           request_kind_o,
  input  wire                 request_ready_i,
  input  wire                 beat_valid_i,
  input  wire [127:0]         beat_data_i,
  // slices
  input  wire [WARPS*2-1:0]   input_set_i,       // set that is the input of each warp
  output wire [WARPS-1:0]     full_o,
  input  wire                 take_i,            // take_warp_i's packages become current
  input  wire [WARP_BITS-1:0] take_warp_i,
  // ray memory: a package access
  output reg                  write_o,
  output reg  [1:0]           write_set_o,
  output reg  [9:0]           write_thread_o,
  output reg  [4:0]           write_word_o,
  output reg  [7:0]           write_mask_o,
  output reg  [255:0]         write_data_o       // without WIDE the upper half is 0
);
  localparam integer LANE_BITS = $clog2(LANES);
  localparam integer LAST_LANE = LANES - 1;
  localparam integer BEATS = (INTERSECTION_WORDS + 3) / 4;
  localparam integer LAST_BEAT = BEATS - 1;
  localparam [3:0] LAST_MASK = 4'b1111 >> (4 * BEATS - INTERSECTION_WORDS);   // the words that it carries

  reg [10:0] threads_q, requested_q, received_q;
  reg [1:0] outstanding_q;
  reg [2:0] beat_q;
  wire second = WIDE && beat_q[0];         // of the beats that are written together
  wire last = beat_q == LAST_BEAT[2:0];
  wire [3:0] mask = last ? LAST_MASK : 4'b1111;   // of the beat's words
  reg [WARPS-1:0] full_q;
  assign full_o = full_q;

  wire taken = request_valid_o && request_ready_i;
  wire received = beat_valid_i && last;
  wire [10:0] received_next = received_q + 11'd1;
  wire launch_end = received_next == threads_q;
  wire slice_end = (received_q & LAST_LANE[10:0]) == LAST_LANE[10:0] || launch_end;

  wire [10:0] receive_warp = received_q >> LANE_BITS;

  // If the request is not taken, and if it is, which is known late: what has been requested and not received, and
  // whether a package may be requested next.
  wire [10:0] requested_more = requested_q + 11'd1;
  wire [1:0] outstanding = outstanding_q - {1'b0, received};
  wire [1:0] outstanding_more = outstanding + 2'd1;
  wire [10:0] request_warp = requested_q >> LANE_BITS;
  wire [10:0] request_warp_more = requested_more >> LANE_BITS;
  wire requests = requested_q != threads_q && outstanding != 2'd2 && !full_q[request_warp[WARP_BITS-1:0]];
  wire requests_more = requested_more != threads_q && outstanding_more != 2'd2 &&
                       !full_q[request_warp_more[WARP_BITS-1:0]];
  wire unused = &{1'b0, request_warp, request_warp_more, receive_warp};   // the upper bits are 0 where it matters

  always @(posedge clk_i)
    if (!rst_ni) begin
      active_o <= 1'b0;
      request_valid_o <= 1'b0;
      outstanding_q <= 2'd0;
      full_q <= {WARPS{1'b0}};
      write_o <= 1'b0;
    end else begin
      if (start_i && start_kind_i != 2'd0) begin
        active_o <= 1'b1;
        request_kind_o <= start_kind_i;
        threads_q <= start_threads_i;
        requested_q <= 11'd0;
        received_q <= 11'd0;
        beat_q <= 3'd0;
      end
      if (active_o) begin
        if (taken) requested_q <= requested_more;
        outstanding_q <= taken ? outstanding_more : outstanding;
        // A request that waits keeps these conditions: nothing but itself changes them.
        request_valid_o <= taken ? requests_more : requests;
        if (received) begin
          received_q <= received_next;
          if (launch_end) active_o <= 1'b0;
          if (slice_end) full_q[receive_warp[WARP_BITS-1:0]] <= 1'b1;
        end
      end
      if (take_i) full_q[take_warp_i] <= 1'b0;

      write_o <= beat_valid_i && (!WIDE || second || last);
      if (beat_valid_i) begin
        beat_q <= received ? 3'd0 : beat_q + 3'd1;
        write_set_o <= input_set_i[receive_warp[WARP_BITS-1:0]*2 +: 2];
        write_thread_o <= received_q[9:0];
        write_word_o <= {beat_q[2:1], beat_q[0] && !WIDE, 2'b00};
        write_mask_o <= second ? {mask, 4'b1111} : {4'b0000, mask};
      end
    end

  always @(posedge clk_i)
    if (beat_valid_i) begin
      if (!second) write_data_o[127:0] <= beat_data_i;
      if (!WIDE) write_data_o[255:128] <= 128'd0;
      else if (second) write_data_o[255:128] <= beat_data_i;
    end
endmodule
`default_nettype wire
