// Embree's builder calls back with pointers; the pointer tree is then laid out flat, depth first.
#include "scene/bvh.hpp"

#include <embree3/rtcore.h>

#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>

#include "bits.hpp"
#include "scene/embree_device.hpp"

namespace raypool {
namespace {

/// Embree wants untyped pointers: even a leaf's is one to this type.
struct BuildNode {
  uint32_t count = 0;  ///< children or triangles
  bool leaf = false;
  uint32_t triangles[kBvhWidth] = {};
  BuildNode* children[kBvhWidth] = {};
  RTCBounds bounds[kBvhWidth] = {};
};

/// What the builder has made.
struct Made {
  size_t nodes = 0, leaves = 0;
};

void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void* made) {
  ++static_cast<Made*>(made)->nodes;
  auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
  node->count = count;
  return node;
}

void set_children(void* pointer, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i)
    static_cast<BuildNode*>(pointer)->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* pointer, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<BuildNode*>(pointer)->bounds[i] = *bounds[i];
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count, void* made) {
  ++static_cast<Made*>(made)->leaves;
  auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), 16)) BuildNode;
  node->leaf = true;
  node->count = static_cast<uint32_t>(count);
  for (size_t i = 0; i < count; ++i) node->triangles[i] = primitives[i].primID;
  return node;
}

class Flattener {
 public:
  Flattener(const Scene& scene, Bvh& bvh) : scene_(scene), bvh_(bvh) {}

  uint32_t flatten(const BuildNode& node) {
    if (node.leaf) return add_block(node) | kLeafBit;
    const auto index = size32(bvh_.nodes);
    bvh_.nodes.push_back(empty_node());
    for (uint32_t i = 0; i < node.count; ++i) {
      const uint32_t child = flatten(*node.children[i]);
      set_child(bvh_.nodes[index], i, node.bounds[i], child);
    }
    return index;
  }

  /// A scene of one leaf gets a root above it.
  void flatten_root(const BuildNode& root, const RTCBounds& bounds) {
    if (!root.leaf) {
      flatten(root);
      return;
    }
    bvh_.nodes.push_back(empty_node());
    set_child(bvh_.nodes[0], 0, bounds, flatten(root));
  }

 private:
  static BvhNode empty_node() {
    BvhNode node{};
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kBvhWidth; ++i) node.bounds[0][axis][i] = INFINITY, node.bounds[1][axis][i] = -INFINITY;
    }
    for (uint32_t& child : node.children) child = kNoChild;
    return node;
  }

  static void set_child(BvhNode& node, uint32_t i, const RTCBounds& bounds, uint32_t child) {
    const float lower[3] = {bounds.lower_x, bounds.lower_y, bounds.lower_z};
    const float upper[3] = {bounds.upper_x, bounds.upper_y, bounds.upper_z};
    for (int axis = 0; axis < 3; ++axis) node.bounds[0][axis][i] = lower[axis], node.bounds[1][axis][i] = upper[axis];
    node.children[i] = child;
  }

  uint32_t add_block(const BuildNode& leaf) {
    TriangleBlock block{};
    block.count = leaf.count;
    block.first = bvh_.blocks.empty() ? 0 : bvh_.blocks.back().first + bvh_.blocks.back().count;
    for (uint32_t i = 0; i < kBvhWidth; ++i) {
      const bool used = i < leaf.count;
      block.triangles[i] = used ? leaf.triangles[i] : kNoChild;
      for (int corner = 0; corner < 3; ++corner) {
        const Vec3& v = scene_.corner(leaf.triangles[used ? i : 0], used ? corner : 0);
        for (int axis = 0; axis < 3; ++axis) block.vertices[corner][axis][i] = v[axis];
      }
    }
    bvh_.blocks.push_back(block);
    return static_cast<uint32_t>(bvh_.blocks.size() - 1);
  }

  const Scene& scene_;
  Bvh& bvh_;
};

std::vector<RTCBuildPrimitive> build_primitives(const Scene& scene, RTCBounds& all) {
  all = {INFINITY, INFINITY, INFINITY, 0, -INFINITY, -INFINITY, -INFINITY, 0};
  std::vector<RTCBuildPrimitive> primitives;
  primitives.reserve(scene.triangles.size());
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    if (is_degenerate(scene, i)) continue;
    const Vec3 &a = scene.corner(i, 0), &b = scene.corner(i, 1), &c = scene.corner(i, 2);
    RTCBuildPrimitive p{};
    p.lower_x = std::fmin(a.x, std::fmin(b.x, c.x)), p.upper_x = std::fmax(a.x, std::fmax(b.x, c.x));
    p.lower_y = std::fmin(a.y, std::fmin(b.y, c.y)), p.upper_y = std::fmax(a.y, std::fmax(b.y, c.y));
    p.lower_z = std::fmin(a.z, std::fmin(b.z, c.z)), p.upper_z = std::fmax(a.z, std::fmax(b.z, c.z));
    p.primID = static_cast<unsigned>(i);
    all.lower_x = std::fmin(all.lower_x, p.lower_x), all.upper_x = std::fmax(all.upper_x, p.upper_x);
    all.lower_y = std::fmin(all.lower_y, p.lower_y), all.upper_y = std::fmax(all.upper_y, p.upper_y);
    all.lower_z = std::fmin(all.lower_z, p.lower_z), all.upper_z = std::fmax(all.upper_z, p.upper_z);
    primitives.push_back(p);
  }
  return primitives;
}

}  // namespace

Bvh build_bvh(const Scene& scene) {
  Bvh result;
  RTCBounds all;
  std::vector<RTCBuildPrimitive> primitives = build_primitives(scene, all);
  if (primitives.empty()) return result;
  result.bounds = {{all.lower_x, all.lower_y, all.lower_z}, {all.upper_x, all.upper_y, all.upper_z}};

  const std::unique_ptr<RTCBVHTy, void (*)(RTCBVH)> bvh(rtcNewBVH(embree_device()), rtcReleaseBVH);

  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_HIGH;
  arguments.maxBranchingFactor = kBvhWidth;
  arguments.maxDepth = 64;
  arguments.maxLeafSize = kBvhWidth;
  arguments.traversalCost = 1;
  arguments.intersectionCost = 1;
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  Made made;
  arguments.userPtr = &made;
  const auto* root = static_cast<const BuildNode*>(rtcBuildBVH(&arguments));
  if (root == nullptr)
    throw std::runtime_error("Embree could not build the hierarchy; the scene may be too large for the memory");
  result.nodes.reserve(made.nodes + 1);
  result.blocks.reserve(made.leaves);
  Flattener(scene, result).flatten_root(*root, all);
  return result;
}

}  // namespace raypool
