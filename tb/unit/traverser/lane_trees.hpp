// Trees and rays for the benches of a lane: the tree as lines of the traverser's memory, rays as their set-up has them,
// and what each must visit and hit, found by a walk that knows nothing of lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "machine/traverser/lane_hits.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/tree_fault.hpp"
#include "machine/traverser/triangle_pipe.hpp"
#include "scene/narrow_boxes.hpp"
#include "scene/test_traversal.hpp"
#include "scene/tree_file.hpp"

namespace raypool::bench {

/// Of any size, from nothing to two thousand triangles, near the origin and far from it; the same one many times.
inline Scene any_scene(std::mt19937& random) {
  const Vec3 at{static_cast<float>(random() % 100), -static_cast<float>(random() % 1000), 3};
  const float scale = std::ldexp(1.0f, static_cast<int>(random() % 40) - 20);
  switch (random() % 7) {
    case 0:
      return soup(random(), static_cast<int>(random() % 5), scale, at);
    case 1: {
      const auto place = [&] { return Vec3{static_cast<float>(random() % 5), static_cast<float>(random() % 5), 1}; };
      return scene_of(std::vector<std::array<Vec3, 3>>(1 + random() % 100, {place(), place(), place()}));
    }
    case 2:
      return soup(random(), 2000, scale, at);
    case 3:
      return test::ball({0, 0, 0}, 4 + static_cast<int>(random() % 8));
    default:
      return soup(random(), 5 + static_cast<int>(random() % 200), scale, random() % 2 == 0 ? Vec3{0, 0, 0} : at);
  }
}

/// Of up to sixty triangles, or more once in fifty times.
inline Scene small_scene(std::mt19937& random) {
  if (random() % 50 == 0) return any_scene(random);
  const float scale = std::ldexp(1.0f, static_cast<int>(random() % 40) - 20);
  const Vec3 at{static_cast<float>(random() % 100), -static_cast<float>(random() % 1000), 3};
  return soup(random(), static_cast<int>(random() % (random() % 4 == 0 ? 60 : 12)), scale,
              random() % 2 == 0 ? Vec3{0, 0, 0} : at);
}

struct LaneTree {
  std::vector<TreeLine> nodes, triangles;
  Bounds bounds{};
  uint32_t root = kNoChild;

  LaneTree() = default;
  LaneTree(const Scene& scene, Bvh bvh) : bounds(bvh.bounds) {
    uint32_t first = 0;  // a random tree has no places yet
    for (TriangleBlock& block : bvh.blocks) {
      block.first = first;
      first += block.count;
    }
    const TreeFile file = make_tree_file(scene, bvh);
    root = file.header.root;
    nodes = lines(file.nodes);
    triangles = lines(file.triangles);
    // A tree of one leaf needs no node.
    if (file.nodes.size() == 1 && file.nodes[0].boxes.children == 1 && first % 2 == 1) root = file.nodes[0].children[0];
  }

  TreeNode node(uint32_t number) const {
    TreeNode node{};
    std::memcpy(&node, &nodes[number], sizeof node);
    return node;
  }
  Triangle triangle(uint32_t place) const {
    Triangle triangle{};
    const auto* const words = triangles.data()->data();
    std::memcpy(&triangle, words + size_t{place} * LeafReader::kTriangleWords, sizeof triangle);
    return triangle;
  }

 private:
  template <typename Part>
  static std::vector<TreeLine> lines(const std::vector<Part>& parts) {
    const size_t bytes = parts.size() * sizeof(Part);
    std::vector<TreeLine> lines((bytes + sizeof(TreeLine) - 1) / sizeof(TreeLine));
    if (bytes != 0) std::memcpy(static_cast<void*>(lines.data()), parts.data(), bytes);
    return lines;
  }
};

inline LaneRay lane_ray(const RayQuery& query, const Bounds& bounds, uint32_t bits, bool shadow) {
  const PreparedRay prepared = prepare(query, bounds);
  LaneRay ray{prepared.valid, shadow, BoxRay({0, 0, 0}, {0, 0, 0}, 0, static_cast<int>(bits)), {}, {1, 0}};
  if (!prepared.valid) return ray;
  ray.box = narrow_ray(query, prepared, bounds, bits);
  ray.triangle = prepared;
  ray.limit = {query.limit, std::ilogb(prepared.t_scale)};
  return ray;
}

/// What a ray does. Of a malformed tree it ends with a fault.
struct Walk {
  static constexpr uint32_t kLeafLine = 1u << 31;
  std::vector<uint32_t> lines;  ///< of nodes, and of leaves with kLeafLine, in their order
  LaneHits::Hit hit;
  uint32_t deepest = 0;           ///< entries of the stack
  std::vector<TreeFault> faults;  ///< one of them there must be, if there are any: lines are given without their base

