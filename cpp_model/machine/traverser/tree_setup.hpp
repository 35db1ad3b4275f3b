// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where the memory of rtl/traverser/rp_traverser.v has a scene's tree, and what leaves of its hits: what stays for a
// frame.
#pragma once

#include <cstdint>

#include "machine/common/packages.hpp"
#include "machine/traverser/ray_setup.hpp"

namespace raypool {

/// Lines are of 64 bytes.
struct TreeSetup {
  uint32_t root = UINT32_MAX;   ///< node or leaf, as TreeNode::children; all ones: an empty tree
  RootBox bounds{};             ///< of all vertices
  uint32_t triangles_line = 0;  ///< where triangles begin; nodes are the lines from 0 to here
  uint32_t triangle_lines = 0;  ///< that triangles take
  uint32_t stacks_line = 0;     ///< and the stacks, 4 KB for each slot: a multiple of that
  uint32_t material_base = 0;   ///< bytes: word kMaterial is this and 32 times the material's index
  RecordLayout layout;          ///< of the records that leave
};

}  // namespace raypool
