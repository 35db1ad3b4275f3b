// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_alu_pipeline.v: when an ALU with `latency` cycles between tasks and `depth` stages takes its next
// task, and when a task is done. It is all that tid_alu, brh_alu, int_alu, flt_alu and slw_alu have of time; what they
// compute is the functional core's.
#pragma once

#include <algorithm>
#include <cstdint>

#include "config/configuration.hpp"

namespace raypool {

class AluPipeline {
 public:
  AluPipeline() = default;
  explicit AluPipeline(const AluConfiguration& alu) : latency_(alu.latency), depth_(alu.depth) {}

  void reset() { ready_from_ = 0; }

  /// Whether a task granted in this cycle, which arrives in the next one, is taken.
  bool ready(uint64_t cycle) const { return ready_from_ <= cycle; }
  /// Such a task is granted; returns the cycle in which it is done.
  uint64_t grant(uint64_t cycle) {
    ready_from_ = cycle + latency_;
    return cycle + 1 + depth_;
  }
  uint32_t depth() const { return depth_; }
  /// Cycles of one task in which no other one is taken.
  uint32_t pause() const { return latency_ - 1; }
  /// How many cycles from this one on it is not ready, as far as is known.
  uint64_t unready(uint64_t cycle) const { return std::max(ready_from_, cycle) - cycle; }

 private:
  uint32_t latency_ = 1, depth_ = 1;
  uint64_t ready_from_ = 0;  // cycle; in the RTL pause_q counts down to it
};

}  // namespace raypool
