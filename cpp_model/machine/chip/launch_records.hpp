// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_launch_records.v: what the kernels of a compute unit may still export.
//
// Each launch has a record until everything that its kernel has exported has left the unit: the unit itself reports how
// many there are when the kernel ends. The caller passes the cycle of each event, and asks after settle() of it.
#pragma once

#include <array>
#include <cstdint>

#include "machine/common/port_cycles.hpp"

namespace raypool {

class LaunchRecords {
 public:
  static constexpr uint32_t kRecords = 4;  ///< two kernels that run, one that waits, one with exports that still leave

  bool full() const { return count_ == kRecords; }
  bool empty() const { return count_ == 0; }
  uint32_t normal() const { return normal_; }  ///< rays that kernels on record may still export, at most
  uint32_t shadow() const { return shadow_; }  ///< shadow rays, likewise

  /// A kernel is launched that may export so many rays. Not while full().
  void launch(uint64_t cycle, uint32_t normal, uint32_t shadow) {
    begin(cycle);
    records_[count_++] = {normal, shadow, false, 0};
    normal_ += normal;
    shadow_ += shadow;
  }
  /// A ray has left the unit. Of two kernels that may have made it the older one is held to have: what they may still
  /// export together is not too low for it.
  void ray_left(uint64_t cycle, bool shadow) {
    left(cycle);
    for (uint32_t i = 0; i < count_; ++i) {
      Record& record = records_[i];
      uint32_t& rays = shadow ? record.shadow : record.normal;
      if (drained(record, left_before_) || rays == 0) continue;
      --rays;
      --(shadow ? shadow_ : normal_);
      return;
    }
  }
  void contribution_left(uint64_t cycle) { left(cycle); }
  /// The oldest kernel that runs has ended; its unit has reported so far that it exports this many packages, modulo
  /// 2^16. After what has left in the same cycle.
  void kernel_ended(uint64_t cycle, uint16_t exports) {
    begin(cycle);
    for (uint32_t i = 0; i < count_; ++i) {
      Record& record = records_[i];
      if (record.ended) continue;
      record.ended = true;
      record.mark = exports;
      return;
    }
  }

  /// All that has happened in a cycle has been reported: the oldest record goes in it, if nothing of it was left in the
  /// unit at the end of the cycle before.
  void settle(uint64_t cycle) {
    for (uint64_t gone = due(); gone <= cycle && gone != kNever; gone = due()) remove(gone);
  }
  /// The cycle in which a record goes, if nothing happens before; kNever: none does.
  uint64_t due() const { return count_ != 0 && drained(records_[0], left_) ? changed_at_ + 1 : kNever; }

 private:
  struct Record {
    uint32_t normal = 0, shadow = 0;  // rays that it may still export
    bool ended = false;
    uint16_t mark = 0;  // packages of the unit up to its last one
  };

  /// Nothing of it is left in the unit, of which so many packages have come.
  static bool drained(const Record& record, uint16_t left) {
    return record.ended && ((left - record.mark) & 0x8000) == 0;
  }
  void begin(uint64_t cycle) {
    settle(cycle);
    if (cycle != changed_at_) left_before_ = left_;
    changed_at_ = cycle;
  }
  void left(uint64_t cycle) {
    begin(cycle);
    ++left_;
  }
  void remove(uint64_t cycle) {
    normal_ -= records_[0].normal;
    shadow_ -= records_[0].shadow;
    --count_;
    for (uint32_t i = 0; i < count_; ++i) records_[i] = records_[i + 1];
    left_before_ = left_;
    changed_at_ = cycle;
  }

  std::array<Record, kRecords> records_{};  // oldest first
  uint32_t count_ = 0, normal_ = 0, shadow_ = 0;
  uint16_t left_ = 0, left_before_ = 0;  // packages, modulo 2^16; before the cycle in which anything last happened
  uint64_t changed_at_ = kNever;         // this cycle
};

}  // namespace raypool
