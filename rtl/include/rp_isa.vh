// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/isa.hpp by `raypool isa --verilog`; a test compares. Do not edit.
  // Constants of the instruction set. To be included inside a module body; rtl/include/rp_isa_functions.vh decodes.
  // A module uses some of them only.
  /* verilator lint_off UNUSEDPARAM */

  // ALU types
  localparam [3:0] ISA_TYPE_TID = 4'd0;
  localparam [3:0] ISA_TYPE_BRH = 4'd1;
  localparam [3:0] ISA_TYPE_MEM = 4'd2;
  localparam [3:0] ISA_TYPE_INT = 4'd3;
  localparam [3:0] ISA_TYPE_FLT = 4'd4;
  localparam [3:0] ISA_TYPE_SLW = 4'd5;
  localparam [3:0] ISA_TYPE_RAY = 4'd6;

  // operations
  localparam [4:0] ISA_TID_TID = 5'd0;
  localparam [4:0] ISA_TID_LANE = 5'd1;
  localparam [4:0] ISA_TID_WARP = 5'd2;
  localparam [4:0] ISA_TID_BLOCK = 5'd3;
  localparam [4:0] ISA_TID_THREADS = 5'd4;
  localparam [4:0] ISA_TID_BLOCKS = 5'd5;
  localparam [4:0] ISA_TID_ARG = 5'd6;
  localparam [4:0] ISA_BRH_IEQ = 5'd0;
  localparam [4:0] ISA_BRH_INE = 5'd1;
  localparam [4:0] ISA_BRH_ILT = 5'd2;
  localparam [4:0] ISA_BRH_ILE = 5'd3;
  localparam [4:0] ISA_BRH_IGT = 5'd4;
  localparam [4:0] ISA_BRH_IGE = 5'd5;
  localparam [4:0] ISA_BRH_ULT = 5'd6;
  localparam [4:0] ISA_BRH_ULE = 5'd7;
  localparam [4:0] ISA_BRH_UGT = 5'd8;
  localparam [4:0] ISA_BRH_UGE = 5'd9;
  localparam [4:0] ISA_BRH_FEQ = 5'd10;
  localparam [4:0] ISA_BRH_FNE = 5'd11;
  localparam [4:0] ISA_BRH_FLT = 5'd12;
  localparam [4:0] ISA_BRH_FLE = 5'd13;
  localparam [4:0] ISA_BRH_FGT = 5'd14;
  localparam [4:0] ISA_BRH_FGE = 5'd15;
  localparam [4:0] ISA_BRH_PAND = 5'd16;
  localparam [4:0] ISA_BRH_POR = 5'd17;
  localparam [4:0] ISA_BRH_PXOR = 5'd18;
  localparam [4:0] ISA_BRH_PANDN = 5'd19;
  localparam [4:0] ISA_BRH_JANY = 5'd24;
  localparam [4:0] ISA_BRH_JNONE = 5'd25;
  localparam [4:0] ISA_BRH_CALL = 5'd26;
  localparam [4:0] ISA_BRH_LOOP = 5'd27;
  localparam [4:0] ISA_BRH_RET = 5'd28;
  localparam [4:0] ISA_BRH_EXIT = 5'd29;
  localparam [4:0] ISA_MEM_LD = 5'd0;
  localparam [4:0] ISA_MEM_ST = 5'd1;
  localparam [4:0] ISA_INT_MOV = 5'd0;
  localparam [4:0] ISA_INT_IADD = 5'd1;
  localparam [4:0] ISA_INT_ISUB = 5'd2;
  localparam [4:0] ISA_INT_IMUL = 5'd3;
  localparam [4:0] ISA_INT_AND = 5'd4;
  localparam [4:0] ISA_INT_OR = 5'd5;
  localparam [4:0] ISA_INT_XOR = 5'd6;
  localparam [4:0] ISA_INT_SHL = 5'd7;
  localparam [4:0] ISA_INT_SHR = 5'd8;
  localparam [4:0] ISA_INT_SAR = 5'd9;
  localparam [4:0] ISA_INT_IMIN = 5'd10;
  localparam [4:0] ISA_INT_IMAX = 5'd11;
  localparam [4:0] ISA_INT_UMIN = 5'd12;
  localparam [4:0] ISA_INT_UMAX = 5'd13;
  localparam [4:0] ISA_INT_SEL = 5'd14;
  localparam [4:0] ISA_FLT_FADD = 5'd0;
  localparam [4:0] ISA_FLT_FSUB = 5'd1;
  localparam [4:0] ISA_FLT_FMUL = 5'd2;
  localparam [4:0] ISA_FLT_FMIN = 5'd3;
  localparam [4:0] ISA_FLT_FMAX = 5'd4;
  localparam [4:0] ISA_FLT_F2I = 5'd5;
  localparam [4:0] ISA_FLT_I2F = 5'd6;
  localparam [4:0] ISA_FLT_FFMA = 5'd7;
  localparam [4:0] ISA_SLW_FDIV = 5'd0;
  localparam [4:0] ISA_SLW_FSQRT = 5'd1;
  localparam [4:0] ISA_SLW_FRSQRT = 5'd2;
  localparam [4:0] ISA_SLW_FRCP = 5'd3;
  localparam [4:0] ISA_RAY_RIN = 5'd0;
  localparam [4:0] ISA_RAY_ROUT = 5'd1;
  localparam [4:0] ISA_RAY_RFB = 5'd2;
  localparam [4:0] ISA_RAY_RLD = 5'd3;
  localparam [4:0] ISA_RAY_RST = 5'd4;
  localparam [4:0] ISA_FLT_FADD3 = 5'd16;
  localparam [4:0] ISA_FLT_FSUB3 = 5'd17;
  localparam [4:0] ISA_FLT_FMUL3 = 5'd18;
  localparam [4:0] ISA_FLT_FMUL3S = 5'd26;
  localparam [4:0] ISA_FLT_FFMA3 = 5'd23;
  localparam [4:0] ISA_FLT_FFMA3S = 5'd31;
  localparam [4:0] ISA_TID_ARG3 = 5'd22;
  localparam [4:0] ISA_MEM_LD3 = 5'd16;
  localparam [4:0] ISA_RAY_RLD3 = 5'd19;
  localparam [4:0] ISA_RAY_RST3 = 5'd20;
  localparam [4:0] ISA_TID_UNIT = 5'd7;
  localparam [4:0] ISA_MEM_INVAL = 5'd2;

  // whether an ALU type looks at an operand: bit n is that of type n
  localparam [15:0] ISA_HAS_OPERAND_A = 16'b0000000000111110;
  localparam [15:0] ISA_HAS_OPERAND_B = 16'b0000000001111110;
  localparam [15:0] ISA_HAS_OPERAND_C = 16'b0000000000010000;
  localparam [15:0] ISA_HAS_IMMEDIATE = 16'b0000000000000101;
  localparam [15:0] ISA_HAS_WORD = 16'b0000000001000000;
  localparam [15:0] ISA_HAS_PREDICATE_X = 16'b0000000000001010;
  localparam [15:0] ISA_HAS_PREDICATE_B = 16'b0000000000000010;
  /* verilator lint_on UNUSEDPARAM */
