// Waiters and filled lines are anything; a warp has one task at a time, which is queued or starts at once, ends
// its pass and then parks or is done.
// @modules memory_sequencer
// @proves only a warp that is queued or parked is chosen, once; none is lost: idle_o and queue_empty_o are high when
//   none is left
// @proves what is ready to start stays until it is taken; something is chosen whenever something may be
// @proves at most one warp has the privilege, a loser; it has it no longer two cycles
//   after it took a register or is no loser
// @proves a privileged loser that may try goes before new tasks; every loser has the
//   privilege after WARPS - 1 others at most
// @zeros
// @parameters WARPS=2 WARP_BITS=1
// @parameters WARPS=4 WARP_BITS=2
// @break memory_sequencer s/pass_of_privileged && pass_allocated_i/1'b0/
// @break memory_sequencer s/\|\| !loser_q\[privilege_warp_q\]\)/)/
// @break memory_sequencer s/lowest\(after\(loser_q, privilege_warp_q\)\)/lowest(loser_q)/
// @break memory_sequencer s/if \(freed_i\) attempt_q/if (1'b0) attempt_q/
// @break memory_sequencer s/else parked_q\[select_warp_o\] <= 1'b0/else parked_q[0] <= 1'b0/
// @break memory_sequencer s/if \(!next_valid_q\) begin/if (1'b1) begin/
`default_nettype none
module check #(parameter WARPS = 4, WARP_BITS = 2, MSHRS = 2) (
  input wire clk_i, queue_i, start_i, park_i, end_i, refused_i, allocated_i, freed_i, take_i, done_i,
  input wire [WARP_BITS-1:0] queue_warp_i, start_warp_i, park_warp_i, end_warp_i, done_warp_i,
  input wire [MSHRS-1:0] filled_i, input wire [MSHRS*WARPS-1:0] waiters_i
);
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire select, next, next_mshr, queue_empty, privilege, idle;
  wire [1:0] kind;
  wire [WARP_BITS-1:0] select_warp, next_warp, holder;
  rp_memory_sequencer #(.WARPS(WARPS), .MSHRS(MSHRS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .queue_i(queue_i), .queue_warp_i(queue_warp_i), .park_i(park_i),
    .park_warp_i(park_warp_i), .pass_end_i(end_i), .pass_warp_i(end_warp_i), .pass_refused_i(refused_i),
    .pass_allocated_i(allocated_i), .filled_i(filled_i), .waiters_i(waiters_i), .freed_i(freed_i), .select_o(select),
    .select_warp_o(select_warp), .next_valid_o(next), .next_kind_o(kind), .next_warp_o(next_warp),
    .next_mshr_o(next_mshr), .next_take_i(take_i), .queue_empty_o(queue_empty), .privilege_o(privilege),
    .privilege_warp_o(holder), .idle_o(idle));

  // Where each warp's task is
  reg [WARPS-1:0] queued_q = 0, parked_q = 0, running_q = 0, ended_q = 0, loser_q = 0;
  reg chosen_q = 1'b0, chosen_new_q = 1'b0, may_try_q = 1'b0, tries_q = 1'b0;
  reg [WARP_BITS-1:0] chosen_warp_q = 0, holder_q = 0;
  reg privilege_q = 1'b0, over_q = 1'b0, losers_q = 1'b0;
  wire [WARPS-1:0] nowhere = ~(queued_q | parked_q | running_q | ended_q | (chosen_q ? 1 << chosen_warp_q : 0));
  wire tries = privilege && may_try_q && loser_q[holder] && parked_q[holder] && !chosen_q;
  reg waiter;
  integer r;
  always @* begin
    waiter = 1'b0;
    for (r = 0; r < MSHRS; r = r + 1) if (filled_i[r] && (waiters_i[r*WARPS +: WARPS] & parked_q) != 0) waiter = 1'b1;
  end
  (* anyconst *) wire [WARP_BITS-1:0] loser;
  wire waits = loser_q[loser] && !(privilege && holder == loser);
  wire turn = privilege && !privilege_q;
  reg [3:0] turns_q = 0;
  always @(posedge clk_i)
    if (rst_n) begin
      if (queue_i) queued_q[queue_warp_i] <= 1'b1;
      if (start_i) running_q[start_warp_i] <= 1'b1;
      if (select) begin
        chosen_q <= 1'b1;
        chosen_warp_q <= select_warp;
        chosen_new_q <= queued_q[select_warp];
        queued_q[select_warp] <= 1'b0;
        parked_q[select_warp] <= 1'b0;
      end
      if (take_i) begin
        chosen_q <= 1'b0;
        running_q[next_warp] <= 1'b1;
      end
      if (end_i) begin
        running_q[end_warp_i] <= 1'b0;
        ended_q[end_warp_i] <= 1'b1;
        loser_q[end_warp_i] <= refused_i;
      end
      if (park_i) begin
        ended_q[park_warp_i] <= 1'b0;
        parked_q[park_warp_i] <= 1'b1;
      end
      if (done_i) ended_q[done_warp_i] <= 1'b0;
      privilege_q <= privilege;
      holder_q <= holder;
      losers_q <= loser_q != 0;
      over_q <= privilege && ((end_i && end_warp_i == holder && allocated_i) || !loser_q[holder]);
      tries_q <= tries;
      if (privilege ? freed_i : loser_q != 0) may_try_q <= 1'b1;
      else if (select && tries && select_warp == holder && !waiter) may_try_q <= 1'b0;
      turns_q <= waits ? turns_q + turn : 0;
    end
  always @* begin
    assume (!queue_i || nowhere[queue_warp_i]);
    assume (!start_i || (nowhere[start_warp_i] && !(queue_i && queue_warp_i == start_warp_i)));
    assume (!take_i || next);
    assume (!end_i || running_q[end_warp_i]);
    assume (!park_i || ended_q[park_warp_i]);
    assume (!done_i || (ended_q[done_warp_i] && !loser_q[done_warp_i] && !(park_i && park_warp_i == done_warp_i)));
    if (rst_n) begin
      assert (!select || (!chosen_q && (queued_q[select_warp] || parked_q[select_warp])));
      assert (next == chosen_q && (!next || (next_warp == chosen_warp_q && (kind == 0) == chosen_new_q && kind < 3)));
      assert (queue_empty == (queued_q == 0) && idle == ((queued_q | parked_q) == 0 && !chosen_q));
      assert (chosen_q || !(queued_q != 0 || waiter || tries) || select);
      assert (!(privilege && privilege_q) || holder == holder_q);
      assert (!(over_q && privilege));
      assert (privilege_q || privilege == losers_q);
      assert (!tries_q || (next && kind != 0));
      assert (!(waits && turn && turns_q == WARPS - 1));
    end
  end
endmodule
`default_nettype wire
