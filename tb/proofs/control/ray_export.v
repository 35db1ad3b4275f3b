// Four warps of two lanes. A warp's output set stays while its slice is busy.
// @modules ray_export ram_1r1w
// @proves slices are read in the order of their pushes: none lost, none twice, busy_o until the last word
// @proves of a slice exactly the masked lanes are read, in rising order: words 0, 4 and 8
//   for the pool, 7 for the frame buffer
// @proves what is read is offered on its port, in order: nothing lost, nothing twice;
//   what is offered stays until it is taken
// @proves while memory and ports are willing, no more than 4 cycles pass without a read or a beat
// @zeros
// @slow
// @break ray_export s/fill_q\} \+ \{2'd0, landing_q\} != 3'd3/fill_q} != 3'd3/
// @break ray_export s/first_q <= first_q \+ NEXT_PLACE/first_q <= first_q/
// @break ray_export s/\{!slot_q\[first_warp\], first_warp\}/{slot_q[first_warp], first_warp}/
// @break ray_export s/rest_q <= rest_q & \(rest_q - ONE\)/rest_q <= rest_q/
// @break ray_export s/beat_0_q <= beat_1_q/beat_0_q <= beat_2_q/
// @break ray_export s/next_q <= take_first \|\| \(next_q && !load\)/next_q <= take_first/
`default_nettype none
module check (
  input wire clk_i, park_i, frame_i, push_i, grant_i, export_ready_i, frame_ready_i, choose_i, choose_beat_i,
  input wire [1:0] park_warp_i, push_warp_i, mask_i, input wire [7:0] sets_i, input wire [5:0] memory_i
);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [3:0] busy;
  wire exporting, read, export_valid, export_last, frame_valid;
  wire [1:0] set;
  wire [9:0] thread;
  wire [4:0] word;
  wire [127:0] data;
  wire [31:0] pixel;
  wire [95:0] color;
  // Two bits of each set's quadword are enough: the lowest and the highest.
  rp_ray_export #(.WARPS(4), .LANES(2), .WARP_BITS(2)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .park_i(park_i), .park_warp_i(park_warp_i), .park_frame_i(frame_i),
    .park_mask_i(mask_i), .push_i(push_i), .push_warp_i(push_warp_i), .output_set_i(sets_i), .busy_o(busy),
    .exporting_o(exporting), .read_o(read), .read_set_o(set), .read_thread_o(thread), .read_word_o(word),
    .read_grant_i(grant_i),
    .memory_data_i({memory_i[5], 126'd0, memory_i[4],
                    memory_i[3], 126'd0, memory_i[2], memory_i[1], 126'd0, memory_i[0]}),
    .export_valid_o(export_valid), .export_ready_i(export_ready_i), .export_data_o(data), .export_last_o(export_last),
    .frame_valid_o(frame_valid), .frame_ready_i(frame_ready_i),
    .frame_pixel_o(pixel), .frame_color_o(color));

  wire granted = rst_n && read && grant_i;
  wire [1:0] read_warp = thread[2:1];
  wire sent = rst_n && ((export_valid && export_ready_i) || (frame_valid && frame_ready_i));
  // Protocol
  reg [3:0] parked_q = 0, frames_q = 0, busy_q = 0;
  reg [7:0] masks_q = 0, sets_q = 0;
  // One slice
  reg tracked_q = 1'b0, slice_frame_q = 1'b0;
  reg [1:0] slice_warp_q = 0, rest_q = 0, beat_q = 0;
  reg [2:0] before_q = 0;
  wire fallen = (busy_q & ~busy & ~(4'd1 << slice_warp_q)) != 0;    // the slice of another warp has ended
  wire [2:0] before = before_q - fallen;
  wire choose = push_i && choose_i && !tracked_q;
  wire last_beat = slice_frame_q || beat_q == 2;
  wire own = tracked_q && before == 0;
  // One beat
  reg beat_tracked_q = 1'b0, landing_q = 1'b0, last_q = 1'b0, to_frame_q = 1'b0;
  reg [2:0] flight_q = 0, beat_before_q = 0, still_q = 0;
  reg [1:0] beat_set_q = 0, value_q = 0;
  wire choose_beat = granted && choose_beat_i && !beat_tracked_q && own && rest_q != 0;
  reg export_waits_q = 1'b0, frame_waits_q = 1'b0;
  reg [2:0] offer_q = 0;
  wire [2:0] offer = {export_last, data[127], data[0]};
  always @(posedge clk_i)
    if (rst_n) begin
      if (park_i) begin
        parked_q[park_warp_i] <= 1'b1;
        frames_q[park_warp_i] <= frame_i;
        masks_q[park_warp_i*2 +: 2] <= mask_i;
      end
      if (push_i) parked_q[push_warp_i] <= 1'b0;
      busy_q <= busy;
      sets_q <= sets_i;

      if (choose) begin
        tracked_q <= 1'b1;
        slice_warp_q <= push_warp_i;
        slice_frame_q <= frames_q[push_warp_i];
        rest_q <= masks_q[push_warp_i*2 +: 2];
        beat_q <= 0;
        before_q <= busy[0] + busy[1] + busy[2] + busy[3];
      end else if (own && rest_q == 0) tracked_q <= 1'b0;
      else if (tracked_q) begin
        before_q <= before;
        if (own && granted) begin
          beat_q <= last_beat ? 0 : beat_q + 1;
          if (last_beat) rest_q <= rest_q & (rest_q - 1);
        end
      end

      flight_q <= flight_q + granted - sent;
      landing_q <= choose_beat;
      if (choose_beat) begin
        beat_tracked_q <= 1'b1;
        beat_before_q <= flight_q - sent;
        beat_set_q <= set;
        last_q <= last_beat;
        to_frame_q <= slice_frame_q;
      end else if (beat_tracked_q && sent) begin
        beat_tracked_q <= beat_before_q != 0;
        beat_before_q <= beat_before_q - 1;
      end
      if (landing_q) value_q <= memory_i[beat_set_q*2 +: 2];
      export_waits_q <= export_valid && !export_ready_i;
      frame_waits_q <= frame_valid && !frame_ready_i;
      offer_q <= offer;
      still_q <= exporting && grant_i && export_ready_i && frame_ready_i && !granted && !sent ? still_q + 1 : 0;
    end
  integer w;
  always @* begin
    assume (!park_i || (mask_i != 0 && !parked_q[park_warp_i]));
    assume (!push_i || (parked_q[push_warp_i] && !busy[push_warp_i]));
    for (w = 0; w < 4; w = w + 1) begin
      assume (sets_i[w*2 +: 2] != 3);
      assume (!(busy[w] && busy_q[w]) || sets_i[w*2 +: 2] == sets_q[w*2 +: 2]);
    end
    if (rst_n) begin
      assert (!(tracked_q && granted && before != 0) || read_warp != slice_warp_q);
      assert (!(own && granted && rest_q != 0) || read_warp == slice_warp_q);
      assert (!(own && read && rest_q != 0) ||
              (thread[9:3] == 0 && thread[0] == !rest_q[0] && word == (slice_frame_q ? 7 : beat_q * 4) &&
                                                set == sets_i[slice_warp_q*2 +: 2]));
      assert (!tracked_q || busy[slice_warp_q] == (rest_q != 0));
      assert (!read || busy[read_warp]);
      assert (flight_q <= 4 && !(sent && flight_q == 0));
      assert (!(export_valid && frame_valid));
      assert (exporting == (busy != 0 || flight_q != 0));
      assert (!(beat_tracked_q && beat_before_q == 0 && (export_valid || frame_valid)) ||
              (frame_valid == to_frame_q && data[0] == value_q[0] && data[127] == value_q[1] &&
               (to_frame_q || export_last == last_q)));
      assert (data == {color, pixel});
      assert (!export_waits_q || (export_valid && offer == offer_q));
      assert (!frame_waits_q || (frame_valid && offer == offer_q));
      assert (still_q < 5);
    end
  end
endmodule
`default_nettype wire
