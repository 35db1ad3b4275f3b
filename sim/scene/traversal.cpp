// Ray preparation, the box test, the triangle test, and the loop around them.
#include "scene/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "bits.hpp"
#include "scene/compressed_node.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

#include "scene/triangle_test.hpp"

/// The parts of a prepared ray that the box test wants in all four lanes.
struct BoxRay {
  Float4 padded[2][3];
  Float4 inverse[3];

  explicit BoxRay(const PreparedRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      padded[0][axis] = splat4(ray.padded[0][axis]);
      padded[1][axis] = splat4(ray.padded[1][axis]);
      inverse[axis] = splat4(ray.inverse[axis]);
    }
  }
};

/// Where the ray enters each of the four boxes; bit i of the result: box i is met at or before `best`.
unsigned intersect_boxes(const PreparedRay& ray, const BoxRay& box_ray, const BvhNode& node, float best, float* entry) {
  Float4 near = splat4(0), far = splat4(INFINITY);
  for (int axis = 0; axis < 3; ++axis) {
    const int first = ray.near_side[axis], second = 1 - first;
    near = max4(near, (load4(node.bounds[first][axis]) - box_ray.padded[first][axis]) * box_ray.inverse[axis]);
    far = min4(far, (load4(node.bounds[second][axis]) - box_ray.padded[second][axis]) * box_ray.inverse[axis]);
  }
  near = near * splat4(kNearScale);
  far = far * splat4(kFarScale);
  std::memcpy(entry, &near, sizeof near);
  return mask4(near <= min4(far, splat4(best)));
}

Hit finish(const PreparedRay& ray, const Candidate& best) {
  Vec3d corners[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) corners[corner][axis] = best.block->vertices[corner][axis][best.lane];
  }
  Hit hit;
  hit.t = static_cast<float>(static_cast<double>(best.t) * ray.t_scale);
  hit.u = static_cast<float>(best.u);
  hit.v = static_cast<float>(best.v);
  hit.normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0])).as<float>();
  hit.triangle = best.triangle;
  return hit;
}

/// `ray` is valid and the tree not empty.
template <bool kAny>
bool traverse(const Bvh& bvh, const PreparedRay& ray, Candidate& best, TraversalCounts* counts, VisitList* visits) {
  struct Entry {
    uint32_t child;
    float t;
  };
  const BoxRay box_ray(ray);
  best.t = ray.internal_limit;
  bool found = false;
  uint64_t nodes = 0, blocks = 0, triangles = 0;
  Entry stack[(kBvhWidth - 1) * kMaxDepth + 1];
  int depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const Entry top = stack[--depth];
    if (top.t > best.t) {
      if (visits != nullptr) ++visits->back().discarded;
      continue;
    }
    if ((top.child & kLeafBit) != 0) {
      const TriangleBlock& block = bvh.blocks[top.child & ~kLeafBit];
      if (visits != nullptr) visits->push_back({block.first, static_cast<uint8_t>(block.count), 0, 0});
      ++blocks;
      triangles += block.count;
      found |= intersect_block(ray, block, best);
      if (kAny && found) break;
      continue;
    }
    const BvhNode& node = bvh.nodes[top.child];
    ++nodes;
    float entry[kBvhWidth];
    unsigned lanes = intersect_boxes(ray, box_ray, node, best.t, entry);
    if (visits != nullptr) visits->push_back({top.child, 0, static_cast<uint8_t>(popcount(lanes)), 0});
    // The nearest child must end on top: insertion sort, furthest first.
    const int base = depth;
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = lowest(lanes);
      int place = depth++;
      for (; place > base && stack[place - 1].t < entry[lane]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.children[lane], entry[lane]};
    }
  }
  if (counts != nullptr) {
    counts->nodes += nodes;
    counts->blocks += blocks;
    counts->triangles += triangles;
  }
  return found;
}

