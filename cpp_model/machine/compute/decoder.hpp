// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Decodes an instruction once, so that executing it needs no more field extraction.
#pragma once

#include <cstdint>

#include "config/configuration.hpp"
#include "isa/isa.hpp"

namespace raypool {

struct DecodedInstruction {
  uint64_t encoding = 0;
  uint32_t immediate = 0;
  const InstructionInfo* info = nullptr;  ///< null: illegal; of a triple's element that of what it does
  Opcode opcode{};                        ///< of a legal one
  uint8_t guard = 0;                      ///< predicate number
  bool guard_negated = false;
  uint8_t rd = 0, ra = 0, rb = 0;
  uint8_t x = 0;
  bool b_is_immediate = false;
  Kind kind = Kind::Plain;
  bool uses_b = false;  ///< has an operand B (or rb of `st`)
  bool writes_register = false;
  bool writes_predicate = false;
  /// A triple's next element, null: this is the last, or no triple. Set by the owner of the elements.
  const DecodedInstruction* next = nullptr;
  bool elements_depend = false;

  bool legal() const { return info != nullptr; }
  AluType alu() const { return alu_of(opcode); }
  uint32_t target() const { return immediate & 0xffffu; }
  uint32_t end() const { return immediate >> 16; }
};

/// Rows that need a feature which the configuration has not are illegal. Of a triple, that element.
DecodedInstruction decode(uint64_t encoding, const Configuration& configuration, int element = 0);
/// How many elements it has: 1, or 3 of a triple that is legal.
int elements(uint64_t encoding, const Configuration& configuration);

}  // namespace raypool