  /// `entries`: of a slot's stack, that are not in the memory.
  Walk(const LaneTree& tree, const LaneRay& ray, const NarrowFloat& narrow, uint32_t entries = 16)
      : most_here_(entries) {
    if (!ray.meets || tree.root == kNoChild) return;
    std::vector<LaneStacks::Entry> stack{{0, tree.root}};
    uint32_t limit = ray.box.limit;
    bool on_stack = false;
    while (!stack.empty() && faults.empty()) {
      const LaneStacks::Entry top = stack.back();
      stack.pop_back();
      if (on_stack) take_off();
      on_stack = true;
      if (top.key > limit) continue;
      if ((top.reference & kLeafBit) == 0) {
        on_stack = !visit_node(tree, ray, top.reference & kMostLines, limit, stack);
      } else if (visit_leaf(tree, ray, top.reference, narrow)) {
        if (ray.shadow) return;
        limit = ray.box.key(hit.t, ray.limit.scale);
      }
    }
  }

 private:
  static constexpr uint32_t kMostLines = (1u << 26) - 1, kMostBlocks = 127;

  void fault(TreeFaultCode code, uint32_t line) { faults.push_back({true, code, line}); }
  static bool is_backward(uint32_t child, uint32_t number) {
    return (child & kLeafBit) == 0 && (child <= number || child > kMostLines);
  }
  bool fails(const TreeNode& node, uint32_t number, size_t nodes) {
    const uint32_t count = node.boxes.children;
    const uint32_t* const end = node.children + std::min<uint32_t>(count, kBvhWidth);
    if (count == 0 || count > kBvhWidth)
      fault(TreeFaultCode::Children, number);
    else if (std::any_of(node.children, end, [number](uint32_t child) { return is_backward(child, number); }))
      fault(TreeFaultCode::Order, number);
    else if (++visits_ > nodes)
      fault(TreeFaultCode::Visits, number);
    return !faults.empty();
  }
  // Of the stack an entry is taken; so many are put on it, and the ray goes on with another node or leaf.
  void take_off() {
    if (here_ == 0) {
      --blocks_;
      here_ = LaneStacks::kBlock;
    }
    --here_;
  }
  void put_on(uint32_t count) {
    here_ += count;
    if (here_ + LaneStacks::kLeast <= most_here_) return;
    here_ -= LaneStacks::kBlock;
    if (blocks_++ == kMostBlocks) fault(TreeFaultCode::StackFull, 0);
  }

  // True: it goes on with the top of the stack at once.
  bool visit_node(const LaneTree& tree, const LaneRay& ray, uint32_t number, uint32_t limit,
                  std::vector<LaneStacks::Entry>& stack) {
    if (number >= tree.nodes.size()) return fault(TreeFaultCode::NodeBeyond, number), false;
    lines.push_back(number);
    const TreeNode node = tree.node(number);
    if (fails(node, number, tree.nodes.size())) return false;
    const BoxResult boxes = test_boxes(ray.box, node.boxes, limit);
    std::vector<LaneStacks::Entry> met;
    for (uint32_t i = 0; i < kBoxes; ++i)
      if ((boxes.met >> i & 1) != 0) met.push_back({boxes.entry[i], node.children[i]});
    const auto further = [](const LaneStacks::Entry& a, const LaneStacks::Entry& b) { return a.key > b.key; };
    std::stable_sort(met.begin(), met.end(), further);
    stack.insert(stack.end(), met.begin(), met.end());
    deepest = std::max(deepest, static_cast<uint32_t>(stack.size()));
    if (met.empty()) return false;
    put_on(static_cast<uint32_t>(met.size()) - 1);
    return true;
  }
  bool visit_leaf(const LaneTree& tree, const LaneRay& ray, uint32_t leaf, const NarrowFloat& narrow) {
    const uint32_t first = leaf & ((1u << kLeafPlaceBits) - 1), end = first + (leaf >> kLeafPlaceBits & 3) + 1;
    const auto line_of = [](uint64_t word) { return static_cast<uint32_t>(word / 16); };
    for (uint32_t line = line_of(uint64_t{first} * 11); line <= line_of(uint64_t{end} * 11 - 1); ++line) {
      lines.push_back(line | kLeafLine);
      if (line >= tree.triangles.size()) fault(TreeFaultCode::TriangleBeyond, std::min(line, kMostLines));
    }
    if (!faults.empty()) return false;
    bool found = false;
    for (uint32_t place = first; place < end; ++place) {
      const Triangle triangle = tree.triangle(place);
      float t = 0;
      if (!meets_triangle(narrow, ray.triangle, triangle, t)) continue;
      if (!triangle::within_limit(t, std::ldexp(1.0, ray.limit.scale), ray.limit.limit)) continue;
      if (hit.hit && !triangle::is_nearer(t, triangle.number, hit.t, hit.number)) continue;
      hit = {true, t, triangle.number, place};
      found = true;
    }
    return found;
  }

  uint32_t most_here_, here_ = 0, blocks_ = 0;  // of the stack, as lanes keep it
  size_t visits_ = 0;                           // of nodes
};

}  // namespace raypool::bench
