// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/child_order.v: the children of a node that a ray meets, the nearest first.
#pragma once

#include <cstdint>

#include "machine/box_pipe.hpp"
#include "machine/lane_stacks.hpp"

namespace raypool {

/// What a box test and the node's references make of its result for the stacks, but for slot and limit: the ray goes on
/// with the nearest child; the others are put on its stack, the furthest first. Of two that are entered at the same
/// time the one with the higher number is the nearer.
inline void order_children(const BoxResult& boxes, const uint32_t* references, LaneStacks::NodeResult& result) {
  result.children = static_cast<uint32_t>(popcount(boxes.met));
  int64_t entries[kBoxes];  // of one that is not met before all others
  for (uint32_t box = 0; box < kBoxes; ++box)
    entries[box] = (boxes.met >> box & 1) != 0 ? int64_t{boxes.entry[box]} : -1;
  for (uint32_t box = 0; box < kBoxes; ++box) {
    if (entries[box] < 0) continue;
    uint32_t further = 0;  // children
    for (uint32_t other = 0; other < kBoxes; ++other)
      further += other < box ? entries[other] >= entries[box] : entries[other] > entries[box];
    if (further + 1 == result.children) {
      result.nearest = references[box];
    } else {
      result.others[further].key = boxes.entry[box];
      result.others[further].reference = references[box];
    }
  }
}

}  // namespace raypool
