// This file is compiled for any processor of its architecture, whatever the others are compiled for; what wants more is
// below a pragma, and chosen when the program runs.
#include "scene/wide_bvh.hpp"

#include <array>
#include <cmath>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "bits.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

struct Child {
  const BvhNode* parent;
  uint32_t lane;

  uint32_t place() const { return parent->children[lane]; }
  /// Half of its box's.
  float area() const {
    float size[3];
    for (int axis = 0; axis < 3; ++axis) size[axis] = parent->bounds[1][axis][lane] - parent->bounds[0][axis][lane];
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  }
};

class Widener {
 public:
  explicit Widener(const Bvh& bvh) : bvh_(bvh), triangles_(bvh.nodes.size()) {
    // Parents come before children.
    for (size_t i = bvh.nodes.size(); i-- > 0;) {
      for (const uint32_t child : bvh.nodes[i].children) {
        if (child != kNoChild) triangles_[i] += triangles_of(child);
      }
    }
  }

  WideBvh run() {
    wide_.nodes.reserve(bvh_.nodes.size());
    wide_.blocks.reserve(bvh_.blocks.size());
    if (!bvh_.nodes.empty()) add_node(0);
    return std::move(wide_);
  }

 private:
  uint32_t triangles_of(uint32_t place) const {
    return (place & kLeafBit) != 0 ? bvh_.blocks[place & ~kLeafBit].count : triangles_[place];
  }

  void add_children(uint32_t node, std::vector<Child>& children) const {
    for (uint32_t lane = 0; lane < kBvhWidth; ++lane) {
      if (bvh_.nodes[node].children[lane] != kNoChild) children.push_back({&bvh_.nodes[node], lane});
    }
  }

  /// Opens children of this node, the largest first, as long as all find room.
  std::vector<Child> children_of(uint32_t node) const {
    std::vector<Child> children;
    add_children(node, children);
    for (;;) {
      size_t largest = children.size();
      for (size_t i = 0; i < children.size(); ++i) {
        const uint32_t place = children[i].place();
        if ((place & kLeafBit) != 0 || triangles_[place] <= kBvhWidth) continue;
        std::vector<Child> inner;
        add_children(place, inner);
        if (children.size() - 1 + inner.size() > kWideBvhWidth) continue;
        if (largest == children.size() || children[i].area() > children[largest].area()) largest = i;
      }
      if (largest == children.size()) return children;
      const uint32_t place = children[largest].place();
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(largest));
      add_children(place, children);
    }
  }

  uint32_t add_node(uint32_t from) {
    const auto index = size32(wide_.nodes);
    wide_.nodes.emplace_back();
    WideBvhNode node{};
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kWideBvhWidth; ++i) node.bounds[0][axis][i] = INFINITY, node.bounds[1][axis][i] = -INFINITY;
    }
    for (uint32_t& child : node.children) child = kNoChild;
    const std::vector<Child> children = children_of(from);
    for (size_t i = 0; i < children.size(); ++i) {
      const Child& child = children[i];
      for (int side = 0; side < 2; ++side) {
        for (int axis = 0; axis < 3; ++axis) node.bounds[side][axis][i] = child.parent->bounds[side][axis][child.lane];
      }
      node.children[i] = triangles_of(child.place()) <= kBvhWidth ? add_block(child.place()) : add_node(child.place());
    }
    wide_.nodes[index] = node;
    return index;
  }

  /// All triangles below this place.
  uint32_t add_block(uint32_t place) {
    TriangleBlock block{};
    gather(place, block);
    for (uint32_t i = block.count; i < kBvhWidth; ++i) {
      block.triangles[i] = kNoChild;
      for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) block.vertices[corner][axis][i] = block.vertices[0][axis][0];
      }
    }
    wide_.blocks.push_back(block);
    return (size32(wide_.blocks) - 1) | kLeafBit;
  }

  void gather(uint32_t place, TriangleBlock& block) {
    if (place == kNoChild) return;
    if ((place & kLeafBit) == 0) {
      for (const uint32_t child : bvh_.nodes[place].children) gather(child, block);
      return;
    }
    const TriangleBlock& leaf = bvh_.blocks[place & ~kLeafBit];
    for (uint32_t i = 0; i < leaf.count; ++i) {
      block.triangles[block.count] = leaf.triangles[i];
      for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) block.vertices[corner][axis][block.count] = leaf.vertices[corner][axis][i];
      }
      ++block.count;
    }
  }

  const Bvh& bvh_;
  std::vector<uint32_t> triangles_;  ///< below each node
  WideBvh wide_;
};

#define RAYPOOL_WALK_AVX 0
namespace any_processor {
#include "scene/triangle_test.hpp"
#include "scene/wide_walk.hpp"
}  // namespace any_processor
#undef RAYPOOL_WALK_AVX

#if defined(__x86_64__) && !defined(__AVX2__) && !defined(__clang__)
#define RAYPOOL_HAS_AVX2_WALK
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2")
#define RAYPOOL_WALK_AVX 1
namespace avx2 {
#include "scene/triangle_test.hpp"
#include "scene/wide_walk.hpp"
}  // namespace avx2
#undef RAYPOOL_WALK_AVX
#pragma GCC pop_options
#endif

}  // namespace

WideBvh widen(const Bvh& bvh) { return Widener(bvh).run(); }

const std::vector<Walk>& walks() {
  static const std::vector<Walk> all = [] {
    std::vector<Walk> found{{"any processor's", any_processor::walk_nearest, any_processor::walk_any}};
#if defined(RAYPOOL_HAS_AVX2_WALK)
    const bool bits = __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0;
    if (__builtin_cpu_supports("avx2") != 0 && bits) found.push_back({"AVX2", avx2::walk_nearest, avx2::walk_any});
#endif
    return found;
  }();
  return all;
}

}  // namespace raypool
