// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The four boxes of a node, as the traverser reads them from memory.
#pragma once

#include <cstdint>

namespace raypool {

inline constexpr int kBoxes = 4;

/// The boxes of a node, as CompressedNode has them: plane q lies at origin + q x 2^exponent.
struct BoxNode {
  float origin[3];  ///< finite
  int8_t exponent[3];
  uint8_t children;              ///< that there are, at most four
  uint8_t planes[2][3][kBoxes];  ///< lower, upper, which is not less; x, y, z; child
};

}  // namespace raypool
