// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The one table of ALU types and instructions. Decoder, encoder, assembler, disassembler, configuration keys, Verilog
// parameters, rtl/include/*.vh and docs/machine/isa.md are derived from it. docs/develop/add-an-alu.md adds a type.
//
// Encoding of an instruction, 64 bits:
//   63:60 type | 59:55 operation | 54 guard negated | 53:50 guard predicate
//   49:46 rd (or pd) | 45:42 ra | 41:38 rb (or pb) | 37 b is the immediate
//   36:32 x (predicate ps/pa, register rc, or word of a ray package) | 31:0 immediate
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "enum_array.hpp"

namespace raypool {

// The ALU types, a row each in the order of their numbers.
//   type        enumerator of AluType; its number is the unit field of an instruction
//   name        three lower-case letters: key of the configuration, prefix of the Verilog parameters, module <name>_alu
//   depth       least pipeline depth, which is what the function needs at speed, and
//               the default one; 0: timed by events
//   ports       Framework: those of docs/machine/architecture.md, section 3; rtl/include/rp_alu_instances.vh
//               places it. Guarded: these and done_subnormal_o. Own: rtl/compute/rp_compute_unit.v places it
//   parameters  of the module beside the framework's, as rtl/compute/rp_compute_unit.v names them, separated by ", "; a
//   type
//               with instructions that are Optional has WITHOUT too, a bit for each operation that it lacks
//   title       for docs/machine/isa.md
// CORE: FunctionalCore executes the type. CLASS: a class derived from AluModel does, and the ports are the framework's.
// clang-format off
#define RAYPOOL_ALU_TYPES(CORE, CLASS) \
  CORE(Tid, "tid",  1, Own,       "",                       "indices, dimensions, arguments") \
  CORE(Brh, "brh",  2, Guarded,   "SUBNORMALS, SIGNIFICAND", "compares, predicates, control") \
  CORE(Mem, "mem",  0, Own,       "",                       "memory") \
  CORE(Int, "int",  2, Framework, "",                       "integer and logic") \
  CORE(Flt, "flt",  3, Guarded,   "SUBNORMALS, SIGNIFICAND, FMA", "single-precision float") \
  CORE(Slw, "slw", 11, Guarded,   "SUBNORMALS, SIGNIFICAND, SLOW_UNIT, SLOW_LANES", \
       "slow float: division and square roots") \
  CORE(Ray, "ray",  0, Own,       "",                       "ray packages") \
  /* The table ends here: the backslash above lets a row follow it. */
// clang-format on

/// ALU types. The value is the unit field of an instruction.
enum class AluType : uint8_t {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) type,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) type,
  RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
};

enum class Ports : uint8_t { Framework, Guarded, Own };

struct AluInfo {
  std::string_view name;
  uint32_t depth;
  Ports ports;
  std::string_view parameters;  ///< separated by ", "
  std::string_view title;
  bool timed_by_events() const { return depth == 0; }
};

inline constexpr AluType kEveryAluType[] = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) AluType::type,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) AluType::type,
    RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
};

inline constexpr int kAluTypes = std::size(kEveryAluType);
static_assert(kAluTypes <= 8, "the performance counters have room for eight ALU types");

inline constexpr EnumArray<AluType, AluInfo, kAluTypes> kAluTable = {{{
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) {name, depth, Ports::ports, parameters, title},
#define RAYPOOL_CLASS(type, name, depth, parameters, title) {name, depth, Ports::Framework, parameters, title},
    RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
}}};

inline constexpr EnumArray<AluType, std::string_view, kAluTypes> kAluNames = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) name,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) name,
    RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
};

inline constexpr const AluInfo& alu_info(AluType type) { return kAluTable[type]; }

/// One operand in the order of the assembly text, and where it is encoded.
enum class Operand : uint8_t {
  None,
  Rd,        ///< destination register, rd
  Ra,        ///< source register, ra
  Rb,        ///< source register rb
  Rc,        ///< source register, in x[3:0]
  B,         ///< source register rb, or the immediate (b_is_immediate)
  Pd,        ///< destination predicate, in rd
  Px,        ///< source predicate, in x[3:0]
  Pb,        ///< source predicate, in rb
  Address,   ///< [ra + immediate]
  Word,      ///< word of a ray package, in x, 0 .. 20
  Argument,  ///< kernel argument, in the immediate, 0 .. 31
  Target,    ///< instruction address, in immediate[15:0]
  End,       ///< instruction address, in immediate[31:16] beside a Target, else in immediate[15:0]
};

