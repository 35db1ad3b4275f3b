// rtl/child_order.v: the children of a node that a ray meets, the nearest first.
#pragma once

#include <array>
#include <cstdint>

#include "machine/box_pipe.hpp"
#include "machine/lane_stacks.hpp"

namespace raypool {

/// What a box test and the node's references make of its result for the stacks, but for slot and limit: the ray goes on
/// with the nearest child; the others are put on its stack, the furthest first. Of two that are entered at the same
/// time the one with the higher number is the nearer.
inline void order_children(const BoxResult& boxes, const std::array<uint32_t, kBoxes>& references,
                           LaneStacks::NodeResult& result) {
  std::array<LaneStacks::Entry, kBoxes> children;  // the furthest first
  result.children = 0;
  for (uint32_t box = 0; box < kBoxes; ++box) {
    if ((boxes.met >> box & 1) == 0) continue;
    uint32_t place = result.children++;
    for (; place > 0 && children[place - 1].key < boxes.entry[box]; --place) children[place] = children[place - 1];
    children[place] = {boxes.entry[box], references[box]};
  }
  if (result.children == 0) return;
  result.nearest = children[result.children - 1].reference;
  for (uint32_t i = 0; i + 1 < result.children; ++i) result.others[i] = children[i];
}

}  // namespace raypool
