// Trees and rays for the benches of a lane: the tree as lines of the traverser's memory, rays as their set-up has them,
// and what each must visit and hit, found by a walk that knows nothing of lanes.
#pragma once

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "machine/lane_hits.hpp"
#include "machine/leaf_reader.hpp"
#include "machine/triangle_pipe.hpp"
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

/// What a ray does.
struct Walk {
  static constexpr uint32_t kLeafLine = 1u << 31;
  std::vector<uint32_t> lines;  ///< of nodes, and of leaves with kLeafLine, in their order
  LaneHits::Hit hit;
  uint32_t deepest = 0;  ///< entries of the stack

  Walk(const LaneTree& tree, const LaneRay& ray, const NarrowFloat& narrow) {
    if (!ray.meets || tree.root == kNoChild) return;
    std::vector<LaneStacks::Entry> stack{{0, tree.root}};
    uint32_t limit = ray.box.limit;
    while (!stack.empty()) {
      const LaneStacks::Entry top = stack.back();
      stack.pop_back();
      if (top.key > limit) continue;
      if ((top.reference & kLeafBit) == 0) {
        visit_node(tree, ray, top.reference, limit, stack);
      } else if (visit_leaf(tree, ray, top.reference, narrow)) {
        if (ray.shadow) return;
        limit = ray.box.key(hit.t, ray.limit.scale);
      }
    }
  }

 private:
  void visit_node(const LaneTree& tree, const LaneRay& ray, uint32_t number, uint32_t limit,
                  std::vector<LaneStacks::Entry>& stack) {
    lines.push_back(number);
    const TreeNode node = tree.node(number);
    const BoxResult boxes = test_boxes(ray.box, node.boxes, limit);
    std::vector<LaneStacks::Entry> met;
    for (uint32_t i = 0; i < kBoxes; ++i)
      if ((boxes.met >> i & 1) != 0) met.push_back({boxes.entry[i], node.children[i]});
    const auto further = [](const LaneStacks::Entry& a, const LaneStacks::Entry& b) { return a.key > b.key; };
    std::stable_sort(met.begin(), met.end(), further);
    stack.insert(stack.end(), met.begin(), met.end());
    deepest = std::max(deepest, static_cast<uint32_t>(stack.size()));
  }
  bool visit_leaf(const LaneTree& tree, const LaneRay& ray, uint32_t leaf, const NarrowFloat& narrow) {
    const uint32_t first = leaf & ((1u << kLeafPlaceBits) - 1), end = first + (leaf >> kLeafPlaceBits & 3) + 1;
    const auto line_of = [](uint64_t word) { return static_cast<uint32_t>(word / 16); };
    for (uint32_t line = line_of(uint64_t{first} * 11); line <= line_of(uint64_t{end} * 11 - 1); ++line)
      lines.push_back(line | kLeafLine);
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
};

}  // namespace raypool::bench
