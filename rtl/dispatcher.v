// Each cycle, gives every free ALU instance (slot) the lowest-numbered warp that wants its type and has no slot yet, and latches that
// warp's task into the slot's task register. Never grants a slot that is not ready, nor a warp twice.
`default_nettype none
module dispatcher #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer WARP_BITS = 3,
  parameter integer SLOTS = 7,
  parameter [SLOTS*4-1:0] SLOT_UNITS = 28'h6543210,  // type of each slot
  parameter integer FMA = 0                          // slots of type Flt have a third operand
) (
  input  wire                        clk_i,
  input  wire                        rst_ni,
  // warps
  input  wire [WARPS-1:0]            want_i,
  output reg  [WARPS-1:0]            grant_o,
  input  wire [WARPS*64-1:0]         instruction_i,
  input  wire [WARPS*LANES-1:0]      mask_i,
  input  wire [WARPS*LANES-1:0]      px_i,
  input  wire [WARPS*LANES-1:0]      pb_i,
  input  wire [WARPS*LANES*32-1:0]   a_i,
  input  wire [WARPS*LANES*32-1:0]   b_i,
  input  wire [WARPS*LANES*32-1:0]   c_i,
  // slots
  input  wire [SLOTS-1:0]            ready_i,
  output reg  [SLOTS-1:0]            slot_grant_o,   // in this cycle; the task register is valid in the next
  output reg  [SLOTS-1:0]            task_valid_o,
  output reg  [SLOTS*WARP_BITS-1:0]  task_warp_o,
  output reg  [SLOTS*5-1:0]          task_op_o,
  output reg  [SLOTS*LANES-1:0]      task_mask_o,
  output reg  [SLOTS*LANES*32-1:0]   task_a_o,
  output reg  [SLOTS*LANES*32-1:0]   task_b_o,
  output wire [SLOTS*LANES*32-1:0]   task_c_o,       // of slots without a third operand: zero
  output reg  [SLOTS*32-1:0]         task_imm_o,
  output reg  [SLOTS*5-1:0]          task_x_o,
  output reg  [SLOTS*LANES-1:0]      task_px_o,
  output reg  [SLOTS*LANES-1:0]      task_pb_o,
  // warps that got no slot in this cycle
  output wire [WARPS-1:0]            waiting_o
);
`include "isa.vh"
  localparam [WARPS-1:0] ONE = 1;
  reg [SLOTS*WARP_BITS-1:0] slot_warp;
  reg [WARPS-1:0] candidates, winner;
  integer s, w;

  always @* begin
    grant_o = {WARPS{1'b0}};
    slot_grant_o = {SLOTS{1'b0}};
    slot_warp = {SLOTS*WARP_BITS{1'b0}};
    candidates = {WARPS{1'b0}};
    winner = {WARPS{1'b0}};
    if (|want_i)
      for (s = 0; s < SLOTS; s = s + 1)
        if (ready_i[s]) begin
          for (w = 0; w < WARPS; w = w + 1)
            candidates[w] = want_i[w] && !grant_o[w] && instruction_i[w*64+60 +: 4] == SLOT_UNITS[s*4 +: 4];
          winner = candidates & (~candidates + ONE);
          grant_o = grant_o | winner;
          slot_grant_o[s] = |candidates;
          for (w = 0; w < WARPS; w = w + 1)
            if (winner[w]) slot_warp[s*WARP_BITS +: WARP_BITS] = w[WARP_BITS-1:0];
        end
  end

  assign waiting_o = want_i & ~grant_o;

  always @(posedge clk_i)
    if (!rst_ni) task_valid_o <= {SLOTS{1'b0}};
    else task_valid_o <= slot_grant_o;

  genvar k;
  generate
    for (k = 0; k < SLOTS; k = k + 1) begin : gen_slot
      // A type that does not look at an operand gets zeros: no register and no multiplexer is spent on it. A new type gets everything.
      localparam [3:0] UNIT = SLOT_UNITS[k*4 +: 4];
      localparam [0:0] NEW = UNIT != ISA_UNIT_TID && UNIT != ISA_UNIT_BRH && UNIT != ISA_UNIT_MEM && UNIT != ISA_UNIT_INT &&
                             UNIT != ISA_UNIT_FLT && UNIT != ISA_UNIT_SLW && UNIT != ISA_UNIT_RAY;
      localparam [0:0] USES_A = UNIT != ISA_UNIT_TID && UNIT != ISA_UNIT_RAY;
      localparam [0:0] USES_B = UNIT != ISA_UNIT_TID;
      localparam [0:0] USES_IMM = NEW || UNIT == ISA_UNIT_TID || UNIT == ISA_UNIT_MEM;
      localparam [0:0] USES_X = NEW || UNIT == ISA_UNIT_RAY;
      localparam [0:0] USES_PX = NEW || UNIT == ISA_UNIT_BRH || UNIT == ISA_UNIT_INT;
      localparam [0:0] USES_PB = NEW || UNIT == ISA_UNIT_BRH;
      wire [WARP_BITS-1:0] source = slot_warp[k*WARP_BITS +: WARP_BITS];
      always @(posedge clk_i)
        if (slot_grant_o[k]) begin
          task_warp_o[k*WARP_BITS +: WARP_BITS] <= source;
          task_op_o[k*5 +: 5] <= instruction_i[source*64+55 +: 5];
          task_imm_o[k*32 +: 32] <= USES_IMM ? instruction_i[source*64 +: 32] : 32'd0;
          task_x_o[k*5 +: 5] <= USES_X ? instruction_i[source*64+32 +: 5] : 5'd0;
          task_mask_o[k*LANES +: LANES] <= mask_i[source*LANES +: LANES];
          task_px_o[k*LANES +: LANES] <= USES_PX ? px_i[source*LANES +: LANES] : {LANES{1'b0}};
          task_pb_o[k*LANES +: LANES] <= USES_PB ? pb_i[source*LANES +: LANES] : {LANES{1'b0}};
          task_a_o[k*LANES*32 +: LANES*32] <= USES_A ? a_i[source*LANES*32 +: LANES*32] : {LANES*32{1'b0}};
          task_b_o[k*LANES*32 +: LANES*32] <= !USES_B ? {LANES*32{1'b0}} :
                                              instruction_i[source*64+37 +: 1] ? {LANES{instruction_i[source*64 +: 32]}} :
                                              b_i[source*LANES*32 +: LANES*32];
        end
      if (FMA != 0 && SLOT_UNITS[k*4 +: 4] == ISA_UNIT_FLT) begin : gen_third
        reg [LANES*32-1:0] c_q;
        always @(posedge clk_i) if (slot_grant_o[k]) c_q <= c_i[source*LANES*32 +: LANES*32];
        assign task_c_o[k*LANES*32 +: LANES*32] = c_q;
      end else begin : gen_no_third
        assign task_c_o[k*LANES*32 +: LANES*32] = {LANES*32{1'b0}};
      end
    end
  endgenerate
endmodule
`default_nettype wire
