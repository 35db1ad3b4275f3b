// Bench top: of each ALU type that may lack instructions, one ALU that has them all beside one for each of them that
// has none of the others, all fed with the same tasks. The types are 0 brh, 1 int, 2 flt, 3
// slw. Bit type * 32 + operation of differs_o: the ALU with that instruction alone ends a task with another result than
// the one that has all.
`default_nettype none
module left_out_units #(
  parameter integer SUBNORMALS = 0,
  parameter integer SIGNIFICAND = 24,
  parameter integer SLOW_UNIT = 0
) (
  input  wire         clk_i,
  input  wire         rst_ni,
  input  wire         task_valid_i,
  input  wire [4:0]   task_operation_i,
  input  wire [31:0]  task_operand_a_i,
  input  wire [31:0]  task_operand_b_i,
  input  wire         task_predicate_x_i,
  output wire [3:0]   done_valid_o,
  output wire [127:0] differs_o
);
`include "rp_isa.vh"
`include "rp_isa_functions.vh"
  localparam [15:0] TYPES = {ISA_TYPE_SLW, ISA_TYPE_FLT, ISA_TYPE_INT, ISA_TYPE_BRH};
  // The instructions of a type that a unit may lack.
  function [31:0] optional(input integer type_of_bench);
    integer operation;
    for (operation = 0; operation < 32; operation = operation + 1)
      optional[operation] = isa_optional_op({TYPES[type_of_bench*4 +: 4], operation[4:0], 55'd0});
  endfunction
  localparam integer SLOW_DEPTH = (SLOW_UNIT <= 1) ? 11 : (SLOW_UNIT == 2) ? 8 : 6;
  genvar t, n;
  generate
    for (t = 0; t < 4; t = t + 1) begin : gen_type
      localparam [31:0] OPTIONAL = optional(t);
      wire [31:0] whole_data;
      wire whole_predicate;
      // Number 32 has all.
      for (n = 0; n <= 32; n = n + 1) begin : gen_alone
        if (n == 32 || OPTIONAL[n & 31]) begin : gen_unit
          localparam integer WITHOUT = (n == 32) ? 0 : OPTIONAL & ~(32'd1 << n);
          wire [31:0] data;
          wire predicate, valid;
`define TASK .clk_i(clk_i), .rst_ni(rst_ni), .task_valid_i(task_valid_i), .task_warp_i(1'b0), \
            .task_operation_i(task_operation_i), .task_mask_i(1'b1), .task_operand_a_i(task_operand_a_i), \
            .task_operand_b_i(task_operand_b_i), .task_operand_c_i(32'd0), .task_immediate_i(32'd0), \
            .task_word_i(5'd0), .task_predicate_x_i(task_predicate_x_i), .task_predicate_b_i(1'b0), .ready_o(), \
            .done_valid_o(valid), .done_warp_o(), .done_data_o(data), .done_predicate_o(predicate)
          if (t == 0) begin : gen_brh
            rp_brh_alu #(.WARPS(1), .LANES(1), .WARP_BITS(1), .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND),
              .WITHOUT(WITHOUT)) unit (`TASK, .done_subnormal_o());
          end else if (t == 1) begin : gen_int
            rp_int_alu #(.WARPS(1), .LANES(1), .WARP_BITS(1), .WITHOUT(WITHOUT)) unit (`TASK);
          end else if (t == 2) begin : gen_flt
            rp_flt_alu #(.WARPS(1), .LANES(1), .WARP_BITS(1), .SUBNORMALS(SUBNORMALS), .SIGNIFICAND(SIGNIFICAND),
              .WITHOUT(WITHOUT)) unit (`TASK, .done_subnormal_o());
          end else begin : gen_slw
            rp_slw_alu #(.WARPS(1), .LANES(1), .WARP_BITS(1), .DEPTH(SLOW_DEPTH), .SUBNORMALS(SUBNORMALS),
              .SIGNIFICAND(SIGNIFICAND), .SLOW_UNIT(SLOW_UNIT), .WITHOUT(WITHOUT)) unit (`TASK, .done_subnormal_o());
          end
          if (n == 32) begin : gen_whole
            assign whole_data = data;
            assign whole_predicate = predicate;
            assign done_valid_o[t] = valid;
          end else begin : gen_compare
            assign differs_o[t*32 + (n & 31)] =
              valid != done_valid_o[t] || (valid && (data != whole_data || predicate != whole_predicate));
          end
        end else if (n != 32) begin : gen_none
          assign differs_o[t*32 + (n & 31)] = 1'b0;
        end
      end
    end
  endgenerate
endmodule
`default_nettype wire
