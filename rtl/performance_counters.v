// Counts events while a kernel runs; numbers as in cpp_model/machine/compute_unit.hpp, namespace counter.
`default_nettype none
module performance_counters #(
  parameter integer WARPS = 8,
  parameter integer LANES = 8,
  parameter integer SLOTS = 7,
  parameter integer UNITS = 7,
  parameter [SLOTS*4-1:0] SLOT_UNITS = 28'h6543210
) (
  input  wire                   clk_i,
  input  wire                   rst_ni,
  input  wire                   running_i,
  input  wire [WARPS-1:0]       retire_i,
  input  wire [WARPS*LANES-1:0] retire_mask_i,
  input  wire                   instruction_hit_i,
  input  wire                   instruction_miss_i,
  input  wire                   data_hit_i,
  input  wire                   data_miss_i,
  input  wire                   data_store_i,
  input  wire [SLOTS-1:0]       ready_i,
  input  wire [SLOTS-1:0]       grant_i,
  input  wire [UNITS*6-1:0]     waiting_i,
  input  wire [5:0]             select_i,
  output reg  [63:0]            value_o
);
  localparam integer BITS = 48;
  reg [BITS-1:0] busy_q, instructions_q, threads_q, ihit_q, imiss_q, dhit_q, dmiss_q, dstore_q;
  reg [5:0] instructions;
  reg [10:0] threads;
  integer i;

  always @* begin
    instructions = 6'd0;
    threads = 11'd0;
    if (|retire_i)
      for (i = 0; i < WARPS * LANES; i = i + 1) begin
        if (i % LANES == 0) instructions = instructions + {5'd0, retire_i[i / LANES]};
        threads = threads + {10'd0, retire_i[i / LANES] & retire_mask_i[i]};
      end
  end

  always @(posedge clk_i)
    if (!rst_ni) begin
      busy_q <= {BITS{1'b0}};
      instructions_q <= {BITS{1'b0}};
      threads_q <= {BITS{1'b0}};
      ihit_q <= {BITS{1'b0}};
      imiss_q <= {BITS{1'b0}};
      dhit_q <= {BITS{1'b0}};
      dmiss_q <= {BITS{1'b0}};
      dstore_q <= {BITS{1'b0}};
    end else if (running_i) begin
      busy_q <= busy_q + {{BITS-1{1'b0}}, 1'b1};
      if (|retire_i) begin
        instructions_q <= instructions_q + {{BITS-6{1'b0}}, instructions};
        threads_q <= threads_q + {{BITS-11{1'b0}}, threads};
      end
      if (instruction_hit_i) ihit_q <= ihit_q + {{BITS-1{1'b0}}, 1'b1};
      if (instruction_miss_i) imiss_q <= imiss_q + {{BITS-1{1'b0}}, 1'b1};
      if (data_hit_i) dhit_q <= dhit_q + {{BITS-1{1'b0}}, 1'b1};
      if (data_miss_i) dmiss_q <= dmiss_q + {{BITS-1{1'b0}}, 1'b1};
      if (data_store_i) dstore_q <= dstore_q + {{BITS-1{1'b0}}, 1'b1};
    end

  // How many of a type's slots are set in `slots`.
  function [4:0] count(input [3:0] unit, input [SLOTS-1:0] slots);
    integer n;
    begin
      count = 5'd0;
      for (n = 0; n < SLOTS; n = n + 1)
        if (SLOT_UNITS[n*4 +: 4] == unit) count = count + {4'd0, slots[n]};
    end
  endfunction

  wire [BITS*UNITS-1:0] unused, waiting, issued;
  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      localparam [3:0] UNIT = u;
      reg [BITS-1:0] unused_q, waiting_q, issued_q;
      always @(posedge clk_i)
        if (!rst_ni) begin
          unused_q <= {BITS{1'b0}};
          waiting_q <= {BITS{1'b0}};
          issued_q <= {BITS{1'b0}};
        end else if (running_i) begin
          unused_q <= unused_q + {{BITS-5{1'b0}}, count(UNIT, ready_i & ~grant_i)};
          waiting_q <= waiting_q + {{BITS-6{1'b0}}, waiting_i[u*6 +: 6]};
          issued_q <= issued_q + {{BITS-5{1'b0}}, count(UNIT, grant_i)};
        end
      assign unused[u*BITS +: BITS] = unused_q;
      assign waiting[u*BITS +: BITS] = waiting_q;
      assign issued[u*BITS +: BITS] = issued_q;
    end
  endgenerate

  // Numbers 16, 24 and 32 begin a row of eight, one a type.
  reg [BITS-1:0] selected;
  always @* begin
    selected = {BITS{1'b0}};
    case (select_i)
      6'd0: selected = busy_q;
      6'd1: selected = instructions_q;
      6'd2: selected = threads_q;
      6'd3: selected = ihit_q;
      6'd4: selected = imiss_q;
      6'd5: selected = dhit_q;
      6'd6: selected = dmiss_q;
      6'd7: selected = dstore_q;
      default:
        for (i = 0; i < UNITS; i = i + 1)
          if (select_i[2:0] == i[2:0])
            case (select_i[5:3])
              3'd2: selected = unused[i*BITS +: BITS];
              3'd3: selected = waiting[i*BITS +: BITS];
              3'd4: selected = issued[i*BITS +: BITS];
              default: ;
            endcase
    endcase
    value_o = {{64-BITS{1'b0}}, selected};
  end
endmodule
`default_nettype wire
