// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Shares a port among 2 to 4 requesters, in rotation, a package of one or more transfers at a time. Adds no cycle.
// Promises: the chosen requester keeps the port until the last transfer of its package, also while it has nothing to
// send, so that packages are never mixed and what is offered stays stable; a requester that keeps asking is served
// before any other is served twice. Valid does not depend on ready.
// Must be given: valid_i, data_i and last_i from registers; each stays as it is while it waits.
`default_nettype none
module rp_port_arbiter #(
  parameter integer COUNT = 4,
  parameter integer WIDTH = 32
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  // requesters
  input  wire [COUNT-1:0]       valid_i,
  output wire [COUNT-1:0]       ready_o,
  input  wire [COUNT*WIDTH-1:0] data_i,
  input  wire [COUNT-1:0]       last_i,    // the transfer is its package's last
  // the port
  output wire                   valid_o,
  input  wire                   ready_i,
  output reg  [WIDTH-1:0]       data_o,
  output reg  [1:0]             number_o   // of the requester, while valid_o
);
  generate
    if (COUNT < 2 || COUNT > 4) begin : gen_illegal
      port_arbiter_COUNT_must_be_from_2_to_4 illegal ();
    end
  endgenerate

  reg locked_q;              // a package is under way or offered
  reg [COUNT-1:0] choice_q;  // the requester that has the port; one-hot
  wire [COUNT-1:0] next;
  wire [COUNT-1:0] grant = locked_q ? choice_q : next;

  rp_round_robin #(.COUNT(COUNT)) round_robin (
    .clk_i(clk_i), .rst_ni(rst_ni), .request_i(valid_i), .advance_i(!locked_q), .grant_o(next));

  assign valid_o = |(valid_i & grant);
  assign ready_o = grant & {COUNT{ready_i}};

  integer n;
  always @* begin
    data_o = {WIDTH{1'b0}};
    number_o = 2'd0;
    for (n = 0; n < COUNT; n = n + 1)
      if (grant[n]) begin
        data_o = data_i[n*WIDTH +: WIDTH];
        number_o = n[1:0];
      end
  end

  always @(posedge clk_i)
    if (!rst_ni) begin
      locked_q <= 1'b0;
      choice_q <= {COUNT{1'b0}};
    end else if (valid_o) begin
      locked_q <= !(ready_i && |(last_i & grant));
      choice_q <= grant;
    end
endmodule
`default_nettype wire
