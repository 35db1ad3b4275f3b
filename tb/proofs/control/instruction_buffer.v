// @modules instruction_buffer
// @zeros
// @proves no instruction is issued while one is under way; each one fetched is issued once, with its PC,
//   in order; it stays until it retires
// @proves an instruction without a table row is never issued; none that lies outside the program is fetched
// @proves nothing is stepped while a control instruction is under way; nothing is stepped,
//   fetched, issued or offered while halt_i
// @proves fetch_pc_o is the PC of an instruction that is illegal or outside, from the next
//   cycle on, as long as halt_i follows
// @break instruction_buffer s/fetch_pc_o <= pc_i;/if (!outside_o) fetch_pc_o <= pc_i;/
// @break instruction_buffer s/issue = ready && next_legal_q/issue = ready/
// @break instruction_buffer s/\(data_q == D_IDLE \|\| retire_i\)/(data_q != D_READ)/
// @break instruction_buffer s/next_control_q \? F_IDLE : F_STACK/F_STACK/
// @break instruction_buffer s/if \(!outside_o\) fetch_q/fetch_q/
// @break instruction_buffer s/retire_i\) && !halt_i/retire_i)/
// @break instruction_buffer s/data_q <= D_EXECUTE/data_q <= D_WANT/
// @break instruction_buffer s/refill_done_i \? F_ARBITER : F_MISS/F_STACK/
`default_nettype none
module check (
  input wire clk_i, start_i, halt_i, pc_valid_i, fetch_grant_i, hit_i, refill_i, grant_i, retire_i,
  input wire [2:0] some_pc_i, input wire [9:0] some_instruction_i
);
  `include "isa.vh"
  `include "isa_functions.vh"
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  // Three bits of a PC and ten of an instruction vary: unit, operation and the lowest bit.
  (* anyconst *) wire [2:0] some_length;
  wire [15:0] length = {13'd0, some_length};
  wire [15:0] pc_i = {13'd0, some_pc_i};
  wire [63:0] instruction_i = {some_instruction_i[9:1], 54'd0, some_instruction_i[0]};
  wire active, step, fetch, read, want, writes_register, writes_predicate, illegal, outside;
  wire [15:0] fetch_pc, pc;
  wire [63:0] instruction;
  instruction_buffer dut (
    .clk_i(clk_i), .rst_ni(rst_n), .start_i(start_i), .halt_i(halt_i), .active_o(active), .step_o(step),
    .pc_valid_i(pc_valid_i), .pc_i(pc_i), .program_length_i(length), .fetch_request_o(fetch), .fetch_pc_o(fetch_pc),
    .fetch_grant_i(fetch_grant_i), .cache_hit_i(hit_i), .cache_instruction_i(instruction_i), .refill_done_i(refill_i),
    .read_o(read), .want_o(want), .grant_i(grant_i), .retire_i(retire_i), .instruction_o(instruction), .pc_o(pc),
    .writes_register_o(writes_register), .writes_predicate_o(writes_predicate), .illegal_o(illegal),
    .outside_o(outside));

  reg stepped_q = 1'b0;         // a PC is given out, its instruction not fetched
  reg lookup_q = 1'b0;          // the cache answers in this cycle
  reg fetched_q = 1'b0;         // an instruction is there, not issued
  reg under_way_q = 1'b0, granted_q = 1'b0, halt_q = 1'b0;
  reg [15:0] stepped_pc_q, fetched_pc_q, pc_q;
  reg [63:0] fetched_instruction_q, instruction_q;
  wire fetched = lookup_q && hit_i;
  wire steps = step && pc_valid_i && !outside;
  always @(posedge clk_i)
    if (rst_n) begin
      if (steps) stepped_pc_q <= pc_i;
      stepped_q <= steps || (stepped_q && !fetched);
      lookup_q <= fetch_grant_i;
      fetched_q <= fetched || (fetched_q && !read);
      if (fetched) begin
        fetched_pc_q <= stepped_pc_q;
        fetched_instruction_q <= instruction_i;
      end
      under_way_q <= read || (under_way_q && !retire_i);
      granted_q <= grant_i || (granted_q && !retire_i);
      if (read) begin
        pc_q <= fetched_pc_q;
        instruction_q <= fetched_instruction_q;
      end
      halt_q <= halt_i;
    end
  reg fault_q = 1'b0;           // one was found, and halt_i has been there ever since
  reg [15:0] fault_pc_q;
  always @(posedge clk_i)
    if (rst_n) begin
      fault_q <= illegal || outside || (fault_q && halt_i);
      if (illegal || outside) fault_pc_q <= illegal ? fetched_pc_q : pc_i;
    end
  wire control = isa_control(instruction);
  always @* begin
    assume (!pc_valid_i || step);
    assume (!fetch_grant_i || fetch);
    assume (!grant_i || want);
    assume (!retire_i || granted_q);
    assume (!start_i || !active);
    if (rst_n) begin
      assert (!(read && under_way_q));
      assert (!read || (active && fetched_q && instruction == fetched_instruction_q && pc == fetched_pc_q));
      assert (!under_way_q || (instruction == instruction_q && pc == pc_q));
      assert (!want || (under_way_q && !granted_q));
      assert (!(steps && stepped_q));
      assert (!(fetched && fetched_q));
      assert (!fetch || (stepped_q && fetch_pc == stepped_pc_q));
      assert (!read || isa_legal_op(instruction));
      assert (!illegal || (fetched_q && !isa_legal_op(fetched_instruction_q)));
      assert (!fetch || fetch_pc < length);
      assert (!(step && (read || under_way_q) && control));
      assert (!(halt_i && (step || fetch || want)));
      assert (!(halt_q && read));
      assert (!fault_q || fetch_pc == fault_pc_q);
    end
  end
endmodule
`default_nettype wire
