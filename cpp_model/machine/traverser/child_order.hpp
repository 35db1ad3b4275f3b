// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_child_order.v: the children of a node that a ray meets, the nearest first.
#pragma once

#include <cstdint>

#include "machine/traverser/box_pipe.hpp"
#include "machine/traverser/lane_stacks.hpp"

namespace raypool {

/// What a box test and the node's references make of its result for the stacks, but for slot and limit: the ray goes on
/// with the nearest child; the others are put on its stack, the furthest first. Of two that are entered at the same
/// time the one with the higher number is the nearer.
inline void order_children(const BoxResult& boxes, const uint32_t* references, LaneStacks::NodeResult& result) {
  result.children = static_cast<uint32_t>(popcount(boxes.met));
  int64_t entries[kBoxes];  // of one that is not met before all others
  for (uint32_t box = 0; box < kBoxes; ++box)
    entries[box] = int64_t{boxes.entry[box]} | (int64_t{boxes.met >> box & 1} - 1);
  // Whether a child is met cannot be predicted: one that is not is put behind all.
  LaneStacks::Entry ordered[2 * kBoxes];  // the furthest first
  for (uint32_t box = 0; box < kBoxes; ++box) {
    uint32_t further = 0;  // children
    for (uint32_t other = 0; other < kBoxes; ++other)
      further += other < box ? entries[other] >= entries[box] : entries[other] > entries[box];
    ordered[further + (entries[box] >> 63 & kBoxes)] = {boxes.entry[box], references[box]};
  }
  for (uint32_t other = 0; other < LaneStacks::kLeast; ++other) result.others[other] = ordered[other];
  if (result.children != 0) result.nearest = ordered[result.children - 1].reference;
}

}  // namespace raypool
