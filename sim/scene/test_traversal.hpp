// For tests: scenes, trees and rays that are hard to get right.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "bits.hpp"
#include "scene/hard_rays.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/traversal.hpp"

namespace raypool::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

inline bool same(const Hit& a, const Hit& b) {
  return as_bits(a.t) == as_bits(b.t) && as_bits(a.u) == as_bits(b.u) && as_bits(a.v) == as_bits(b.v) &&
         a.triangle == b.triangle && a.normal == b.normal;
}

/// A closed ball with vertices and edges in the coordinate planes, poles of many triangles, at `centre`.
inline Scene ball(const Vec3d& centre, int around) {
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.sphere(centre, 1, around);
  return scene;
}

struct Item {
  uint32_t child;
  Vec3 lower, upper;
};

/// A node around up to four items from `first` on, which is put behind `nodes`.
inline Item parent_of(const std::vector<Item>& level, size_t first, std::vector<BvhNode>& nodes) {
  BvhNode node{};
  Item parent{size32(nodes), {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t i = 0; i < 4; ++i) {
    const bool used = first + i < level.size();
    node.children[i] = used ? level[first + i].child : kNoChild;
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[0][axis][i] = used ? level[first + i].lower[axis] : INFINITY;
      node.bounds[1][axis][i] = used ? level[first + i].upper[axis] : -INFINITY;
      parent.lower[axis] = std::min(parent.lower[axis], node.bounds[0][axis][i]);
      parent.upper[axis] = std::max(parent.upper[axis], node.bounds[1][axis][i]);
    }
  }
  nodes.push_back(node);
  return parent;
}
/// The level of a tree above this one: four children a node.
inline std::vector<Item> parents_of(const std::vector<Item>& level, std::vector<BvhNode>& nodes) {
  std::vector<Item> parents;
  for (size_t first = 0; first < level.size(); first += 4) parents.push_back(parent_of(level, first, nodes));
  return parents;
}
/// The level without its last items, around which there is a node now: of one level after another a chain of nodes.
inline std::vector<Item> chained(std::vector<Item> level, std::vector<BvhNode>& nodes) {
  const size_t first = level.size() < 4 ? 0 : level.size() - 4;
  const Item parent = parent_of(level, first, nodes);
  level.resize(first);
  level.push_back(parent);
  return level;
}

/// How many triangles leaves of a bad tree have, and children its nodes.
enum class TreeShape : uint8_t {
  Full,   ///< four, but for the last
  Mixed,  ///< one to four
  Chain,  ///< one to four; and each node has a node, as its last child, and leaves beside it: as deep as can be
  Deep,   ///< one; and such a chain
};

/// A bad tree: triangles in random order, leaves in random groups.
inline Bvh random_tree(const Bvh& original, uint32_t seed, TreeShape shape = TreeShape::Full) {
  std::mt19937 random(seed);
  struct Loose {
    const TriangleBlock* block;
    uint32_t lane;
  };
  std::vector<Loose> loose;
  for (const TriangleBlock& block : original.blocks) {
    for (uint32_t lane = 0; lane < block.count; ++lane) loose.push_back({&block, lane});
  }
  std::shuffle(loose.begin(), loose.end(), random);
  Bvh tree;
  tree.bounds = original.bounds;
  std::vector<Item> level;
  const auto most = [&] { return shape == TreeShape::Full ? 4 : shape == TreeShape::Deep ? 1 : 1 + random() % 4; };
  for (size_t first = 0; first < loose.size();) {
    TriangleBlock block{};
    block.first = static_cast<uint32_t>(first);
    block.count = static_cast<uint32_t>(std::min<size_t>(most(), loose.size() - first));
    first += block.count;
    Item item{size32(tree.blocks) | kLeafBit, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t lane = 0; lane < 4; ++lane) {
      const Loose& from = loose[block.first + std::min(lane, block.count - 1)];
      block.triangles[lane] = lane < block.count ? from.block->triangles[from.lane] : kNoChild;
      for (int corner = 0; corner < 3; ++corner) {
        for (int axis = 0; axis < 3; ++axis) {
          const float value = from.block->vertices[lane < block.count ? corner : 0][axis][from.lane];
          block.vertices[corner][axis][lane] = value;
          item.lower[axis] = std::min(item.lower[axis], value);
          item.upper[axis] = std::max(item.upper[axis], value);
        }
      }
    }
    tree.blocks.push_back(block);
    level.push_back(item);
  }
  std::vector<BvhNode> bottom_up;  // children before parents; turned round at the end
  do level = shape >= TreeShape::Chain ? chained(level, bottom_up) : parents_of(level, bottom_up);
  while (level.size() > 1);
  const auto last = static_cast<uint32_t>(bottom_up.size() - 1);
  for (uint32_t i = 0; i <= last; ++i) {
    BvhNode node = bottom_up[last - i];
    for (uint32_t& child : node.children) {
      if ((child & kLeafBit) == 0) child = last - child;
    }
    tree.nodes.push_back(node);
  }
  return tree;
}

}  // namespace raypool::test
