// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Time of the instruction cache: rtl/compute/rp_instruction_cache.v, cycle by cycle, without data;
// docs/machine/memory.md, section 4. The instructions themselves are the functional core's.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"

namespace raypool {

class InstructionCache {
 public:
  explicit InstructionCache(const Configuration& configuration)
      : set_mask_(configuration.instruction_cache_bytes / 128 - 1), sets_(set_mask_ + 1) {}

  void reset() {
    sets_.assign(sets_.size(), Set{});
    fetch_ = Fetch::None;
    done_ = missed_ = changes_ = false;
    first_cycle_ = kNever;
  }
  /// Forgets all lines; only while no line is being fetched.
  void invalidate() {
    for (Set& set : sets_) set.line = {kNone, kNone};
  }

  /// A lookup; its result comes in the next cycle: true for a hit. Between clock() and end_cycle() of its cycle; or
  /// ahead, while not busy().
  bool lookup(uint32_t warp, uint32_t pc) {
    const uint32_t line = pc >> 3;
    warp_ = warp;
    Set& set = sets_[line & set_mask_];
    const bool hit_0 = set.line[0] == line, hit_1 = set.line[1] == line;
    missed_line_ = line;
    missed_ = !hit_0 && !hit_1;
    // Nothing asks for the older way before the result is there, so it may change now.
    set.older = missed_ ? set.older : static_cast<uint8_t>(hit_0);
    return !missed_;
  }

  /// The latest lookup is not to have been.
  void forget_miss() { missed_ = false; }

  // Registers, as they stand in the present cycle.
  bool missed() const { return missed_; }  ///< the latest lookup, before clock() is given it
  bool refill_done() const { return done_; }
  uint32_t result_warp() const { return warp_; }  ///< of the latest lookup
  /// In the cycle after refill_done(): the warp that began the fetch with its miss, as a set. If it does not ask then,
  /// it waits its turn: it has had the line already.
  uint32_t first(uint64_t cycle) const { return cycle == first_cycle_ ? first_ : 0; }
  bool request_valid() const { return fetch_ == Fetch::Request; }
  uint32_t request_address() const { return fetch_line_ << 6; }
  /// False if clock() would change nothing without a miss, request_ready or last_beat.
  bool active() const { return done_ || fetch_ == Fetch::Settle; }
  /// A line is on its way, or a lookup has missed: the next lookups' results depend on when the line comes.
  bool busy() const { return missed_ || done_ || fetch_ != Fetch::None; }

  /// `missed`: the latest lookup was one of the cycle before, and missed.
  void clock(uint64_t cycle, bool missed, bool request_ready, bool last_beat) {
    if (done_) {
      first_ = 1u << fetch_warp_;
      first_cycle_ = cycle + 1;
    }
    done_ = fetch_ == Fetch::Settle;
    Fetch next = fetch_;
    switch (fetch_) {
      case Fetch::None:
        if (missed) {
          Set& set = sets_[missed_line_ & set_mask_];
          next = Fetch::Request;
          fetch_line_ = missed_line_;
          fetch_warp_ = warp_;
          fetch_way_ = set.older;
          set.older ^= 1;
          changes_ = true;
        }
        break;
      case Fetch::Request:
        if (request_ready) next = Fetch::Beats;
        break;
      case Fetch::Beats:
        if (last_beat) {
          next = Fetch::Settle;
          changes_ = true;
        }
        break;
      case Fetch::Settle:
        next = Fetch::None;
        break;
    }
    fetch_ = next;
    if (missed) missed_ = false;
  }
  /// The end of a cycle with a clock(): a line that has come is valid from the next
  /// cycle on, and one that gives way is not.
  void end_cycle() {
    if (!changes_) return;
    changes_ = false;
    sets_[fetch_line_ & set_mask_].line[fetch_way_] = fetch_ == Fetch::Settle ? fetch_line_ : kNone;
  }

 private:
  static constexpr uint32_t kNone = ~0u;  // no line
  static constexpr uint64_t kNever = ~uint64_t{0};
  enum class Fetch : uint8_t { None, Request, Beats, Settle };
  struct Set {
    std::array<uint32_t, 2> line{kNone, kNone};
    uint8_t older = 0;
  };

  uint32_t set_mask_;
  std::vector<Set> sets_;
  Fetch fetch_ = Fetch::None;
  uint32_t warp_ = 0, fetch_line_ = 0, fetch_warp_ = 0, missed_line_ = 0;
  uint64_t first_cycle_ = kNever;
  uint32_t first_ = 0;
  uint8_t fetch_way_ = 0;
  bool done_ = false, changes_ = false;
  bool missed_ = false;
};

}  // namespace raypool
