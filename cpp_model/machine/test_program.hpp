// For tests: instructions encoded by hand from the instruction table, and programs put into memory.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "isa/isa.hpp"
#include "machine/memory.hpp"

namespace raypool::test {

/// One instruction. Fields that are not set are 0; b(...) chooses register or immediate.
struct Encode {
  uint64_t bits = 0;

  explicit Encode(std::string_view mnemonic) {
    for (const InstructionInfo& info : kInstructions) {
      if (info.mnemonic != mnemonic) continue;
      bits = static_cast<uint64_t>(info.opcode) << 55;
      return;
    }
    throw std::logic_error("no instruction " + std::string(mnemonic));
  }
  Encode& field(uint64_t value, int low) {
    bits |= value << low;
    return *this;
  }
  Encode& guard(uint64_t predicate, bool negated = false) { return field(predicate, 50).field(negated, 54); }
  Encode& rd(uint64_t number) { return field(number, 46); }
  Encode& ra(uint64_t number) { return field(number, 42); }
  Encode& rb(uint64_t number) { return field(number, 38); }
  Encode& x(uint64_t number) { return field(number, 32); }
  Encode& imm(uint32_t value) { return field(1, 37).field(value, 0); }  ///< operand B is an immediate
  Encode& plain_imm(uint32_t value) { return field(value, 0); }         ///< address offset, argument number
  Encode& target(uint32_t target, uint32_t end = 0) { return field(target, 0).field(end, 16); }
  operator uint64_t() const { return bits; }
};

inline void put_program(Memory& memory, const std::vector<uint64_t>& code) {
  memory.grow(static_cast<uint32_t>(code.size()) * 8);
  for (size_t i = 0; i < code.size(); ++i) {
    memory.store(static_cast<uint32_t>(8 * i), static_cast<uint32_t>(code[i]));
    memory.store(static_cast<uint32_t>(8 * i + 4), static_cast<uint32_t>(code[i] >> 32));
  }
}

}  // namespace raypool::test
