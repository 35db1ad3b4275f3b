#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <random>
#include <set>
#include <sstream>

#include "isa/assembler.hpp"
#include "isa/encoding.hpp"
#include "isa/input_error.hpp"
#include "isa/reference.hpp"

namespace raypool {
namespace {

std::string read(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.good()) << path << ": run the tests from the repository's root";
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

uint64_t assemble_one(const std::string& text) {
  const Program program = assemble(text, "test");
  EXPECT_EQ(program.code.size(), 1u) << text;
  return program.code.empty() ? 0 : program.code[0];
}

std::string error_of(const std::string& text) {
  try {
    assemble(text, "file");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A random instruction of a table row, its unused fields 0; or, with `any`, random in
/// every bit beside unit and operation.
uint64_t random_instruction(const InstructionInfo& info, std::mt19937_64& random, bool any) {
  Instruction parts;
  parts.info = &info;
  if (any) return (random() & ((uint64_t{1} << field::kOperation.lsb) - 1)) | encode(parts);
  const auto below = [&](uint32_t limit) { return static_cast<uint32_t>(random() % limit); };
  parts.guard = below(16);
  parts.guard_negated = below(2) != 0;
  for (const Operand operand : info.operands) {
    switch (operand) {
      case Operand::None:
        break;
      case Operand::Rd:
      case Operand::Pd:
        parts.rd = below(16);
        break;
      case Operand::Ra:
        parts.ra = below(16);
        break;
      case Operand::Rb:
      case Operand::Pb:
        parts.rb = below(16);
        break;
      case Operand::Rc:
      case Operand::Px:
        parts.x = below(16);
        break;
      case Operand::Word:
        parts.x = below(21);
        break;
      case Operand::Argument:
        parts.immediate = below(32);
        break;
      case Operand::Target:
      case Operand::End:
        parts.immediate |= below(65536);
        break;
      case Operand::B:
        parts.b_is_immediate = below(2) != 0;
        if (parts.b_is_immediate)
          parts.immediate = below(2) != 0 ? static_cast<uint32_t>(random()) : below(200) - 100;
        else
          parts.rb = below(16);
        break;
      case Operand::Address:
        parts.ra = below(16);
        parts.immediate = below(2) != 0 ? static_cast<uint32_t>(random()) : below(200) - 100;
        break;
    }
  }
  if (has_operand(info, Operand::Target) && has_operand(info, Operand::End))
    parts.immediate = static_cast<uint32_t>(random());
  return encode(parts);
}

TEST(InstructionTable, RowsHaveDistinctEncodingsAndNames) {
  std::set<std::pair<int, int>> encodings;
  std::set<std::string_view> names;
  for (const InstructionInfo& info : kInstructions) {
    EXPECT_TRUE(encodings.emplace(to_underlying(info.alu()), info.operation()).second) << info.mnemonic;
    EXPECT_TRUE(names.insert(info.mnemonic).second) << info.mnemonic;
    EXPECT_LT(info.operation(), 32) << info.mnemonic;
    EXPECT_EQ(find_instruction(info.mnemonic), &info);
    EXPECT_EQ(find_instruction(to_underlying(info.alu()), info.operation()), &info);
  }
}

TEST(AluTable, NamesAreThreeLowerCaseLettersAndDistinct) {
  std::set<std::string_view> names;
  for (const AluInfo& info : kAluTable) {
    EXPECT_EQ(info.name.size(), 3u) << info.name;
    EXPECT_EQ(info.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz"), std::string_view::npos) << info.name;
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
  }
}

TEST(AluTable, ThirdOperandsReachFltOnly) {
  for (const InstructionInfo& info : kInstructions) {
    EXPECT_TRUE(info.alu() == AluType::Flt || !has_operand(info, Operand::Rc)) << info.mnemonic;
  }
}

TEST(Encoding, FieldsCoverAllBitsOnce) {
  uint64_t covered = 0;
  for (const Field& each : kFields) {
    if (each.name == field::kTarget.name || each.name == field::kEnd.name) continue;
    const uint64_t bits = ((uint64_t{1} << each.bits) - 1) << each.lsb;
    EXPECT_EQ(covered & bits, 0u) << each.name;
    covered |= bits;
  }
  EXPECT_EQ(covered, ~uint64_t{0});
}

TEST(Encoding, UnpackedAndEncodedIsTheSame) {
  std::mt19937_64 random(1);
  for (const InstructionInfo& info : kInstructions) {
    for (int i = 0; i < 200; ++i) {
      const uint64_t encoding = random_instruction(info, random, true);
      ASSERT_EQ(unpack(encoding).info, &info);
      ASSERT_EQ(encode(unpack(encoding)), encoding) << fmt::format("{:016x}", encoding);
    }
  }
}

TEST(Encoding, IsTheOneThatIsaHppDescribes) {
  // Written out by hand: unit 4, op 1, guard !p3, rd 5, ra 6, rb 7 | immediate.
  EXPECT_EQ(assemble_one("@!p3 fsub r5, r6, r7"), 0x4000000000000000u | uint64_t{1} << 55 | uint64_t{1} << 54 |
                                                      uint64_t{3} << 50 | uint64_t{5} << 46 | uint64_t{6} << 42 |
                                                      uint64_t{7} << 38);
  EXPECT_EQ(assemble_one("fadd r1, r2, 1.0"),
            0x4000000000000000u | uint64_t{1} << 46 | uint64_t{2} << 42 | uint64_t{1} << 37 | 0x3f800000u);
  EXPECT_EQ(assemble_one("rst 20, r9"),
            0x6000000000000000u | uint64_t{4} << 55 | uint64_t{9} << 38 | uint64_t{20} << 32);
  EXPECT_EQ(assemble_one("st [r1-4], r2"),
            0x2000000000000000u | uint64_t{1} << 55 | uint64_t{1} << 42 | uint64_t{2} << 38 | 0xfffffffcu);
  EXPECT_EQ(assemble_one("call 3, 4"), 0x1000000000000000u | uint64_t{26} << 55 | 0x00040003u);
  EXPECT_EQ(assemble_one("loop 9"), 0x1000000000000000u | uint64_t{27} << 55 | 9u);
  EXPECT_EQ(assemble_one("sel r1, p2, r3, -1"), 0x3000000000000000u | uint64_t{14} << 55 | uint64_t{1} << 46 |
                                                    uint64_t{3} << 42 | uint64_t{1} << 37 | uint64_t{2} << 32 |
                                                    0xffffffffu);
  EXPECT_EQ(assemble_one("pandn p1, p2, p3"),
            0x1000000000000000u | uint64_t{19} << 55 | uint64_t{1} << 46 | uint64_t{3} << 38 | uint64_t{2} << 32);
  EXPECT_EQ(assemble_one("arg r1, 31"), uint64_t{6} << 55 | uint64_t{1} << 46 | 31u);
}

std::vector<std::string> elements_of(const std::string& triple) {
  std::vector<std::string> text;
  for (int e = 0; e < kElements; ++e) text.push_back(disassemble(encode(element(unpack(assemble_one(triple)), e))));
  return text;
}

TEST(Triples, ElementsAreTheInstructionsThatIsaMdDescribes) {
  using Text = std::vector<std::string>;
  EXPECT_EQ(elements_of("fadd3 r1, r4, r7"), (Text{"fadd r1, r4, r7", "fadd r2, r5, r8", "fadd r3, r6, r9"}));
  EXPECT_EQ(elements_of("@!p3 fsub3 r14, r15, 1.0"),
            (Text{"@!p3 fsub r14, r15, 1.0", "@!p3 fsub r15, r0, 1.0", "@!p3 fsub r0, r1, 1.0"}));
  EXPECT_EQ(elements_of("fmul3 r1, r1, r15"), (Text{"fmul r1, r1, r15", "fmul r2, r2, r0", "fmul r3, r3, r1"}));
  EXPECT_EQ(elements_of("fmul3s r1, r4, r7"), (Text{"fmul r1, r4, r7", "fmul r2, r4, r8", "fmul r3, r4, r9"}));
  EXPECT_EQ(elements_of("ffma3 r1, r4, r7, r14"),
            (Text{"ffma r1, r4, r7, r14", "ffma r2, r5, r8, r15", "ffma r3, r6, r9, r0"}));
  EXPECT_EQ(elements_of("ffma3s r1, r15, 0.5, r10"),
            (Text{"ffma r1, r15, 0.5, r10", "ffma r2, r15, 0.5, r11", "ffma r3, r15, 0.5, r12"}));
  EXPECT_EQ(elements_of("arg3 r13, 4"), (Text{"arg r13, 4", "arg r14, 5", "arg r15, 6"}));
  EXPECT_EQ(elements_of("ld3 r2, [r2+32]"), (Text{"ld r2, [r2+32]", "ld r3, [r2+36]", "ld r4, [r2+40]"}));
  EXPECT_EQ(elements_of("rld3 r15, 18"), (Text{"rld r15, 18", "rld r0, 19", "rld r1, 20"}));
  EXPECT_EQ(elements_of("rst3 8, r14"), (Text{"rst 8, r14", "rst 9, r15", "rst 10, r0"}));
  EXPECT_EQ(elements_of("rst3 0, 2.5"), (Text{"rst 0, 2.5", "rst 1, 2.5", "rst 2, 2.5"}));
}

TEST(Triples, OfAnInstructionIsFoundByItsElement) {
  int found = 0;
  for (const InstructionInfo& info : kInstructions) {
    for (const bool one_ra : {false, true}) {
      const InstructionInfo* triple = find_triple(info, one_ra);
      if (triple == nullptr) continue;
      ++found;
      EXPECT_EQ(triple->mnemonic, std::string(info.mnemonic) + (one_ra ? "3s" : "3"));
      EXPECT_EQ(has_one_ra(*triple), one_ra);
      EXPECT_EQ(element(Instruction{triple}, 2).info, &info);
    }
  }
  EXPECT_EQ(found, std::count_if(std::begin(kInstructions), std::end(kInstructions), is_triple));
}

/// Whether one of the elements, executed one after the other, reads a register that an earlier one has written.
bool reads_what_was_written(const Instruction& triple, bool one_ra) {
  std::array<bool, kRegisters> written{};
  const bool has_rc = has_operand(*triple.info, Operand::Rc);
  for (int e = 0; e < 3; ++e) {
    if (written[(triple.ra + (one_ra ? 0 : e)) % 16]) return true;
    if (!triple.b_is_immediate && written[(triple.rb + e) % 16]) return true;
    if (has_rc && written[(triple.x + e) % 16]) return true;
    written[(triple.rd + e) % 16] = true;
  }
  return false;
}

TEST(Triples, ElementsDependWhenOneReadsWhatAnEarlierOneHasWritten) {
  int depend = 0, free = 0;
  for (const char* name : {"fadd3", "fmul3s", "ffma3", "ffma3s"}) {
    Instruction triple;
    triple.info = find_instruction(name);
    const bool one_ra = std::string_view(name).back() == 's';
    for (uint32_t n = 0; n < 1u << 17; ++n) {
      triple.rd = n & 15, triple.ra = n >> 4 & 15, triple.rb = n >> 8 & 15, triple.x = n >> 12 & 15;
      triple.b_is_immediate = n >> 16 != 0;
      const bool expected = reads_what_was_written(triple, one_ra);
      ASSERT_EQ(elements_depend(triple), expected) << disassemble(encode(triple));
      ++(expected ? depend : free);
    }
  }
  EXPECT_GT(depend, 100000);
  EXPECT_GT(free, 100000);
}

TEST(Numbers, AreThoseThatAnInstructionNames) {
  using Three = std::array<uint32_t, 3>;
  const auto numbers = [](const std::string& text) {
    const Numbers found = numbers_of(unpack(assemble(text, "test").code.front()));
    return Three{found.registers, found.predicates, found.arguments};
  };
  EXPECT_EQ(numbers("iadd r3, r1, r2"), (Three{4, 1, 0}));
  EXPECT_EQ(numbers("iadd r1, r2, 15"), (Three{3, 1, 0}));
  EXPECT_EQ(numbers("@!p5 st [r7+4], r9"), (Three{10, 6, 0}));
  EXPECT_EQ(numbers("pand p3, p4, p2"), (Three{0, 5, 0}));
  EXPECT_EQ(numbers("flt p7, r1, r2"), (Three{3, 8, 0}));
  EXPECT_EQ(numbers("sel r1, p6, r2, 3"), (Three{3, 7, 0}));
  EXPECT_EQ(numbers("ffma r1, r2, r3, r12"), (Three{13, 1, 0}));
  EXPECT_EQ(numbers("arg r1, 17"), (Three{2, 1, 18}));
  EXPECT_EQ(numbers("rst 20, r11"), (Three{12, 1, 0}));
  EXPECT_EQ(numbers("exit"), (Three{0, 1, 0}));
  // Of a triple the last ones; what comes behind the last of all is the first.
  EXPECT_EQ(numbers("fadd3 r1, r4, r7"), (Three{10, 1, 0}));
  EXPECT_EQ(numbers("fmul3s r1, r11, r4"), (Three{12, 1, 0}));
  EXPECT_EQ(numbers("ffma3 r1, r4, 2.0, r10"), (Three{13, 1, 0}));
  EXPECT_EQ(numbers("ld3 r1, [r9]"), (Three{10, 1, 0}));
  EXPECT_EQ(numbers("arg3 r14, 30"), (Three{16, 1, 32}));
  EXPECT_EQ(numbers("rst3 3, r5"), (Three{8, 1, 0}));
}

TEST(Assembler, DisassembledInstructionsAssembleToThemselves) {
  std::mt19937_64 random(2);
  for (const InstructionInfo& info : kInstructions) {
    for (int i = 0; i < 400; ++i) {
      const uint64_t proper = random_instruction(info, random, false);
      ASSERT_EQ(disassemble(proper).find(".word"), std::string::npos) << disassemble(proper);
      ASSERT_EQ(assemble_one(disassemble(proper)), proper) << disassemble(proper);
      const uint64_t any = random_instruction(info, random, true);
      ASSERT_EQ(assemble_one(disassemble(any)), any) << disassemble(any);
    }
  }
  for (int i = 0; i < 2000; ++i) {
    const uint64_t any = random();
    ASSERT_EQ(assemble_one(disassemble(any)), any) << disassemble(any);
  }
}

TEST(Assembler, ListedProgramsAssembleToThemselves) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 50; ++i) {
    Program program;
    const auto size = static_cast<uint32_t>(1 + random() % 100);
    for (uint32_t k = 0; k < size; ++k) {
      const InstructionInfo& info = kInstructions[random() % std::size(kInstructions)];
      uint64_t encoding = random_instruction(info, random, false);
      if (has_operand(info, Operand::Target) && random() % 4 != 0) {
        encoding = (encoding & ~uint64_t{0xffffffff}) | random() % (size + 1) |
                   (has_operand(info, Operand::End) ? random() % (size + 1) << 16 : 0);
      }
      program.code.push_back(encoding);
    }
    program.entries["first"] = 0;
    program.entries["L5"] = static_cast<uint32_t>(random() % (size + 1));  // a name that a generated label would take
    const std::string text = listing(program);
    const Program again = assemble(text, "listing");
    ASSERT_EQ(again.code, program.code) << text;
    ASSERT_EQ(again.entries, program.entries) << text;
  }
}

TEST(Assembler, LabelsKernelsCommentsAndGuards) {
  const Program program = assemble(
      "# a program\n"
      "\n"
      ".kernel first\r\n"
      "start:  @p1 jany start   # back\n"
      "        call sub, end\n"
      ".kernel second\n"
      "a: b:   exit\n"
      "sub:\n"
      "        ret\n"
      "end:\n",
      "test");
  EXPECT_EQ(program.entries, (std::map<std::string, uint32_t>{{"first", 0}, {"second", 2}}));
  ASSERT_EQ(program.code.size(), 4u);
  EXPECT_EQ(disassemble(program.code[0]), "@p1 jany 0");
  EXPECT_EQ(disassemble(program.code[1]), "call 3, 4");
  EXPECT_EQ(disassemble(program.code[2]), "exit");
}

TEST(Assembler, ImmediatesInAllNotations) {
  const auto immediate = [](const std::string& text) { return static_cast<uint32_t>(assemble_one(text)); };
  EXPECT_EQ(immediate("iadd r1, r1, 4294967295"), 0xffffffffu);
  EXPECT_EQ(immediate("iadd r1, r1, -2147483648"), 0x80000000u);
  EXPECT_EQ(immediate("iadd r1, r1, 0xFF"), 0xffu);
  EXPECT_EQ(immediate("fadd r1, r1, -0.0"), 0x80000000u);
  EXPECT_EQ(immediate("fadd r1, r1, 1e-3"), 0x3a83126fu);
  EXPECT_EQ(immediate("fadd r1, r1, 0x7fc00000"), 0x7fc00000u);
  EXPECT_EQ(immediate("fadd r1, r1, -inf"), 0xff800000u);
  EXPECT_EQ(immediate("fadd r1, r1, 1e-45"), 1u);
  EXPECT_EQ(immediate("mov r1, 0.5"), 0x3f000000u);
  EXPECT_EQ(immediate("ld r1, [r2 + 0x10]"), 16u);
  EXPECT_EQ(immediate("ld r1, [ r2 - 1 ]"), 0xffffffffu);
}

TEST(Assembler, AMistypedMnemonicOrLabelNamesTheNearest) {
  EXPECT_EQ(error_of("fad r1, r2, r3"),
            "file:1:1: unknown instruction 'fad': did you mean fadd? (docs/machine/isa.md lists all)");
  EXPECT_EQ(error_of("exti"),
            "file:1:1: unknown instruction 'exti': did you mean exit? (docs/machine/isa.md lists all)");
  EXPECT_EQ(error_of("again: exit\njany agian"),
            "file:2:6: label 'agian' is not defined in this file: did you mean again?");
}

TEST(Assembler, ErrorsNameLineColumnAndRemedy) {
  EXPECT_EQ(error_of("exit\n mov r16, 1"), "file:2:6: unknown register r16; registers are r0 to r15");
  EXPECT_EQ(error_of("mov p1, 1"), "file:1:5: expected a register, found 'p1'; registers are r0 to r15");
  EXPECT_EQ(error_of("@p16 mov r1, 1"), "file:1:2: unknown predicate p16; predicates are p0 to p15");
  EXPECT_EQ(error_of("mov r01, 1"), "file:1:5: unknown register r01; registers are r0 to r15");
  EXPECT_EQ(error_of("iadd r1, r2, r17"), "file:1:14: unknown register r17; registers are r0 to r15");
  EXPECT_EQ(error_of("saxpy r1, r2, r3"), "file:1:1: unknown instruction 'saxpy'; docs/machine/isa.md lists all");
  EXPECT_EQ(error_of("fadd r1, r2"), "file:1:12: expected ',' before the next operand, found the end of the line");
  EXPECT_EQ(error_of("fadd r1, r2, r3, r4"), "file:1:16: expected the end of the line, found ','");
  EXPECT_EQ(error_of("fadd r1, r2, 2"),
            "file:1:14: '2' is not a float; write 2.0 for the number, or 0x... for the bit pattern");
  EXPECT_EQ(error_of("iadd r1, r2, 2.5"), "file:1:14: iadd takes an integer, not the float 2.5");
  EXPECT_EQ(error_of("iadd r1, r2, 4294967296"),
            "file:1:14: 4294967296 does not fit in 32 bits; integers are -2147483648 to 4294967295");
  EXPECT_EQ(error_of("iadd r1, r2, 99999999999999999999"),
            "file:1:14: 99999999999999999999 does not fit in 32 bits; integers are -2147483648 to 4294967295");
  EXPECT_EQ(error_of("iadd r1, r2, 12z"), "file:1:14: '12z' is not a number");
  EXPECT_EQ(error_of("iadd r1, r2, *"), "file:1:14: expected a register or an immediate, found '*'");
  EXPECT_EQ(error_of("fadd r1, r2, 1e99"),
            "file:1:14: the float 1e99 is too large or too small for single precision; write inf or 0.0");
  EXPECT_EQ(error_of("rst 21, r1"), "file:1:5: there is no ray word 21; ray words are 0 to 20");
  EXPECT_EQ(error_of("arg r1, 32"), "file:1:9: there is no argument 32; arguments are 0 to 31");
  EXPECT_EQ(error_of("jany nowhere"), "file:1:6: label 'nowhere' is not defined in this file");
  EXPECT_EQ(error_of("jany 65536"), "file:1:6: target 65536 does not fit in 16 bits; instructions are 0 to 65535");
  EXPECT_EQ(error_of("a: exit\na: exit"), "file:2:1: label 'a' is defined twice; give one of them another name");
  EXPECT_EQ(error_of("ld r1, r2"), "file:1:8: expected '[' before an address, found 'r2'");
  EXPECT_EQ(error_of("ld r1, [r2+4"), "file:1:13: expected ']' after an address, found the end of the line");
  EXPECT_EQ(error_of(".kernel"), "file:1:8: expected the kernel's name, found the end of the line");
  EXPECT_EQ(error_of(".word 12"), "file:1:7: expected 64 bits in hexadecimal, such as 0x1c00000000000000");
  EXPECT_EQ(error_of("@p1"), "file:1:4: expected an instruction, found the end of the line");
}

TEST(Generated, CheckedInFilesAreThoseOfTheTable) {
  for (const GeneratedFile& file : generated_files()) EXPECT_EQ(read(file.path), file.text) << "make isa";
}

TEST(Generated, ReferenceNamesEveryInstruction) {
  const std::string text = isa_markdown();
  for (const InstructionInfo& info : kInstructions) {
    EXPECT_NE(text.find(fmt::format("`{}", info.mnemonic)), std::string::npos) << info.mnemonic;
    EXPECT_NE(text.find(std::string(info.meaning)), std::string::npos) << info.mnemonic;
  }
}

TEST(Generated, ExampleInTheReferenceAssembles) {
  const std::string text = isa_markdown();
  const size_t begin = text.find("# a comment");
  const size_t end = text.find("```", begin);
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(assemble(text.substr(begin, end - begin), "docs/machine/isa.md").code.size(), 7u);
}

}  // namespace
}  // namespace raypool