/// How the immediate of operand B is written in assembly text.
enum class ImmediateType : uint8_t { None, Integer, Float, Either };

/// What an instruction is to its warp beside its result.
enum class Kind : uint8_t {
  Plain,
  Control,  ///< decides on the PC: stops the instruction routine until write-back
  Swap,     ///< exchanges the ray slices of all lanes for other ones, whatever the mask; may have to wait for them
};

/// What a configuration must have for an instruction to be legal.
enum class Feature : uint8_t {
  Base,              ///< nothing: every machine has the instruction
  Optional,          ///< nothing: every machine has it unless its alus.TYPE.without names it
  FusedMultiplyAdd,  ///< arithmetic.fma
  Triples,           ///< triples
  FusedTriples,      ///< both
  Sharing,           ///< sharing
};

// The instructions, a row each. Programs drawn at random depend on the order of the rows.
// clang-format off
//   name       enumerator of Opcode; in lower case the mnemonic, in upper case and behind
//              ISA_<ALU type>_ the Verilog constant
//   type       enumerator of AluType
//   operation  0 .. 31, no two of a type the same
//   operands   four of Operand, in the order of the assembly text
//   immediate  of ImmediateType: what operand B is when it is no register
//   kind       of Kind
//   meaning    for docs/machine/isa.md; behind it, if not every machine has the instruction, a Feature
#define RAYPOOL_INSTRUCTIONS(ROW) \
  /* Tid: indices, dimensions, arguments */ \
  ROW(Tid,     Tid, 0,  Rd, None, None, None, None, Plain, "rd = index of the thread in its block") \
  ROW(Lane,    Tid, 1,  Rd, None, None, None, None, Plain, "rd = lane of the thread") \
  ROW(Warp,    Tid, 2,  Rd, None, None, None, None, Plain, "rd = warp of the thread") \
  ROW(Block,   Tid, 3,  Rd, None, None, None, None, Plain, "rd = block word of the launch") \
  ROW(Threads, Tid, 4,  Rd, None, None, None, None, Plain, "rd = threads in this block") \
  ROW(Blocks,  Tid, 5,  Rd, None, None, None, None, Plain, "rd = blocks in the grid") \
  ROW(Arg,     Tid, 6,  Rd, Argument, None, None, None, Plain, "rd = kernel argument word") \
  /* Brh: compares into predicates (result AND mask, all lanes written), predicate logic, control */ \
  ROW(Ieq,     Brh, 0,  Pd, Ra, B, None, Integer, Plain, "pd = ra == b") \
  ROW(Ine,     Brh, 1,  Pd, Ra, B, None, Integer, Plain, "pd = ra != b", Feature::Optional) \
  ROW(Ilt,     Brh, 2,  Pd, Ra, B, None, Integer, Plain, "pd = ra < b, signed", Feature::Optional) \
  ROW(Ile,     Brh, 3,  Pd, Ra, B, None, Integer, Plain, "pd = ra <= b, signed", Feature::Optional) \
  ROW(Igt,     Brh, 4,  Pd, Ra, B, None, Integer, Plain, "pd = ra > b, signed") \
  ROW(Ige,     Brh, 5,  Pd, Ra, B, None, Integer, Plain, "pd = ra >= b, signed", Feature::Optional) \
  ROW(Ult,     Brh, 6,  Pd, Ra, B, None, Integer, Plain, "pd = ra < b, unsigned") \
  ROW(Ule,     Brh, 7,  Pd, Ra, B, None, Integer, Plain, "pd = ra <= b, unsigned", Feature::Optional) \
  ROW(Ugt,     Brh, 8,  Pd, Ra, B, None, Integer, Plain, "pd = ra > b, unsigned", Feature::Optional) \
  ROW(Uge,     Brh, 9,  Pd, Ra, B, None, Integer, Plain, "pd = ra >= b, unsigned") \
  ROW(Feq,     Brh, 10, Pd, Ra, B, None, Float, Plain, "pd = ra == b; false with a NaN", Feature::Optional) \
  ROW(Fne,     Brh, 11, Pd, Ra, B, None, Float, Plain, "pd = not (ra == b); true with a NaN", Feature::Optional) \
  ROW(Flt,     Brh, 12, Pd, Ra, B, None, Float, Plain, "pd = ra < b; false with a NaN", Feature::Optional) \
  ROW(Fle,     Brh, 13, Pd, Ra, B, None, Float, Plain, "pd = ra <= b; false with a NaN", Feature::Optional) \
  ROW(Fgt,     Brh, 14, Pd, Ra, B, None, Float, Plain, "pd = ra > b; false with a NaN", Feature::Optional) \
  ROW(Fge,     Brh, 15, Pd, Ra, B, None, Float, Plain, "pd = ra >= b; false with a NaN", Feature::Optional) \
  ROW(Pand,    Brh, 16, Pd, Px, Pb, None, None, Plain, "pd = px and pb") \
  ROW(Por,     Brh, 17, Pd, Px, Pb, None, None, Plain, "pd = px or pb") \
  ROW(Pxor,    Brh, 18, Pd, Px, Pb, None, None, Plain, "pd = px xor pb") \
  ROW(Pandn,   Brh, 19, Pd, Px, Pb, None, None, Plain, "pd = px and not pb") \
  ROW(Jany,    Brh, 24, Target, None, None, None, None, Control, "jump if any masked lane is left") \
  ROW(Jnone,   Brh, 25, Target, None, None, None, None, Control, "jump if no masked lane is left") \
  ROW(Call,    Brh, 26, Target, End, None, None, None, Control, "push {PC = target, RPC = end}") \
  ROW(Loop,    Brh, 27, End, None, None, None, None, Control, \
      "if any masked lane is left: push {PC = next, RPC = end}, this loop runs again after it; else jump to end") \
  ROW(Ret,     Brh, 28, None, None, None, None, None, Control, "pop the PC stack") \
  ROW(Exit,    Brh, 29, None, None, None, None, None, Control, "end of the warp") \
  /* Mem */ \
  ROW(Ld,      Mem, 0,  Rd, Address, None, None, None, Plain, "rd = word at ra + immediate") \
  ROW(St,      Mem, 1,  Address, Rb, None, None, None, Plain, "word at ra + immediate = rb") \
  /* Int */ \
  ROW(Mov,     Int, 0,  Rd, B, None, None, Either, Plain, "rd = b") \
  ROW(Iadd,    Int, 1,  Rd, Ra, B, None, Integer, Plain, "rd = ra + b") \
  ROW(Isub,    Int, 2,  Rd, Ra, B, None, Integer, Plain, "rd = ra - b") \
  ROW(Imul,    Int, 3,  Rd, Ra, B, None, Integer, Plain, "rd = low 32 bits of ra * b", Feature::Optional) \
  ROW(And,     Int, 4,  Rd, Ra, B, None, Integer, Plain, "rd = ra and b") \
  ROW(Or,      Int, 5,  Rd, Ra, B, None, Integer, Plain, "rd = ra or b", Feature::Optional) \
  ROW(Xor,     Int, 6,  Rd, Ra, B, None, Integer, Plain, "rd = ra xor b") \
  ROW(Shl,     Int, 7,  Rd, Ra, B, None, Integer, Plain, "rd = ra << b[4:0]") \
  ROW(Shr,     Int, 8,  Rd, Ra, B, None, Integer, Plain, "rd = ra >> b[4:0], zeros shifted in") \
  ROW(Sar,     Int, 9,  Rd, Ra, B, None, Integer, Plain, "rd = ra >> b[4:0], sign shifted in", Feature::Optional) \
  ROW(Imin,    Int, 10, Rd, Ra, B, None, Integer, Plain, "rd = smaller of ra and b, signed", Feature::Optional) \
  ROW(Imax,    Int, 11, Rd, Ra, B, None, Integer, Plain, "rd = larger of ra and b, signed", Feature::Optional) \
  ROW(Umin,    Int, 12, Rd, Ra, B, None, Integer, Plain, "rd = smaller of ra and b, unsigned", Feature::Optional) \
  ROW(Umax,    Int, 13, Rd, Ra, B, None, Integer, Plain, "rd = larger of ra and b, unsigned", Feature::Optional) \
  ROW(Sel,     Int, 14, Rd, Px, Ra, B, Either, Plain, "rd = px ? ra : b", Feature::Optional) \
  /* Flt */ \
  ROW(Fadd,    Flt, 0,  Rd, Ra, B, None, Float, Plain, "rd = ra + b") \
  ROW(Fsub,    Flt, 1,  Rd, Ra, B, None, Float, Plain, "rd = ra - b") \
  ROW(Fmul,    Flt, 2,  Rd, Ra, B, None, Float, Plain, "rd = ra * b") \
  ROW(Fmin,    Flt, 3,  Rd, Ra, B, None, Float, Plain, \
      "rd = smaller of ra and b; the number if one is a NaN; -0 < +0", Feature::Optional) \
  ROW(Fmax,    Flt, 4,  Rd, Ra, B, None, Float, Plain, \
      "rd = larger of ra and b; the number if one is a NaN; -0 < +0", Feature::Optional) \
  ROW(F2i,     Flt, 5,  Rd, Ra, None, None, None, Plain, \
      "rd = signed integer, towards zero, saturating; NaN gives 0", Feature::Optional) \
  ROW(I2f,     Flt, 6,  Rd, Ra, None, None, None, Plain, "rd = float of signed ra", Feature::Optional) \
  ROW(Ffma,    Flt, 7,  Rd, Ra, B, Rc, Float, Plain, "rd = ra * b + rc, one rounding", Feature::FusedMultiplyAdd) \
  /* Slw */ \
  ROW(Fdiv,    Slw, 0,  Rd, Ra, B, None, Float, Plain, "rd = ra / b", Feature::Optional) \
  ROW(Fsqrt,   Slw, 1,  Rd, Ra, None, None, None, Plain, "rd = square root of ra", Feature::Optional) \
  ROW(Frsqrt,  Slw, 2,  Rd, Ra, None, None, None, Plain, \
      "rd = 1 / square root of ra, one rounding", Feature::Optional) \
  ROW(Frcp,    Slw, 3,  Rd, Ra, None, None, None, Plain, "rd = 1 / ra", Feature::Optional) \
  /* Ray */ \
  ROW(Rin,     Ray, 0,  None, None, None, None, None, Swap, "wait for the imported packages, make them current") \
  ROW(Rout,    Ray, 1,  None, None, None, None, None, Swap, "export masked lanes' rays to the ray pool") \
  ROW(Rfb,     Ray, 2,  None, None, None, None, None, Swap, \
      "export masked lanes' pixel and colour to the frame buffer") \
  ROW(Rld,     Ray, 3,  Rd, Word, None, None, None, Plain, "rd = word of the current slice") \
  ROW(Rst,     Ray, 4,  Word, B, None, None, Float, Plain, "word of the current slice = b") \
  /* Triples: three instructions, their elements, in one. Of element e (0, 1, 2) every register number is e higher, */ \
  /* modulo 16, and so are ray word and argument; an address is 4 e further; an immediate in place of b is the same */ \
  /* for all. Bit 4 of the operation marks them, bit 3 that ra is the same register for all; bits 2:0 are the */ \
  /* element's operation. */ \
  ROW(Fadd3,   Flt, 16, Rd, Ra, B, None, Float, Plain, "fadd, three times", Feature::Triples) \
  ROW(Fsub3,   Flt, 17, Rd, Ra, B, None, Float, Plain, "fsub, three times", Feature::Triples) \
  ROW(Fmul3,   Flt, 18, Rd, Ra, B, None, Float, Plain, "fmul, three times", Feature::Triples) \
  ROW(Fmul3s,  Flt, 26, Rd, Ra, B, None, Float, Plain, "fmul, three times, with one ra", Feature::Triples) \
  ROW(Ffma3,   Flt, 23, Rd, Ra, B, Rc, Float, Plain, "ffma, three times", Feature::FusedTriples) \
  ROW(Ffma3s,  Flt, 31, Rd, Ra, B, Rc, Float, Plain, "ffma, three times, with one ra", Feature::FusedTriples) \
  ROW(Arg3,    Tid, 22, Rd, Argument, None, None, None, Plain, "arg, three times", Feature::Triples) \
  ROW(Ld3,     Mem, 16, Rd, Address, None, None, None, Plain, \
      "ld, three times; bits 3:2 of the offset are 0, and become the element's number", Feature::Triples) \
  ROW(Rld3,    Ray, 19, Rd, Word, None, None, None, Plain, "rld, three times", Feature::Triples) \
  ROW(Rst3,    Ray, 20, Word, B, None, None, Float, Plain, "rst, three times", Feature::Triples) \
  /* What units need to share memory */ \
  ROW(Unit,    Tid, 7,  Rd, None, None, None, None, Plain, "rd = number of the compute unit, from 0", \
      Feature::Sharing) \
  ROW(Inval,   Mem, 2,  Address, None, None, None, None, Plain, \
      "the data cache forgets the line of ra + immediate: the next load reads the memory", Feature::Sharing) \
  /* The table ends here: the backslash above lets a row follow it. */
