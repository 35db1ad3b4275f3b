// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What rtl/compute/rp_subnormal_guard.v finds, on machines with arithmetic.subnormals none: whether a float instruction
// has masked lanes in which an operand that it reads is a subnormal number, or the result was one before it was
// flushed.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "isa/isa.hpp"
#include "machine/compute/float_reads.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

template <int kLanes>
class SubnormalGuard {
 public:
  /// Before the instruction is executed, as rd may be one of its operands.
  SubnormalGuard(Opcode opcode, const Lanes<kLanes>& lanes, arith::Mode mode)
      : opcode_(opcode), mask_(lanes.mask), mode_(mode), reads_(float_reads(opcode)) {
    if (reads_.a) std::memcpy(a_, lanes.a, sizeof(a_));
    if (reads_.b) std::memcpy(b_, lanes.b, sizeof(b_));
    if (reads_.c) std::memcpy(c_, lanes.c, sizeof(c_));
  }

  /// After it has been executed; `results`: a word a lane, null of an instruction that writes no register.
  bool met(const uint32_t* results) const {
    bool operand = false;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      const bool found =
          (reads_.a && subnormal(a_[lane])) || (reads_.b && subnormal(b_[lane])) || (reads_.c && subnormal(c_[lane]));
      operand |= found && (mask_ >> lane & 1) != 0;
    }
    if (operand || results == nullptr || !reads_.a) return operand;
    for (uint32_t left = mask_; left != 0; left &= left - 1) {
      const uint32_t lane = lowest(left);
      if ((results[lane] & arith::detail::kMagnitude) == 0 && vanished(lane)) return true;
    }
    return false;
  }

 private:
  /// As the unit sees it: without what is below its significand.
  bool subnormal(uint32_t word) const {
    word &= ~uint32_t{0} << (arith::kFullSignificand - mode_.significand);
    return (word & arith::detail::kInfinity) == 0 && (word & arith::detail::kMagnitude) != 0;
  }

  /// The result is zero, and no operand subnormal: would it be more than zero with exponents of any size?
  bool vanished(uint32_t lane) const {
    const auto number = [this](uint32_t word) { return double{as_float(arith::detail::operand(word, mode_))}; };
    switch (opcode_) {
      case Opcode::Fadd:
        return number(a_[lane]) + number(b_[lane]) != 0;
      case Opcode::Fsub:
        return number(a_[lane]) - number(b_[lane]) != 0;
      case Opcode::Fmul:
        return number(a_[lane]) != 0 && number(b_[lane]) != 0;
      case Opcode::Ffma:
        return number(a_[lane]) * number(b_[lane]) + number(c_[lane]) != 0;  // exact where it is zero
      case Opcode::Fdiv:
        return number(a_[lane]) != 0 && std::isfinite(number(b_[lane]));
      case Opcode::Frcp:
        return std::isfinite(number(a_[lane]));
      default:
        return false;
    }
  }

  Opcode opcode_;
  uint32_t mask_;
  arith::Mode mode_;
  FloatReads reads_;
  uint32_t a_[kLanes] = {}, b_[kLanes] = {}, c_[kLanes] = {};
};

}  // namespace raypool
