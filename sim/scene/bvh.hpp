// The bounding volume hierarchy: Embree's surface-area-heuristic builder, our own flat nodes of up to four children.
// A ray's result never depends on the tree (see traversal.hpp); only the number of visits does.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

inline constexpr int kBvhWidth = 4;
inline constexpr uint32_t kNoChild = 0xffffffffu;
inline constexpr uint32_t kLeafBit = 0x80000000u;  ///< a child with this bit is triangle block `child & ~kLeafBit`

/// 128 bytes: the boxes of four children and where they are. Unused children have an
/// empty box and kNoChild, and come last.
struct alignas(64) BvhNode {
  /// [0] lower, [1] upper; x, y, z; child. An axis of the four boxes is one SIMD load.
  float bounds[2][3][kBvhWidth];
  uint32_t children[kBvhWidth];
  uint32_t padding[kBvhWidth];
};
static_assert(sizeof(BvhNode) == 128);

/// A leaf: up to four triangles, axis by axis. Unused places repeat vertex 0 of the first
/// triangle, so that no ray hits them.
struct alignas(64) TriangleBlock {
  float vertices[3][3][kBvhWidth];  ///< corner; x, y, z; triangle
  uint32_t triangles[kBvhWidth];    ///< index in the scene, kNoChild when unused
  uint32_t count;
  uint32_t first;  ///< triangles in the blocks before it
  uint32_t padding[6];
};
static_assert(sizeof(TriangleBlock) == 192);

struct Bvh {
  std::vector<BvhNode> nodes;  ///< node 0 is the root, parents before children; empty when no triangle has an area
  std::vector<TriangleBlock> blocks;
  Bounds bounds;  ///< of all triangles in it
};

/// Builds the tree over all triangles that have an area. The same scene gives the same tree.
Bvh build_bvh(const Scene& scene);

}  // namespace raypool
