// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A line that a lane of the traverser offers a cache to look up.
#pragma once

#include <array>
#include <cstdint>

namespace raypool {

/// For the ray of a slot, or (`prefetch`) for none: it will be wanted.
struct LineWant {
  bool valid = false, prefetch = false;
  uint8_t slot = 0;
  uint32_t line = 0;
};
/// Of which one can be looked up in a cycle, the first rather.
using LineWants = std::array<LineWant, 2>;

}  // namespace raypool
