// The one table of ALU types and instructions. Decoder, encoder, assembler, disassembler, configuration keys, Verilog parameters,
// rtl/*.vh and docs/isa.md are derived from it. docs/add-an-alu.md adds a type.
//
// Encoding of an instruction, 64 bits:
//   63:60 unit | 59:55 operation | 54 guard negated | 53:50 guard predicate | 49:46 rd (or pd) | 45:42 ra | 41:38 rb (or pb)
//   37 b is the immediate | 36:32 x (predicate ps/pa, register rc, or word of a ray package) | 31:0 immediate
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

namespace raypool {

// The ALU types, a row each in the order of their numbers.
//   type        enumerator of AluType; its number is the unit field of an instruction
//   name        three lower-case letters: key of the configuration, prefix of the Verilog parameters, module <name>_alu
//   depth       least pipeline depth, which is what the function needs at speed, and the default one; 0: timed by events
//   ports       Framework: those of docs/architecture.md, section 3; rtl/alu_instances.vh places it. Own: rtl/compute_unit.v does
//   parameters  of the module beside the framework's, as rtl/compute_unit.v names them, separated by ", "
//   title       for docs/isa.md
// CORE: FunctionalCore executes the type. CLASS: a class derived from AluModel does, and the ports are the framework's.
// clang-format off
#define RAYPOOL_ALU_TYPES(CORE, CLASS) \
  CORE(Tid, "tid",  1, Own,       "",                       "indices, dimensions, arguments") \
  CORE(Brh, "brh",  2, Framework, "SUBNORMALS",             "compares, predicates, control") \
  CORE(Mem, "mem",  0, Own,       "",                       "memory") \
  CORE(Int, "int",  2, Framework, "",                       "integer and logic") \
  CORE(Flt, "flt",  3, Framework, "SUBNORMALS, FMA",        "single-precision float") \
  CORE(Slw, "slw", 11, Framework, "SUBNORMALS, SLOW_UNIT",  "slow float: division and square roots") \
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

enum class Ports : uint8_t { Framework, Own };

struct AluInfo {
  std::string_view name;
  int depth;
  Ports ports;
  std::string_view parameters;  ///< separated by ", "
  std::string_view title;
  bool timed_by_events() const { return depth == 0; }
};

inline constexpr AluInfo kAluTable[] = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) {name, depth, Ports::ports, parameters, title},
#define RAYPOOL_CLASS(type, name, depth, parameters, title) {name, depth, Ports::Framework, parameters, title},
    RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
};

inline constexpr int kAluTypes = static_cast<int>(std::size(kAluTable));
static_assert(kAluTypes <= 8, "the performance counters have room for eight ALU types");

inline constexpr std::array<std::string_view, kAluTypes> kAluNames = {
#define RAYPOOL_CORE(type, name, depth, ports, parameters, title) name,
#define RAYPOOL_CLASS(type, name, depth, parameters, title) name,
    RAYPOOL_ALU_TYPES(RAYPOOL_CORE, RAYPOOL_CLASS)
#undef RAYPOOL_CORE
#undef RAYPOOL_CLASS
};

inline constexpr const AluInfo& alu_info(AluType type) { return kAluTable[static_cast<size_t>(type)]; }

using Unit = AluType;
inline constexpr int kUnits = kAluTypes;
inline constexpr const auto& kUnitTable = kAluTable;
inline constexpr const auto& kUnitNames = kAluNames;

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
enum class ImmediateType : uint8_t { None, Integer, Float };

/// What a configuration must have for an instruction to be legal.
enum class Feature : uint8_t {
  Base,              ///< nothing: every machine has the instruction
  FusedMultiplyAdd,  ///< arithmetic.fma
};

struct InstructionInfo {
  std::string_view mnemonic;
  AluType unit;
  uint8_t operation;  ///< 0 .. 31
  std::array<Operand, 4> operands;
  ImmediateType immediate;  ///< type of B when it is an immediate
  bool control;             ///< stops the instruction routine until write-back
  std::string_view meaning;
  Feature needs = Feature::Base;
};

