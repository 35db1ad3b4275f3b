// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/common/rp_request_queue.v: a short first-in first-out queue with valid/ready at its end.
#pragma once

#include <array>
#include <cstdint>

namespace raypool {

template <typename Entry, uint32_t kDepth = 3>
class RequestQueue {
 public:
  bool valid() const { return count_ != 0; }
  const Entry& data() const { return entries_[0]; }  ///< the oldest; means something while valid()
  uint32_t count() const { return count_; }

  /// The end of a cycle: what was offered leaves if `ready`; then push() may add an entry.
  void clock(bool ready) {
    if (!valid() || !ready) return;
    --count_;
    for (uint32_t i = 0; i < count_; ++i) entries_[i] = entries_[i + 1];
  }
  /// Only if there were less than kDepth before clock().
  void push(const Entry& entry) { entries_[count_++] = entry; }

 private:
  std::array<Entry, kDepth> entries_{};  // the oldest first
  uint32_t count_ = 0;
};

}  // namespace raypool
