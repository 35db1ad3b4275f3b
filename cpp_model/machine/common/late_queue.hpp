// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A first-in first-out queue behind a register: what is pushed in a cycle is offered from the one behind the next on.
#pragma once

#include <cstdint>

#include "machine/common/ram_queue.hpp"

namespace raypool {

/// Its owner counts the cycles.
template <typename Entry>
class LateQueue {
 public:
  explicit LateQueue(uint32_t depth) : entries_(depth) {}

  bool empty() const { return !entries_.valid(); }  ///< in the register too
  bool valid(uint64_t cycle) const { return entries_.valid() & (entries_.data().from <= cycle); }
  const Entry& data() const { return entries_.data().entry; }  ///< the oldest; means something while valid()
  /// Only while valid().
  void pop() { entries_.pop(); }
  /// Only while it holds fewer than its depth.
  void push(uint64_t cycle, const Entry& entry) { entries_.push({cycle + 2, entry}); }

 private:
  struct Late {
    uint64_t from = 0;
    Entry entry{};
  };
  RamQueue<Late> entries_;
};

}  // namespace raypool