int tree_depth(const Bvh& bvh) {
  std::vector<int> depth(bvh.nodes.size(), 1);
  int deepest = 1;
  for (size_t i = 0; i < bvh.nodes.size(); ++i) {
    for (uint32_t child : bvh.nodes[i].children) {
      if ((child & kLeafBit) == 0) depth[child] = depth[i] + 1;  // kNoChild has the bit too
    }
    deepest = std::max(deepest, depth[i]);
  }
  return deepest;
}

}  // namespace

Traversal::Traversal(const Scene& scene) { set_bvh(build_bvh(scene)); }

void Traversal::compress_nodes() {
  for (BvhNode& node : bvh_.nodes) node = decompress(compress(node));
}

void Traversal::set_bvh(Bvh bvh) {
  if (tree_depth(bvh) > kMaxDepth)
    throw std::runtime_error("the bounding volume hierarchy is deeper than the traversal's stack");
  bvh_ = std::move(bvh);
  wide_ = widen(bvh_);
}

bool Traversal::nearest(const RayQuery& query, Hit& hit, TraversalCounts* counts, VisitList* visits) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  if (!ray.valid || bvh_.nodes.empty()) return false;
  Candidate best;
  const bool fast = counts == nullptr && visits == nullptr;
  if (!(fast ? walks().back().nearest(wide_, ray, best) : traverse<false>(bvh_, ray, best, counts, visits)))
    return false;
  hit = finish(ray, best);
  return true;
}

bool Traversal::occluded(const RayQuery& query, TraversalCounts* counts, VisitList* visits) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  if (!ray.valid || bvh_.nodes.empty()) return false;
  Candidate best;
  const bool fast = counts == nullptr && visits == nullptr;
  return fast ? walks().back().any(wide_, ray, best) : traverse<true>(bvh_, ray, best, counts, visits);
}

bool Traversal::nearest_of_all(const RayQuery& query, Hit& hit) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  if (!ray.valid || bvh_.nodes.empty()) return false;
  Candidate best;
  bool found = false;
  for (const TriangleBlock& block : bvh_.blocks) found |= intersect_block(ray, block, best);
  if (found) hit = finish(ray, best);
  return found;
}

RayQuery to_query(const Ray& ray) {
  auto vector = [&](int first) {
    return Vec3{as_float(ray[first]), as_float(ray[first + 1]), as_float(ray[first + 2])};
  };
  return {vector(word::kOrigin), vector(word::kDirection), as_float(ray[word::kLimit])};
}

Tracer::Tracer(const Scene& scene, uint32_t material_base, NodeFormat nodes)
    : traversal_(scene), material_base_(material_base) {
  if (nodes == NodeFormat::Compressed) traversal_.compress_nodes();
  material_words_.reserve(scene.triangles.size());
  for (uint32_t material : scene.triangle_materials) {
    material_words_.push_back(material_base + material * static_cast<uint32_t>(kMaterialBytes));
  }
  for (const Material& material : scene.materials) reflecting_.push_back(material.reflects());
}

void Tracer::pass_on(const Ray& ray, Intersection& intersection) {
  intersection.fill(0);
  std::copy(ray.begin(), ray.end(), intersection.begin());
}

void Tracer::meet(const Ray& ray, const Hit& hit, Intersection& intersection) const {
  pass_on(ray, intersection);
  intersection[word::kDistance] = as_bits(hit.t);
  intersection[word::kBarycentric] = as_bits(hit.u);
  intersection[word::kBarycentric + 1] = as_bits(hit.v);
  for (int axis = 0; axis < 3; ++axis) intersection[word::kNormal + axis] = as_bits(hit.normal[axis]);
  intersection[word::kMaterial] = material_words_[hit.triangle];
  intersection[word::kTriangle] = hit.triangle;
}

bool Tracer::trace(const Ray& ray, Intersection& intersection, TraversalCounts* counts, VisitList* visits) const {
  const RayQuery query = to_query(ray);
  if ((ray[word::kFlags] & kShadowFlag) != 0) {
    pass_on(ray, intersection);
    return !traversal_.occluded(query, counts, visits);
  }
  Hit hit;
  if (!traversal_.nearest(query, hit, counts, visits)) return false;
  meet(ray, hit, intersection);
  return true;
}

}  // namespace raypool
