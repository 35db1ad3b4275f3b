// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_flt_alu.v computes: floating-point operations and conversions.
#pragma once

#include <cstdint>

#include "arith/arith.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

struct FltAlu {
  template <int kLanes>
  static void execute(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode) {
    mode.narrow() ? execute_in<kLanes, true>(opcode, lanes, mode) : execute_in<kLanes, false>(opcode, lanes, mode);
  }

 private:
  template <int kLanes, bool kNarrow>
  static void execute_in(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode) {
    // Where the compiler knows it, all lanes are computed at once by the host's own unit.
    if (!kNarrow) mode.significand = arith::kFullSignificand;
    switch (opcode) {
      case Opcode::Fadd:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::add(x, y, mode); });
      case Opcode::Fsub:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::sub(x, y, mode); });
      case Opcode::Fmul:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::mul(x, y, mode); });
      case Opcode::Fmin:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::min(x, y, mode); });
      case Opcode::Fmax:
        return lanes.map([mode](uint32_t x, uint32_t y) { return arith::max(x, y, mode); });
      case Opcode::F2i:
        return lanes.map([mode](uint32_t x, uint32_t) { return arith::to_int(x, mode); });
      case Opcode::I2f:
        return lanes.map([mode](uint32_t x, uint32_t) { return arith::from_int(x, mode); });
      case Opcode::Ffma:
        return lanes.each([&](uint32_t lane) { return arith::fma(lanes.a[lane], lanes.b[lane], lanes.c[lane], mode); });
      default:
        not_modelled(opcode);
    }
  }
};

}  // namespace raypool
