// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_miss_status.v: the miss-status holding registers (MSHRs) of the data cache, that is which lines are
// being fetched, into which way, and which warps wait for them.
#pragma once

#include <array>
#include <cstdint>

#include "bits.hpp"
#include "config/configuration.hpp"

namespace raypool {

class MissStatus {
 public:
  static constexpr uint32_t kMostMshrs = 16;

  struct Registers {
    uint32_t busy = 0, filled = 0;  ///< sets of MSHRs
    std::array<uint8_t, kMostMshrs> way{};
    std::array<uint32_t, kMostMshrs> line{};
    std::array<uint32_t, kMostMshrs> waiters{};  ///< sets of warps
  };
  /// The answer to an access.
  struct Answer {
    bool match = false;         ///< its line is being fetched
    bool available = false;     ///< a register is free
    uint32_t match_id = 0;      ///< with match
    uint32_t available_id = 0;  ///< with available
    uint32_t locked = 0;        ///< ways of its set that are promised to a register
  };

  MissStatus(const Configuration& configuration, uint32_t set_mask)
      : all_((1u << configuration.data_cache_mshrs) - 1), set_mask_(set_mask) {}

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  Answer access(uint32_t line) const {
    Answer answer;
    for (uint32_t bits = q_.busy; bits != 0; bits &= bits - 1) {
      const uint32_t id = lowest(bits);
      if ((q_.filled >> id & 1) == 0 && q_.line[id] == line) {
        answer.match = true;
        answer.match_id = id;
      }
      if ((q_.line[id] & set_mask_) == (line & set_mask_)) answer.locked |= 1u << q_.way[id];
    }
    const uint32_t free = ~q_.busy & all_;
    answer.available = free != 0;
    if (free != 0) answer.available_id = lowest(free);
    return answer;
  }
  uint32_t fill_line(uint32_t id) const { return q_.line[id]; }
  uint32_t fill_way(uint32_t id) const { return q_.way[id]; }
  /// MSHRs that are free from the next cycle on, as all their waiters have been served.
  uint32_t finished() const {
    uint32_t finished = 0;
    for (uint32_t bits = q_.filled; bits != 0; bits &= bits - 1) {
      if (q_.waiters[lowest(bits)] == 0) finished |= 1u << lowest(bits);
    }
    return finished;
  }
  bool freed() const { return finished() != 0; }
  bool idle() const { return q_.busy == 0; }

  // The end of a cycle, in this order.
  void free(uint32_t finished) {
    q_.busy &= ~finished;
    q_.filled &= ~finished;
  }
  void join(uint32_t id, uint32_t warp) { q_.waiters[id] |= 1u << warp; }
  void allocate(uint32_t id, uint32_t line, uint32_t way, uint32_t warp) {
    q_.busy |= 1u << id;
    q_.line[id] = line;
    q_.way[id] = static_cast<uint8_t>(way);
    q_.waiters[id] = 1u << warp;
  }
  void fill_last(uint32_t id) { q_.filled |= 1u << id; }
  void served(uint32_t id, uint32_t warp) { q_.waiters[id] &= ~(1u << warp); }

 private:
  uint32_t all_, set_mask_;
  Registers q_;
};

}  // namespace raypool
