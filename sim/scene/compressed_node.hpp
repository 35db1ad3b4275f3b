// A node of the tree in 64 bytes, one line of the traverser's memory: planes of the children's boxes are 8-bit numbers
// on a grid of the node's own, rounded outwards. A box around a box changes no hit (traversal.hpp); a ray only meets
// some more of them.
#pragma once

#include <array>
#include <cstdint>

#include "machine/traverser/box_node.hpp"
#include "scene/bvh.hpp"

namespace raypool {

struct alignas(64) CompressedNode : BoxNode {
  std::array<uint32_t, kBvhWidth> places;  ///< as BvhNode::children
};
static_assert(sizeof(CompressedNode) == 64);
static_assert(kBoxes == kBvhWidth);

/// Coordinates must be finite, and below 1e30. Of a plane its number is chosen in single precision: with the sum of
/// origin and steps rounded so, the box lies around the node's.
CompressedNode compress(const BvhNode& node);
BvhNode decompress(const CompressedNode& node);

}  // namespace raypool
