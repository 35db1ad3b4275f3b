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
  result.children = static_cast<uint32_t>(popcount(boxes.met));
  for (uint32_t met = boxes.met; met != 0; met &= met - 1) {
    const uint32_t box = lowest(met);
    uint32_t further = 0;  // children
    for (uint32_t other = 0; other < kBoxes; ++other) {
      const bool is = other < box ? boxes.entry[other] >= boxes.entry[box] : boxes.entry[other] > boxes.entry[box];
      further += (boxes.met >> other & 1) & (is ? 1u : 0u);
    }
    if (further + 1 == result.children) {
      result.nearest = references[box];
    } else {
      result.others[further].key = boxes.entry[box];
      result.others[further].reference = references[box];
    }
  }
}

}  // namespace raypool
