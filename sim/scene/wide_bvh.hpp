// The tree for speed alone: nodes of eight children, made of the chip's tree (bvh.hpp), and how a ray walks it. What it
// hits is what it hits there, as promised in traversal.hpp: boxes are boxes of that tree, and box test and triangle
// test are the same operations in the same order.
#pragma once

#include <cstdint>
#include <vector>

#include "bits.hpp"
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

/// A scene's two trees: the chip's, and the one for speed made of it.
struct SceneTrees {
  Bvh bvh;
  WideBvh wide;
};

/// The triangles of `bvh` under some of its boxes.
WideBvh widen(const Bvh& bvh);

/// What rays visit since begin(), and in which different places: so many a cache that held all of them would have to
/// read.
class TreeVisits {
 public:
  /// Of a tree with so many nodes and blocks.
  TreeVisits(size_t tree_nodes, size_t tree_blocks) : nodes_(tree_nodes), blocks_(tree_blocks) {}

  void begin() {
    nodes = triangles = 0;
    places.clear();
    ++now_;
  }
  void node(uint32_t number) {
    ++nodes;
    visit(nodes_[number], number);
  }
  void block(uint32_t number, uint32_t count) {
    triangles += count;
    visit(blocks_[number], number | kLeafBit);
  }

  uint64_t nodes = 0, triangles = 0;  ///< nodes with tested boxes, and tested triangles
  std::vector<uint32_t> places;       ///< nodes and, with kLeafBit, blocks, each when it is come to first

 private:
  void visit(uint32_t& last, uint32_t place) {
    if (last != now_) places.push_back(place);
    last = now_;
  }

  std::vector<uint32_t> nodes_, blocks_;  // which begin() was the last before it was visited
  uint32_t now_ = 0;
};

/// The loop around box test and triangle test, for one set of the processor's instructions. `ray` is valid and the tree
/// not empty; `visits`, if not null, records them. False: nothing is hit. All answers are the same whichever set it is.
struct Walk {
  const char* instructions;  ///< "sse", "avx2"
  bool (*nearest)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, TreeVisits* visits);
  /// The first hit that is met.
  bool (*any)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, TreeVisits* visits);
};
/// Those that this processor has, best last.
const std::vector<Walk>& walks();

}  // namespace raypool
