// Which triangle a ray hits. The answer is a function of ray and triangles alone: the nearest hit, at exactly
// equal t the lowest triangle index, whatever the tree, the order of its nodes or the machine. No ray slips between
// triangles that share an edge or a vertex.
//
// How that is kept: a triangle's hit is decided by Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT
// 2013) in single precision, zero edge functions in double; its t is then held within the t-interval of the triangle's
// own padded box. The box test is monotone in the box, operation by operation, so that every box around the triangle
// has an interval that contains this t, and no ancestor can be pruned while its t may still win.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"
#include "scene/bvh.hpp"
#include "scene/compressed_node.hpp"
#include "scene/narrow_triangles.hpp"
#include "scene/prepared_ray.hpp"
#include "scene/wide_bvh.hpp"

namespace raypool {

struct Hit {
  float t = 0;
  float u = 0, v = 0;  ///< the point is (1-u-v) corner 0 + u corner 1 + v corner 2
  Vec3 normal;         ///< unit length, cross(corner 1 - corner 0, corner 2 - corner 0)
  uint32_t triangle = 0;
};

/// What one or more rays visited. They are added to.
struct TraversalCounts {
  uint64_t nodes = 0;      ///< nodes of four boxes
  uint64_t blocks = 0;     ///< leaves
  uint64_t triangles = 0;  ///< triangles in them
};
/// What a ray does at a node, where it tests four boxes, or at a leaf, where it tests all triangles.
struct Visit {
  uint32_t place = 0;     ///< number of the node; of the leaf's first triangle, counted leaf by leaf
  uint8_t triangles = 0;  ///< of the leaf; 0: a node
  uint8_t children = 0;   ///< of the node that the ray meets: it goes on with the nearest, the others wait on the stack
  uint16_t discarded = 0;  ///< taken from the stack then, and found to lie behind the best hit

  bool operator==(const Visit& other) const {
    return place == other.place && triangles == other.triangles && children == other.children &&
           discarded == other.discarded;
  }
};
/// Visits in their order. They are appended to.
using VisitList = std::vector<Visit>;

/// A direction that is zero, infinite or NaN, an origin that is not finite or further than 1e18 from the scene, and a
/// limit that is NaN or not above zero hit nothing.
///
/// A ray without a list for its visits takes the fast way, through nodes of eight (wide_bvh.hpp); else it walks the
/// tree of bvh(), which is the chip's. The answer is the same.
class Traversal {
 public:
  explicit Traversal(const Scene& scene);

  bool nearest(const RayQuery& ray, Hit& hit, TraversalCounts* counts = nullptr, VisitList* visits = nullptr) const;
  /// Any hit at all; visits fewer nodes than nearest().
  bool occluded(const RayQuery& ray, TraversalCounts* counts = nullptr, VisitList* visits = nullptr) const;
  /// The same answers; `visits`, made by visits(), records what is visited: on the fast way, or in bvh() where that
  /// does not have these hits.
  bool nearest(const RayQuery& ray, Hit& hit, TreeVisits& visits) const;
  bool occluded(const RayQuery& ray, TreeVisits& visits) const;
  /// The same answer as nearest(), from every triangle in turn. For tests.
  bool nearest_of_all(const RayQuery& ray, Hit& hit) const;

  const Bvh& bvh() const { return bvh_; }
  const WideBvh& wide_bvh() const { return wide_; }
  TreeVisits visits() const;
  /// Appends the places in bvh() that were visited, from so many on; none that were visited on the fast way.
  void places_of(const TreeVisits& visits, size_t from, VisitList& places) const;
  /// Makes every box of bvh() what a node of 64 bytes has of it (compressed_node.hpp): no answer changes, visits do.
  /// `box_bits`, 6 .. 16: boxes are then tested in integers of so many bits (narrow_boxes.hpp); 0: in floats.
  void compress_nodes(uint32_t box_bits = 0);
  /// From now on nearest() and occluded() test triangles so, with visits or without; boxes are in floats, or in
  /// integers if compress_nodes() is called for them.
  void set_triangle_test(const TriangleTest& test) { triangle_test_ = test; }
  /// From now on hits are what the traverser of the chip makes of them. Of `hardware`: which triangle is hit, and at
  /// which internal t, as in rtl/traverser/rp_triangle_pipe.v (TriangleTest with the plane in 32 bits); t, u, v and
  /// normal as in rtl/traverser/rp_ray_finish.v. Of any other nothing changes.
  void take_hits_of(const ChipConfiguration& chip);
  /// Replaces the tree by another over the same triangles; no answer changes. For tests.
  void set_bvh(Bvh bvh);
  /// The nodes with boxes that are tested in integers; none if they are not.
  const std::vector<CompressedNode>& compressed_nodes() const { return compressed_; }
  /// Replaces them by as many others. For tests.
  void set_compressed_nodes(std::vector<CompressedNode> nodes);

