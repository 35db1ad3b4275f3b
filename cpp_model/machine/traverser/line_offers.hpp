// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_line_offers.v: two lines at most that are offered to be looked up, of which one can be taken in a
// cycle.
#pragma once

#include <cstdint>

#include "machine/traverser/line_want.hpp"

namespace raypool {

class LineOffers {
 public:
  bool any() const { return count_ != 0; }
  bool ready() const { return count_ != 2; }
  /// The older one, and the younger; not valid where there is none.
  const LineWants& wants() const { return wants_; }

  /// The end of a cycle. `comes`: only while ready(), or null. `taken`: bit i: want i; one at most.
  void clock(const LineWant* comes, uint32_t taken) {
    if (taken != 0) {
      if (taken == 1) wants_[0] = wants_[1];
      wants_[1].valid = false;
      --count_;
    }
    if (comes != nullptr) wants_[count_++] = *comes;
  }

 private:
  LineWants wants_{};
  uint32_t count_ = 0;
};

}  // namespace raypool
