// A node of the tree in 64 bytes, one line of the traverser's memory: planes of the children's boxes are 8-bit numbers
// on a grid of the node's own, rounded outwards. A box around a box changes no hit (traversal.hpp); a ray only meets
// some more of them.
#pragma once

#include <array>
#include <cstdint>

#include "scene/bvh.hpp"

namespace raypool {

/// A plane q of an axis lies at origin + q x 2^exponent, in single precision.
struct alignas(64) CompressedNode {
  std::array<float, 3> origin;
  std::array<int8_t, 3> exponent;
  uint8_t children;                        ///< that there are
  uint8_t planes[2][3][kBvhWidth];         ///< lower, upper; x, y, z; child
  std::array<uint32_t, kBvhWidth> places;  ///< as BvhNode::children
};
static_assert(sizeof(CompressedNode) == 64);

/// Coordinates must be finite, and below 1e30.
CompressedNode compress(const BvhNode& node);
BvhNode decompress(const CompressedNode& node);

}  // namespace raypool
