// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_instruction_buffer.v, of all warps at once: what the Verilog has as a state of each warp is a set of
// warps here. The states that last a known number of cycles (F_STACK, F_CACHE, D_READ, and D_EXECUTE in a
// pipelined ALU) are on the timeline.
#pragma once

#include <array>
#include <cstdint>

#include "bits.hpp"

namespace raypool {

class InstructionBuffer {
 public:
  /// Cycles from the issue of an instruction to D_WANT, and from that of the one before to F_ARBITER.
  static constexpr uint64_t kAhead = 2;

  struct Registers {
    uint32_t active = 0;     ///< started and not yet exited
    uint32_t f_arbiter = 0;  ///< want the instruction cache
    uint32_t f_miss = 0;     ///< wait for a line
    uint32_t f_full = 0;     ///< the next instruction is there
    uint32_t d_idle = ~0u;   ///< no instruction under way
    uint32_t control = 0;    ///< the instruction under way is a control instruction
    std::array<uint32_t, kMostWarps> fetch_pc{}, pc{};
  };

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  uint32_t active() const { return q_.active; }
  uint32_t fetch_request() const { return q_.f_arbiter; }
  uint32_t fetch_pc(uint32_t warp) const { return q_.fetch_pc[warp]; }
  uint32_t pc(uint32_t warp) const { return q_.pc[warp]; }
  /// Warps that can issue their next instruction.
  uint32_t ready() const { return q_.f_full & q_.d_idle; }
  bool under_way(uint32_t warp) const { return (q_.d_idle >> warp & 1) == 0; }

  void start(uint32_t warp) { q_.active |= 1u << warp; }
  void exit(uint32_t warp) { q_.active &= ~(1u << warp); }

  // The instruction routine
  void stack_pc(uint32_t warp, uint32_t pc) { q_.fetch_pc[warp] = pc; }  ///< what F_STACK leaves
  void want_cache(uint32_t warps) { q_.f_arbiter |= warps; }
  void fetch_grant(uint32_t warps) { q_.f_arbiter &= ~warps; }
  void cache_hit(uint32_t warps) { q_.f_full |= warps; }
  void cache_miss(uint32_t warp) { q_.f_miss |= 1u << warp; }
  /// A line has come back: the warps that should repeat their lookups.
  uint32_t refill_done() {
    const uint32_t warps = q_.f_miss;
    q_.f_miss = 0;
    return warps;
  }

  // The data routine
  void issue(uint32_t warp) {
    const uint32_t bit = 1u << warp;
    q_.f_full &= ~bit;
    q_.d_idle &= ~bit;
    q_.pc[warp] = q_.fetch_pc[warp];
  }
  void issue_control(uint32_t warp) { q_.control |= 1u << warp; }
  /// Warps that retire in this cycle may issue in it. Returns those that have retired a control instruction.
  uint32_t retire(uint32_t warps) {
    const uint32_t control = warps & q_.control;
    q_.d_idle |= warps;
    q_.control &= ~control;
    return control;
  }

 private:
  Registers q_;
};

}  // namespace raypool
