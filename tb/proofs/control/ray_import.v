// Two warps of two lanes. Of each word of a beat one bit is carried.
// @long 8
// @modules ray_import
// @proves each package is requested once, of the launch's kind; what is offered stays; two at most are under way, none
//   for a slice that is full; where one may be requested it is, two cycles later
// @proves each beat is written once, in order, in the cycle after its arrival, or with WIDE together with the beat
//   before it: to its thread, its words, the slice's set; nothing else is written
// @proves a slice is full from its last package on until it is taken; the import ends with the launch's last package
// @parameters WIDE=1
// @parameters WIDE=0
// @parameters WIDE=1 WORDS=18
// @parameters WIDE=0 WORDS=16
// @break ray_import s/outstanding_more != 2'd2/outstanding != 2'd2/
// @break ray_import s/!full_q\[request_warp\[/!full_q[receive_warp[/
// @break ray_import s/requested_more != threads_q/requested_q != threads_q/
// @break ray_import s/second = WIDE && beat_q\[0\]/second = WIDE/
// @break ray_import s/\(!WIDE \|\| second \|\| last\)/1'b1/
// @break ray_import s/second \? \{mask, 4'b1111\}/second ? {4'b1111, 4'b1111}/
// @break ray_import s/\{beat_q\[2:1\], beat_q\[0\] && !WIDE, 2'b00\}/{beat_q, 2'b00}/
// @break ray_import s/if \(!second\) write_data_o/if (1'b1) write_data_o/
// @break ray_import s/slice_end = .*launch_end;/slice_end = launch_end;/
// @break ray_import s/beat_q <= received \? 3'd0 : /beat_q <= /
// @break ray_import s/if \(launch_end\) active_o <= 1'b0;/if (slice_end) active_o <= 1'b0;/
// @break ray_import s/if \(take_i\) full_q\[take_warp_i\]/if (take_i) full_q[0]/
`default_nettype none
module check #(parameter [0:0] WIDE = 1'b1, parameter integer WORDS = 21) (
  input wire clk_i, start_i, request_ready_i, beat_valid_i, take_i, take_warp_i, input wire [1:0] start_kind_i,
  input wire [2:0] start_threads_i, input wire [3:0] beat_i, input_set_i
);
  localparam [2:0] LAST_BEAT = (WORDS + 3) / 4 - 1;
  localparam [3:0] LAST_WORDS = 4'b1111 >> ((4 - WORDS % 4) % 4);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;

  wire active, request_valid, write;
  wire [1:0] request_kind, full, write_set;
  wire [9:0] write_thread;
  wire [4:0] write_word;
  wire [7:0] write_mask;
  wire [255:0] write_data;
  rp_ray_import #(.WARPS(2), .LANES(2), .WARP_BITS(1), .INTERSECTION_WORDS(WORDS), .WIDE(WIDE)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .start_i(start_i), .start_kind_i(start_kind_i),
    .start_threads_i({8'd0, start_threads_i}), .active_o(active), .request_valid_o(request_valid),
    .request_kind_o(request_kind), .request_ready_i(request_ready_i), .beat_valid_i(beat_valid_i),
    .beat_data_i({31'd0, beat_i[3], 31'd0, beat_i[2], 31'd0, beat_i[1], 31'd0, beat_i[0]}),
    .input_set_i(input_set_i), .full_o(full), .take_i(take_i), .take_warp_i(take_warp_i), .write_o(write),
    .write_set_o(write_set), .write_thread_o(write_thread), .write_word_o(write_word), .write_mask_o(write_mask),
    .write_data_o(write_data));

  // What a launch has asked for and what it has got.
  reg active_q = 1'b0, offered_q = 1'b0;
  reg [2:0] threads_q = 0, requested_q = 0, received_q = 0, beat_q = 0;
  reg [1:0] kind_q = 0, full_q = 0, may_q = 0;
  wire taken = rst_n && request_valid && request_ready_i;
  wire received = beat_valid_i && beat_q == LAST_BEAT;
  wire may = active_q && requested_q != threads_q && requested_q - received_q < 2 && !full_q[requested_q[1]];
  always @(posedge clk_i) begin
    offered_q <= rst_n && request_valid && !request_ready_i;
    // for how many cycles a request may have been made, with nothing that changed it
    may_q <= !may || taken || beat_valid_i || take_i ? 2'd0 : may_q == 2'd2 ? may_q : may_q + 2'd1;
    if (start_i && start_kind_i != 0) begin
      active_q <= 1'b1;
      kind_q <= start_kind_i;
      threads_q <= start_threads_i;
      requested_q <= 3'd0;
      received_q <= 3'd0;
      beat_q <= 3'd0;
    end
    if (taken) requested_q <= requested_q + 3'd1;
    if (beat_valid_i) beat_q <= received ? 3'd0 : beat_q + 3'd1;
    if (take_i) full_q[take_warp_i] <= 1'b0;
    if (received) begin
      received_q <= received_q + 3'd1;
      if (received_q + 3'd1 == threads_q) active_q <= 1'b0;
      if (received_q[0] || received_q + 3'd1 == threads_q) full_q[received_q[1]] <= 1'b1;
    end
  end

  // The beat of the cycle before, and the one before that of its package.
  reg due_q = 1'b0;
  reg [2:0] number_q;
  reg [1:0] set_q, thread_q;
  reg [3:0] bits_q, before_q;
  always @(posedge clk_i) begin
    due_q <= beat_valid_i && rst_n && (!WIDE || beat_q[0] || beat_q == LAST_BEAT);
    if (beat_valid_i) begin
      number_q <= beat_q;
      thread_q <= received_q[1:0];
      set_q <= received_q[1] ? input_set_i[3:2] : input_set_i[1:0];
      bits_q <= beat_i;
      before_q <= bits_q;
    end
  end
  wire [3:0] low = {write_data[96], write_data[64], write_data[32], write_data[0]};
  wire [3:0] high = {write_data[224], write_data[192], write_data[160], write_data[128]};
  wire [3:0] words = number_q == LAST_BEAT ? LAST_WORDS : 4'b1111;

  always @* begin
    assume (rst_n || !(start_i || beat_valid_i || take_i));
    assume (!start_i || !active);
    assume (start_threads_i >= 1 && start_threads_i <= 4);
    assume (!beat_valid_i || received_q != requested_q);
    assume (!take_i || full[take_warp_i]);
    if (rst_n) begin
      assert (active == active_q && full == full_q);
      assert (!request_valid || active_q && request_kind == kind_q && requested_q != threads_q);
      assert (!request_valid || requested_q - received_q < 2 && !full_q[requested_q[1]]);
      assert (!offered_q || request_valid);
      assert (may_q != 2 || request_valid);
      assert (write == due_q);
      if (due_q) begin
        assert (write_set == set_q && write_thread == {8'd0, thread_q});
        assert (write_word == (WIDE ? {number_q[2:1], 3'b000} : {number_q, 2'b00}));
        assert (write_mask == (WIDE && number_q[0] ? {words, 4'b1111} : {4'b0000, words}));
        assert (WIDE && number_q[0] ? high == bits_q && low == before_q : low == bits_q);
      end
    end
  end
endmodule
`default_nettype wire
