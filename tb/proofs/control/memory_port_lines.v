// What becomes of the memory's answers, and that requests go on; memory_port has their order. The device's ids are made
// of the addresses, so that the memory sees them.
// @long 50
// @modules memory_port ram_queue ram_1r1w request_queue event_counter
// @proves beats are handed on unchanged, in their order, to the requester of the line and with its id and their number,
//   CYCLES_PER_BEAT cycles apart at least; no more than LINES lines are on their way
// @proves no requester starves: while lines may be on their way, the next request is offered within 4 CYCLES_PER_BEAT
//   cycles, and a beat that is there is handed on within CYCLES_PER_BEAT
// @proves a unit is quiet if and only if none of its requests waits or is on its way, and the port is idle if and only
//   if no request does
// @parameters QUEUE=1 TRAVERSER_QUEUE=1 CYCLES_PER_BEAT=2 LINES=1
// @parameters QUEUE=1 TRAVERSER_QUEUE=1 CYCLES_PER_BEAT=1 LINES=1
// @break memory_port s/lines_left = lines_q != .*;/lines_left = 1'b1;/
// @break memory_port s/memory_beat_ready_o = beats != 2'd2/memory_beat_ready_o = beats != 2'd3/
// @break memory_port s/^    .data_i\(\{traverser_turn/    .data_i({traverser_waits/
// @break memory_port s/line_ends = hand_on && beat_q == 2'd3/line_ends = hand_on \&\& beat_q == 2'd2/
// @break memory_port s/read_ends = line_ends/read_ends = hand_on/
// @break memory_port s/came_q == went_q && lines_q == .LINES_BITS.1'b0.. &&/came_q == went_q \&\&/
// @break memory_port s/came_q == went_q && lines_q/lines_q/
// @break memory_port s/write_ends = written/write_ends = serve_device \&\& write/
// @break memory_port s/unit_q <= device_id/unit_q <= device_request_id_i/
// @break memory_port s/else if \(wait_q != /else if (memory_request_ready_i \&\& wait_q != /
`default_nettype none
module check #(
  parameter QUEUE = 1, parameter TRAVERSER_QUEUE = 1, parameter CYCLES_PER_BEAT = 1, parameter LINES = 1
) (
  input wire clk_i, device_valid, device_write, traverser_valid, traverser_write, traverser_second, memory_ready,
  beat_valid, beat_bit, choose_line, choose_beat,
  input wire [2:0] device_address, traverser_address, input wire device_bit, input wire [1:0] traverser_bits,
  input wire [1:0] any_unit);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  localparam LINE = 4 * CYCLES_PER_BEAT;

  wire idle, device_ready, traverser_ready, device_back, traverser_back, memory_valid, of_traverser, write, beat_ready;
  wire [6:0] back_id;
  wire [1:0] device_beat, traverser_beat;
  wire [127:0] device_data, traverser_data, data;
  wire [31:0] address;
  wire [3:0] quiet, mask;
  wire [143:0] unused;
  rp_memory_port #(.QUEUE(QUEUE), .TRAVERSER_QUEUE(TRAVERSER_QUEUE), .CYCLES_PER_BEAT(CYCLES_PER_BEAT),
                .LINES(LINES)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .device_request_valid_i(device_valid), .device_request_ready_o(device_ready),
    .device_request_write_i(device_write), .device_request_address_i({25'd0, device_address, 4'd0}),
    .device_request_data_i({127'd0, device_bit}), .device_request_mask_i(4'd0),
    .device_request_id_i({device_address[1:0], 4'd0, device_address[2]}), .device_response_valid_o(device_back),
    .device_response_id_o(back_id), .device_response_beat_o(device_beat), .device_response_data_o(device_data),
    .traverser_request_valid_i(traverser_valid), .traverser_request_ready_o(traverser_ready),
    .traverser_request_write_i(traverser_write), .traverser_request_second_i(traverser_second),
    .traverser_request_address_i({25'd0, traverser_address, 4'd0}),
    .traverser_request_data_i({127'd0, traverser_bits[1], 127'd0, traverser_bits[0]}),
    .traverser_response_valid_o(traverser_back), .traverser_response_beat_o(traverser_beat),
    .traverser_response_data_o(traverser_data), .memory_request_valid_o(memory_valid),
    .memory_request_ready_i(memory_ready), .memory_request_traverser_o(of_traverser), .memory_request_write_o(write),
    .memory_request_address_o(address), .memory_request_data_o(data), .memory_request_mask_o(mask),
    .memory_beat_valid_i(beat_valid), .memory_beat_ready_o(beat_ready), .memory_beat_data_i({127'd0, beat_bit}),
    .quiet_o(quiet), .idle_o(idle), .reads_o(unused[47:0]), .writes_o(unused[95:48]), .busy_cycles_o(unused[143:96]));

  wire from_device = rst_n && device_valid && device_ready;
  wire from_traverser = rst_n && traverser_valid && traverser_ready;
  wire takes = rst_n && memory_valid && memory_ready;
  wire comes = rst_n && beat_valid && beat_ready;
  wire goes = rst_n && (device_back || traverser_back);
  wire takes_line = takes && !write;
  wire [6:0] shown_id = {address[5:4], 4'd0, address[6]};

  // How many there are: accesses that the memory has not taken; beats that it owes, and that have not been handed on.
  reg [2:0] accesses_q = 0;
  reg [3:0] owed_q = 0, beats_q = 0;
  wire [3:0] new_beats = takes_line ? 4'd4 : 4'd0;
  always @(posedge clk_i) begin
    accesses_q <= accesses_q + from_device + (from_traverser ? (traverser_second ? 3'd2 : 3'd1) : 3'd0) - takes;
    owed_q <= owed_q + new_beats - comes;
    beats_q <= beats_q + new_beats - goes;
  end
  wire [3:0] held = beats_q - owed_q;
  wire [1:0] lines = (beats_q + 4'd3) >> 2;

  // Any one line: beats before its first; its own.
  reg line_q = 0, of_q, id_bit_q;
  reg [1:0] unit_q, own_q;
  reg [3:0] before_q;
  wire own = line_q && before_q == 0;
  always @(posedge clk_i)
    if (!line_q && takes_line && choose_line) begin
      line_q <= 1;
      own_q <= 0;
      before_q <= beats_q - goes;
      of_q <= of_traverser;
      {unit_q, id_bit_q} <= {shown_id[6:5], shown_id[0]};
    end else if (own && goes) begin
      own_q <= own_q + 1;
      if (own_q == 3) line_q <= 0;
    end else if (line_q && goes) before_q <= before_q - 1;

  // Any one beat.
  reg beat_q = 0, value_q;
  reg [1:0] beat_before_q;
  always @(posedge clk_i)
    if (!beat_q && comes && choose_beat) begin
      beat_q <= 1;
      value_q <= beat_bit;
      beat_before_q <= held - goes;
    end else if (beat_q && goes) begin
      beat_q <= beat_before_q != 0;
      beat_before_q <= beat_before_q - 1;
    end

  // Any one unit: requests of it.
  reg [1:0] chosen_q;
  reg chosen = 0;
  reg [2:0] pending_q = 0;
  always @(posedge clk_i) begin
    chosen <= 1;
    if (!chosen) chosen_q <= any_unit;
    pending_q <= pending_q + (from_device && device_address[1:0] == chosen_q)
               - (takes && write && !of_traverser && shown_id[6:5] == chosen_q)
               - (goes && device_back && device_beat == 2'd3 && back_id[6:5] == chosen_q);
  end

  // How long ago the last beat was handed on; how long nothing has been offered, and none handed on.
  reg [3:0] beat_age_q = 15, idle_q = 0, beat_idle_q = 0;
  always @(posedge clk_i) begin
    if (goes) beat_age_q <= 1;
    else if (beat_age_q != 15) beat_age_q <= beat_age_q + 1;
    idle_q <= (accesses_q != 0 && !memory_valid && lines < LINES) ? idle_q + 1 : 0;
    beat_idle_q <= (held != 0 && !goes) ? beat_idle_q + 1 : 0;
  end

  always @* begin
    assume (!(traverser_second && (traverser_write ? traverser_address[0] : traverser_address[2])));
    assume (!beat_valid || owed_q != 0 || takes_line);
    if (rst_n) begin
      assert (held <= 2);
      assert (beat_ready == (held != 2));
      assert (!(device_back && traverser_back));
      assert (!goes || held != 0);
      assert (!goes || beat_age_q >= CYCLES_PER_BEAT);
      assert (!(own && goes) || traverser_back == of_q);
      assert (!(own && goes) || (of_q ? traverser_beat : device_beat) == own_q);
      assert (!(own && goes) || of_q || {back_id[6:5], back_id[0]} == {unit_q, id_bit_q});
      assert (!(beat_q && beat_before_q == 0 && goes) || (device_back ? device_data[0] : traverser_data[0]) == value_q);
      assert (lines + (memory_valid && !write) <= LINES);
      assert (idle_q <= LINE);
      assert (beat_idle_q <= CYCLES_PER_BEAT);
      assert (quiet[chosen_q] == (pending_q == 0));
      assert (idle == (accesses_q == 0 && beats_q == 0));
    end
  end
endmodule
`default_nettype wire