 private:
  void set_trees(SceneTrees trees);
  /// Those of a list, of this tree.
  void add(const VisitList& list, TreeVisits& visits) const;
  template <bool kAny>
  bool walk(const RayQuery& query, const PreparedRay& ray, Candidate& best, TraversalCounts* counts,
            VisitList* visits) const;
  template <typename Walk>
  bool nearest_on(const RayQuery& query, Hit& hit, const Walk& walk) const;

  Bvh bvh_;
  WideBvh wide_;
  std::vector<CompressedNode> compressed_;
  uint32_t box_bits_ = 0;
  std::optional<TriangleTest> triangle_test_;
  bool hardware_hits_ = false;
};

/// Words 0 .. 6 of a ray.
RayQuery to_query(const Ray& ray);

/// The traverser of the chip and of the native renderer: packages in, packages out. Safe to use from several threads.
class Tracer {
 public:
  /// Material words are material_base + 32 * the triangle's material index. Keeps nothing of `scene`.
  explicit Tracer(const Scene& scene, uint32_t material_base = 0);
  /// With the hits of the traverser of `chip` (take_hits_of()).
  Tracer(const Scene& scene, uint32_t material_base, const ChipConfiguration& chip);

  /// Normal ray: true and the intersection when it hits, false when it misses. Shadow ray: false when it is blocked;
  /// true when it is free, with words 12 .. 20 of the intersection zero. Words 0 .. 11 are the ray's. A ray that
  /// returns: true, and its flags say whether it has met something; words 12 .. 20 are zero if not, or if any hit would
  /// do.
  bool trace(const Ray& ray, Intersection& intersection, TraversalCounts* counts = nullptr,
             VisitList* visits = nullptr) const;

  /// The same answer; `visits`, which traversal().visits() made, records what is visited.
  bool trace(const Ray& ray, Intersection& intersection, TreeVisits& visits) const;

  /// Words 0 .. 11 are the ray's, the others zero.
  static void pass_on(const Ray& ray, Intersection& intersection);

  /// trace() with the answers of `occluded` and `nearest`, of which one is called.
  template <typename Occluded, typename Nearest>
  bool answer(const Ray& ray, Intersection& intersection, const Occluded& occluded, const Nearest& nearest) const {
    const bool returning = miss_records_ && returns(ray);
    bool met = false;
    pass_on(ray, intersection);
    if (is_shadow(ray) || (returning && returns_first(ray))) {
      met = occluded(to_query(ray));
    } else {
      Hit hit;
      met = nearest(to_query(ray), hit);
      if (met) meet(hit, intersection);
    }
    if (!returning) return met != is_shadow(ray);
    set_met(intersection, met);
    return true;
  }

  /// Whether the material of this word of an intersection reflects. Throws std::out_of_range if it is no material's:
  /// what a ray that hits nothing leaves is no intersection.
  bool reflects(uint32_t material) const { return reflecting_.at((material - material_base_) / kMaterialBytes); }

  const Traversal& traversal() const { return traversal_; }
  void set_triangle_test(const TriangleTest& test) { traversal_.set_triangle_test(test); }
  /// And rays that return, if the chip has them.
  void take_hits_of(const ChipConfiguration& chip) {
    traversal_.take_hits_of(chip);
    miss_records_ = chip.miss_records;
  }

 private:
  template <typename... Told>
  bool trace_and_tell(const Ray& ray, Intersection& intersection, Told&&... told) const;
  /// Words 12 .. 20 are those of the hit.
  void meet(const Hit& hit, Intersection& intersection) const;

  Traversal traversal_;
  uint32_t material_base_;
  std::vector<uint32_t> material_words_;  ///< one a triangle
  std::vector<bool> reflecting_;          ///< one a material
  bool miss_records_ = false;             ///< chip.miss_records
};

}  // namespace raypool
