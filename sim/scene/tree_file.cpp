#include "scene/tree_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"
#include "isa/input_error.hpp"
#include "scene/compressed_node.hpp"

namespace raypool {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they are in memory");

TreeNode to_tree_node(const BvhNode& node, const Bvh& bvh) {
  const CompressedNode packed = compress(node);
  TreeNode result{packed, {}, {}};
  for (int i = 0; i < kBvhWidth; ++i) {
    const uint32_t place = packed.places[i];
    const bool leaf = i < packed.children && (place & kLeafBit) != 0;
    const TriangleBlock* const block = leaf ? &bvh.blocks[place & ~kLeafBit] : nullptr;
    result.children[i] = leaf ? leaf_word(block->first, block->count) : place;
  }
  return result;
}

TreeTriangle to_tree_triangle(const TriangleBlock& block, uint32_t lane, const Scene& scene) {
  TreeTriangle result{{}, block.triangles[lane], scene.triangle_materials[block.triangles[lane]]};
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) result.corners[corner][axis] = block.vertices[corner][axis][lane];
  }
  return result;
}

template <typename Part>
void append(std::string& bytes, const Part* parts, size_t count) {
  bytes.append(reinterpret_cast<const char*>(parts), count * sizeof(Part));
}

}  // namespace

TreeFile make_tree_file(const Scene& scene) { return make_tree_file(scene, build_bvh(scene)); }

TreeFile make_tree_file(const Scene& scene, const Bvh& bvh) {
  const uint64_t triangles = bvh.blocks.empty() ? 0 : uint64_t{bvh.blocks.back().first} + bvh.blocks.back().count;
  // With fewer than all of its bits set, no leaf's word is that of no child.
  if (triangles >= 1u << kLeafPlaceBits) {
    throw InputError(fmt::format("a scene of {} triangles: the places of leaves have {} bits; give it fewer", triangles,
                                 kLeafPlaceBits));
  }
  TreeFile result;
  result.nodes.reserve(bvh.nodes.size());
  for (const BvhNode& node : bvh.nodes) result.nodes.push_back(to_tree_node(node, bvh));
  result.triangles.reserve(triangles);
  for (const TriangleBlock& block : bvh.blocks) {
    for (uint32_t lane = 0; lane < block.count; ++lane)
      result.triangles.push_back(to_tree_triangle(block, lane, scene));
  }
  TreeHeader& header = result.header;
  if (!bvh.nodes.empty()) header.root = 0;
  for (int axis = 0; axis < 3; ++axis) {
    header.lower[axis] = bvh.bounds.lower[axis];
    header.upper[axis] = bvh.bounds.upper[axis];
  }
  header.nodes = size32(result.nodes);
  header.triangles = size32(result.triangles);
  header.nodes_offset = sizeof header;
  header.triangles_offset = header.nodes_offset + result.nodes.size() * sizeof(TreeNode);
  return result;
}

std::string to_bytes(const TreeFile& tree) {
  std::string bytes;
  bytes.reserve(tree.header.triangles_offset + tree.triangles.size() * sizeof(TreeTriangle));
  append(bytes, &tree.header, 1);
  append(bytes, tree.nodes.data(), tree.nodes.size());
  append(bytes, tree.triangles.data(), tree.triangles.size());
  return bytes;
}

}  // namespace raypool
