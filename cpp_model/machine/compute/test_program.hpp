// For tests: machine code from assembly text, and programs put into memory.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "bits.hpp"
#include "isa/assembler.hpp"
#include "machine/common/memory.hpp"

namespace raypool::test {

/// The machine code of assembly text; a semicolon ends a line, too.
inline std::vector<uint64_t> assembled(std::string text) {
  std::replace(text.begin(), text.end(), ';', '\n');
  return assemble(text, "test").code;
}

inline void put_program(Memory& memory, const std::vector<uint64_t>& code) {
  memory.grow(size32(code) * 8);
  for (size_t i = 0; i < code.size(); ++i) {
    memory.store(static_cast<uint32_t>(8 * i), static_cast<uint32_t>(code[i]));
    memory.store(static_cast<uint32_t>(8 * i + 4), static_cast<uint32_t>(code[i] >> 32));
  }
}

}  // namespace raypool::test
