// A ray with all that boxes and triangles ask of it, and the best hit so far.
#pragma once

#include <cmath>
#include <cstdint>

#include "scene/bvh.hpp"
#include "scene/scene.hpp"

namespace raypool {

struct RayQuery {
  Vec3 origin;
  Vec3 direction;  ///< not normalised
  float limit;     ///< hits with 0 < t < limit count
};

inline constexpr float kUlp = 1.1920929e-7f;  // 2^-23
/// t of a slab carries three roundings.
inline constexpr float kNearScale = 1 - 4 * kUlp;
inline constexpr float kFarScale = 1 + 4 * kUlp;
/// What is left of a sum is a smaller share of its terms than this.
inline constexpr double kCancelled = 0x1p-10;
/// Of Bvh: nodes on the way from the root to a leaf.
inline constexpr int kMaxDepth = 80;

/// Its direction is scaled by a power of two so that the largest component lies in 1 .. 2; times t_scale, internal t is
/// the ray's.
struct PreparedRay {
  bool valid = false;  ///< false: it hits nothing, and nothing else is set
  float origin[3];
  float padded[2][3];  ///< subtracted from lower and upper bounds
  float reach;         ///< the largest distance along an axis between the origin and a face of the scene's box
  float inverse[3];
  int near_side[3];  ///< 0: the lower bound is met first
  int kx, ky, kz;
  float shear_x, shear_y;
  double direction[3];
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
