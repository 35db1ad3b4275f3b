// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Valid, warp and ready of an ALU with LATENCY cycles between tasks and DEPTH stages; it has no data path.
// A task that arrives in cycle t (task_valid_i) is done in cycle t + DEPTH (done_valid_o, done_warp_o).
// stage_valid_o[k] is high when the task which arrived k cycles ago is in its stage k now, so the data path's register
// behind stage k loads then, and the last one, behind stage DEPTH-1, is the done data. With ready_o a task granted in
// this cycle, which arrives in the next one, is taken; the dispatcher must not grant otherwise.
`default_nettype none
module rp_alu_pipeline #(
  parameter integer WARP_BITS = 3,
  parameter integer LATENCY = 1,
  parameter integer DEPTH = 1
) (
  input  wire                 clk_i,
  input  wire                 rst_ni,
  input  wire                 task_valid_i,
  input  wire [WARP_BITS-1:0] task_warp_i,
  output wire                 ready_o,
  output wire                 done_valid_o,
  output wire [WARP_BITS-1:0] done_warp_o,
  output wire [DEPTH-1:0]     stage_valid_o
);
  generate
    if (WARP_BITS < 1 || LATENCY < 1 || DEPTH < 1) begin : gen_illegal
      alu_pipeline_needs_warp_bits_latency_and_depth_of_at_least_1 illegal ();
    end
  endgenerate

  // Bit k-1 is that of stage k; the highest one is the done stage.
  reg [DEPTH-1:0] valid_q;
  reg [DEPTH*WARP_BITS-1:0] warp_q;

  generate
    if (DEPTH == 1) begin : gen_single
      assign stage_valid_o = task_valid_i;
      always @(posedge clk_i) begin
        if (task_valid_i) warp_q <= task_warp_i;
      end
    end else begin : gen_shift
      assign stage_valid_o = {valid_q[DEPTH-2:0], task_valid_i};
      always @(posedge clk_i) begin
        // Nothing moves while the pipeline is empty.
        if (|stage_valid_o) warp_q <= {warp_q[(DEPTH-1)*WARP_BITS-1:0], task_warp_i};
      end
    end
  endgenerate

  always @(posedge clk_i) begin
    if (!rst_ni) valid_q <= {DEPTH{1'b0}};
    else valid_q <= stage_valid_o;
  end

  assign done_valid_o = valid_q[DEPTH-1];
  assign done_warp_o = warp_q[(DEPTH-1)*WARP_BITS +: WARP_BITS];

  generate
    if (LATENCY == 1) begin : gen_always_ready
      assign ready_o = 1'b1;
    end else begin : gen_ready
      // Cycles after the one of arrival in which no grant is allowed yet: LATENCY-2.
      localparam integer COUNT_BITS = $clog2(LATENCY);
      localparam integer PAUSE = LATENCY - 2;
      reg [COUNT_BITS-1:0] pause_q;
      always @(posedge clk_i) begin
        if (!rst_ni) pause_q <= {COUNT_BITS{1'b0}};
        else if (task_valid_i) pause_q <= PAUSE[COUNT_BITS-1:0];
        else if (pause_q != {COUNT_BITS{1'b0}}) pause_q <= pause_q - {{(COUNT_BITS-1){1'b0}}, 1'b1};
      end
      assign ready_o = !task_valid_i && pause_q == {COUNT_BITS{1'b0}};
    end
  endgenerate
endmodule
`default_nettype wire
