// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Two lines at most that are offered to be looked up, of which one can be taken in a cycle: which, is known late, so it
// is looked at in the next cycle.
// Promises: each line that comes is taken once, as it came; the older one is offered first; what is offered stays until
// it is taken. No output depends on an input of the same cycle.
// Must be given: one of those that are offered at most is taken.
`default_nettype none
module rp_line_offers #(
  parameter integer WIDTH = 32
) (
  input  wire               clk_i,
  input  wire               rst_ni,
  input  wire               valid_i,
  output wire               ready_o,
  input  wire [WIDTH-1:0]   data_i,
  // the older one below
  output wire [1:0]         valid_o,
  output wire [2*WIDTH-1:0] data_o,
  input  wire [1:0]         taken_i,
  // what was taken in the cycle before
  output wire               asked_o,
  output wire [WIDTH-1:0]   asked_data_o
);
  reg [1:0] there_q;
  reg older_q;                                   // which is older; if one is free, the other
  reg [WIDTH-1:0] low_q, high_q;
  assign ready_o = there_q != 2'b11;
  wire [1:0] comes = (valid_i && ready_o) ? {there_q[0], !there_q[0]} : 2'd0;
  assign valid_o = {&there_q, |there_q};
  assign data_o = older_q ? {low_q, high_q} : {high_q, low_q};
  wire [1:0] gone = older_q ? {taken_i[0], taken_i[1]} : taken_i;
  // In the cycle after, a register still has what was taken out of it.
  reg [1:0] gone_q;
  assign asked_o = |gone_q;
  assign asked_data_o = gone_q[1] ? high_q : low_q;
  always @(posedge clk_i)
    if (!rst_ni) begin
      there_q <= 2'd0;
      older_q <= 1'b0;
      gone_q <= 2'd0;
    end else begin
      there_q <= (there_q | comes) & ~gone;
      if (|gone) older_q <= gone[0];
      else if (there_q == 2'd0) older_q <= 1'b0;
      gone_q <= gone;
    end
  always @(posedge clk_i) begin
    if (comes[0]) low_q <= data_i;
    if (comes[1]) high_q <= data_i;
  end
endmodule
`default_nettype wire
