// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_launch_rules.v: the two rules that keep the chip from locking up, whatever a policy proposes
// (docs/machine/deadlock.md), and the rounds of tiles without the remedy of the window effect.
#pragma once

#include <cstdint>

#include "config/configuration.hpp"

namespace raypool {

class LaunchRules {
 public:
  /// Of a chip where full kernels have `contents` threads.
  LaunchRules(const ChipConfiguration& chip, uint32_t contents, uint32_t units)
      : contents_(contents),
        units_(units),
        held_limit_(chip.held_limit),
        shadow_limit_(chip.intersection_pool_size + chip.ray_pool_size - 1),
        window_remedy_(chip.window_remedy),
        traverser_shades_(chip.shading == Shading::Traverser) {}

  /// A tile of so many pixels may be cast while so many are held.
  bool may_cast(uint32_t tile_pixels, uint32_t held) const {
    if (!window_remedy_ && held > 0 && round_ == 0) return false;
    return held + tile_pixels <= held_limit_;
  }
  /// A tile is cast.
  void cast(uint32_t held) { round_ = (held == 0 ? units_ : round_) - 1; }

  /// Most threads of a secondary kernel, with so many shadow rays in the ray pool, to come from kernels, and as
  /// intersections that no kernel has been promised.
  uint32_t secondary_room(uint32_t shadow_rays, uint32_t shadow_to_come, uint32_t shadow) const {
    if (traverser_shades_) return contents_;  // no shadow ray ever waits for room
    const uint32_t shadows = shadow_rays + shadow_to_come + shadow;
    return shadows < shadow_limit_ ? shadow_limit_ - shadows : 0;
  }

 private:
  uint32_t contents_, units_, held_limit_, shadow_limit_;
  bool window_remedy_, traverser_shades_;
  uint32_t round_ = 0;  // tiles that may be cast before no pixel is held; without the remedy only
};

}  // namespace raypool
