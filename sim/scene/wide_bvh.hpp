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

/// What rays visit since begin(), and in how many different places: so many a cache that held all of them would have to
/// read.
class WideVisits {
 public:
  explicit WideVisits(const WideBvh& bvh) : nodes_(bvh.nodes.size()), blocks_(bvh.blocks.size()) {}

  void begin() {
    nodes = triangles = places = 0;
    ++now_;
  }
  void node(uint32_t number) {
    ++nodes;
    visit(nodes_[number]);
  }
  void block(uint32_t number, uint32_t count) {
    triangles += count;
    visit(blocks_[number]);
  }

  uint64_t nodes = 0, triangles = 0;  ///< whose boxes, and which themselves, are tested
  uint64_t places = 0;                ///< nodes and blocks, each once

 private:
  void visit(uint32_t& last) {
    places += last != now_;
    last = now_;
  }

  std::vector<uint32_t> nodes_, blocks_;  // which begin() was the last before it was visited
  uint32_t now_ = 0;
};

/// The loop around box test and triangle test, for one set of the processor's instructions. `ray` is valid and the tree
/// not empty; `visits`, if not null, is told. False: nothing is hit. All answers are the same whichever set it is.
struct Walk {
  const char* instructions;  ///< "sse", "avx2"
  bool (*nearest)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, WideVisits* visits);
  /// The first hit that is met.
  bool (*any)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, WideVisits* visits);
};
/// Those that this processor has, best last.
const std::vector<Walk>& walks();

}  // namespace raypool
