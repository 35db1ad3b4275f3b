// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Export engine: takes warps' output slices in the order in which they are pushed, reads the masked lanes' packages in
// rising order, four words a cycle, and offers them on the ray-pool port (words 0 .. 11, three beats) or the
// frame-buffer port (words 7 .. 10, one).
// Promises: a beat every cycle as long as the port takes it and the memory grants; a slice is
// busy until its last word has been read.
// Must be given: a push after the park of the same rout or rfb, and only while the warp is not busy.
`default_nettype none
module rp_ray_export #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  // a rout or rfb has arrived: which lanes it will export where
  input  wire                 park_i,
  input  wire [WARP_BITS-1:0] park_warp_i,
  input  wire                 park_frame_i,
  input  wire [LANES-1:0]     park_mask_i,
  // it is executed: its slice is the output from the next cycle on. The mask must not have been empty.
  input  wire                 push_i,
  input  wire [WARP_BITS-1:0] push_warp_i,
  input  wire [WARPS*2-1:0]   output_set_i,      // set that is the output of each warp
  output wire [WARPS-1:0]     busy_o,            // slices that wait or are being read
  output wire                 exporting_o,       // something waits, is being read or offered
  // ray memory: a package access
  output wire                 read_o,
  output wire [1:0]           read_set_o,
  output wire [9:0]           read_thread_o,
  output wire [4:0]           read_word_o,
  input  wire                 read_grant_i,
  input  wire [3*128-1:0]     memory_data_i,     // of each set, in the cycle after the grant
  // ports
  output wire                 export_valid_o,
  input  wire                 export_ready_i,
  output wire [127:0]         export_data_o,
  output wire                 export_last_o,
  output wire                 frame_valid_o,
  input  wire                 frame_ready_i,
  output wire [31:0]          frame_pixel_o,
  output wire [95:0]          frame_color_o
);
  localparam integer LANE_BITS = $clog2(LANES);
  localparam integer PLACES = 1 << WARP_BITS;
  localparam [LANES-1:0] ONE = 1;
  localparam [WARP_BITS:0] NEXT_PLACE = 1;

  function [4:0] lowest;   // of the lanes that are set
    input [LANES-1:0] lanes;
    integer l;
    begin
      lowest = 5'd0;
      for (l = LANES - 1; l >= 0; l = l - 1)
        if (lanes[l]) lowest = l[4:0];
    end
  endfunction

  // ---- Masks. A warp's next rout may arrive while the one before is exported, so each warp has two
  // places; slot_q is that of the next one.
  reg [WARPS-1:0] slot_q, busy_q;
  reg [PLACES*WARP_BITS-1:0] order_q;          // warps in the order of their pushes
  reg [WARP_BITS:0] first_q, end_q;            // a bit wider than a place, so that full and empty differ
  wire [WARP_BITS-1:0] first_warp = order_q[first_q[WARP_BITS-1:0]*WARP_BITS +: WARP_BITS];
  wire take_first, load;
  wire next_frame;
  wire [LANES-1:0] next_mask;
  rp_ram_1r1w #(.WIDTH(LANES + 1), .DEPTH(2 * PLACES)) u_masks (
    .clk_i(clk_i),
    .read_i(take_first),
    .read_address_i({!slot_q[first_warp], first_warp}),
    .read_data_o({next_frame, next_mask}),
    .write_i(park_i),
    .write_address_i({slot_q[park_warp_i], park_warp_i}),
    .write_data_i({park_frame_i, park_mask_i})
  );

  // ---- The slice after the one that is read: its mask is at the memory's output.
  reg next_q;
  reg [WARP_BITS-1:0] next_warp_q;
  assign take_first = first_q != end_q && (!next_q || load);

  // ---- The slice that is read.
  reg slice_q, frame_q;
  reg [WARP_BITS-1:0] warp_q;
  reg [1:0] set_q;
  reg [4:0] lane_q;
  reg [LANES-1:0] rest_q;                      // lanes after lane_q
  reg [1:0] beat_q;
  // Up to three beats wait for their port, and one may be on its way from the memory: enough for a beat a cycle.
  reg landing_q, landing_frame_q, landing_last_q;
  reg [1:0] landing_set_q;
  reg [1:0] fill_q;
  reg [129:0] beat_0_q, beat_1_q, beat_2_q;    // {frame, last, data}; 0 is offered

  wire room = {1'b0, fill_q} + {2'd0, landing_q} != 3'd3;
  wire granted = read_o && read_grant_i;
  wire package_end = frame_q || beat_q == 2'd2;
  wire slice_end = granted && package_end && rest_q == {LANES{1'b0}};
  assign load = next_q && (!slice_q || slice_end);
  assign busy_o = busy_q;
  assign exporting_o = |busy_q || landing_q || fill_q != 2'd0;
  assign read_o = slice_q && room;
  assign read_set_o = set_q;
  assign read_thread_o = ({{10-WARP_BITS{1'b0}}, warp_q} << LANE_BITS) | {5'd0, lane_q};
  assign read_word_o = frame_q ? 5'd7 : {1'b0, beat_q, 2'b00};

  always @(posedge clk_i)
    if (!rst_ni) begin
      slot_q <= {WARPS{1'b0}};
      busy_q <= {WARPS{1'b0}};
      first_q <= {WARP_BITS+1{1'b0}};
      end_q <= {WARP_BITS+1{1'b0}};
      next_q <= 1'b0;
      slice_q <= 1'b0;
    end else begin
      if (slice_end) busy_q[warp_q] <= 1'b0;
      if (push_i) begin
        order_q[end_q[WARP_BITS-1:0]*WARP_BITS +: WARP_BITS] <= push_warp_i;
        end_q <= end_q + NEXT_PLACE;
        slot_q[push_warp_i] <= !slot_q[push_warp_i];
        busy_q[push_warp_i] <= 1'b1;
      end

      next_q <= take_first || (next_q && !load);
      if (take_first) begin
        next_warp_q <= first_warp;
        first_q <= first_q + NEXT_PLACE;
      end

      slice_q <= load || (slice_q && !slice_end);
      if (load) begin
        frame_q <= next_frame;
        warp_q <= next_warp_q;
        set_q <= output_set_i[next_warp_q*2 +: 2];
        lane_q <= lowest(next_mask);
        rest_q <= next_mask & (next_mask - ONE);
        beat_q <= 2'd0;
      end else if (granted) begin
        beat_q <= package_end ? 2'd0 : beat_q + 2'd1;
        if (package_end) begin
          lane_q <= lowest(rest_q);
          rest_q <= rest_q & (rest_q - ONE);
        end
      end
    end

  // ---- Beats that wait
  wire sent = fill_q != 2'd0 && (beat_0_q[129] ? frame_ready_i : export_ready_i);
  wire [1:0] fill_left = fill_q - {1'b0, sent};
  wire [129:0] landed = {landing_frame_q, landing_last_q, landing_set_q == 2'd0 ? memory_data_i[127:0] :
                         landing_set_q == 2'd1 ? memory_data_i[255:128] : memory_data_i[383:256]};
  always @(posedge clk_i) begin
    if (!rst_ni) begin
      landing_q <= 1'b0;
      fill_q <= 2'd0;
    end else begin
      landing_q <= granted;
      fill_q <= fill_left + {1'b0, landing_q};
    end
    if (granted) begin
      landing_frame_q <= frame_q;
      landing_last_q <= package_end;
      landing_set_q <= set_q;
    end
    if (sent) begin
      beat_0_q <= beat_1_q;
      beat_1_q <= beat_2_q;
    end
    if (landing_q)
      case (fill_left)
        2'd0: beat_0_q <= landed;
        2'd1: beat_1_q <= landed;
        default: beat_2_q <= landed;
      endcase
  end

  assign export_valid_o = fill_q != 2'd0 && !beat_0_q[129];
  assign export_last_o = beat_0_q[128];
  assign export_data_o = beat_0_q[127:0];
  assign frame_valid_o = fill_q != 2'd0 && beat_0_q[129];
  assign frame_pixel_o = beat_0_q[31:0];
  assign frame_color_o = beat_0_q[127:32];
endmodule
`default_nettype wire
