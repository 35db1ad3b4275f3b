// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_slw_alu.v computes: quotients and roots.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

struct SlwAlu {
  template <int kLanes>
  static void execute(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode) {
    switch (opcode) {
      case Opcode::Fdiv:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::div(x, y, mode); });
      case Opcode::Fsqrt:
        return lanes.map([mode](uint32_t x, uint32_t) { return arith::sqrt(x, mode); });
      case Opcode::Frsqrt:
        return lanes.map([mode](uint32_t x, uint32_t) { return arith::rsqrt(x, mode); });
      case Opcode::Frcp:
        return lanes.map([mode](uint32_t x, uint32_t) { return arith::rcp(x, mode); });
      default:
        not_modelled(opcode);
    }
  }
};

}  // namespace raypool
