// The tree for speed alone: nodes of eight children, made of the chip's tree (bvh.hpp), and how a ray walks it. What it
// hits is what it hits there, as traversal.hpp says: boxes are boxes of that tree, and box test and triangle test are
// the same operations in the same order.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/bvh.hpp"
#include "scene/prepared_ray.hpp"

namespace raypool {

inline constexpr int kWideBvhWidth = 8;

/// 256 bytes, else as BvhNode.
struct alignas(64) WideBvhNode {
  float bounds[2][3][kWideBvhWidth];
  uint32_t children[kWideBvhWidth];
  uint32_t padding[kWideBvhWidth];
};
static_assert(sizeof(WideBvhNode) == 256);

struct WideBvh {
  std::vector<WideBvhNode> nodes;     ///< node 0 is the root; empty when no triangle has an area
  std::vector<TriangleBlock> blocks;  ///< each may hold the triangles of several leaves; `first` is not set
};

/// The triangles of `bvh` under some of its boxes.
WideBvh widen(const Bvh& bvh);

/// The loop around box test and triangle test, for one set of the processor's instructions. `ray` is valid and the tree
/// not empty. False: nothing is hit. Both answers are the same whichever set it is.
struct Walk {
  const char* instructions;  ///< "sse", "avx2"
  bool (*nearest)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best);
  bool (*any)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best);  ///< the first hit that is met
};
/// Those that this processor has, best last.
const std::vector<Walk>& walks();

}  // namespace raypool
