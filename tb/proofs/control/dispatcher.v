// Four warps, two slots of type 8 (slots 0 and 2) and one of type 9, with pipelines of other latencies and depths.
// These types are not shipped, so their tasks get every operand.
// @modules dispatcher alu_pipeline
// @zeros
// @proves a grant goes to a warp that wants, to one slot of its type, which is ready; no warp gets two
// @proves the lowest warp wins the lowest slot; nobody waits while a slot of his type is
//   ready; waiting_o shows those who wait
// @proves the slot's task register holds what the warp that won offered
// @proves a busy ALU gets no task: LATENCY cycles lie between two at least; a task is done
//   DEPTH cycles later, once, with its warp
// @break dispatcher s/if \(ready_i\[s\]\)/if (1'b1)/
// @break dispatcher s/want_i\[w\] && !grant_o\[w\] && instruction/want_i[w] \&\& instruction/
// @break dispatcher s/candidates & \(~candidates \+ ONE\)/candidates \& ~(candidates >> 1)/
// @break dispatcher s/candidates\[w\] = want_i\[w\] &&/candidates[w] =/
// @break dispatcher s/USES_IMM \? instruction_i\[source/USES_IMM ? instruction_i[0/
// @break alu_pipeline s/LATENCY - 2/LATENCY - 3/
// @break alu_pipeline s/if \(\|stage_valid_o\)/if (task_valid_i)/
`default_nettype none
module check (
  input wire clk_i, input wire [3:0] want_i, input wire [255:0] instruction_i, input wire [3:0] mask_i, px_i, pb_i,
      input wire [127:0] a_i, b_i
);
  localparam [11:0] TYPES = 12'h898;
  localparam [11:0] LATENCY = 12'h431, DEPTH = 12'h521;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [3:0] grant;
  wire [2:0] ready, slot_grant, valid, mask, px, pb, done;
  wire [5:0] warp, done_warp;
  wire [14:0] op, x;
  wire [95:0] a, b, imm;
  wire [3:0] waiting;
  dispatcher #(.WARPS(4), .LANES(1), .WARP_BITS(2), .SLOTS(3), .SLOT_UNITS(TYPES)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .want_i(want_i), .grant_o(grant), .instruction_i(instruction_i), .mask_i(mask_i),
    .px_i(px_i), .pb_i(pb_i), .a_i(a_i), .b_i(b_i), .c_i(128'd0), .ready_i(ready), .slot_grant_o(slot_grant),
    .task_valid_o(valid), .task_warp_o(warp), .task_op_o(op), .task_mask_o(mask), .task_a_o(a), .task_b_o(b),
    .task_c_o(), .task_imm_o(imm), .task_x_o(x), .task_px_o(px), .task_pb_o(pb), .waiting_o(waiting));

  // The cycle before
  reg [3:0] want_q = 0, grant_q = 0, mask_q, px_q, pb_q;
  reg [2:0] slot_grant_q = 0;
  reg [255:0] instruction_q;
  reg [127:0] a_q, b_q;
  always @(posedge clk_i) begin
    want_q <= want_i;
    grant_q <= rst_n ? grant : 0;
    slot_grant_q <= rst_n ? slot_grant : 0;
    {mask_q, px_q, pb_q, instruction_q, a_q, b_q} <= {mask_i, px_i, pb_i, instruction_i, a_i, b_i};
  end
  (* anyconst *) wire [1:0] low;
  (* anyconst *) wire [1:0] high;
  wire same = instruction_i[low*64+60 +: 4] == instruction_i[high*64+60 +: 4];

  genvar s;
  generate
    for (s = 0; s < 3; s = s + 1) begin : gen_slot
      localparam L = LATENCY[s*4 +: 4], D = DEPTH[s*4 +: 4];
      alu_pipeline #(.WARP_BITS(2), .LATENCY(L), .DEPTH(D)) pipeline (
        .clk_i(clk_i), .rst_ni(rst_n), .task_valid_i(valid[s]), .task_warp_i(warp[s*2 +: 2]), .ready_o(ready[s]),
        .done_valid_o(done[s]), .done_warp_o(done_warp[s*2 +: 2]), .stage_valid_o());
      reg [3:0] since_q = 15;            // cycles since the last task
      reg [D-1:0] valid_q = 0;
      reg [2*D-1:0] warps_q;
      wire [3:0] since = valid[s] ? 0 : since_q;
      wire [1:0] source = warp[s*2 +: 2];
      wire [63:0] instruction = instruction_q[source*64 +: 64];
      always @(posedge clk_i)
        if (rst_n) begin
          since_q <= since == 15 ? 15 : since + 1;
          valid_q <= {valid_q, valid[s]};
          warps_q <= {warps_q, source};
        end
      always @*
        if (rst_n) begin
          assert (!valid[s] || since_q >= L);
          assert (ready[s] == (since >= L - 1));
          assert (!slot_grant[s] || ready[s]);
          assert (valid[s] == slot_grant_q[s]);
          assert (!valid[s] || (want_q[source] && grant_q[source] && instruction[63:60] == TYPES[s*4 +: 4]));
          assert (!valid[s] || (op[s*5 +: 5] == instruction[59:55] && imm[s*32 +: 32] == instruction[31:0] &&
                                x[s*5 +: 5] == instruction[36:32]));
          assert (!valid[s] || (mask[s] == mask_q[source] && px[s] == px_q[source] && pb[s] == pb_q[source]));
          assert (!valid[s] || a[s*32 +: 32] == a_q[source*32 +: 32]);
          assert (!valid[s] || b[s*32 +: 32] == (instruction[37] ? instruction[31:0] : b_q[source*32 +: 32]));
          assert (done[s] == valid_q[D-1] && (!done[s] || done_warp[s*2 +: 2] == warps_q[2*D-1 -: 2]));
          assert (!(want_i[high] && !grant[high] && instruction_i[high*64+60 +: 4] == TYPES[s*4 +: 4]) || !ready[s] ||
                  slot_grant[s]);
        end
    end
  endgenerate
  integer w;
  always @* begin
    for (w = 0; w < 4; w = w + 1) assume (instruction_i[w*64+61 +: 3] == 3'b100);
    assume (low < high);
    if (rst_n) begin
      assert ((grant & ~want_i) == 0);
      assert (grant[0] + grant[1] + grant[2] + grant[3] == slot_grant[0] + slot_grant[1] + slot_grant[2] + 3'd0);
      assert (!(valid[0] && valid[1] && warp[1:0] == warp[3:2]));
      assert (!(valid[1] && valid[2] && warp[3:2] == warp[5:4]));
      assert (!(valid[0] && valid[2]) || warp[1:0] < warp[5:4]);
      assert (!(grant[high] && same && want_i[low]) || grant[low]);
      assert (waiting == (want_i & ~grant));
    end
  end
endmodule
`default_nettype wire
