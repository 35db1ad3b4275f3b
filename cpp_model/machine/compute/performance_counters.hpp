// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_performance_counters.v: what is counted while a kernel runs. The numbers are those of namespace
// counter. The RTL adds events one or two cycles later, which does not show once it is idle.
#pragma once

#include <array>
#include <cstdint>

#include "isa/isa.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

struct PerformanceCounters {
  std::array<uint64_t, counter::kUnused> single{};  ///< [number] those that no ALU type has of its own
  std::array<uint64_t, kAluTypes> waiting{}, issued{};
  /// [type] busy cycles x instances that could take no task
  std::array<uint64_t, kAluTypes> unready{};

  void reset() { *this = PerformanceCounters{}; }

  /// Warps are in the state that counter `number` counts from `cycle` on, or no longer: their cycles are counted when
  /// they leave, so such a counter holds while no kernel runs.
  void enter(int number, uint64_t cycle, uint64_t warps) { single[number] -= warps * cycle; }
  void leave(int number, uint64_t cycle, uint64_t warps) { single[number] += warps * cycle; }

  /// `instances`: of the number's ALU type, for those that have one; `rest`: what is
  /// in its `unready` and still to come.
  uint64_t value(int number, uint32_t instances, uint64_t rest) const {
    if (number < counter::kUnused) return single[number];
    const size_t type = static_cast<size_t>(number & 7);
    if (type >= kAluTypes) return 0;
    switch (number & ~7) {
      case counter::kUnused:
        // Each instance is busy, given a task, or unused.
        return single[counter::kBusyCycles] * instances - (unready[type] - rest) - issued[type];
      case counter::kWaiting:
        return waiting[type];
      case counter::kIssued:
        return issued[type];
      default:
        return 0;
    }
  }
};

}  // namespace raypool
