// Takes launches: one may wait while a kernel runs. Starts the warps, notices the end of the kernel.
`default_nettype none
module launcher #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   launch_valid_i,
  output wire                   launch_ready_o,
  input  wire [15:0]            launch_pc_i,
  input  wire [10:0]            launch_threads_i,
  input  wire [31:0]            launch_block_i,
  input  wire [31:0]            launch_blocks_i,
  input  wire [1:0]             launch_import_i,
  // the ray ALU's import engine
  output wire                   import_start_o,
  input  wire                   import_active_i,
  // warps
  output wire [WARPS-1:0]       start_o,
  output wire [15:0]            start_pc_o,
  output wire [WARPS*LANES-1:0] start_lanes_o,
  input  wire [WARPS-1:0]       active_i,
  // the launch that runs
  output wire [WARPS-1:0]       launched_o,     // has threads of it
  output reg  [10:0]            threads_o,
  output reg  [31:0]            block_o,
  output reg  [31:0]            blocks_o,
  output wire                   kernel_done_o,
  output reg                    running_o,
  output wire                   waiting_o
);
  reg pending_q;
  reg [15:0] pc_q;
  reg [10:0] threads_q;
  reg [31:0] block_q, blocks_q;
  wire accept = launch_valid_i && launch_ready_o;
  wire start = pending_q && !running_o;
  genvar t;

  assign launch_ready_o = !pending_q && !import_active_i;
  assign import_start_o = accept && launch_import_i != 2'd0;
  assign start_pc_o = pc_q;
  assign kernel_done_o = running_o && active_i == {WARPS{1'b0}};
  assign waiting_o = pending_q;

  generate
    for (t = 0; t < WARPS * LANES; t = t + 1) begin : gen_thread
      localparam [10:0] THREAD = t;
      assign start_lanes_o[t] = THREAD < threads_q;
    end
    for (t = 0; t < WARPS; t = t + 1) begin : gen_warp
      localparam integer FIRST_THREAD = t * LANES;
      assign start_o[t] = start && start_lanes_o[t*LANES];
      assign launched_o[t] = threads_o > FIRST_THREAD[10:0];
    end
  endgenerate

  always @(posedge clk_i)
    if (!rst_ni) begin
      pending_q <= 1'b0;
      running_o <= 1'b0;
    end else begin
      if (accept) begin
        pending_q <= 1'b1;
        pc_q <= launch_pc_i;
        threads_q <= launch_threads_i;
        block_q <= launch_block_i;
        blocks_q <= launch_blocks_i;
      end
      if (start) begin
        pending_q <= 1'b0;
        running_o <= 1'b1;
        threads_o <= threads_q;
        block_o <= block_q;
        blocks_o <= blocks_q;
      end else if (kernel_done_o) begin
        running_o <= 1'b0;
      end
    end
endmodule
`default_nettype wire
