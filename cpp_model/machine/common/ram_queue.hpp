// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/common/rp_ram_queue.v: a first-in first-out queue of a fixed size. What is pushed in a cycle is offered from the
// next one on: look at it before the cycle's pushes.
#pragma once

#include <cstdint>
#include <vector>

namespace raypool {

template <typename Entry>
class RamQueue {
 public:
  explicit RamQueue(uint32_t depth) : depth_(depth), entries_(depth) {}

  uint32_t size() const { return size_; }
  bool valid() const { return size_ != 0; }
  const Entry& data() const { return entries_[head_]; }  ///< the oldest; means something while valid()
  /// Only while it holds one.
  void pop() {
    head_ = behind(head_);
    --size_;
  }
  /// Only while it holds fewer than its depth.
  void push(const Entry& entry) {
    entries_[tail_] = entry;
    tail_ = behind(tail_);
    ++size_;
  }

 private:
  uint32_t behind(uint32_t place) const { return place + 1 == depth_ ? 0 : place + 1; }

  uint32_t depth_;
  std::vector<Entry> entries_;
  uint32_t head_ = 0, tail_ = 0, size_ = 0;
};

}  // namespace raypool
