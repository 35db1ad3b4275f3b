// Four warps of two lanes. A warp's active_i falls at any time, and rises in the cycle after its start alone. What the
// launches carry besides their threads is marked by their PC: the checker takes the block and blocks to be made of it.
// @modules launcher
// @zeros
// @proves a warp is started only while it is inactive, for the launch that began last, with its PC and lanes, and only
//   if it has threads of it; not twice for one launch
// @proves a launch's kernel is done only when each warp that has threads of it was started once and has ended
// @proves kernels are done in the order of the launches, once each; without OVERLAP one runs at most, with it two
// @proves threads, block and blocks at the place of a warp that runs are those of the launch it was started for;
//   older_o are the warps of the older one of two
// @proves a launch is taken only while none waits and no import is under way, and starts an import if it has one
// @proves a launch that can begin does, and with OVERLAP a warp that can be started is
// @parameters OVERLAP=1
// @parameters OVERLAP=0
// @break launcher s/has & ~started_q & ~active_i/has \& ~started_q/
// @break launcher s/has & ~started_q & ~active_i/has \& ~active_i/
// @break launcher s/pending_q && !older_q/pending_q/
// @break launcher s/newest_q <= !newest_q/newest_q <= newest_q/
// @break launcher s/older_q \? older_done : newest_done/newest_done/
// @break launcher s/running_o && all_started && active_i ==/running_o \&\& active_i ==/
// @break launcher s/\(active_i & ~of_newest\) == /(active_i \& of_newest) == /
// @break launcher s/older_q <= running_o && !kernel_done_o/older_q <= running_o/
// @break launcher s/if \(start_o\[w\]\) warp_place_q/if (!start_o[w]) warp_place_q/
// @break launcher s/place_block_q\[63:32\] <= block_q/place_block_q[31:0] <= block_q/
// @break launcher s/older_o = ~of_newest/older_o = of_newest/
`default_nettype none
module check #(parameter OVERLAP = 1) (
  input wire clk_i, launch_valid_i, import_active_i, input wire [3:0] pc_i, threads_i, end_i,
  input wire [1:0] import_i
);
  localparam integer WARPS = 4, LANES = 2;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  reg [3:0] active_q = 0;
  wire ready, import_start, done, running, waiting;
  wire [3:0] start, launched, place, older;
  wire [15:0] start_pc;
  wire [7:0] start_lanes;
  wire [21:0] threads;
  wire [63:0] block, blocks;
  wire accept = rst_n && launch_valid_i && ready;
  rp_launcher #(.WARPS(WARPS), .LANES(LANES), .OVERLAP(OVERLAP)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .launch_valid_i(launch_valid_i), .launch_ready_o(ready),
    .launch_pc_i({12'd0, pc_i}), .launch_threads_i({7'd0, threads_i}), .launch_block_i({28'd1, pc_i}),
    .launch_blocks_i({28'd2, pc_i}), .launch_import_i(import_i), .import_start_o(import_start),
    .import_active_i(import_active_i), .start_o(start), .start_pc_o(start_pc),
    .start_lanes_o(start_lanes), .active_i(active_q), .launched_o(launched), .place_o(place), .older_o(older),
    .threads_o(threads), .block_o(block), .blocks_o(blocks), .kernel_done_o(done), .running_o(running),
    .waiting_o(waiting));

  // What should be: launches in order, of which 0 is the oldest that is not done.
  reg [1:0] count_q = 0;                         // launches, the one that waits among them
  reg [3:0] pc0_q = 0, pc1_q = 0, pc2_q = 0, threads0_q = 0, threads1_q = 0, threads2_q = 0;
  reg [3:0] started0_q = 0, started1_q = 0;      // warps of them, ever
  reg [3:0] second_q = 0;                        // warps of launch 1 that run, the others are of launch 0
  function [3:0] warps_of(input [3:0] count);
    warps_of = {count > 6, count > 4, count > 2, count > 0};
  endfunction
  wire [1:0] runs = count_q - waiting;
  wire second = runs == 2;
  wire [3:0] newest_pc = OVERLAP ? (second ? pc1_q : pc0_q) : (waiting ? (runs == 0 ? pc0_q : pc1_q) : pc0_q);
  wire [3:0] newest_threads = OVERLAP ? (second ? threads1_q : threads0_q) :
                              (waiting ? (runs == 0 ? threads0_q : threads1_q) : threads0_q);
  wire [3:0] newest_warps = warps_of(newest_threads), newest_started = second ? started1_q : started0_q;
  wire all_started = started0_q == warps_of(threads0_q);
  // The launch that waits has to run in the next cycle
  wire must_begin = waiting && (OVERLAP ? !second : runs == 0);
  reg must_q = 1'b0;
  wire [3:0] started0 = started0_q | (second ? 4'd0 : start), started1 = started1_q | (second ? start : 4'd0);
  always @(posedge clk_i)
    if (rst_n) begin
      active_q <= (active_q & ~end_i) | start;
      must_q <= must_begin;
      count_q <= count_q + accept - done;
      if (done) begin
        {pc0_q, threads0_q} <= {pc1_q, threads1_q};
        {pc1_q, threads1_q} <= {pc2_q, threads2_q};
        started0_q <= second ? started1 : 4'd0;
        started1_q <= 4'd0;
        second_q <= 4'd0;
      end else begin
        started0_q <= started0;
        started1_q <= started1;
        second_q <= (second_q & ~start) | (second ? start : 4'd0);
      end
      if (accept)
        case (count_q - done)
          0: {pc0_q, threads0_q} <= {pc_i, threads_i};
          1: {pc1_q, threads1_q} <= {pc_i, threads_i};
          default: {pc2_q, threads2_q} <= {pc_i, threads_i};
        endcase
    end

  (* anyconst *) wire [1:0] w;                    // any warp
  wire [3:0] mine = second_q[w] ? pc1_q : pc0_q, mine_threads = second_q[w] ? threads1_q : threads0_q;
  always @* begin
    assume (threads_i > 0 && threads_i <= WARPS * LANES);
    if (rst_n) begin
      assert (ready == !(waiting || import_active_i));
      assert (import_start == (accept && import_i != 0));
      assert (count_q >= waiting && runs <= (OVERLAP ? 2 : 1) && running == (runs != 0));
      assert (done == (running && all_started && (active_q & ~second_q) == 0));
      assert (!must_q || !waiting);
      if (OVERLAP && running && newest_warps[w] && !newest_started[w]) assert (start[w] || active_q[w]);
      if (start[w]) begin
        assert (!active_q[w] && newest_warps[w] && (OVERLAP == 0 || running));
        assert (!newest_started[w]);
        assert (start_pc == newest_pc);
        assert (start_lanes[2*w] == (newest_threads > 2 * w) && start_lanes[2*w+1] == (newest_threads > 2 * w + 1));
      end
      if (active_q[w]) begin
        assert (running && launched[w] && (!second_q[w] || second));
        assert (threads[place[w]*11 +: 11] == {7'd0, mine_threads});
        assert (block[place[w]*32 +: 32] == {28'd1, mine} && blocks[place[w]*32 +: 32] == {28'd2, mine});
        assert (older[w] == (second && !second_q[w]));
      end
    end
  end
endmodule
`default_nettype wire
