// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Adds up to 2^EVENT_BITS - 1 events a cycle. The carry out of the low bits is added a cycle later, so
// that no long carry chain stands in a cycle. Promise: value_o + pending_o is the number of events up to
// and including this cycle's event_i; with LATE, the cycle before's: for events that are known late.
`default_nettype none
module rp_event_counter #(
  parameter integer BITS = 48,
  parameter integer LOW_BITS = 12,
  parameter integer EVENT_BITS = 6,         // at most LOW_BITS
  parameter integer LATE = 0
) (
  input  wire                  clk_i,
  input  wire                  rst_ni,
  input  wire [EVENT_BITS-1:0] event_i,
  output wire [BITS-1:0]       value_o,
  output wire [LOW_BITS:0]     pending_o
);
  localparam integer HIGH_BITS = BITS - LOW_BITS;
  reg [LOW_BITS-1:0] low_q;
  reg [HIGH_BITS-1:0] high_q;
  reg carry_q;
  wire [EVENT_BITS-1:0] event_then;
  generate
    if (LATE != 0) begin : gen_late
      reg [EVENT_BITS-1:0] event_q;
      always @(posedge clk_i) event_q <= rst_ni ? event_i : {EVENT_BITS{1'b0}};
      assign event_then = event_q;
    end else begin : gen_now
      assign event_then = event_i;
    end
  endgenerate
  wire [LOW_BITS-1:0] events = {{LOW_BITS-EVENT_BITS{1'b0}}, event_then};

  always @(posedge clk_i)
    if (!rst_ni) begin
      low_q <= {LOW_BITS{1'b0}};
      carry_q <= 1'b0;
      high_q <= {HIGH_BITS{1'b0}};
    end else begin
      {carry_q, low_q} <= {1'b0, low_q} + {1'b0, events};
      if (carry_q) high_q <= high_q + {{HIGH_BITS-1{1'b0}}, 1'b1};
    end
  assign value_o = {high_q, low_q};
  assign pending_o = {carry_q, events};
endmodule
`default_nettype wire
