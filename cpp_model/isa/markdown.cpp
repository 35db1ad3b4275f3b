// Writes docs/machine/isa.md.
#include <fmt/format.h>

#include "isa/encoding.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

std::string operand_text(Operand operand) {
  switch (operand) {
    case Operand::None:
      return "";
    case Operand::Rd:
      return "rd";
    case Operand::Ra:
      return "ra";
    case Operand::Rb:
      return "rb";
    case Operand::Rc:
      return "rc";
    case Operand::B:
      return "b";
    case Operand::Pd:
      return "pd";
    case Operand::Px:
      return "px";
    case Operand::Pb:
      return "pb";
    case Operand::Address:
      return "[ra+offset]";
    case Operand::Word:
      return "word";
    case Operand::Argument:
      return "n";
    case Operand::Target:
      return "target";
    case Operand::End:
      return "end";
  }
  return "";
}

std::string syntax(const InstructionInfo& info) {
  std::string text(info.mnemonic);
  const char* separator = " ";
  for (const Operand operand : info.operands) {
    if (operand == Operand::None) continue;
    text += separator + operand_text(operand);
    separator = ", ";
  }
  return text;
}

const char* marks(const InstructionInfo& info) {
  if (info.needs == Feature::FusedMultiplyAdd) return "*fma*";
  if (info.needs == Feature::Triples) return "*t*";
  if (info.needs == Feature::FusedTriples) return "*t fma*";
  if (info.needs == Feature::Optional) return "*o*";
  if (info.needs == Feature::Sharing) return "*s*";
  return info.kind == Kind::Control ? "*c*" : "";
}

constexpr const char* kIntroduction = R"(# Instruction set

Generated from the one table, `cpp_model/isa/isa.hpp`, by `raypool isa --markdown`; a test compares. Do not edit.

An instruction has 64 bits, data 32 bits. A thread has 16 registers r0 .. r15; a warp has 16 predicates p0 .. p15 of one
bit a thread, of which p0 is all ones. What a mask does to each kind of result stands in
[architecture.md](architecture.md), section 4.

## Encoding

| bits | field | |
| --- | --- | --- |
)";

constexpr const char* kText = R"(
`target` and `end` are the halves of the immediate of `jany`, `jnone` and `call`; `loop` has its end in the low half.
Fields that an instruction does not use are written as 0 by the assembler and ignored by the machine. An instruction
with unit and operation in no row below is illegal, and so is one that the configuration has not: `ffma` without
`arithmetic.fma`, a triple without `triples`, `ffma3` and `ffma3s` without both, `unit` and `inval` without `sharing`,
and one with an *o* that its type's `without` names. One that names a register, predicate or argument which the
configuration has not (`registers`, `predicates`, `arguments`) is illegal too; of a triple those of all elements count.

A target, an end or an entry that does not fit into `pc_bits` is the greatest PC there is. It is outside of every
program: of 16 bits, FFFF hex.

## Triples

A triple is three instructions, its elements 0, 1 and 2, which leave what the three leave if they are executed one after
the other, under one guard. Of element e

- every register number is e higher, modulo 16: behind r15 comes r0. With an `s` at the end of the name all elements
  have the same ra, and so have those of `ld3`, where ra is an address;
- an immediate in place of b is the same for all;
- the ray word of `rld3` and `rst3` is e higher. One above 18, or `intersection_words` - 3, is illegal, as the last
  word would be outside;
- the argument of `arg3` is e higher;
- bits 3:2 of the offset of `ld3` should be 0: they are ORed with e.

Bit 4 of the operation marks a triple, bit 3 that ra is one for all; bits 2:0 are the element's operation. What a triple
takes in cycles is in [architecture.md](architecture.md), section 3.

## Assembly text

```asm
# a comment
.kernel scale              # names the entry of a kernel
        tid   r0
        ult   p1, r0, 100
  @p1   shl   r1, r0, 2
  @p1   ld    r2, [r1+256]
  @p1   fmul  r2, r2, 0.5
  @p1   st    [r1+256], r2
        exit
```

One instruction a line, labels end in a colon. `@p3` before an instruction masks it with predicate p3, `@!p3` with its
inverse. Where `b` stands, a register or an immediate is allowed. Immediates: decimal or 0x hexadecimal integers from
-2147483648 to 4294967295; after a float instruction and `rst` a number with a point or an exponent, `inf`, `-inf`, or a
bit pattern in 0x hexadecimal. A target is a label, or the number of an instruction. `.word 0x...` puts any 64-bit
pattern in place.
)";

}  // namespace

std::string isa_markdown() {
  std::string text = kIntroduction;
  const auto meaning = [](const Field& each) -> const char* {
    if (each.name == field::kType.name) return "ALU type";
    if (each.name == field::kOperation.name) return "operation of that type";
    if (each.name == field::kGuardNegated.name) return "the guard predicate is inverted";
    if (each.name == field::kGuard.name) return "guard predicate";
    if (each.name == field::kRd.name) return "destination register, or destination predicate pd";
    if (each.name == field::kRa.name) return "source register";
    if (each.name == field::kRb.name) return "source register, or source predicate pb";
    if (each.name == field::kBIsImmediate.name) return "b is the immediate, not rb";
    if (each.name == field::kX.name) return "source predicate px, source register rc, or word of a ray package";
    return "immediate b, address offset, argument number, or target and end";
  };
  for (const Field& each : kFields) {
    if (each.name == field::kTarget.name || each.name == field::kEnd.name) continue;
    const std::string bits =
        each.bits == 1 ? fmt::format("{}", each.lsb) : fmt::format("{}:{}", each.lsb + each.bits - 1, each.lsb);
    text += fmt::format("| {} | {} | {} |\n", bits, each.name, meaning(each));
  }
  text += kText;
  text +=
      "\n## Instructions\n\nRows marked *c* are control instructions: they stop the instruction routine until their "
      "write-back.\nRows marked *fma* are there in configurations with `arithmetic.fma` only, those marked *o* unless "
      "the type's\n"
      "`without` names them, those marked *t* with "
      "`triples` "
      "only,\nthose marked *t fma* with both only, those marked *s* with `sharing` only.\n";
  for (const AluType type : kEveryAluType) {
    text += fmt::format("\n### {}: {} (type {})\n\n| op | instruction | | meaning |\n| --- | --- | --- | --- |\n",
                        alu_info(type).name, alu_info(type).title, to_underlying(type));
    for (const InstructionInfo& info : kInstructions) {
      if (info.alu() != type) continue;
      text += fmt::format("| {} | `{}` | {} | {} |\n", info.operation(), syntax(info), marks(info), info.meaning);
    }
  }
  return text;
}

}  // namespace raypool
