// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/common/rp_free_list.v: the numbers 0 .. size-1 that are free: first those that have never been taken, then those
// that have come back, in the order in which they did.
#pragma once

#include <cstdint>

#include "machine/common/ram_queue.hpp"

namespace raypool {

class FreeList {
 public:
  explicit FreeList(uint32_t size) : size_(size), returned_(size) {}

  bool valid() const { return used_ < size_ || returned_.valid(); }
  uint32_t number() const { return used_ < size_ ? used_ : returned_.data(); }  ///< means something while valid()
  void take() {
    if (used_ < size_) {
      ++used_;
    } else {
      returned_.pop();
    }
  }
  void free(uint32_t number) { returned_.push(number); }

 private:
  uint32_t size_, used_ = 0;
  RamQueue<uint32_t> returned_;
};

}  // namespace raypool
