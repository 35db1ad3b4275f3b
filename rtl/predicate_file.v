// Predicates of one warp: 16 registers of one bit a lane. p0 reads as all ones; writes to it are ignored.
// read_i captures the three reads and the thread mask; they stay until the next read.
`default_nettype none
module predicate_file #(
  parameter integer LANES = 8
) (
  input  wire             clk_i,
  input  wire             clear_i,       // start of a kernel: p1 .. p15 become 0
  input  wire             read_i,
  input  wire [LANES-1:0] launched_i,
  input  wire             guard_negated_i,
  input  wire [3:0]       guard_i,
  input  wire [3:0]       x_index_i,
  input  wire [3:0]       b_index_i,
  output reg  [LANES-1:0] mask_o,        // launched lanes whose guard holds
  output reg  [LANES-1:0] x_o,
  output reg  [LANES-1:0] b_o,
  input  wire             write_i,
  input  wire [3:0]       write_index_i,
  input  wire [LANES-1:0] write_data_i
);
  reg [LANES-1:0] predicates_q [1:15];
  integer i;

  always @(posedge clk_i)
    if (clear_i) begin
      for (i = 1; i < 16; i = i + 1) predicates_q[i] <= {LANES{1'b0}};
    end else if (write_i && write_index_i != 4'd0) begin
      predicates_q[write_index_i] <= write_data_i;
    end

  always @(posedge clk_i)
    if (read_i) begin
      mask_o <= launched_i & ((guard_i == 4'd0 ? {LANES{1'b1}} : predicates_q[guard_i]) ^ {LANES{guard_negated_i}});
      x_o <= x_index_i == 4'd0 ? {LANES{1'b1}} : predicates_q[x_index_i];
      b_o <= b_index_i == 4'd0 ? {LANES{1'b1}} : predicates_q[b_index_i];
    end
endmodule
`default_nettype wire
