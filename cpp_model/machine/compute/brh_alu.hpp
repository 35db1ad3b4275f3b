// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_brh_alu.v computes: compares into predicates, predicate logic, and the decision of control
// instructions.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

struct BrhAlu {
  /// Compares, and logic of the predicates px and pb.
  template <int kLanes>
  static uint32_t compare(Opcode opcode, const Lanes<kLanes>& lanes, uint32_t predicate_x, uint32_t predicate_b,
                          arith::Mode mode) {
    switch (opcode) {
      case Opcode::Ieq:
        return lanes.test([](uint32_t x, uint32_t y) { return x == y; });
      case Opcode::Ine:
        return lanes.test([](uint32_t x, uint32_t y) { return x != y; });
      case Opcode::Ilt:
        return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y); });
      case Opcode::Ile:
        return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) <= as_signed(y); });
      case Opcode::Igt:
        return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) > as_signed(y); });
      case Opcode::Ige:
        return lanes.test([](uint32_t x, uint32_t y) { return as_signed(x) >= as_signed(y); });
      case Opcode::Ult:
        return lanes.test([](uint32_t x, uint32_t y) { return x < y; });
      case Opcode::Ule:
        return lanes.test([](uint32_t x, uint32_t y) { return x <= y; });
      case Opcode::Ugt:
        return lanes.test([](uint32_t x, uint32_t y) { return x > y; });
      case Opcode::Uge:
        return lanes.test([](uint32_t x, uint32_t y) { return x >= y; });
      case Opcode::Feq:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::equal(x, y, mode); });
      case Opcode::Fne:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::not_equal(x, y, mode); });
      case Opcode::Flt:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::less(x, y, mode); });
      case Opcode::Fle:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::less_equal(x, y, mode); });
      case Opcode::Fgt:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::greater(x, y, mode); });
      case Opcode::Fge:
        return lanes.test([mode](uint32_t x, uint32_t y) { return arith::greater_equal(x, y, mode); });
      case Opcode::Pand:
        return predicate_x & predicate_b;
      case Opcode::Por:
        return predicate_x | predicate_b;
      case Opcode::Pxor:
        return predicate_x ^ predicate_b;
      case Opcode::Pandn:
        return predicate_x & ~predicate_b;
      default:
        not_modelled(opcode);
    }
  }

  /// Whether a control instruction with this thread mask jumps, enters or leaves.
  static bool taken(Opcode opcode, uint32_t mask) {
    switch (opcode) {
      case Opcode::Jany:
      case Opcode::Loop:
        return mask != 0;
      case Opcode::Jnone:
        return mask == 0;
      default:  // call, ret, exit
        return true;
    }
  }
};

}  // namespace raypool
