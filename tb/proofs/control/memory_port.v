// What becomes of requests, whatever the memory answers; memory_port_lines has the answers.
// @long 25
// @modules memory_port ram_queue ram_1r1w request_queue event_counter
// @proves nothing is lost, nothing comes twice, the order is kept: any one request, whosever it is, is offered to the
//   memory as it came, after just those that came before, and its second part at once after its first; what is offered
//   stays until it is taken
// @proves no queue overflows: the device is ready if and only if fewer than QUEUE of its requests wait, the traverser
//   whenever fewer than TRAVERSER_QUEUE accesses wait
// @proves nothing is offered within the time of the request before
// @parameters QUEUE=2 TRAVERSER_QUEUE=1 CYCLES_PER_BEAT=1 LINES=1
// @parameters QUEUE=1 TRAVERSER_QUEUE=1 CYCLES_PER_BEAT=2 LINES=1
// @break memory_port s/before_oldest != went_q/1'b1/
// @break memory_port s/before_oldest != went_q/1'b0/
// @break memory_port s/nothing_waits \? !device_request_valid_i/nothing_waits ? traverser_request_valid_i/
// @break memory_port s/device_comes && !device_passes/device_comes \&\& !serve_device/
// @break memory_port s/!\(traverser_passes && !another\)/!traverser_passes/
// @break memory_port s/if \(goes\) went_q/if (serve_traverser \&\& !second_q) went_q/
// @break memory_port s/traverser_waiting == LAST_PLACE/1'b0/
// @break memory_port s/\(traverser_comes != goes\)/(traverser_comes)/
// @break memory_port s/waiting_q != QUEUE/waiting_q <= QUEUE/
// @break memory_port s/&& \(!memory_request_valid_o \|\| memory_request_ready_i\)//
// @break memory_port s/write \? BEAT_WAIT/!write ? BEAT_WAIT/
// @break memory_port s/second_q && write, 4'd0/second_q, 4'd0/
`default_nettype none
module check #(
  parameter QUEUE = 2, parameter TRAVERSER_QUEUE = 2, parameter CYCLES_PER_BEAT = 1, parameter LINES = 1
) (
  input wire clk_i, device_valid, device_write, traverser_valid, traverser_write, traverser_second, memory_ready,
  beat_valid, beat_bit, choose_device, choose_traverser,
  input wire [2:0] device_address, traverser_address, input wire device_bit, input wire [1:0] traverser_bits);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  localparam LINE = 4 * CYCLES_PER_BEAT;

  wire device_ready, traverser_ready, device_back, traverser_back, memory_valid, of_traverser, write, beat_ready;
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
    .device_request_id_i(7'd0), .device_response_valid_o(device_back),
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
    .quiet_o(quiet), .reads_o(unused[47:0]), .writes_o(unused[95:48]), .busy_cycles_o(unused[143:96]));

  wire from_device = rst_n && device_valid && device_ready;
  wire from_traverser = rst_n && traverser_valid && traverser_ready;
  wire takes = rst_n && memory_valid && memory_ready;

  // How many there are: the device's that the memory has not taken; accesses of both.
  reg [2:0] device_q = 0;
  reg [3:0] accesses_q = 0;
  always @(posedge clk_i) begin
    device_q <= device_q + from_device - (takes && !of_traverser);
    accesses_q <= accesses_q + from_device + (from_traverser ? (traverser_second ? 4'd2 : 4'd1) : 4'd0) - takes;
  end

  // Any one request: accesses before it; then its second part, before which there are none.
  reg [1:0] state_q = 0;               // 1: has not been taken, 2: its second part has not
  reg of_q, write_q, second_q, bit_q, second_bit_q;
  reg [2:0] address_q;
  reg [3:0] before_q = 0;
  wire track_device = state_q == 0 && from_device && choose_device;
  wire track_traverser = state_q == 0 && from_traverser && choose_traverser && !track_device;
  wire turn = state_q != 0 && before_q == 0;
  always @(posedge clk_i)
    if (track_device || track_traverser) begin
      state_q <= 1;
      before_q <= accesses_q - takes + (track_traverser && from_device);
      of_q <= track_traverser;
      write_q <= track_device ? device_write : traverser_write;
      second_q <= track_traverser && traverser_second;
      address_q <= track_device ? device_address : traverser_address;
      bit_q <= track_device ? device_bit : traverser_bits[0];
      second_bit_q <= traverser_bits[1];
    end else if (turn && takes) state_q <= (state_q == 1 && second_q) ? 2 : 0;
    else if (state_q != 0 && takes) before_q <= before_q - 1;

  // How long ago the last one was offered.
  reg [3:0] offered_q = 15;
  reg stays_q = 0, last_write_q = 1;
  reg [5:0] stayed_q;
  wire [5:0] shown = {of_traverser, write, address[6:4], data[0]};
  wire new_offer = rst_n && memory_valid && !stays_q;
  always @(posedge clk_i) begin
    stays_q <= rst_n && memory_valid && !memory_ready;
    stayed_q <= shown;
    if (new_offer) begin
      offered_q <= 1;
      last_write_q <= write;
    end else if (offered_q != 15) offered_q <= offered_q + 1;
  end

  wire [2:0] waiting = device_q - (memory_valid && !of_traverser);
  wire [3:0] traverser_waiting = accesses_q - device_q - (memory_valid && of_traverser);
  always @* begin
    assume (!(traverser_second && (traverser_write ? traverser_address[0] : traverser_address[2])));
    if (rst_n) begin
      assert (!memory_valid || accesses_q != 0);
      assert (waiting <= QUEUE);
      assert (device_ready == (waiting < QUEUE));
      assert (traverser_ready || traverser_waiting >= TRAVERSER_QUEUE);
      assert (traverser_waiting <= 2 * TRAVERSER_QUEUE);
      assert (!turn || !memory_valid || {of_traverser, write} == {of_q, write_q});
      assert (!turn || !memory_valid
              || address[6:4] == (state_q == 1 ? address_q : address_q | (write_q ? 3'd1 : 3'd4)));
      assert (!turn || !memory_valid || !write || data[0] == (state_q == 1 ? bit_q : second_bit_q));
      assert (!stays_q || (memory_valid && shown == stayed_q));
      assert (!new_offer || offered_q >= (last_write_q ? CYCLES_PER_BEAT : LINE));
    end
  end
endmodule
`default_nettype wire
