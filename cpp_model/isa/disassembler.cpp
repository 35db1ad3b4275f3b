// The disassembler: single instructions and whole programs.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "isa/encoding.hpp"

namespace raypool {
namespace {

using Labels = std::map<uint32_t, std::string>;

std::string float_text(uint32_t bits) {
  const float value = as_float(bits);
  // A tiny number is more likely an integer that goes into a ray word.
  if (std::isnan(value) || std::fpclassify(value) == FP_SUBNORMAL) return fmt::format("0x{:08x}", bits);
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  std::string text = fmt::format("{}", value);  // the shortest that reads back the same
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string integer_text(uint32_t bits) {
  const auto value = static_cast<int32_t>(bits);
  return value >= -32768 && value <= 65535 ? fmt::format("{}", value) : fmt::format("0x{:08x}", bits);
}

std::string offset_text(uint32_t bits) {
  const auto value = static_cast<int32_t>(bits);
  if (value == 0) return "";
  if (value < 0 && value >= -32768) return fmt::format("{}", value);
  return "+" + integer_text(bits);
}

std::string target_text(uint32_t target, const Labels& labels) {
  const auto label = labels.find(target);
  return label == labels.end() ? fmt::format("{}", target) : label->second;
}

uint32_t target_of(const Instruction& parts) { return parts.immediate & 0xffffu; }
uint32_t end_of(const Instruction& parts) {
  return has_operand(*parts.info, Operand::Target) ? parts.immediate >> 16 : parts.immediate & 0xffffu;
}

std::string operand_text(Operand operand, const Instruction& parts, const Labels& labels) {
  switch (operand) {
    case Operand::None:
      break;
    case Operand::Rd:
      return fmt::format("r{}", parts.rd);
    case Operand::Ra:
      return fmt::format("r{}", parts.ra);
    case Operand::Rb:
      return fmt::format("r{}", parts.rb);
    case Operand::Rc:
      return fmt::format("r{}", parts.x & 15);
    case Operand::B:
      if (!parts.b_is_immediate) return fmt::format("r{}", parts.rb);
      return parts.info->immediate == ImmediateType::Float ? float_text(parts.immediate)
                                                           : integer_text(parts.immediate);
    case Operand::Pd:
      return fmt::format("p{}", parts.rd);
    case Operand::Px:
      return fmt::format("p{}", parts.x & 15);
    case Operand::Pb:
      return fmt::format("p{}", parts.rb);
    case Operand::Address:
      return fmt::format("[r{}{}]", parts.ra, offset_text(parts.immediate));
    case Operand::Word:
      return fmt::format("{}", parts.x);
    case Operand::Argument:
      return fmt::format("{}", parts.immediate);
    case Operand::Target:
      return target_text(target_of(parts), labels);
    case Operand::End:
      return target_text(end_of(parts), labels);
  }
  return "";
}

/// The same instruction with everything its operands do not use set to 0: what the assembler would write.
Instruction canonical(const Instruction& parts) {
  Instruction result;
  result.info = parts.info;
  result.guard = parts.guard;
  result.guard_negated = parts.guard_negated;
  for (const Operand operand : parts.info->operands) {
    switch (operand) {
      case Operand::None:
        break;
      case Operand::Rd:
      case Operand::Pd:
        result.rd = parts.rd;
        break;
      case Operand::Ra:
        result.ra = parts.ra;
        break;
      case Operand::Rb:
      case Operand::Pb:
        result.rb = parts.rb;
        break;
      case Operand::B:
        result.b_is_immediate = parts.b_is_immediate;
        if (parts.b_is_immediate)
          result.immediate = parts.immediate;
        else
          result.rb = parts.rb;
        break;
      case Operand::Rc:
      case Operand::Px:
        result.x = parts.x & 15;
        break;
      case Operand::Address:
        result.ra = parts.ra;
        result.immediate = parts.immediate;
        break;
      case Operand::Word:
        result.x = parts.x <= kLastRayWord ? parts.x : 0;
        break;
      case Operand::Argument:
        result.immediate = parts.immediate % kArguments;
        break;
      case Operand::Target:
        result.immediate |= target_of(parts);
        break;
      case Operand::End:
        result.immediate |= has_operand(*parts.info, Operand::Target) ? end_of(parts) << 16 : end_of(parts);
        break;
    }
  }
  return result;
}

/// `columns`: guard and mnemonic padded, for a listing.
std::string instruction_text(const Instruction& parts, const Labels& labels, bool columns) {
  std::string guard;
  if (parts.guard != 0 || parts.guard_negated)
    guard = fmt::format("@{}p{}", parts.guard_negated ? "!" : "", parts.guard);
  std::string operands;
  for (const Operand operand : parts.info->operands) {
    if (operand == Operand::None) continue;
    operands += (operands.empty() ? "" : ", ") + operand_text(operand, parts, labels);
  }
  if (columns) return fmt::format("{:<6}{:<8}{}", guard, parts.info->mnemonic, operands);
  return fmt::format("{}{}{}{}{}", guard, guard.empty() ? "" : " ", parts.info->mnemonic, operands.empty() ? "" : " ",
                     operands);
}

std::string text_of(uint64_t encoding, const Labels& labels, bool columns) {
  const Instruction parts = unpack(encoding);
  const std::string word = fmt::format("{}.word 0x{:016x}", columns ? "      " : "", encoding);
  if (parts.info == nullptr) return word + "  # illegal";
  if (encode(canonical(parts)) != encoding) return word + "  # " + instruction_text(parts, {}, false);
  return instruction_text(parts, labels, columns);
}

}  // namespace

std::string disassemble(uint64_t encoding) { return text_of(encoding, {}, false); }

std::string listing(const Program& program) {
  Labels labels;
  for (const auto& [name, entry] : program.entries) labels[entry] = name;
  for (const uint64_t encoding : program.code) {
    const Instruction parts = unpack(encoding);
    if (parts.info == nullptr || encode(canonical(parts)) != encoding) continue;
    for (const Operand operand : parts.info->operands) {
      if (operand != Operand::Target && operand != Operand::End) continue;
      const uint32_t target = operand == Operand::Target ? target_of(parts) : end_of(parts);
      if (target > program.code.size()) continue;  // stays a number
      std::string name = fmt::format("L{}", target);
      while (program.entries.count(name) != 0) name += "_";
      labels.emplace(target, name);
    }
  }
  std::string text;
  for (uint32_t pc = 0; pc <= program.code.size(); ++pc) {
    for (const auto& [name, entry] : program.entries) {
      if (entry == pc) text += fmt::format(".kernel {}\n", name);
    }
    const auto label = labels.find(pc);
    if (label != labels.end() && program.entries.count(label->second) == 0) text += label->second + ":\n";
    if (pc < program.code.size()) text += fmt::format("  {:<46} # {}\n", text_of(program.code[pc], labels, true), pc);
  }
  return text;
}

}  // namespace raypool
