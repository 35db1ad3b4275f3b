// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_memory_sequencer.v: which warp's memory task goes through the cache next. A warp is queued (new, not
// started) or parked (lanes are left); a parked one waits for lines that are being fetched, or was
// refused a fetch (it is a loser), or both.
#pragma once

#include <cstdint>

#include "bits.hpp"
#include "machine/compute/miss_status.hpp"

namespace raypool {

class MemorySequencer {
 public:
  /// Of a pass: over all lanes of a new task, over those of a line that has come, over those of the privileged loser.
  enum class Kind : uint8_t { New, Filled, Loser };

  struct Registers {
    uint32_t queued = 0, parked = 0, loser = 0;  ///< sets of warps
    bool privilege = false;                      ///< only privilege_warp may take an MSHR
    uint32_t privilege_warp = 0;
    bool attempt = false;     ///< the privileged loser has not tried since an MSHR became free
    bool next_valid = false;  ///< a pass is prepared
    Kind next_kind = Kind::New;
    uint32_t next_warp = 0, next_mshr = 0;
  };
  /// The pass that is prepared from the next cycle on.
  struct Select {
    bool valid = false;
    Kind kind = Kind::New;
    uint32_t warp = 0, mshr = 0;
  };
  struct Inputs {
    bool queue = false;  ///< a new task that cannot start at once
    uint32_t queue_warp = 0;
    bool park = false;
    uint32_t park_warp = 0;
    bool pass_end = false;  ///< last access of a pass
    uint32_t pass_warp = 0;
    bool pass_refused = false;    ///< it leaves lanes that were refused
    bool pass_allocated = false;  ///< it took an MSHR
    bool freed = false;           ///< an MSHR
    bool next_take = false;
  };

  void reset() { q_ = Registers{}; }
  const Registers& registers() const { return q_; }

  bool queue_empty() const { return q_.queued == 0; }
  bool idle() const { return (q_.queued | q_.parked) == 0 && !q_.next_valid; }
  /// Something is to be done, as long as no MSHR is filled.
  bool active() const { return q_.next_valid || (q_.queued | q_.loser) != 0 || q_.privilege; }
  bool may_allocate(uint32_t warp) const { return !q_.privilege || q_.privilege_warp == warp; }

  /// Waiters of a line that has come, then the privileged loser, then new tasks.
  Select select(const MissStatus::Registers& miss) const {
    if (q_.next_valid) return {};
    for (uint32_t bits = miss.filled; bits != 0; bits &= bits - 1) {
      const uint32_t waiters = miss.waiters[lowest(bits)] & q_.parked;
      if (waiters != 0) return {true, Kind::Filled, lowest(waiters), lowest(bits)};
    }
    if (q_.privilege && q_.attempt && (q_.loser & q_.parked) >> q_.privilege_warp & 1)
      return {true, Kind::Loser, q_.privilege_warp, 0};
    if (q_.queued != 0) return {true, Kind::New, lowest(q_.queued), 0};
    return {};
  }

  void clock(const Inputs& in, const Select& select) {
    const uint32_t loser = q_.loser;
    if (in.queue) q_.queued |= 1u << in.queue_warp;
    if (in.park) q_.parked |= 1u << in.park_warp;
    if (in.pass_end) q_.loser = (q_.loser & ~(1u << in.pass_warp)) | uint32_t{in.pass_refused} << in.pass_warp;
    if (in.next_take) q_.next_valid = false;
    if (select.valid) {
      q_.next_valid = true;
      q_.next_kind = select.kind;
      q_.next_warp = select.warp;
      q_.next_mshr = select.mshr;
      (select.kind == Kind::New ? q_.queued : q_.parked) &= ~(1u << select.warp);
      if (select.kind == Kind::Loser) q_.attempt = false;
    }
    if (q_.privilege) {
      if (in.freed) q_.attempt = true;
      const bool pass_of_privileged = in.pass_end && in.pass_warp == q_.privilege_warp;
      if ((pass_of_privileged && in.pass_allocated) || (loser >> q_.privilege_warp & 1) == 0) q_.privilege = false;
    } else if (loser != 0) {
      const uint32_t after = loser & ~((2u << q_.privilege_warp) - 1);
      q_.privilege = q_.attempt = true;
      q_.privilege_warp = lowest(after != 0 ? after : loser);
    }
  }

 private:
  Registers q_;
};

}  // namespace raypool
