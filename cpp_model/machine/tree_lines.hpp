// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Lines of the memory of rtl/traverser.v.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace raypool {

/// 64 bytes of the traverser's memory: little-endian words.
using TreeLine = std::array<uint32_t, 16>;

/// Numbers of lines: of nodes as they are in the memory, of triangles counted from the first one.
struct TreeLines {
  std::vector<uint32_t> nodes, triangles;
};

}  // namespace raypool
