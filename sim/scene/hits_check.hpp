// Our hits against Embree's, ray by ray, with an exact verdict wherever the two differ.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "kernel/kernels.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// Where a ray passes a triangle, computed without rounding errors that matter
/// (113-bit arithmetic on the float inputs).
enum class Passage : uint8_t {
  Inside,  ///< well inside the triangle
  Border,  ///< on an edge, or nearer to it than single precision resolves
  Outside,
  Parallel,  ///< the triangle has no area as seen from the ray
};
struct ExactHit {
  Passage passage = Passage::Outside;
  double t = 0;       ///< of the triangle's plane
  double margin = 0;  ///< smallest barycentric coordinate; below 0 outside
};
/// A ray in double precision; a RayQuery is one.
struct ExactRay {
  Vec3d origin, direction;  ///< direction of any length
  double limit = INFINITY;  ///< hits with 0 < t < limit count

  ExactRay(const Vec3d& from, const Vec3d& towards, double largest_t)
      : origin(from), direction(towards), limit(largest_t) {}
  ExactRay(const RayQuery& ray)
      : origin(ray.origin.as<double>()), direction(ray.direction.as<double>()), limit(static_cast<double>(ray.limit)) {}
};
ExactHit exact_hit(const Scene& scene, uint32_t triangle, const ExactRay& ray);

/// What one side finds for a ray.
struct HitAnswer {
  bool hit = false;
  uint32_t triangle = 0;
  float t = 0;
};
enum class HitVerdict : uint8_t { Tie, OursWrong, EmbreeWrong };
/// Judges two answers that differ by exact_hit() of their triangles. The exact values are appended to `reason`.
HitVerdict judge_hits(const Scene& scene, const ExactRay& ray, const HitAnswer& ours, const HitAnswer& embree,
                      std::string& reason);

/// Outcome of one kind of rays.
struct HitCounts {
  uint64_t rays = 0;
  uint64_t agree = 0;  ///< the same triangle, or both miss; shadow rays: both free or both blocked
  uint64_t ties = 0;  ///< both answers are right: equal t (shared edge, coplanar duplicate), or a border either side of
                      ///< which is right
  uint64_t ours_wrong = 0;
  uint64_t embree_wrong = 0;
};

struct HitsReport {
  HitCounts primary, shadow;
  std::vector<std::string>
      explanations;  ///< one line for each wrong hit: pixel, triangles, t, exact verdict; the first max_explanations
  TraversalCounts primary_visits, shadow_visits;
};

struct HitsOptions {
  int width = 512, height = 512;
  size_t max_explanations = 100;
  std::function<void(RayKernel, NativeThread&)> kernel;  ///< makes the rays; run_native when empty
};

/// Traces the scene's view: eye rays and the shadow rays that follow from our hits, with our traversal and with
/// rtcIntersect1 and rtcOccluded1 of a robust Embree scene. Throws std::logic_error where the two ways of our traversal
/// differ.
HitsReport compare_with_embree(const Scene& scene, const HitsOptions& options);

}  // namespace raypool
