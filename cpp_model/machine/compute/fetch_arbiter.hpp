// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_fetch_arbiter.v: which warp looks up the instruction cache in a cycle.
#pragma once

#include <cstdint>

#include "machine/common/round_robin.hpp"

namespace raypool {

class FetchArbiter {
 public:
  /// One of `requests`, which must not be 0. One in `first` goes before all others and leaves the rotation as it is.
  uint32_t grant(uint32_t requests, uint32_t first) {
    if ((requests & first) != 0) return lowest(requests & first);
    const uint32_t warp = round_robin_.choose(requests);
    round_robin_.advance(warp);
    return warp;
  }

 private:
  RoundRobin round_robin_;
};

}  // namespace raypool