// clang-format on

/// ALU type and operation of an instruction, bits 63:55 of its encoding.
enum class Opcode : uint16_t {
#define RAYPOOL_ROW(name, type, operation, ...) name = to_underlying(AluType::type) << 5 | operation,
  RAYPOOL_INSTRUCTIONS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
};

inline constexpr AluType alu_of(Opcode opcode) { return static_cast<AluType>(to_underlying(opcode) >> 5); }
/// Number within the type, 0 .. 31.
inline constexpr uint8_t operation_of(Opcode opcode) { return to_underlying(opcode) & 31; }

namespace mnemonic {
/// The name of a row in lower case.
template <size_t kSize>
struct Text {
  char text[kSize] = {};
  constexpr explicit Text(const char (&name)[kSize]) {
    for (size_t i = 0; i < kSize; ++i) text[i] = name[i];
    for (char& c : text)
      if (c >= 'A' && c <= 'Z') c += 'a' - 'A';
  }
};
#define RAYPOOL_ROW(name, ...) inline constexpr Text name(#name);
RAYPOOL_INSTRUCTIONS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
}  // namespace mnemonic

struct InstructionInfo {
  std::string_view mnemonic;
  Opcode opcode;
  std::array<Operand, 4> operands;
  ImmediateType immediate;  ///< type of B when it is an immediate
  Kind kind;
  std::string_view meaning;
  Feature needs = Feature::Base;

