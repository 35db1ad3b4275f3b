// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/common/rp_round_robin.v: the next among those that ask, one bit each.
#pragma once

#include <cstdint>

#include "bits.hpp"

namespace raypool {

class RoundRobin {
 public:
  /// The first above the one chosen last, or else the lowest. `requests` must not be 0.
  uint32_t choose(uint32_t requests) const {
    const uint32_t behind = requests & behind_;
    return lowest(behind != 0 ? behind : requests);
  }
  /// The choice is made use of.
  void advance(uint32_t number) { behind_ = ~((uint32_t{2} << number) - 1); }

 private:
  uint32_t behind_ = ~uint32_t{0};
};

}  // namespace raypool
