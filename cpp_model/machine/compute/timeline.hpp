// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the model knows ahead: the warps that get on in each of the next cycles. So a cycle in which nothing happens
// costs next to nothing. No module of the RTL: there a state machine counts the cycles.
#pragma once

#include <array>
#include <cstdint>

namespace raypool {

class Timeline {
 public:
  /// Cycles ahead for which something can be known; a task of the deepest ALU, slw, takes 63.
  static constexpr uint32_t kCycles = 128;

  /// Sets of warps.
  struct alignas(32) Cycle {
    uint32_t done = 0;      ///< a pipelined ALU is done with their instruction in this cycle
    uint32_t fetch = 0;     ///< they want the instruction cache from this cycle on
    uint32_t full = 0;      ///< their next instruction is in the buffer from this cycle on
    uint32_t want_mem = 0;  ///< they want the memory ALU from this cycle on
    uint32_t want_ray = 0;
    uint32_t part = 0;   ///< a pipelined ALU is done with an element of their triple that is not the last
    uint32_t again = 0;  ///< they begin to read the operands of the next element for one in the cycle after this
    bool any() const { return (done | fetch | full | want_mem | want_ray | part | again) != 0; }
  };

  void reset() { ring_.fill(Cycle{}); }
  Cycle& at(uint64_t cycle) { return ring_[cycle % kCycles]; }
  const Cycle& at(uint64_t cycle) const { return ring_[cycle % kCycles]; }

 private:
  std::array<Cycle, kCycles> ring_{};
};

}  // namespace raypool
