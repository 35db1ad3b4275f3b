// Ray preparation, the box test, the triangle test, and the loop around them.
#include "scene/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "bits.hpp"
#include "machine/traverser/ray_finish.hpp"
#include "scene/narrow_boxes.hpp"
#include "scene/scene_cache.hpp"
#include "scene/simd4.hpp"

namespace raypool {
namespace {

#include "scene/triangle_test.hpp"

/// The triangles of a leaf as engines test them. TriangleTest is another.
struct EngineTriangles {
  bool operator()(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) const {
    return intersect_block(ray, block, best);
  }
};

/// The boxes of a tree, in single precision, as the walk below asks a ray for them. NarrowBoxes is another.
class FloatBoxes {
 public:
  using Time = float;  ///< at which the ray enters a box

  FloatBoxes(const Bvh& bvh, const PreparedRay& ray) : nodes_(bvh.nodes.data()), ray_(ray), best_(ray.internal_limit) {
    for (int axis = 0; axis < 3; ++axis) {
      padded_[0][axis] = splat4(ray.padded[0][axis]);
      padded_[1][axis] = splat4(ray.padded[1][axis]);
      inverse_[axis] = splat4(ray.inverse[axis]);
    }
  }
  /// Where the ray enters each of the four boxes; bit i of the result: box i is met at or before the best hit so far.
  unsigned meet(uint32_t number, Time (&entry)[kBvhWidth]) const {
    const BvhNode& node = nodes_[number];
    Float4 near = splat4(0), far = splat4(INFINITY);
    for (int axis = 0; axis < 3; ++axis) {
      const int first = ray_.near_side[axis], second = 1 - first;
      near = max4(near, (load4(node.bounds[first][axis]) - padded_[first][axis]) * inverse_[axis]);
      far = min4(far, (load4(node.bounds[second][axis]) - padded_[second][axis]) * inverse_[axis]);
    }
    near = near * splat4(kNearScale);
    far = far * splat4(kFarScale);
    std::memcpy(entry, &near, sizeof near);
    return mask4(near <= min4(far, splat4(best_)));
  }
  /// The best hit so far is behind it.
  bool behind(Time entry) const { return entry > best_; }
  void found(const Candidate& best) { best_ = best.t; }

 private:
  const BvhNode* nodes_;
  const PreparedRay& ray_;
  float best_;
  Float4 padded_[2][3], inverse_[3];
};

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

/// As rtl/traverser/rp_ray_finish.v does.
Hit finish_in_hardware(const PreparedRay& ray, const Candidate& best) {
  Triangle triangle{{}, best.triangle};
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) triangle.corners[corner][axis] = best.block->vertices[corner][axis][best.lane];
  }
  const RayFinish made(ray, triangle, best.t, std::ilogb(ray.t_scale));
  return {made.t, made.u, made.v, {made.normal[0], made.normal[1], made.normal[2]}, best.triangle};
}

