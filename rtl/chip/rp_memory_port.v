// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The chip's memory port: requests of the device and of the traverser go to the memory one by one, in the order in
// which they come, and lines come back. A line keeps the port for four beats, a quadword for one; a beat takes
// CYCLES_PER_BEAT cycles. docs/machine/memory-port.md gives its cycles.
// Promises: requests are served in the order in which they were taken, those of a cycle the device's first; a second
// part follows its first one at once; beats are handed on unchanged, in the order of the requests, CYCLES_PER_BEAT
// cycles apart at least, the first no sooner after its line's service; what is offered to the memory stays until it is
// taken. No output depends on an input of the same cycle.
// Must be given: what is offered stays as it is until it is taken; reads at multiples of 64, or of 128 with a second
// line; writes at multiples of 16, or of 32 with a second quadword; four beats a line, in the order in which the memory
// has taken the reads, from the cycle in which it has. A beat that is offered is always taken.
`default_nettype none
module rp_memory_port #(
  parameter integer QUEUE = 8,             // requests of the device that wait
  parameter integer TRAVERSER_QUEUE = 32,  // and of the traverser
  parameter integer CYCLES_PER_BEAT = 2,
  parameter integer LATENCY = 120,         // of a line, from its service to its last beat: LINES are enough for that
  parameter integer LINES = (LATENCY > 4 * CYCLES_PER_BEAT) ? LATENCY / (4 * CYCLES_PER_BEAT) + 1 : 2
) (
  input  wire         clk_i,
  input  wire         rst_ni,
  // from the device; bits 6:5 of the id are the unit's number, of a write too
  input  wire         device_request_valid_i,
  output wire         device_request_ready_o,
  input  wire         device_request_write_i,
  input  wire [31:0]  device_request_address_i,
  input  wire [127:0] device_request_data_i,
  input  wire [3:0]   device_request_mask_i,        // words that are written
  input  wire [6:0]   device_request_id_i,
  output wire         device_response_valid_o,
  output wire [6:0]   device_response_id_o,
  output wire [1:0]   device_response_beat_o,
  output wire [127:0] device_response_data_o,
  // from the traverser
  input  wire         traverser_request_valid_i,
  output wire         traverser_request_ready_o,
  input  wire         traverser_request_write_i,
  input  wire         traverser_request_second_i,   // and the line, or quadword, behind it
  input  wire [31:0]  traverser_request_address_i,
  input  wire [255:0] traverser_request_data_i,     // the second quadword in the upper half
  output wire         traverser_response_valid_o,   // lines in the order of the requests
  output wire [1:0]   traverser_response_beat_o,
  output wire [127:0] traverser_response_data_o,
  // to the memory, from the cycle after the service on
  output reg          memory_request_valid_o,
  input  wire         memory_request_ready_i,
  output reg          memory_request_traverser_o,   // in the traverser's memory
  output reg          memory_request_write_o,
  output reg  [31:0]  memory_request_address_o,
  output reg  [127:0] memory_request_data_o,
  output reg  [3:0]   memory_request_mask_o,
  input  wire         memory_beat_valid_i,
  output wire         memory_beat_ready_o,
  input  wire [127:0] memory_beat_data_i,
  // of each unit: nothing waits or is on its way
  output wire [3:0]   quiet_o,
  output wire         idle_o,                       // the same of all units and of the traverser
  // for the report, right two cycles after the last event
  output wire [47:0]  reads_o,                      // lines, of the device
  output wire [47:0]  writes_o,                     // quadwords, of the device
  output wire [47:0]  busy_cycles_o
);
  generate
    if (QUEUE < 1 || QUEUE > 64 || TRAVERSER_QUEUE < 1 || TRAVERSER_QUEUE > 1024) begin : gen_bad_queue
      memory_port_QUEUE_must_be_from_1_to_64_and_TRAVERSER_QUEUE_from_1_to_1024 illegal ();
    end
    if (CYCLES_PER_BEAT < 1 || CYCLES_PER_BEAT > 64) begin : gen_bad_cycles
      memory_port_CYCLES_PER_BEAT_must_be_from_1_to_64 illegal ();
    end
    if (LATENCY < 1 || LATENCY > 10000 || LINES < 1 || LINES > 4096) begin : gen_bad_lines
      memory_port_LATENCY_must_be_from_1_to_10000_and_LINES_from_1_to_4096 illegal ();
    end
  endgenerate
  localparam integer QUEUE_BITS = $clog2(QUEUE + 1);
  localparam integer NUMBER_BITS = $clog2(TRAVERSER_QUEUE + 1);
  localparam integer LINES_BITS = $clog2(LINES + 1);
  localparam integer PENDING_BITS = $clog2(QUEUE + LINES + 2);
  localparam integer WAIT_BITS = $clog2(4 * CYCLES_PER_BEAT);
  localparam integer LINE_WAIT = 4 * CYCLES_PER_BEAT - 1;
  localparam integer BEAT_WAIT = CYCLES_PER_BEAT - 1;
  localparam [31:0] LAST_OF_QUEUE = TRAVERSER_QUEUE - 1;
  localparam [NUMBER_BITS-1:0] LAST_PLACE = LAST_OF_QUEUE[NUMBER_BITS-1:0];

  // ---- Arrivals. Requests of the traverser are numbered; each of the device that waits knows how many came before.
  reg [QUEUE_BITS-1:0] waiting_q;              // the device's
  reg [NUMBER_BITS-1:0] came_q, went_q;        // the traverser's, so many in all
  wire [NUMBER_BITS-1:0] traverser_waiting = came_q - went_q;
  assign device_request_ready_o = waiting_q != QUEUE[QUEUE_BITS-1:0];
  // That the queue is full is kept, as the traverser's lanes hear of it.
  reg traverser_full_q;
  assign traverser_request_ready_o = !traverser_full_q;
  wire device_comes = device_request_valid_i && device_request_ready_o;
  wire traverser_comes = traverser_request_valid_i && traverser_request_ready_o;

  localparam integer DEVICE_WIDTH = 1 + 32 + 128 + 4 + 7;
  localparam integer TRAVERSER_WIDTH = 1 + 1 + 32 + 256;
  wire [DEVICE_WIDTH-1:0] device_new = {device_request_write_i, device_request_address_i, device_request_data_i,
                                        device_request_mask_i, device_request_id_i};
  wire [TRAVERSER_WIDTH-1:0] traverser_new = {traverser_request_write_i, traverser_request_second_i,
                                              traverser_request_address_i, traverser_request_data_i};
  wire device_waits, traverser_waits;
  wire [DEVICE_WIDTH-1:0] device_oldest;
  wire [TRAVERSER_WIDTH-1:0] traverser_oldest;
  wire [NUMBER_BITS-1:0] before_oldest;

  // ---- The next to be served. Where nothing waits, what comes is served in the same cycle.
  reg second_q;                                // the oldest of the traverser's has had its first part
  wire nothing_waits = !device_waits && !traverser_waits;
  wire oldest_turn = traverser_waits && (!device_waits || before_oldest != went_q);   // else the device's
  wire traverser_turn = nothing_waits ? !device_request_valid_i : oldest_turn;
  wire write, second, device_write, traverser_write;
  wire [31:0] device_address, traverser_address;
  wire [127:0] device_data;
  wire [255:0] traverser_data;
  wire [3:0] device_mask;
  wire [6:0] device_id;
  wire device_write_waits = device_oldest[DEVICE_WIDTH-1];
  assign {device_write, device_address, device_data, device_mask, device_id} =
    device_waits ? device_oldest : device_new;
  assign {traverser_write, second, traverser_address, traverser_data} =
    traverser_waits ? traverser_oldest : traverser_new;
  assign write = traverser_turn ? traverser_write : device_write;

  reg [WAIT_BITS-1:0] wait_q;                  // cycles until the port is free
  reg [LINES_BITS-1:0] lines_q;                // on their way
  wire port_free = wait_q == {WAIT_BITS{1'b0}} && (!memory_request_valid_o || memory_request_ready_i);
  wire lines_left = lines_q != LINES[LINES_BITS-1:0];
  wire another = second && !second_q;
  // What waits is served whatever comes; and what comes is known late, a unit's request latest.
  wire device_goes = port_free && !oldest_turn && (device_write_waits || lines_left);
  wire traverser_goes = port_free && oldest_turn && (traverser_write || lines_left);
  wire device_passes = port_free && nothing_waits && (device_request_write_i || lines_left);
  wire traverser_passes = port_free && nothing_waits && !device_request_valid_i && (traverser_write || lines_left);
  wire serve_device = (device_waits && device_goes) || (device_request_valid_i && device_passes);
  wire serve_traverser = traverser_goes || (traverser_request_valid_i && traverser_passes);
  wire serve = serve_device || serve_traverser;
  wire serve_line = serve && !write;
  wire goes = serve_traverser && !another;

  rp_ram_queue #(.WIDTH(NUMBER_BITS + DEVICE_WIDTH), .DEPTH(QUEUE)) device_requests (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(device_comes && !device_passes),
    .data_i({came_q, device_new}),
    .valid_o(device_waits),
    .ready_i(device_goes),
    .data_o({before_oldest, device_oldest})
  );
  rp_ram_queue #(.WIDTH(TRAVERSER_WIDTH), .DEPTH(TRAVERSER_QUEUE)) traverser_requests (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(traverser_comes && !(traverser_passes && !another)),
    .data_i(traverser_new),
    .valid_o(traverser_waits),
    .ready_i(traverser_goes && !another),
    .data_o(traverser_oldest)
  );

  always @(posedge clk_i)
    if (!rst_ni) begin
      waiting_q <= {QUEUE_BITS{1'b0}};
      came_q <= {NUMBER_BITS{1'b0}};
      went_q <= {NUMBER_BITS{1'b0}};
      traverser_full_q <= 1'b0;
      second_q <= 1'b0;
      wait_q <= {WAIT_BITS{1'b0}};
    end else begin
      if (device_comes != serve_device) waiting_q <= device_comes ? waiting_q + 1'b1 : waiting_q - 1'b1;
      if (traverser_comes) came_q <= came_q + 1'b1;
      if (traverser_comes != goes) traverser_full_q <= traverser_comes && traverser_waiting == LAST_PLACE;
      if (goes) went_q <= went_q + 1'b1;
      if (serve_traverser) second_q <= another;
      if (serve) wait_q <= write ? BEAT_WAIT[WAIT_BITS-1:0] : LINE_WAIT[WAIT_BITS-1:0];
      else if (wait_q != {WAIT_BITS{1'b0}}) wait_q <= wait_q - 1'b1;
    end

  // ---- To the memory
  reg [1:0] unit_q;
  always @(posedge clk_i)
    if (!rst_ni) memory_request_valid_o <= 1'b0;
    else if (serve) memory_request_valid_o <= 1'b1;
    else if (memory_request_ready_i) memory_request_valid_o <= 1'b0;
  always @(posedge clk_i)
    if (port_free) begin
      memory_request_traverser_o <= traverser_turn;
      memory_request_write_o <= write;
      memory_request_address_o <= traverser_turn
        ? traverser_address | {25'd0, second_q && !write, 1'b0, second_q && write, 4'd0} : device_address;
      memory_request_data_o <= !traverser_turn ? device_data
                             : second_q ? traverser_data[255:128] : traverser_data[127:0];
      memory_request_mask_o <= traverser_turn ? 4'b1111 : device_mask;
      unit_q <= device_id[6:5];
    end
  wire written = memory_request_valid_o && memory_request_ready_i && memory_request_write_o
               && !memory_request_traverser_o;

  // ---- Lines that come back: two places, one is filled while the other one leaves; and their requesters.
  reg [WAIT_BITS-1:0] beat_wait_q;             // cycles until the next beat may be handed on
  reg [1:0] beat_q;                            // its number
  wire beat_waits;
  wire [1:0] beats;
  wire [127:0] beat_data;
  wire line_known, of_traverser;
  wire [6:0] line_id;
  assign memory_beat_ready_o = beats != 2'd2;
  wire hand_on = beat_waits && line_known && beat_wait_q == {WAIT_BITS{1'b0}};
  wire line_ends = hand_on && beat_q == 2'd3;
  rp_request_queue #(.WIDTH(128), .DEPTH(2)) answers (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(memory_beat_valid_i && memory_beat_ready_o),
    .data_i(memory_beat_data_i),
    .valid_o(beat_waits),
    .ready_i(hand_on),
    .data_o(beat_data),
    .count_o(beats)
  );
  rp_ram_queue #(.WIDTH(8), .DEPTH(LINES)) lines (
    .clk_i(clk_i),
    .rst_ni(rst_ni),
    .push_i(serve_line),
    .data_i({traverser_turn, device_id}),
    .valid_o(line_known),
    .ready_i(line_ends),
    .data_o({of_traverser, line_id})
  );
  // A line that begins while no other is on its way counts as a beat: its own first one is apart from that.
  always @(posedge clk_i)
    if (!rst_ni) begin
      beat_wait_q <= {WAIT_BITS{1'b0}};
      beat_q <= 2'd0;
      lines_q <= {LINES_BITS{1'b0}};
    end else begin
      if (hand_on || (serve_line && lines_q == {LINES_BITS{1'b0}})) beat_wait_q <= BEAT_WAIT[WAIT_BITS-1:0];
      else if (beat_wait_q != {WAIT_BITS{1'b0}}) beat_wait_q <= beat_wait_q - 1'b1;
      if (hand_on) beat_q <= beat_q + 2'd1;
      if (serve_line != line_ends) lines_q <= serve_line ? lines_q + 1'b1 : lines_q - 1'b1;
    end
  assign device_response_valid_o = hand_on && !of_traverser;
  assign device_response_id_o = line_id;
  assign device_response_beat_o = beat_q;
  assign device_response_data_o = beat_data;
  assign traverser_response_valid_o = hand_on && of_traverser;
  assign traverser_response_beat_o = beat_q;
  assign traverser_response_data_o = beat_data;

  // ---- Requests of each unit that wait or are on their way: a write until the memory has taken it, a line until its
  // last beat.
  genvar u;
  generate
    for (u = 0; u < 4; u = u + 1) begin : gen_unit
      localparam [1:0] UNIT = u;
      reg [PENDING_BITS-1:0] pending_q;
      wire comes = device_comes && device_request_id_i[6:5] == UNIT;
      wire write_ends = written && unit_q == UNIT;
      wire read_ends = line_ends && !of_traverser && line_id[6:5] == UNIT;
      assign quiet_o[u] = pending_q == {PENDING_BITS{1'b0}};
      always @(posedge clk_i)
        if (!rst_ni) pending_q <= {PENDING_BITS{1'b0}};
        else pending_q <= pending_q + {{PENDING_BITS-1{1'b0}}, comes} - {{PENDING_BITS-1{1'b0}}, write_ends}
                        - {{PENDING_BITS-1{1'b0}}, read_ends};
    end
  endgenerate

  assign idle_o = waiting_q == {QUEUE_BITS{1'b0}} && came_q == went_q && lines_q == {LINES_BITS{1'b0}} &&
                  !memory_request_valid_o;

  // ---- For the report
  wire [38:0] unused;
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) reads (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(serve_device && !write), .value_o(reads_o),
    .pending_o(unused[12:0]));
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) writes (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(serve_device && write), .value_o(writes_o),
    .pending_o(unused[25:13]));
  rp_event_counter #(.EVENT_BITS(1), .LATE(1)) busy_cycles (
    .clk_i(clk_i), .rst_ni(rst_ni), .event_i(serve || wait_q != {WAIT_BITS{1'b0}}), .value_o(busy_cycles_o),
    .pending_o(unused[38:26]));
endmodule
`default_nettype wire
