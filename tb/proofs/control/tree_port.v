// The requests that the traverser's port takes over, what it asks the memory for, and the requesters of the lines that
// come. Nodes lie in lines 0 and 1, triangles in 2 to 4, stacks from 8 on; numbers of lines that the caches ask for may
// lie beyond.
// @modules tree_port round_robin ram_queue ram_1r1w
// @proves a requester that is heard has asked, alone; what is offered in the next cycle is that one's request, at its
//   place, and stays until it is taken; what lies beyond the tree, and a stack's last block, is not offered but a
//   fault, with its source and line; while a fault is reported, and from stop_i on, none is heard
// @proves no requester starves: a cache is passed by two others at most, a lane's stack by two before each lane's turn
//   and its own; the port is not idle while a requester asks
// @proves each line is given once, unchanged and in order, to the cache or lane that asked for it, with its id, or the
//   half of it that the block lies in, and stays until a cache takes it
// @break tree_port /heard_turn/,/grant_o/ s/takes && grant\[2\]/takes/
// @break tree_port /stack_turn/,/grant_o/ s/takes && grant\[2\]/takes/
// @break tree_port s/fault_source_o == TRIANGLES\) \?/1'b0) ?/
// @break tree_port s/half_q <= writes && block/half_q <= block/
// @break tree_port s/free = !request_valid_o \|\| request_ready_i/free = 1'b1/
// @break tree_port s/\|grant && !writes\)/|grant)/
// @break tree_port s/node_request_line_i >= triangles_line_i/node_request_line_i > triangles_line_i/
// @break tree_port s/triangle_request_line_i >= triangle_lines_i/triangle_request_line_i > triangle_lines_i/
// @break tree_port s/&& !beyond;/;/
// @break tree_port s/&& !stop_i;/;/
// @break tree_port s/free && !fault_valid_o/free/
// @break tree_port s/id_q\[0\] \? fill_data_o/!id_q[0] ? fill_data_o/
// @break tree_port s/ \|\| \(triangle_fill_valid_o && !triangle_fill_ready_i\)//
// @break tree_port s/response_beat_i == 2'd3/response_beat_i == 2'd2/
// @break round_robin s/\|behind \? first_behind : first/first/
`default_nettype none
module check (
  input wire clk_i, node_valid, triangle_valid, node_id, triangle_id, node_takes, triangle_takes, memory_ready,
  input wire beat_valid, choose, any_stop,
  input wire [1:0] node_line, triangle_line, stack_valid, stack_write, stack_slot, beat_bits,
  input wire [3:0] stack_block, input wire [7:0] stack_entries);
  localparam NODES = 0, TRIANGLES = 1, STACKS = 2;
  localparam LINES = 2;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;

  // The traverser stops in the cycle after a fault, and may stop of its own.
  reg stop_q = 1'b0;
  wire fault;
  always @(posedge clk_i) stop_q <= stop_q || (rst_n && (fault || any_stop));
  reg [1:0] beat_q = 2'd0;
  wire [1:0] fault_source, stack_ready, stack_filled;
  wire [25:0] fault_line;
  wire node_ready, node_filled, node_filled_id, triangle_ready, triangle_filled, triangle_filled_id;
  wire valid, write, second;
  wire [31:0] address;
  wire [255:0] data;
  wire [511:0] fill_data;
  wire [3:0] fill_entries;
  rp_tree_port #(.LANES(2), .SLOTS(2), .ENTRY_BITS(1), .BLOCK_BITS(2), .NODE_ID_BITS(1), .TRIANGLE_ID_BITS(1),
              .LINES(LINES)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .triangles_line_i(26'd2), .triangle_lines_i(26'd3), .stacks_line_i(26'd8),
    .fault_valid_o(fault), .fault_source_o(fault_source), .fault_line_o(fault_line), .stop_i(stop_q),
    .node_request_valid_i(node_valid), .node_request_ready_o(node_ready), .node_request_line_i({24'd0, node_line}),
    .node_request_id_i(node_id), .node_fill_valid_o(node_filled), .node_fill_ready_i(node_takes),
    .node_fill_id_o(node_filled_id), .triangle_request_valid_i(triangle_valid),
    .triangle_request_ready_o(triangle_ready), .triangle_request_line_i({24'd0, triangle_line}),
    .triangle_request_id_i(triangle_id), .triangle_fill_valid_o(triangle_filled),
    .triangle_fill_ready_i(triangle_takes), .triangle_fill_id_o(triangle_filled_id), .fill_data_o(fill_data),
    .stack_request_valid_i(stack_valid), .stack_request_ready_o(stack_ready), .stack_request_write_i(stack_write),
    .stack_request_slot_i(stack_slot), .stack_request_block_i(stack_block), .stack_request_entries_i(stack_entries),
    .stack_fill_valid_o(stack_filled), .stack_fill_entries_o(fill_entries), .request_valid_o(valid),
    .request_ready_i(memory_ready), .request_write_o(write), .request_second_o(second), .request_address_o(address),
    .request_data_o(data), .response_valid_i(beat_valid), .response_beat_i(beat_q),
    .response_data_i({63'd0, beat_bits[1], 63'd0, beat_bits[0]}));

  // ---- The requester that is heard, and what it asks for
  wire [3:0] asks = {stack_valid, triangle_valid, node_valid};
  wire [3:0] heard = {stack_ready, triangle_ready, node_ready} & {4{rst_n}};
  wire lane = heard[3];
  wire of_stack = heard[2] || heard[3];
  wire writes = of_stack && stack_write[lane];
  wire [1:0] block = stack_block[2*lane +: 2];
  wire [5:0] line = heard[0] ? {4'd0, node_line} : heard[1] ? 6'd2 + {4'd0, triangle_line} :
                    6'd8 + {3'd0, lane, stack_slot[lane], block[1]};
  wire beyond = (heard[0] && node_line >= 2) || (heard[1] && triangle_line == 3) || (writes && block == 3);
  wire [1:0] source = heard[0] ? NODES : heard[1] ? TRIANGLES : STACKS;
  wire reads = heard != 0 && !writes;
  reg offered_q = 1'b0, faulted_q = 1'b0, writes_q, half_q;
  reg [5:0] line_q;
  reg [1:0] source_q;
  reg [3:0] entries_q;
  wire taken = rst_n && valid && memory_ready;
  always @(posedge clk_i) begin
    offered_q <= heard != 0 ? !beyond : offered_q && !taken;
    faulted_q <= heard != 0 && beyond;
    if (heard != 0) begin
      {writes_q, half_q, line_q, source_q} <= {writes, writes && block[0], line, source};
      entries_q <= stack_entries[4*lane +: 4];
    end
  end

  // ---- Any requester that waits: how often others were heard meanwhile
  (* anyconst *) wire [1:0] waiter;
  reg [2:0] passed_q = 0;
  always @(posedge clk_i) passed_q <= (rst_n && asks[waiter] && !heard[waiter]) ? passed_q + (heard != 0) : 0;

  // ---- Lines that are on their way, and beats that the memory owes
  reg [1:0] lines_q = 0;
  reg [3:0] owed_q = 0;
  wire ends = beat_valid && beat_q == 3;
  always @(posedge clk_i) begin
    lines_q <= lines_q + reads - ends;
    owed_q <= owed_q + ((taken && !write) ? 4 : 0) - beat_valid;
    beat_q <= beat_q + beat_valid;
  end

  // ---- Any one line: its requester, how many come before it, what it is
  reg chosen_q = 1'b0, given_q = 1'b0, own_half_q, own_lane_q, own_id_q;
  reg [1:0] own_source_q, before_q;
  reg [7:0] bits_q;
  wire own = chosen_q && !given_q && before_q == 0;
  wire takes = own_source_q == NODES ? node_takes : own_source_q == TRIANGLES ? triangle_takes : 1'b1;
  always @(posedge clk_i)
    if (!chosen_q && reads && !beyond && choose) begin
      chosen_q <= 1'b1;
      own_source_q <= source;
      {own_id_q, own_lane_q, own_half_q} <= {heard[0] ? node_id : triangle_id, lane, block[0]};
      before_q <= lines_q - ends;
    end else if (given_q && takes) {chosen_q, given_q} <= 2'd0;
    else if (own && beat_valid) begin
      bits_q <= {beat_bits, bits_q[7:2]};
      given_q <= ends;
    end else if (chosen_q && ends) before_q <= before_q - 1;

  // ---- That a line is given, once
  wire [3:0] filled = {stack_filled, triangle_filled, node_filled};
  wire waits = rst_n && ((node_filled && !node_takes) || (triangle_filled && !triangle_takes));
  reg gives_q = 1'b0;
  always @(posedge clk_i) gives_q <= rst_n && (ends || waits);

  integer e;
  always @* begin
    assume (!beat_valid || (rst_n && owed_q != 0));
    assume (!reads || lines_q < LINES);
    assume (!(ends && waits));
    if (rst_n) begin
      assert ((heard & ~asks) == 0);
      assert ((heard & (heard - 4'd1)) == 0);
      assert (valid == offered_q);
      assert (fault == faulted_q);
      if (valid) begin
        assert (address == {20'd0, line_q, half_q, 5'd0});
        assert (write == writes_q && second == writes_q);
        for (e = 0; e < 4; e = e + 1) assert (!write || data[64*e +: 64] == {63'd0, entries_q[e]});
      end
      assert (!fault || (fault_source == source_q && fault_line == {20'd0, line_q}));
      assert (!(fault || stop_q) || heard == 0);

      assert (passed_q <= (waiter < 2 ? 2 : 5));
      assert (asks == 0 || heard != 0 || (valid && !memory_ready) || fault || stop_q);

      assert ((filled & (filled - 4'd1)) == 0);
      assert ((filled != 0) == gives_q);
      if (given_q) begin
        assert (filled == (own_source_q == STACKS ? 4'd4 << own_lane_q : 4'd1 << own_source_q));
        assert (own_source_q != NODES || node_filled_id == own_id_q);
        assert (own_source_q != TRIANGLES || triangle_filled_id == own_id_q);
        for (e = 0; e < 8; e = e + 1) assert (fill_data[64*e +: 64] == {63'd0, bits_q[e]});
        for (e = 0; e < 4; e = e + 1)
          assert (own_source_q != STACKS || fill_entries[e] == bits_q[4*own_half_q + e]);
      end
    end
  end
endmodule
`default_nettype wire
