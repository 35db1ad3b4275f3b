// Four warps, two instances of type 1 (numbers 0 and 2) and one of type 2, with pipelines of other latencies and
// depths. What instance 0 is granted goes to a task register of each type, too.
// @long 20
// @modules dispatcher task_register alu_pipeline
// @zeros
// @proves a grant goes to a warp that wants, to one instance of its type, which is ready; no warp gets two
// @proves the lowest warp wins the lowest instance; no warp waits beside a ready one; waiting_o shows those that wait
// @proves with OVERLAP, of the warps that want a type those in first_i are served before all others; without it first_i
//   changes nothing
// @proves a task register holds of each operand that its type has what the warp that won offered, else zero
// @proves a busy ALU gets no task: LATENCY cycles lie between two; a task is done DEPTH cycles later, with its warp
// @parameters OVERLAP=1
// @parameters OVERLAP=0
// @break dispatcher s/if \(ready_i\[i\]\)/if (1'b1)/
// @break dispatcher s/want_i\[w\] && !grant_o\[w\] && type/want_i[w] \&\& type/
// @break dispatcher s/candidates & \(~candidates \+ ONE\)/candidates \& ~(candidates >> 1)/
// @break dispatcher s/candidates\[w\] = want_i\[w\] &&/candidates[w] =/
// @break dispatcher s/candidates = candidates & first/candidates = candidates/
// @break dispatcher s/\|\(candidates & first\)/|first/
// @break task_register s/ISA_HAS_IMMEDIATE\[TYPE\] \? field_immediate/ISA_HAS_IMMEDIATE[TYPE] ? instruction_i[31:0]/
// @break task_register s/operand_c_i\[warp_i\*DATA/operand_c_i[0*DATA/
// @break task_register s/predicate_b_o <= ISA_HAS_PREDICATE_B/predicate_b_o <= ISA_HAS_PREDICATE_X/
// @break task_register s/field_b_is_immediate \?/1'b0 ?/
// @break alu_pipeline s/LATENCY - 2/LATENCY - 3/
// @break alu_pipeline s/if \(\|stage_valid_o\)/if (task_valid_i)/
`default_nettype none
module check #(parameter OVERLAP = 1) (
  input wire clk_i, input wire [3:0] want_i, first_i, input wire [255:0] instruction_i,
  input wire [3:0] mask_i, x_i, b_i, input wire [127:0] operand_a_i, operand_b_i, operand_c_i
);
`include "rp_isa.vh"
  localparam [11:0] TYPES = 12'h121;
  localparam [11:0] LATENCY = 12'h431, DEPTH = 12'h521;
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire [15:0] types;
  wire [3:0] grant, waiting;
  wire [2:0] ready, instance_grant, valid, done;
  wire [5:0] instance_warp, warp, done_warp;
  rp_dispatcher #(.WARPS(4), .WARP_BITS(2), .INSTANCES(3), .INSTANCE_TYPES(TYPES), .OVERLAP(OVERLAP)) dut (
    .want_i(want_i), .type_i(types), .first_i(first_i), .grant_o(grant), .waiting_o(waiting),
    .ready_i(ready), .instance_grant_o(instance_grant), .instance_warp_o(instance_warp));

  wire [3:0] first = OVERLAP ? first_i : 0;
  // The cycle before
  reg [3:0] want_q = 0, grant_q = 0, first_q = 0, mask_q, x_q, b_q;
  reg [2:0] instance_grant_q = 0;
  reg [255:0] instruction_q;
  reg [127:0] operand_a_q, operand_b_q, operand_c_q;
  always @(posedge clk_i) begin
    want_q <= want_i;
    first_q <= first;
    grant_q <= rst_n ? grant : 0;
    instance_grant_q <= rst_n ? instance_grant : 0;
    {mask_q, x_q, b_q, instruction_q} <= {mask_i, x_i, b_i, instruction_i};
    {operand_a_q, operand_b_q, operand_c_q} <= {operand_a_i, operand_b_i, operand_c_i};
  end
  (* anyconst *) wire [1:0] low;
  (* anyconst *) wire [1:0] high;
  wire same = types[low*4 +: 4] == types[high*4 +: 4];
  // Which of the two goes before the other
  wire high_goes = first[high] && !first[low];
  wire low_goes = !high_goes;

  genvar s, t;
  generate
    for (s = 0; s < 4; s = s + 1) begin : gen_warp
      assign types[s*4 +: 4] = instruction_i[s*64+60 +: 4];
    end
    for (s = 0; s < 3; s = s + 1) begin : gen_instance
      localparam L = LATENCY[s*4 +: 4], D = DEPTH[s*4 +: 4];
      rp_task_register #(.WARPS(4), .LANES(1), .WARP_BITS(2), .TYPE(TYPES[s*4 +: 4])) register (
        .clk_i(clk_i), .rst_ni(rst_n), .grant_i(instance_grant[s]), .warp_i(instance_warp[s*2 +: 2]),
        .instruction_i(instruction_i), .mask_i(mask_i), .predicate_x_i(x_i), .predicate_b_i(b_i),
        .operand_a_i(operand_a_i), .operand_b_i(operand_b_i), .operand_c_i(operand_c_i),
        .task_valid_o(valid[s]), .task_warp_o(warp[s*2 +: 2]));
      rp_alu_pipeline #(.WARP_BITS(2), .LATENCY(L), .DEPTH(D)) pipeline (
        .clk_i(clk_i), .rst_ni(rst_n), .task_valid_i(valid[s]), .task_warp_i(warp[s*2 +: 2]), .ready_o(ready[s]),
        .done_valid_o(done[s]), .done_warp_o(done_warp[s*2 +: 2]), .stage_valid_o());
      reg [3:0] since_q = 15;            // cycles since the last task
      reg [D-1:0] valid_q = 0;
      reg [2*D-1:0] warps_q;
      wire [3:0] since = valid[s] ? 0 : since_q;
      wire [1:0] source = warp[s*2 +: 2];
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
          assert (!instance_grant[s] || ready[s]);
          assert (valid[s] == instance_grant_q[s]);
          assert (!valid[s] || (want_q[source] && grant_q[source]));
          assert (!valid[s] || instruction_q[source*64+60 +: 4] == TYPES[s*4 +: 4]);
          assert (done[s] == valid_q[D-1] && (!done[s] || done_warp[s*2 +: 2] == warps_q[2*D-1 -: 2]));
          if (want_i[high] && !grant[high] && types[high*4 +: 4] == TYPES[s*4 +: 4])
            assert (!ready[s] || instance_grant[s]);
        end
    end

    for (t = 0; t < 7; t = t + 1) begin : gen_type
      wire held, mask, x, b;
      wire [1:0] source;
      wire [4:0] operation, word;
      wire [31:0] operand_a, operand_b, operand_c, immediate;
      rp_task_register #(.WARPS(4), .LANES(1), .WARP_BITS(2), .TYPE(t), .FMA(1)) register (
        .clk_i(clk_i), .rst_ni(rst_n), .grant_i(instance_grant[0]), .warp_i(instance_warp[1:0]),
        .instruction_i(instruction_i), .mask_i(mask_i), .predicate_x_i(x_i), .predicate_b_i(b_i),
        .operand_a_i(operand_a_i), .operand_b_i(operand_b_i), .operand_c_i(operand_c_i),
        .task_valid_o(held), .task_warp_o(source), .task_operation_o(operation), .task_mask_o(mask),
        .task_operand_a_o(operand_a), .task_operand_b_o(operand_b), .task_operand_c_o(operand_c),
        .task_immediate_o(immediate), .task_word_o(word), .task_predicate_x_o(x), .task_predicate_b_o(b));
      wire [63:0] instruction = instruction_q[source*64 +: 64];
      wire [31:0] second = instruction[37] ? instruction[31:0] : operand_b_q[source*32 +: 32];
      always @*
        if (rst_n && held) begin
          assert (source == warp[1:0] && operation == instruction[59:55] && mask == mask_q[source]);
          assert (operand_a == (ISA_HAS_OPERAND_A[t] ? operand_a_q[source*32 +: 32] : 0));
          assert (operand_b == (ISA_HAS_OPERAND_B[t] ? second : 0));
          assert (operand_c == (ISA_HAS_OPERAND_C[t] ? operand_c_q[source*32 +: 32] : 0));
          assert (immediate == (ISA_HAS_IMMEDIATE[t] ? instruction[31:0] : 0));
          assert (word == (ISA_HAS_WORD[t] ? instruction[36:32] : 0));
          assert (x == (ISA_HAS_PREDICATE_X[t] && x_q[source]) && b == (ISA_HAS_PREDICATE_B[t] && b_q[source]));
        end
    end
  endgenerate
  integer w;
  always @* begin
    for (w = 0; w < 4; w = w + 1) assume (types[w*4 +: 4] == 4'd1 || types[w*4 +: 4] == 4'd2);
    assume (low < high);
    if (rst_n) begin
      assert ((grant & ~want_i) == 0);
      assert (grant[0] + grant[1] + grant[2] + grant[3] + 3'd0 ==
              instance_grant[0] + instance_grant[1] + instance_grant[2] + 3'd0);
      assert (!(valid[0] && valid[1] && warp[1:0] == warp[3:2]));
      assert (!(valid[1] && valid[2] && warp[3:2] == warp[5:4]));
      if (valid[0] && valid[2])
        assert (first_q[warp[1:0]] == first_q[warp[5:4]] ? warp[1:0] < warp[5:4] : first_q[warp[1:0]]);
      assert (!(grant[high] && same && want_i[low] && low_goes) || grant[low]);
      assert (!(grant[low] && same && want_i[high] && high_goes) || grant[high]);
      assert (waiting == (want_i & ~grant));
    end
  end
endmodule
`default_nettype wire
