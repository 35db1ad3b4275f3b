// @long 10
// @modules pc_stack
// @proves a push on the full stack raises overflow_o and changes nothing, a pop of the first entry
//   raises underflow_o and changes nothing
// @proves neither is raised otherwise; a step never pops the first entry; the number of entries stays within 1 .. DEPTH
// @proves any one entry keeps its PC and RPC while others lie above it, and is what the top shows when it is the top
// @parameters DEPTH=4 PC_BITS=9
// @parameters DEPTH=4
// @parameters DEPTH=2
// @parameters DEPTH=8
// @proves a PC that does not fit into PC_BITS becomes the greatest there is
// @break pc_stack s/push_i && !overflow_o/push_i/
// @break pc_stack s/overflow_o = push_i && .*/overflow_o = 1'b0;/
// @break pc_stack s/pop_i && !first/pop_i/
// @break pc_stack s/finished = !first &&/finished =/
// @break pc_stack s/if \(pc\[b\]\) fitting/if (1'b0) fitting/
// @break pc_stack s/pc_q\[top_q\] <= return_i/pc_q[above] <= return_i/
`default_nettype none
module check #(parameter DEPTH = 4, parameter PC_BITS = 16) (
  input wire clk_i, start_i, step_i, jump_i, push_i, push_return_i, pop_i, input wire [15:0] start_pc_i, target_i,
      end_i, input wire [PC_BITS-1:0] return_i
);
  localparam [PC_BITS-1:0] GREATEST = {PC_BITS{1'b1}};
  wire [PC_BITS-1:0] start_pc = start_pc_i > GREATEST ? GREATEST : start_pc_i[PC_BITS-1:0];
  wire [PC_BITS-1:0] target = target_i > GREATEST ? GREATEST : target_i[PC_BITS-1:0];
  wire [PC_BITS-1:0] finish = end_i > GREATEST ? GREATEST : end_i[PC_BITS-1:0];
  reg rst_n = 1'b0, started_q = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  wire pc_valid, overflow, underflow;
  wire [PC_BITS-1:0] pc;
  rp_pc_stack #(.DEPTH(DEPTH), .PC_BITS(PC_BITS)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .start_i(start_i), .start_pc_i(start_pc_i), .step_i(step_i), .pc_valid_o(pc_valid),
    .pc_o(pc), .jump_i(jump_i), .push_i(push_i), .push_return_i(push_return_i), .pop_i(pop_i), .target_i(target_i),
    .end_i(end_i), .return_i(return_i), .overflow_o(overflow), .underflow_o(underflow));

  (* anyconst *) wire [3:0] entry;
  reg [3:0] top_q = 0;
  reg [PC_BITS-1:0] pc_q, rpc_q;       // of the entry
  wire is_top = top_q == entry;
  always @(posedge clk_i)
    if (rst_n) begin
      if (start_i) begin
        started_q <= 1'b1;
        top_q <= 0;
        if (entry == 0) pc_q <= start_pc;
      end else if (step_i) begin
        if (!pc_valid) top_q <= top_q - 1;
        else if (is_top) pc_q <= pc_q + 1;
      end else if (jump_i) begin
        if (is_top) pc_q <= target;
      end else if (push_i && top_q != DEPTH - 1) begin
        top_q <= top_q + 1;
        if (is_top && push_return_i) pc_q <= return_i;
        if (top_q + 1 == entry) begin
          pc_q <= target;
          rpc_q <= finish;
        end
      end else if (pop_i && top_q != 0) top_q <= top_q - 1;
    end
  always @* begin
    assume (entry < DEPTH);
    assume (step_i + jump_i + push_i + pop_i <= 3'd1);
    assume (started_q || !(step_i || jump_i || push_i || pop_i));
    if (rst_n) begin
      assert (top_q < DEPTH);
      assert (overflow == (push_i && top_q == DEPTH - 1));
      assert (underflow == (pop_i && top_q == 0));
      assert (!(step_i && top_q == 0) || pc_valid);
      assert (!(started_q && is_top) || pc == pc_q);
      assert (!(step_i && is_top) || pc_valid == (top_q == 0 || pc_q < rpc_q));
    end
  end
endmodule
`default_nettype wire
