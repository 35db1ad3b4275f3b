// @long 10
// @modules instruction_buffer
// @zeros
// @parameters TRIPLES=1
// @parameters TRIPLES=0
// @proves no instruction is issued while one is under way; each one fetched is issued once, with its PC,
//   in order; it stays until it retires
// @proves a triple's elements are read, offered and done in order, no element twice and none left out before it retires
// @proves the next element is read only when the one before has its ALU, or, if elements wait for each other, when that
//   is done; where the counter counts it as read at once, it is
// @proves an instruction without a table row, or that its ALU lacks, is never issued; none that lies outside the
//   program is fetched
// @proves nothing is stepped while a control instruction is under way; nothing is stepped,
//   fetched, issued or offered while halt_i
// @proves fetch_pc_o is the PC of an instruction that is illegal or outside, from the next
//   cycle on, as long as halt_i follows; pc_o stays that of one that is done with a fault
// @break instruction_buffer s/fetch_pc_o <= pc_i;/if (!outside_o) fetch_pc_o <= pc_i;/
// @break instruction_buffer s/issue = ready && next_legal_q/issue = ready/
// @break instruction_buffer s/WITHOUT\[cache_instruction_i\[63:55\]\]/1'b0/
// @break instruction_buffer s/\(data_q == D_IDLE \|\| retire\)/(data_q != D_READ)/
// @break instruction_buffer s/next_control_q \? F_IDLE : F_STACK/F_STACK/
// @break instruction_buffer s/if \(!outside_o\) fetch_q/fetch_q/
// @break instruction_buffer s/retire\) && !halt_i/retire)/
// @break instruction_buffer s/ && !fault_i//
// @break instruction_buffer s/data_q <= overlaps_o \? D_READ : D_EXECUTE/data_q <= D_WANT/
// @break instruction_buffer s/refill_done_i \? F_ARBITER : F_MISS/F_STACK/
// @break instruction_buffer s/read_element_q <= 2'd0/read_element_q <= read_element_q/
// @break instruction_buffer s/done_element_q <= 2'd0/done_element_q <= done_element_q/
// @break instruction_buffer s/read_element_q == 2'd2/read_element_q == 2'd3/
// @break instruction_buffer s/done_element_q == 2'd2/done_element_q == 2'd1/
// @break instruction_buffer s/overlaps_o = !last_read && !waits_q/overlaps_o = !last_read/
// @break instruction_buffer s/isa_elements_depend\(next_q\) :/1'b0 :/
// @break instruction_buffer s/overlaps_o \? D_READ/triple_o ? D_READ/
// @break instruction_buffer s/done_i && !last_done && waits_q/done_i \&\& !last_done/
`default_nettype none
module check #(parameter [0:0] TRIPLES = 1'b1) (
  input wire clk_i, start_i, halt_i, pc_valid_i, fetch_grant_i, hit_i, refill_i, grant_i, done_i, fault_i,
  input wire [2:0] some_pc_i, input wire [10:0] some_instruction_i
);
  `include "rp_isa.vh"
  `include "rp_isa_functions.vh"
  reg rst_n = 1'b0;
  always @(posedge clk_i) rst_n <= 1'b1;
  // Three bits of a PC and eleven of an instruction vary: unit, operation, the lowest bit of rd, so that elements wait
  // for each other or do not, and the lowest bit of all.
  (* anyconst *) wire [2:0] some_length;
  wire [15:0] length = {13'd0, some_length};
  wire [15:0] pc_i = {13'd0, some_pc_i};
  wire [63:0] instruction_i = {some_instruction_i[10:2], 8'd0, some_instruction_i[1], 45'd0, some_instruction_i[0]};
  wire active, step, fetch, read, want, triple, overlaps, writes_register, writes_predicate, illegal, outside;
  wire [1:0] read_element, done_element;
  wire [15:0] fetch_pc, pc;
  wire [63:0] instruction;
  // Two that its ALUs lack.
  localparam [511:0] WITHOUT = (512'd1 << {ISA_TYPE_INT, ISA_INT_IMUL}) | (512'd1 << {ISA_TYPE_SLW, ISA_SLW_FDIV});
  rp_instruction_buffer #(.TRIPLES(TRIPLES), .WITHOUT(WITHOUT)) dut (
    .clk_i(clk_i), .rst_ni(rst_n), .start_i(start_i), .halt_i(halt_i), .active_o(active), .step_o(step),
    .pc_valid_i(pc_valid_i), .pc_i(pc_i), .program_length_i(length), .fetch_request_o(fetch), .fetch_pc_o(fetch_pc),
    .fetch_grant_i(fetch_grant_i), .cache_hit_i(hit_i), .cache_instruction_i(instruction_i), .refill_done_i(refill_i),
    .read_o(read), .want_o(want), .grant_i(grant_i), .done_i(done_i), .fault_i(fault_i),
    .instruction_o(instruction), .triple_o(triple),
    .read_element_o(read_element), .done_element_o(done_element), .overlaps_o(overlaps), .pc_o(pc),
    .writes_register_o(writes_register), .writes_predicate_o(writes_predicate), .illegal_o(illegal),
    .outside_o(outside));

  reg stepped_q = 1'b0;         // a PC is given out, its instruction not fetched
  reg lookup_q = 1'b0;          // the cache answers in this cycle
  reg fetched_q = 1'b0;         // an instruction is there, not issued
  // Of the instruction under way, elements that have been read, granted and done; of no triple it has one. None read:
  // none is under way.
  reg [1:0] reads_q = 2'd0, grants_q = 2'd0, dones_q = 2'd0;
  reg halt_q = 1'b0, overlapped_q = 1'b0;
  reg [15:0] stepped_pc_q, fetched_pc_q, pc_q;
  reg [63:0] fetched_instruction_q, instruction_q;
  wire fetched = lookup_q && hit_i;
  wire steps = step && pc_valid_i && !outside;
  wire first_read = read && reads_q == 2'd0;
  wire [1:0] last = TRIPLES && isa_triple(instruction) ? 2'd2 : 2'd0;
  wire is_flt = instruction[63:60] == ISA_TYPE_FLT;
  wire waits = is_flt ? isa_elements_depend(instruction) : instruction[63:60] != ISA_TYPE_RAY;
  wire retires = done_i && dones_q == last;
  always @(posedge clk_i)
    if (rst_n) begin
      if (steps) stepped_pc_q <= pc_i;
      stepped_q <= steps || (stepped_q && !fetched);
      lookup_q <= fetch_grant_i;
      fetched_q <= fetched || (fetched_q && !first_read);
      if (fetched) begin
        fetched_pc_q <= stepped_pc_q;
        fetched_instruction_q <= instruction_i;
      end
      reads_q <= retires ? 2'd0 : reads_q + {1'b0, read};
      grants_q <= retires ? 2'd0 : grants_q + {1'b0, grant_i};
      dones_q <= retires ? 2'd0 : dones_q + {1'b0, done_i};
      if (first_read) begin
        pc_q <= fetched_pc_q;
        instruction_q <= fetched_instruction_q;
      end
      halt_q <= halt_i;
      overlapped_q <= grant_i && overlaps;
    end
  reg fault_q = 1'b0;           // one was found, and halt_i has been there ever since
  reg [15:0] fault_pc_q;
  always @(posedge clk_i)
    if (rst_n) begin
      fault_q <= illegal || outside || (fault_q && halt_i);
      if (illegal || outside) fault_pc_q <= illegal ? fetched_pc_q : pc_i;
    end
  reg done_fault_q = 1'b0;      // likewise of one that was done with a fault
  reg [15:0] done_fault_pc_q;
  always @(posedge clk_i)
    if (rst_n) begin
      done_fault_q <= fault_i || (done_fault_q && halt_i);
      if (fault_i) done_fault_pc_q <= pc;
    end
  wire control = isa_control(instruction);
  always @* begin
    assume (!pc_valid_i || step);
    assume (!fetch_grant_i || fetch);
    assume (!grant_i || want);
    assume (!done_i || dones_q < grants_q);
    assume (!fault_i || done_i);
    assume (!start_i || !active);
    if (rst_n) begin
      assert (!first_read ||
              (active && fetched_q && instruction == fetched_instruction_q && pc == fetched_pc_q));
      assert (reads_q == 2'd0 || (instruction == instruction_q && pc == pc_q));
      assert (!read || (reads_q <= last && read_element == reads_q && grants_q == reads_q));
      assert (!read || !waits || dones_q == reads_q);
      assert (!want || (reads_q == grants_q + 2'd1 && read_element == grants_q));
      assert (!done_i || done_element == dones_q);
      assert (!retires || reads_q == last + 2'd1);
      assert (reads_q == 2'd0 || triple == (last == 2'd2));
      assert (!overlapped_q || read);
      assert (!(steps && stepped_q));
      assert (!(fetched && fetched_q));
      assert (!fetch || (stepped_q && fetch_pc == stepped_pc_q));
      assert (!read || isa_legal(instruction, 1'b0, TRIPLES, 5'd21, WITHOUT[instruction[63:55]]));
      assert (!illegal || (fetched_q && !isa_legal(fetched_instruction_q, 1'b0, TRIPLES, 5'd21,
                                                   WITHOUT[fetched_instruction_q[63:55]])));
      assert (!fetch || fetch_pc < length);
      assert (!(step && (read || reads_q != 2'd0) && control));
      assert (!(halt_i && (step || fetch || want)));
      assert (!(halt_q && first_read));
      assert (!fault_q || fetch_pc == fault_pc_q);
      assert (!(fault_i && illegal));
      assert (!done_fault_q || (!first_read && pc == done_fault_pc_q));
    end
  end
endmodule
`default_nettype wire
