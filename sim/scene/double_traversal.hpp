// Which triangle a ray hits, in double precision: what the hits of machines are measured against. It shares the tree
// with them, and no arithmetic.
#pragma once

#include <cstdint>

#include "scene/bvh.hpp"
#include "scene/vec.hpp"

namespace raypool {

inline constexpr uint32_t kNoTriangle = 0xffffffffu;

struct DoubleHit {
  uint32_t triangle = kNoTriangle;  ///< at equal t the lowest index
  double t = 0;
};

/// On which side of an edge a ray passes is decided with 113 bits where 53 leave it open; an edge is part of the
/// triangles on both sides. Rays have a direction of any length but zero, both vectors finite; hits with 0 < t < limit
/// count. `bvh` must outlive it.
class DoubleTraversal {
 public:
  explicit DoubleTraversal(const Bvh& bvh) : bvh_(bvh) {}

  DoubleHit nearest(const Vec3d& origin, const Vec3d& direction, double limit) const {
    return trace(origin, direction, limit, false);
  }
  /// Some hit; its triangle, or kNoTriangle.
  uint32_t occluder(const Vec3d& origin, const Vec3d& direction, double limit) const {
    return trace(origin, direction, limit, true).triangle;
  }

 private:
  DoubleHit trace(const Vec3d& origin, const Vec3d& direction, double limit, bool any) const;

  const Bvh& bvh_;
};

}  // namespace raypool
