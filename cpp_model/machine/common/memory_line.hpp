// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The lines of a memory, as its ports carry them.
#pragma once

#include <cstdint>

namespace raypool {

struct MemoryLine {
  static constexpr uint32_t kBeats = 4;
  static constexpr uint32_t kBytes = 64, kQuadwordBytes = 16;
};

}  // namespace raypool