/// `ray` is valid and the tree not empty.
template <bool kAny, typename Boxes, typename Triangles = EngineTriangles>
bool traverse(const Bvh& bvh, const PreparedRay& ray, Boxes boxes, Candidate& best, TraversalCounts* counts,
              VisitList* visits, const Triangles& test = {}) {
  struct Entry {
    uint32_t child;
    typename Boxes::Time t;
  };
  best.t = ray.internal_limit;
  bool found = false;
  uint64_t nodes = 0, blocks = 0, triangles = 0;
  Entry stack[(kBvhWidth - 1) * kMaxDepth + 1];
  int depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    const Entry top = stack[--depth];
    if (boxes.behind(top.t)) {
      if (visits != nullptr) ++visits->back().discarded;
      continue;
    }
    if ((top.child & kLeafBit) != 0) {
      const TriangleBlock& block = bvh.blocks[top.child & ~kLeafBit];
      if (visits != nullptr) visits->push_back({block.first, static_cast<uint8_t>(block.count), 0, 0});
      ++blocks;
      triangles += block.count;
      if (!test(ray, block, best)) continue;
      found = true;
      if (kAny) break;
      boxes.found(best);
      continue;
    }
    const BvhNode& node = bvh.nodes[top.child];
    ++nodes;
    typename Boxes::Time entry[kBvhWidth];
    unsigned lanes = boxes.meet(top.child, entry);
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

Traversal::Traversal(const Scene& scene) {
  const auto make = [&] {
    SceneTrees trees{build_bvh(scene), {}};
    trees.wide = widen(trees.bvh);
    return trees;
  };
  const std::optional<SceneCache>& cache = SceneCache::of_program();
  set_trees(cache ? cache->trees(scene, make) : make());
}

void Traversal::compress_nodes(uint32_t box_bits) {
  compressed_.clear();
  for (const BvhNode& node : bvh_.nodes) compressed_.push_back(compress(node));
  std::transform(compressed_.begin(), compressed_.end(), bvh_.nodes.begin(), decompress);
  box_bits_ = box_bits;
  if (box_bits_ == 0) compressed_.clear();
}

void Traversal::set_compressed_nodes(std::vector<CompressedNode> nodes) {
  if (nodes.size() != compressed_.size()) throw std::logic_error("another number of nodes than the tree has");
  compressed_ = std::move(nodes);
}

void Traversal::take_hits_of(const ChipConfiguration& chip) {
  constexpr uint32_t kTimeBits = 32;
  if (chip.traverser != TraverserName::Hardware) return;
  hardware_hits_ = true;
  triangle_test_.emplace(TriangleTime::Plane, kTimeBits);
}

void Traversal::set_bvh(Bvh bvh) {
  SceneTrees trees{std::move(bvh), {}};
  trees.wide = widen(trees.bvh);
  set_trees(std::move(trees));
}

void Traversal::set_trees(SceneTrees trees) {
  if (tree_depth(trees.bvh) > kMaxDepth)
    throw std::runtime_error("the bounding volume hierarchy is deeper than the traversal's stack");
  bvh_ = std::move(trees.bvh);
  wide_ = std::move(trees.wide);
  compressed_.clear();
  box_bits_ = 0;
}

template <bool kAny>
bool Traversal::walk(const RayQuery& query, const PreparedRay& ray, Candidate& best, TraversalCounts* counts,
                     VisitList* visits) const {
  if (triangle_test_ && box_bits_ == 0) {
    return traverse<kAny>(bvh_, ray, FloatBoxes(bvh_, ray), best, counts, visits, *triangle_test_);
  }
  if (!triangle_test_ && counts == nullptr && visits == nullptr) {
    const Walk& fast = walks().back();
    return (kAny ? fast.any : fast.nearest)(wide_, ray, best, nullptr);
  }
  if (box_bits_ == 0) return traverse<kAny>(bvh_, ray, FloatBoxes(bvh_, ray), best, counts, visits);
  const NarrowBoxes boxes(compressed_, narrow_ray(query, ray, bvh_.bounds, box_bits_), ray);
  if (triangle_test_) return traverse<kAny>(bvh_, ray, boxes, best, counts, visits, *triangle_test_);
  return traverse<kAny>(bvh_, ray, boxes, best, counts, visits);
}

// walk(ray, best): whether it meets something.
template <typename Walk>
bool Traversal::nearest_on(const RayQuery& query, Hit& hit, const Walk& walk) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  Candidate best;
  if (!ray.valid || bvh_.nodes.empty() || !walk(ray, best)) return false;
  hit = hardware_hits_ ? finish_in_hardware(ray, best) : finish(ray, best);
  return true;
}

bool Traversal::nearest(const RayQuery& query, Hit& hit, TraversalCounts* counts, VisitList* visits) const {
  return nearest_on(query, hit, [&](const PreparedRay& ray, Candidate& best) {
    return walk<false>(query, ray, best, counts, visits);
  });
}

