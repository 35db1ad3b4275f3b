// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
  // Generated from cpp_model/isa/isa.hpp by `raypool isa --verilog-functions`; a test compares. Do not edit.
  // Decoding functions of the instruction set. To be included inside a module body; they need no constants. A label is
  // ALU type * 32 + operation.

  // every machine has this instruction
  function isa_legal_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: tid lane warp block threads blocks arg
        9'd0, 9'd1, 9'd2, 9'd3, 9'd4, 9'd5, 9'd6
        // brh: ieq igt ult uge pand por pxor pandn jany jnone call loop ret exit
        , 9'd32, 9'd36, 9'd38, 9'd41, 9'd48, 9'd49, 9'd50, 9'd51, 9'd56, 9'd57, 9'd58, 9'd59, 9'd60, 9'd61
        // mem: ld st
        , 9'd64, 9'd65
        // int: mov iadd isub and xor shl shr
        , 9'd96, 9'd97, 9'd98, 9'd100, 9'd102, 9'd103, 9'd104
        // flt: fadd fsub fmul
        , 9'd128, 9'd129, 9'd130
        // ray: rin rout rfb rld rst
        , 9'd192, 9'd193, 9'd194, 9'd195, 9'd196
          : isa_legal_op = 1'b1;
        default: isa_legal_op = 1'b0;
      endcase
    end
  endfunction

  // a machine has this instruction unless its ALU is without it
  function isa_optional_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: ine ilt ile ige ule ugt feq fne flt fle fgt fge
        9'd33, 9'd34, 9'd35, 9'd37, 9'd39, 9'd40, 9'd42, 9'd43, 9'd44, 9'd45, 9'd46, 9'd47
        // int: imul or sar imin imax umin umax sel
        , 9'd99, 9'd101, 9'd105, 9'd106, 9'd107, 9'd108, 9'd109, 9'd110
        // flt: fmin fmax f2i i2f
        , 9'd131, 9'd132, 9'd133, 9'd134
        // slw: fdiv fsqrt frsqrt frcp
        , 9'd160, 9'd161, 9'd162, 9'd163
          : isa_optional_op = 1'b1;
        default: isa_optional_op = 1'b0;
      endcase
    end
  endfunction

  // machines with arithmetic.fma have this instruction
  function isa_legal_fma_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // flt: ffma
        9'd135
          : isa_legal_fma_op = 1'b1;
        default: isa_legal_fma_op = 1'b0;
      endcase
    end
  endfunction

  // machines with triples have this instruction
  function isa_legal_triple_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: arg3
        9'd22
        // mem: ld3
        , 9'd80
        // flt: fadd3 fsub3 fmul3 fmul3s
        , 9'd144, 9'd145, 9'd146, 9'd154
        // ray: rld3 rst3
        , 9'd211, 9'd212
          : isa_legal_triple_op = 1'b1;
        default: isa_legal_triple_op = 1'b0;
      endcase
    end
  endfunction

  // machines with both have this instruction
  function isa_legal_fused_triple_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // flt: ffma3 ffma3s
        9'd151, 9'd159
          : isa_legal_fused_triple_op = 1'b1;
        default: isa_legal_fused_triple_op = 1'b0;
      endcase
    end
  endfunction

  // machines with sharing have this instruction
  function isa_legal_sharing_op;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: unit
        9'd7
        // mem: inval
        , 9'd66
          : isa_legal_sharing_op = 1'b1;
        default: isa_legal_sharing_op = 1'b0;
      endcase
    end
  endfunction

  // the instruction accesses three words of a ray package
  function isa_triple_of_words;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // ray: rld3 rst3
        9'd211, 9'd212
          : isa_triple_of_words = 1'b1;
        default: isa_triple_of_words = 1'b0;
      endcase
    end
  endfunction

  // has a register in ra
  function isa_names_ra;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: ieq ine ilt ile igt ige ult ule ugt uge feq fne flt fle
        //   fgt fge
        9'd32, 9'd33, 9'd34, 9'd35, 9'd36, 9'd37, 9'd38, 9'd39, 9'd40, 9'd41, 9'd42, 9'd43, 9'd44, 9'd45,
        9'd46, 9'd47
        // mem: ld st ld3 inval
        , 9'd64, 9'd65, 9'd80, 9'd66
        // int: iadd isub imul and or xor shl shr sar imin imax umin umax sel
        , 9'd97, 9'd98, 9'd99, 9'd100, 9'd101, 9'd102, 9'd103, 9'd104, 9'd105, 9'd106, 9'd107, 9'd108, 9'd109, 9'd110
        // flt: fadd fsub fmul fmin fmax f2i i2f ffma fadd3 fsub3 fmul3 fmul3s ffma3 ffma3s
        , 9'd128, 9'd129, 9'd130, 9'd131, 9'd132, 9'd133, 9'd134, 9'd135, 9'd144, 9'd145, 9'd146, 9'd154, 9'd151, 9'd159
        // slw: fdiv fsqrt frsqrt frcp
        , 9'd160, 9'd161, 9'd162, 9'd163
          : isa_names_ra = 1'b1;
        default: isa_names_ra = 1'b0;
      endcase
    end
  endfunction

  // has a register in rb, unless bit 37 makes b the immediate
  function isa_names_b;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: ieq ine ilt ile igt ige ult ule ugt uge feq fne flt fle
        //   fgt fge
        9'd32, 9'd33, 9'd34, 9'd35, 9'd36, 9'd37, 9'd38, 9'd39, 9'd40, 9'd41, 9'd42, 9'd43, 9'd44, 9'd45,
        9'd46, 9'd47
        // int: mov iadd isub imul and or xor shl shr sar imin imax umin umax
        //   sel
        , 9'd96, 9'd97, 9'd98, 9'd99, 9'd100, 9'd101, 9'd102, 9'd103, 9'd104, 9'd105, 9'd106, 9'd107, 9'd108, 9'd109,
        9'd110
        // flt: fadd fsub fmul fmin fmax ffma fadd3 fsub3 fmul3 fmul3s ffma3 ffma3s
        , 9'd128, 9'd129, 9'd130, 9'd131, 9'd132, 9'd135, 9'd144, 9'd145, 9'd146, 9'd154, 9'd151, 9'd159
        // slw: fdiv
        , 9'd160
        // ray: rst rst3
        , 9'd196, 9'd212
          : isa_names_b = 1'b1;
        default: isa_names_b = 1'b0;
      endcase
    end
  endfunction

  // has a register in rb
  function isa_names_rb;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // mem: st
        9'd65
          : isa_names_rb = 1'b1;
        default: isa_names_rb = 1'b0;
      endcase
    end
  endfunction

  // has a register in x
  function isa_names_rc;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // flt: ffma ffma3 ffma3s
        9'd135, 9'd151, 9'd159
          : isa_names_rc = 1'b1;
        default: isa_names_rc = 1'b0;
      endcase
    end
  endfunction

  // has a predicate in x
  function isa_names_px;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: pand por pxor pandn
        9'd48, 9'd49, 9'd50, 9'd51
        // int: sel
        , 9'd110
          : isa_names_px = 1'b1;
        default: isa_names_px = 1'b0;
      endcase
    end
  endfunction

  // has a predicate in rb
  function isa_names_pb;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: pand por pxor pandn
        9'd48, 9'd49, 9'd50, 9'd51
          : isa_names_pb = 1'b1;
        default: isa_names_pb = 1'b0;
      endcase
    end
  endfunction

  // has an argument's number in the immediate
  function isa_names_argument;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: arg arg3
        9'd6, 9'd22
          : isa_names_argument = 1'b1;
        default: isa_names_argument = 1'b0;
      endcase
    end
  endfunction

  // all registers, predicates and arguments that the instruction names are there, where there are so many; of a
  // triple those of its last element too. Numbers go on behind the last of 16 registers and 32 arguments
  function isa_numbers_fit;
    input [63:0] encoding;
    input [4:0] registers;
    input [4:0] predicates;
    input [5:0] arguments;
    reg three, same_ra;
    reg [4:0] last, last_moving, last_predicate;
    reg [5:0] last_argument;
    begin
      three = isa_triple(encoding);
      same_ra = encoding[58] || encoding[63:60] == 4'd2;
      last = registers - 5'd1;
      last_moving = three && registers != 5'd16 ? registers - 5'd3 : last;
      last_predicate = predicates - 5'd1;
      last_argument = three && arguments != 6'd32 ? arguments - 6'd3 : arguments - 6'd1;
      isa_numbers_fit = !(
        {1'b0, encoding[53:50]} > last_predicate ||
        (isa_writes_register(encoding) && {1'b0, encoding[49:46]} > last_moving) ||
        (isa_names_ra(encoding) && {1'b0, encoding[45:42]} > (same_ra ? last : last_moving)) ||
        (isa_names_b(encoding) && !encoding[37] && {1'b0, encoding[41:38]} > last_moving) ||
        (isa_names_rb(encoding) && {1'b0, encoding[41:38]} > last) ||
        (isa_names_rc(encoding) && {1'b0, encoding[35:32]} > last_moving) ||
        (isa_writes_predicate(encoding) && {1'b0, encoding[49:46]} > last_predicate) ||
        (isa_names_px(encoding) && {1'b0, encoding[35:32]} > last_predicate) ||
        (isa_names_pb(encoding) && {1'b0, encoding[41:38]} > last_predicate) ||
        (isa_names_argument(encoding) && {1'b0, encoding[4:0]} > last_argument));
    end
  endfunction

  // the instruction has a table row, and the machine what it needs; fma: arithmetic.fma. A triple's words are
  // all there, in packages of package_words. lacking: it is one that its ALU is without, or names what is not there
  function isa_legal;
    input [63:0] encoding;
    input fma;
    input triples;
    input sharing;
    input [4:0] package_words;
    input lacking;
    begin
      isa_legal = isa_legal_op(encoding) || (!lacking && isa_optional_op(encoding)) ||
                  (fma && isa_legal_fma_op(encoding)) ||
                  (sharing && isa_legal_sharing_op(encoding)) ||
                  (triples && isa_legal_triple_op(encoding) &&
                   !(isa_triple_of_words(encoding) && encoding[36:32] > package_words - 5'd3)) ||
                  (fma && triples && isa_legal_fused_triple_op(encoding));
    end
  endfunction

  // the instruction does three
  function isa_triple;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: arg3
        9'd22
        // mem: ld3
        , 9'd80
        // flt: fadd3 fsub3 fmul3 fmul3s ffma3 ffma3s
        , 9'd144, 9'd145, 9'd146, 9'd154, 9'd151, 9'd159
        // ray: rld3 rst3
        , 9'd211, 9'd212
          : isa_triple = 1'b1;
        default: isa_triple = 1'b0;
      endcase
    end
  endfunction

  // an element of this float triple reads what an earlier one has written
  function isa_elements_depend;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    reg [3:0] a, b, c;
    begin
      a = encoding[49:46] - encoding[45:42];
      b = encoding[49:46] - encoding[41:38];
      c = encoding[49:46] - encoding[35:32];
      isa_elements_depend = (encoding[58] ? a == 4'd0 || a == 4'd15 : a == 4'd1 || a == 4'd2) ||
                            (!encoding[37] && (b == 4'd1 || b == 4'd2)) ||
                            (encoding[57:55] == 3'd7 && (c == 4'd1 || c == 4'd2));
    end
  endfunction

  // writes register rd
  function isa_writes_register;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // tid: tid lane warp block threads blocks arg arg3 unit
        9'd0, 9'd1, 9'd2, 9'd3, 9'd4, 9'd5, 9'd6, 9'd22, 9'd7
        // mem: ld ld3
        , 9'd64, 9'd80
        // int: mov iadd isub imul and or xor shl shr sar imin imax umin umax
        //   sel
        , 9'd96, 9'd97, 9'd98, 9'd99, 9'd100, 9'd101, 9'd102, 9'd103, 9'd104, 9'd105, 9'd106, 9'd107, 9'd108, 9'd109,
        9'd110
        // flt: fadd fsub fmul fmin fmax f2i i2f ffma fadd3 fsub3 fmul3 fmul3s ffma3 ffma3s
        , 9'd128, 9'd129, 9'd130, 9'd131, 9'd132, 9'd133, 9'd134, 9'd135, 9'd144, 9'd145, 9'd146, 9'd154, 9'd151, 9'd159
        // slw: fdiv fsqrt frsqrt frcp
        , 9'd160, 9'd161, 9'd162, 9'd163
        // ray: rld rld3
        , 9'd195, 9'd211
          : isa_writes_register = 1'b1;
        default: isa_writes_register = 1'b0;
      endcase
    end
  endfunction

  // writes predicate pd
  function isa_writes_predicate;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: ieq ine ilt ile igt ige ult ule ugt uge feq fne flt fle
        //   fgt fge pand por pxor pandn
        9'd32, 9'd33, 9'd34, 9'd35, 9'd36, 9'd37, 9'd38, 9'd39, 9'd40, 9'd41, 9'd42, 9'd43, 9'd44, 9'd45,
        9'd46, 9'd47, 9'd48, 9'd49, 9'd50, 9'd51
          : isa_writes_predicate = 1'b1;
        default: isa_writes_predicate = 1'b0;
      endcase
    end
  endfunction

  // stops the instruction routine until its write-back
  function isa_control;
    /* verilator lint_off UNUSEDSIGNAL */
    input [63:0] encoding;
    /* verilator lint_on UNUSEDSIGNAL */
    begin
      case ({encoding[63:60], encoding[59:55]})
        // brh: jany jnone call loop ret exit
        9'd56, 9'd57, 9'd58, 9'd59, 9'd60, 9'd61
          : isa_control = 1'b1;
        default: isa_control = 1'b0;
      endcase
    end
  endfunction
