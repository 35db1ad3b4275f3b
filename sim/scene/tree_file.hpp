// The tree as the traverser's memory holds it, and as a file of just that: a header, nodes of 64 bytes,
// triangles of 44. docs/use/tree-file.md has a table of every byte. Numbers are little-endian.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "machine/traverser/box_node.hpp"
#include "scene/bvh.hpp"

namespace raypool {

struct TreeHeader {
  std::array<char, 8> magic = {'r', 'a', 'y', 'p', '-', 'b', 'v', 'h'};
  uint32_t version = 1;
  uint32_t root = kNoChild;            ///< as TreeNode::children; kNoChild: no triangle has an area
  float lower[3] = {}, upper[3] = {};  ///< of all triangles in the tree; zeros without any
  uint32_t nodes = 0, triangles = 0;
  uint64_t nodes_offset = 0, triangles_offset = 0;  ///< bytes from the beginning of the file
};
static_assert(sizeof(TreeHeader) == 64);

/// What CompressedNode is in the model, but that a leaf is named by the place of its triangles: a ray's stack need hold
/// only one number of a child.
struct TreeNode {
  BoxNode boxes;
  /// Of node n: n. Of a leaf: leaf_word(). Of none: kNoChild.
  uint32_t children[kBvhWidth];
  uint32_t padding[2];  ///< zero
};
static_assert(sizeof(TreeNode) == 64);

struct TreeTriangle {
  float corners[3][3];  ///< corner; x, y, z
  uint32_t number;      ///< index in the scene
  uint32_t material;    ///< index in the scene
};
static_assert(sizeof(TreeTriangle) == 44);

inline constexpr uint32_t kLeafPlaceBits = 29;
/// Of a leaf's `count` triangles, 1 .. 4, from the one at `first` on: the place of that one in the tree's triangles,
/// below 2^kLeafPlaceBits; above it count - 1; above that kLeafBit.
constexpr uint32_t leaf_word(uint32_t first, uint32_t count) {
  return kLeafBit | (count - 1) << kLeafPlaceBits | first;
}

struct TreeFile {
  TreeHeader header;
  std::vector<TreeNode> nodes;          ///< numbered as those of build_bvh()
  std::vector<TreeTriangle> triangles;  ///< leaf by leaf: Visit::place is the index
};

/// The tree of build_bvh(), each node of which goes through compress(). Throws InputError if it has too many triangles
/// for the places of leaves.
TreeFile make_tree_file(const Scene& scene);
/// The same of a tree over this scene's triangles.
TreeFile make_tree_file(const Scene& scene, const Bvh& bvh);

/// The file.
std::string to_bytes(const TreeFile& tree);

}  // namespace raypool
