// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_ray_memory.v, of which a unit has three sets, as far as time goes: the one port that each of them
// has. The words are those of RaySlices.
#pragma once

#include <cstdint>

namespace raypool {

/// The sets' ports in one cycle.
class RayMemory {
 public:
  /// The first to ask has the port of the set.
  bool grant(bool asks, uint8_t set) {
    const bool granted = asks && (taken_ >> set & 1) == 0;
    taken_ |= uint32_t{granted} << set;
    return granted;
  }

 private:
  uint32_t taken_ = 0;
};

}  // namespace raypool
