// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_int_alu.v computes: integer and logic operations.
#pragma once

#include <cstdint>

#include "machine/compute/lanes.hpp"

namespace raypool {

struct IntAlu {
  template <int kLanes>
  static void execute(Opcode opcode, const Lanes<kLanes>& lanes, uint32_t predicate_x) {
    switch (opcode) {
      case Opcode::Mov:
        return lanes.map([](uint32_t, uint32_t y) { return y; });
      case Opcode::Iadd:
        return lanes.map([](uint32_t x, uint32_t y) { return x + y; });
      case Opcode::Isub:
        return lanes.map([](uint32_t x, uint32_t y) { return x - y; });
      case Opcode::Imul:
        return lanes.map([](uint32_t x, uint32_t y) { return x * y; });
      case Opcode::And:
        return lanes.map([](uint32_t x, uint32_t y) { return x & y; });
      case Opcode::Or:
        return lanes.map([](uint32_t x, uint32_t y) { return x | y; });
      case Opcode::Xor:
        return lanes.map([](uint32_t x, uint32_t y) { return x ^ y; });
      case Opcode::Shl:
        return lanes.map([](uint32_t x, uint32_t y) { return x << (y & 31); });
      case Opcode::Shr:
        return lanes.map([](uint32_t x, uint32_t y) { return x >> (y & 31); });
      case Opcode::Sar:
        return lanes.map([](uint32_t x, uint32_t y) { return static_cast<uint32_t>(as_signed(x) >> (y & 31)); });
      case Opcode::Imin:
        return lanes.map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? x : y; });
      case Opcode::Imax:
        return lanes.map([](uint32_t x, uint32_t y) { return as_signed(x) < as_signed(y) ? y : x; });
      case Opcode::Umin:
        return lanes.map([](uint32_t x, uint32_t y) { return x < y ? x : y; });
      case Opcode::Umax:
        return lanes.map([](uint32_t x, uint32_t y) { return x < y ? y : x; });
      case Opcode::Sel:
        return lanes.each([&](uint32_t lane) { return predicate_x >> lane & 1 ? lanes.a[lane] : lanes.b[lane]; });
      default:
        not_modelled(opcode);
    }
  }
};

}  // namespace raypool
