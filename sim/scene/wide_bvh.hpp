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

/// To what in the chip's tree a ray comes that comes to a node, or to a block: to nodes and, with kLeafBit, leaves.
/// Some nodes are on the way to several.
class WideOrigins {
 public:
  /// What is added from now on is of the next one, and this way to it.
  void begin(const std::vector<uint32_t>& way) {
    begins_.push_back(size32(places_));
    places_.insert(places_.end(), way.begin(), way.end());
  }
  void add(uint32_t place) { places_.push_back(place); }

  template <typename Told>
  void each(uint32_t number, const Told& told) const {
    const uint32_t end = number + 1 < begins_.size() ? begins_[number + 1] : size32(places_);
    for (uint32_t i = begins_[number]; i < end; ++i) told(places_[i]);
  }
  /// All that it consists of, to be kept or got back.
  template <typename Member>
  void each_member(const Member& member) {
    member(begins_);
    member(places_);
  }

 private:
  std::vector<uint32_t> begins_, places_;
};

struct WideBvh {
  std::vector<WideBvhNode> nodes;     ///< node 0 is the root; empty when no triangle has an area
  std::vector<TriangleBlock> blocks;  ///< each may hold the triangles of several leaves; `first` is not set
  WideOrigins node_origins, block_origins;
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
class WideVisits {
 public:
  explicit WideVisits(const WideBvh& bvh) : nodes_(bvh.nodes.size()), blocks_(bvh.blocks.size()) {}

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
  bool (*nearest)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, WideVisits* visits);
  /// The first hit that is met.
  bool (*any)(const WideBvh& bvh, const PreparedRay& ray, Candidate& best, WideVisits* visits);
};
/// Those that this processor has, best last.
const std::vector<Walk>& walks();

}  // namespace raypool