void Traversal::places_of(const TreeVisits& visits, size_t from, VisitList& places) const {
  if (!triangle_test_) return;
  for (size_t i = from; i < visits.places.size(); ++i) {
    const uint32_t place = visits.places[i];
    const bool leaf = (place & kLeafBit) != 0;
    const TriangleBlock* const block = leaf ? &bvh_.blocks[place & ~kLeafBit] : nullptr;
    places.push_back({leaf ? block->first : place, static_cast<uint8_t>(leaf ? block->count : 0), 0, 0});
  }
}

TreeVisits Traversal::visits() const {
  return triangle_test_ ? TreeVisits(bvh_.nodes.size(), bvh_.blocks.size())
                        : TreeVisits(wide_.nodes.size(), wide_.blocks.size());
}

void Traversal::add(const VisitList& list, TreeVisits& visits) const {
  for (const Visit& visit : list) {
    if (visit.triangles == 0) {
      visits.node(visit.place);
      continue;
    }
    const auto block = std::partition_point(bvh_.blocks.begin(), bvh_.blocks.end(),
                                            [&](const TriangleBlock& each) { return each.first < visit.place; });
    visits.block(static_cast<uint32_t>(block - bvh_.blocks.begin()), visit.triangles);
  }
}

bool Traversal::nearest(const RayQuery& query, Hit& hit, TreeVisits& visits) const {
  if (triangle_test_) {
    VisitList list;
    const bool met = nearest(query, hit, nullptr, &list);
    add(list, visits);
    return met;
  }
  return nearest_on(query, hit, [&](const PreparedRay& ray, Candidate& best) {
    return walks().back().nearest(wide_, ray, best, &visits);
  });
}

bool Traversal::occluded(const RayQuery& query, TraversalCounts* counts, VisitList* visits) const {
  const PreparedRay ray = prepare(query, bvh_.bounds);
  if (!ray.valid || bvh_.nodes.empty()) return false;
  Candidate best;
  return walk<true>(query, ray, best, counts, visits);
}

bool Traversal::occluded(const RayQuery& query, TreeVisits& visits) const {
  if (triangle_test_) {
    VisitList list;
    const bool met = occluded(query, nullptr, &list);
    add(list, visits);
    return met;
  }
  const PreparedRay ray = prepare(query, bvh_.bounds);
  Candidate best;
  return ray.valid && !bvh_.nodes.empty() && walks().back().any(wide_, ray, best, &visits);
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

Tracer::Tracer(const Scene& scene, uint32_t material_base, const ChipConfiguration& chip)
    : Tracer(scene, material_base) {
  take_hits_of(chip);
}

Tracer::Tracer(const Scene& scene, uint32_t material_base) : traversal_(scene), material_base_(material_base) {
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

void Tracer::meet(const Hit& hit, Intersection& intersection) const {
  intersection[word::kDistance] = as_bits(hit.t);
  intersection[word::kBarycentric] = as_bits(hit.u);
  intersection[word::kBarycentric + 1] = as_bits(hit.v);
  for (int axis = 0; axis < 3; ++axis) intersection[word::kNormal + axis] = as_bits(hit.normal[axis]);
  intersection[word::kMaterial] = material_words_[hit.triangle];
  intersection[word::kTriangle] = hit.triangle;
}

template <typename... Told>
bool Tracer::trace_and_tell(const Ray& ray, Intersection& intersection, Told&&... told) const {
  return answer(
      ray, intersection, [&](const RayQuery& query) { return traversal_.occluded(query, told...); },
      [&](const RayQuery& query, Hit& hit) { return traversal_.nearest(query, hit, told...); });
}

bool Tracer::trace(const Ray& ray, Intersection& intersection, TraversalCounts* counts, VisitList* visits) const {
  return trace_and_tell(ray, intersection, counts, visits);
}

bool Tracer::trace(const Ray& ray, Intersection& intersection, TreeVisits& visits) const {
  return trace_and_tell(ray, intersection, visits);
}

}  // namespace raypool
