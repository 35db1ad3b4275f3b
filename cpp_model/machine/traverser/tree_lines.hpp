// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Lines of the memory of rtl/traverser/rp_traverser.v, and how it is asked for them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "machine/common/packages.hpp"

namespace raypool {

/// 64 bytes of the traverser's memory: little-endian words.
using TreeLine = std::array<uint32_t, 16>;

/// What the traverser asks of its memory.
struct TreeRequest {
  bool write = false;
  bool second = false;         ///< and the line, or quadword, behind it
  uint32_t address = 0;        ///< multiple of 64 (read) or 16 (write); of twice that with a second one
  std::array<Beat, 2> data{};  ///< write only
};

/// Numbers of lines: of nodes as they are in the memory, of triangles counted from the first one.
struct TreeLines {
  std::vector<uint32_t> nodes, triangles;
};

}  // namespace raypool
