// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Counts the infinities and NaNs that a program's float instructions meet: at which PC, as operands or as results.
#pragma once

#include <cstdint>
#include <vector>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "isa/isa.hpp"
#include "machine/compute/float_reads.hpp"
#include "machine/compute/lanes.hpp"

namespace raypool {

/// Of an instruction, or the elements of a triple, at one PC: how often a thread executed it, and in how many of these
/// an operand that it reads as a float, or the float that it gives, was infinite or a NaN.
struct SpecialCounts {
  uint64_t executed = 0;
  uint64_t infinite_operands = 0, nan_operands = 0;
  uint64_t infinite_results = 0, nan_results = 0;

  bool any() const { return (infinite_operands | nan_operands | infinite_results | nan_results) != 0; }
};

class SpecialCensus {
 public:
  /// As units of this mode see words: without what is below their significand.
  explicit SpecialCensus(arith::Mode mode) : kept_(~uint32_t{0} << (arith::kFullSignificand - mode.significand)) {}

  /// Before an instruction is executed, as rd may be one of its operands; nothing of one that reads no float.
  template <int kLanes>
  void operands(uint32_t pc, Opcode opcode, const Lanes<kLanes>& lanes) {
    const FloatReads reads = float_reads(opcode);
    if (!reads.a) return;
    SpecialCounts& counts = at(pc);
    for (uint32_t left = lanes.mask; left != 0; left &= left - 1) {
      const uint32_t lane = lowest(left);
      const auto one_is = [&](auto special) {
        return (reads.a && special(lanes.a[lane])) || (reads.b && special(lanes.b[lane])) ||
               (reads.c && special(lanes.c[lane]));
      };
      ++counts.executed;
      counts.infinite_operands += one_is([this](uint32_t word) { return infinite(word); }) ? 1 : 0;
      counts.nan_operands += one_is([this](uint32_t word) { return nan(word); }) ? 1 : 0;
    }
  }

  /// After it, if it writes a register.
  template <int kLanes>
  void results(uint32_t pc, Opcode opcode, const Lanes<kLanes>& lanes) {
    if (!float_reads(opcode).a || opcode == Opcode::F2i) return;
    SpecialCounts& counts = at(pc);
    for (uint32_t left = lanes.mask; left != 0; left &= left - 1) {
      const uint32_t word = lanes.rd[lowest(left)];
      counts.infinite_results += infinite(word) ? 1 : 0;
      counts.nan_results += nan(word) ? 1 : 0;
    }
  }

  /// By PC.
  const std::vector<SpecialCounts>& counts() const { return counts_; }

 private:
  SpecialCounts& at(uint32_t pc) {
    if (pc >= counts_.size()) counts_.resize(pc + 1);
    return counts_[pc];
  }
  bool infinite(uint32_t word) const { return (word & kept_ & arith::detail::kMagnitude) == arith::detail::kInfinity; }
  bool nan(uint32_t word) const { return (word & kept_ & arith::detail::kMagnitude) > arith::detail::kInfinity; }

  uint32_t kept_;
  std::vector<SpecialCounts> counts_;
};

}  // namespace raypool
