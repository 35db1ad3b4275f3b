// A ray with all that boxes and triangles ask of it, and the best hit so far.
#pragma once

#include <cmath>
#include <cstdint>

#include "machine/traverser/triangle_ray.hpp"
#include "scene/bvh.hpp"
#include "scene/scene.hpp"

namespace raypool {

struct RayQuery {
  Vec3 origin;
  Vec3 direction;  ///< not normalised
  float limit;     ///< hits with 0 < t < limit count
};

/// Edge functions in floats of which one is nearer to zero are computed in double: it may be zero but for a rounding,
/// or made of products so small that floats have lost digits of them.
inline constexpr float kLeastWeight = 0x1p-100f;
/// What is left of a sum is a smaller share of its terms than this: some corners lie behind the ray's origin. Then the
/// terms' errors, of floats, would be more than t may have, with the error of one float (docs/studies/offset.md).
inline constexpr double kCancelled = 0.5;
/// Of Bvh: nodes on the path from the root to a leaf.
inline constexpr int kMaxDepth = 80;

/// Times t_scale, internal t is the ray's.
struct PreparedRay : TriangleRay {
  bool valid = false;  ///< false: it hits nothing, and nothing else is set
  float reach;         ///< the largest distance along an axis between the origin and a face of the scene's box
  double inverse_z;
  double t_scale;
  float limit;           ///< the ray's
  float internal_limit;  ///< rounded up
};

PreparedRay prepare(const RayQuery& query, const Bounds& bounds);

/// Best hit so far, in internal t.
struct Candidate {
  float t = INFINITY;
  uint32_t triangle = kNoChild;
  double u = 0, v = 0;
  const TriangleBlock* block = nullptr;
  unsigned lane = 0;
};

/// t of the triangle's plane.
double plane_t(const PreparedRay& ray, const TriangleBlock& block, unsigned lane);

}  // namespace raypool
