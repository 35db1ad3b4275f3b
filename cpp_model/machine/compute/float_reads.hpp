// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Which operands an instruction reads as floats.
#pragma once

#include "isa/isa.hpp"

namespace raypool {

struct FloatReads {
  bool a, b, c;
};

inline FloatReads float_reads(Opcode opcode) {
  switch (opcode) {
    case Opcode::Feq:
    case Opcode::Fne:
    case Opcode::Flt:
    case Opcode::Fle:
    case Opcode::Fgt:
    case Opcode::Fge:
    case Opcode::Fadd:
    case Opcode::Fsub:
    case Opcode::Fmul:
    case Opcode::Fmin:
    case Opcode::Fmax:
    case Opcode::Fdiv:
      return {true, true, false};
    case Opcode::Ffma:
      return {true, true, true};
    case Opcode::F2i:
    case Opcode::Fsqrt:
    case Opcode::Frsqrt:
    case Opcode::Frcp:
      return {true, false, false};
    default:  // i2f, integers and predicates
      return {false, false, false};
  }
}

}  // namespace raypool