// A table is read by its columns.
// clang-format off
inline constexpr InstructionInfo kInstructions[] = {
#define RAYPOOL_ROW(mnemonic, unit, op, o0, o1, o2, o3, imm, control, meaning) \
  {mnemonic, AluType::unit, op, {Operand::o0, Operand::o1, Operand::o2, Operand::o3}, ImmediateType::imm, control, meaning}
#define RAYPOOL_ROW_WITH(feature, mnemonic, unit, op, o0, o1, o2, o3, imm, control, meaning) \
  {mnemonic, AluType::unit, op, {Operand::o0, Operand::o1, Operand::o2, Operand::o3}, ImmediateType::imm, control, meaning, \
   Feature::feature}
  // Tid: indices, dimensions, arguments
  RAYPOOL_ROW("tid",    Tid, 0, Rd, None, None, None, None, false, "rd = index of the thread in its block"),
  RAYPOOL_ROW("lane",   Tid, 1, Rd, None, None, None, None, false, "rd = lane of the thread"),
  RAYPOOL_ROW("warp",   Tid, 2, Rd, None, None, None, None, false, "rd = warp of the thread"),
  RAYPOOL_ROW("block",  Tid, 3, Rd, None, None, None, None, false, "rd = block word of the launch"),
  RAYPOOL_ROW("threads",Tid, 4, Rd, None, None, None, None, false, "rd = threads in this block"),
  RAYPOOL_ROW("blocks", Tid, 5, Rd, None, None, None, None, false, "rd = blocks in the grid"),
  RAYPOOL_ROW("arg",    Tid, 6, Rd, Argument, None, None, None, false, "rd = kernel argument word"),
  // Brh: compares into predicates (result AND mask, all lanes written), predicate logic, control
  RAYPOOL_ROW("ieq",  Brh, 0,  Pd, Ra, B, None, Integer, false, "pd = ra == b"),
  RAYPOOL_ROW("ine",  Brh, 1,  Pd, Ra, B, None, Integer, false, "pd = ra != b"),
  RAYPOOL_ROW("ilt",  Brh, 2,  Pd, Ra, B, None, Integer, false, "pd = ra < b, signed"),
  RAYPOOL_ROW("ile",  Brh, 3,  Pd, Ra, B, None, Integer, false, "pd = ra <= b, signed"),
  RAYPOOL_ROW("igt",  Brh, 4,  Pd, Ra, B, None, Integer, false, "pd = ra > b, signed"),
  RAYPOOL_ROW("ige",  Brh, 5,  Pd, Ra, B, None, Integer, false, "pd = ra >= b, signed"),
  RAYPOOL_ROW("ult",  Brh, 6,  Pd, Ra, B, None, Integer, false, "pd = ra < b, unsigned"),
  RAYPOOL_ROW("ule",  Brh, 7,  Pd, Ra, B, None, Integer, false, "pd = ra <= b, unsigned"),
  RAYPOOL_ROW("ugt",  Brh, 8,  Pd, Ra, B, None, Integer, false, "pd = ra > b, unsigned"),
  RAYPOOL_ROW("uge",  Brh, 9,  Pd, Ra, B, None, Integer, false, "pd = ra >= b, unsigned"),
  RAYPOOL_ROW("feq",  Brh, 10, Pd, Ra, B, None, Float, false, "pd = ra == b; false with a NaN"),
  RAYPOOL_ROW("fne",  Brh, 11, Pd, Ra, B, None, Float, false, "pd = not (ra == b); true with a NaN"),
  RAYPOOL_ROW("flt",  Brh, 12, Pd, Ra, B, None, Float, false, "pd = ra < b; false with a NaN"),
  RAYPOOL_ROW("fle",  Brh, 13, Pd, Ra, B, None, Float, false, "pd = ra <= b; false with a NaN"),
  RAYPOOL_ROW("fgt",  Brh, 14, Pd, Ra, B, None, Float, false, "pd = ra > b; false with a NaN"),
  RAYPOOL_ROW("fge",  Brh, 15, Pd, Ra, B, None, Float, false, "pd = ra >= b; false with a NaN"),
  RAYPOOL_ROW("pand", Brh, 16, Pd, Px, Pb, None, None, false, "pd = px and pb"),
  RAYPOOL_ROW("por",  Brh, 17, Pd, Px, Pb, None, None, false, "pd = px or pb"),
  RAYPOOL_ROW("pxor", Brh, 18, Pd, Px, Pb, None, None, false, "pd = px xor pb"),
  RAYPOOL_ROW("pandn",Brh, 19, Pd, Px, Pb, None, None, false, "pd = px and not pb"),
  RAYPOOL_ROW("jany", Brh, 24, Target, None, None, None, None, true, "jump if any masked lane is left"),
  RAYPOOL_ROW("jnone",Brh, 25, Target, None, None, None, None, true, "jump if no masked lane is left"),
  RAYPOOL_ROW("call", Brh, 26, Target, End, None, None, None, true, "push {PC = target, RPC = end}"),
  RAYPOOL_ROW("loop", Brh, 27, End, None, None, None, None, true,
              "if any masked lane is left: push {PC = next, RPC = end}, this loop runs again after it; else jump to end"),
  RAYPOOL_ROW("ret",  Brh, 28, None, None, None, None, None, true, "pop the PC stack"),
  RAYPOOL_ROW("exit", Brh, 29, None, None, None, None, None, true, "end of the warp"),
  // Mem
  RAYPOOL_ROW("ld",   Mem, 0, Rd, Address, None, None, None, false, "rd = word at ra + immediate"),
  RAYPOOL_ROW("st",   Mem, 1, Address, Rb, None, None, None, false, "word at ra + immediate = rb"),
  // Int
  RAYPOOL_ROW("mov",  Int, 0,  Rd, B, None, None, Integer, false, "rd = b"),
  RAYPOOL_ROW("iadd", Int, 1,  Rd, Ra, B, None, Integer, false, "rd = ra + b"),
  RAYPOOL_ROW("isub", Int, 2,  Rd, Ra, B, None, Integer, false, "rd = ra - b"),
  RAYPOOL_ROW("imul", Int, 3,  Rd, Ra, B, None, Integer, false, "rd = low 32 bits of ra * b"),
  RAYPOOL_ROW("and",  Int, 4,  Rd, Ra, B, None, Integer, false, "rd = ra and b"),
  RAYPOOL_ROW("or",   Int, 5,  Rd, Ra, B, None, Integer, false, "rd = ra or b"),
  RAYPOOL_ROW("xor",  Int, 6,  Rd, Ra, B, None, Integer, false, "rd = ra xor b"),
  RAYPOOL_ROW("shl",  Int, 7,  Rd, Ra, B, None, Integer, false, "rd = ra << b[4:0]"),
  RAYPOOL_ROW("shr",  Int, 8,  Rd, Ra, B, None, Integer, false, "rd = ra >> b[4:0], zeros shifted in"),
  RAYPOOL_ROW("sar",  Int, 9,  Rd, Ra, B, None, Integer, false, "rd = ra >> b[4:0], sign shifted in"),
  RAYPOOL_ROW("imin", Int, 10, Rd, Ra, B, None, Integer, false, "rd = smaller of ra and b, signed"),
  RAYPOOL_ROW("imax", Int, 11, Rd, Ra, B, None, Integer, false, "rd = larger of ra and b, signed"),
  RAYPOOL_ROW("umin", Int, 12, Rd, Ra, B, None, Integer, false, "rd = smaller of ra and b, unsigned"),
  RAYPOOL_ROW("umax", Int, 13, Rd, Ra, B, None, Integer, false, "rd = larger of ra and b, unsigned"),
  RAYPOOL_ROW("sel",  Int, 14, Rd, Px, Ra, B, Integer, false, "rd = px ? ra : b"),
  // Flt
  RAYPOOL_ROW("fadd", Flt, 0, Rd, Ra, B, None, Float, false, "rd = ra + b"),
  RAYPOOL_ROW("fsub", Flt, 1, Rd, Ra, B, None, Float, false, "rd = ra - b"),
  RAYPOOL_ROW("fmul", Flt, 2, Rd, Ra, B, None, Float, false, "rd = ra * b"),
  RAYPOOL_ROW("fmin", Flt, 3, Rd, Ra, B, None, Float, false, "rd = smaller of ra and b; the number if one is a NaN; -0 < +0"),
  RAYPOOL_ROW("fmax", Flt, 4, Rd, Ra, B, None, Float, false, "rd = larger of ra and b; the number if one is a NaN; -0 < +0"),
  RAYPOOL_ROW("f2i",  Flt, 5, Rd, Ra, None, None, None, false, "rd = signed integer, towards zero, saturating; NaN gives 0"),
  RAYPOOL_ROW("i2f",  Flt, 6, Rd, Ra, None, None, None, false, "rd = float of signed ra"),
  RAYPOOL_ROW_WITH(FusedMultiplyAdd, "ffma", Flt, 7, Rd, Ra, B, Rc, Float, false, "rd = ra * b + rc, one rounding"),
  // Slw
  RAYPOOL_ROW("fdiv",  Slw, 0, Rd, Ra, B, None, Float, false, "rd = ra / b"),
  RAYPOOL_ROW("fsqrt", Slw, 1, Rd, Ra, None, None, None, false, "rd = square root of ra"),
  RAYPOOL_ROW("frsqrt",Slw, 2, Rd, Ra, None, None, None, false, "rd = 1 / square root of ra, one rounding"),
  RAYPOOL_ROW("frcp",  Slw, 3, Rd, Ra, None, None, None, false, "rd = 1 / ra"),
  // Ray
  RAYPOOL_ROW("rin",  Ray, 0, None, None, None, None, None, false, "wait for the imported packages, make them current"),
  RAYPOOL_ROW("rout", Ray, 1, None, None, None, None, None, false, "export masked lanes' rays to the ray pool"),
  RAYPOOL_ROW("rfb",  Ray, 2, None, None, None, None, None, false, "export masked lanes' pixel and colour to the frame buffer"),
  RAYPOOL_ROW("rld",  Ray, 3, Rd, Word, None, None, None, false, "rd = word of the current slice"),
  RAYPOOL_ROW("rst",  Ray, 4, Word, B, None, None, Float, false, "word of the current slice = b"),
#undef RAYPOOL_ROW
#undef RAYPOOL_ROW_WITH
};
// clang-format on

inline constexpr int kRegisters = 16;
inline constexpr int kPredicates = 16;
inline constexpr int kArguments = 32;

}  // namespace raypool