  constexpr AluType alu() const { return alu_of(opcode); }
  constexpr uint8_t operation() const { return operation_of(opcode); }
};

inline constexpr InstructionInfo kInstructions[] = {
// clang-format off
#define RAYPOOL_ROW(name, type, operation, o0, o1, o2, o3, immediate, kind, ...) \
  {mnemonic::name.text, Opcode::name, {Operand::o0, Operand::o1, Operand::o2, Operand::o3}, \
   ImmediateType::immediate, Kind::kind, __VA_ARGS__},
    // clang-format on
    RAYPOOL_INSTRUCTIONS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
};

/// Rows in front of the triples, behind which stands what several units need.
inline constexpr size_t kSingles = [] {
  size_t rows = 0;
  while (kInstructions[rows].needs != Feature::Triples && kInstructions[rows].needs != Feature::FusedTriples) ++rows;
  return rows;
}();

/// Instructions of the type that a machine may lack: a bit for each operation number.
inline constexpr uint32_t optional_operations(AluType type) {
  uint32_t operations = 0;
  for (const InstructionInfo& info : kInstructions)
    if (info.alu() == type && info.needs == Feature::Optional) operations |= 1u << info.operation();
  return operations;
}

inline constexpr int kRegisters = 16;
inline constexpr int kPredicates = 16;
inline constexpr int kArguments = 32;
inline constexpr int kPackageWords = 21;  ///< of a slice of ray memory, a thread

}  // namespace raypool
