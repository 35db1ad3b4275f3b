// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_triangle_pipe.v: whether and where a ray hits a triangle, from the triangle's plane, without double.
// docs/machine/triangle-test.md explains why.
#pragma once

#include <cmath>
#include <cstdint>

#include "arith/narrow_float.hpp"
#include "bits.hpp"
#include "machine/common/pipe_items.hpp"
#include "machine/traverser/triangle_edges.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool {
namespace triangle {
#include "machine/traverser/triangle_interval.hpp"
}  // namespace triangle

/// The corners as the ray sees them, from its origin and along its direction.
struct CornersInView {
  float x[3], y[3], z[3];

  CornersInView(const TriangleRay& ray, const Triangle& triangle) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto from_origin = [&](int axis) { return triangle(corner, axis) - ray.origin[axis]; };
      z[corner] = from_origin(ray.kz);
      x[corner] = from_origin(ray.kx) - ray.shear_x * z[corner];
      y[corner] = from_origin(ray.ky) - ray.shear_y * z[corner];
    }
  }
};

/// rtl/traverser/rp_triangle_view.v: these, and which lie in front.
struct TriangleView : CornersInView {
  int in_front = 0;  ///< corners that do, along the ray's main axis

  TriangleView(const TriangleRay& ray, const Triangle& triangle) : CornersInView(ray, triangle) {
    for (const float distance : z) in_front += static_cast<double>(distance) * ray.direction[ray.kz] > 0;
  }
};

/// rtl/traverser/rp_triangle_plane.v: t of a triangle's plane, n . a / n . d, with a corner 0 and sides[i - 1] what
/// leads from it to corner i. Sums are added from left to right, and every operation is rounded.
inline double plane_time(const NarrowFloat& narrow, const TriangleRay& ray, const double (&a)[3],
                         const double (&sides)[2][3]) {
  double normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    normal[axis] =
        narrow.subtract(narrow.multiply(sides[0][i], sides[1][j]), narrow.multiply(sides[0][j], sides[1][i]));
  }
  const auto dot = [&](const double(&b)[3]) {
    const double first = narrow.add(narrow.multiply(normal[0], b[0]), narrow.multiply(normal[1], b[1]));
    return narrow.add(first, narrow.multiply(normal[2], b[2]));
  };
  return narrow.divide(dot(a), dot(ray.direction));
}
inline double plane_time(const NarrowFloat& narrow, const TriangleRay& ray, const Triangle& triangle) {
  const auto difference = [&](float to, float from) { return narrow.subtract(to, from); };
  double a[3], sides[2][3];
  for (int axis = 0; axis < 3; ++axis) {
    a[axis] = difference(triangle(0, axis), ray.origin[axis]);
    for (int i = 0; i < 2; ++i) sides[i][axis] = difference(triangle(i + 1, axis), triangle(0, axis));
  }
  return plane_time(narrow, ray, a, sides);
}

/// Whether the ray, without its limit, hits the triangle, and at which internal t. A triangle of which all corners lie
/// in front is hit whatever rounding makes of its plane.
inline bool meets_triangle(const NarrowFloat& narrow, const TriangleRay& ray, const Triangle& triangle, float& t) {
  const TriangleView view(ray, triangle);
  if (!TriangleEdges(view.x, view.y).inside() || view.in_front == 0) return false;
  t = static_cast<float>(plane_time(narrow, ray, triangle));
  if (view.in_front == 3 && !(t > 0)) t = as_float(1);
  return triangle::move_into_own_box(ray, triangle, t);
}

/// What becomes of a test.
struct TriangleResult {
  uint64_t tag = 0;
  uint32_t number = 0;
  bool hit = false;  ///< it is the ray's best hit from now on
  float t = 0;       ///< where it meets the triangle; internal
};

/// The pipe: it begins a test a cycle, and never waits.
class TrianglePipe {
 public:
  /// What a ray answers a test that asks.
  struct Limit {
    float limit;  ///< the ray's
    int scale;    ///< its t is internal t x 2^scale
  };
  struct Best {
    float t;  ///< internal; 0 or above
    uint32_t number;
  };

  /// `bits`: 26, 28, 30 or 32.
  explicit TrianglePipe(uint32_t bits) : narrow_(bits), stages_(stages(bits)) {}

  /// Cycles from a test to its result.
  static constexpr uint32_t stages(uint32_t bits) { return 30 + bits / 2; }
  int stages() const { return static_cast<int>(stages_); }

  /// A test asks for the limit, or the best hit, of the ray with this tag, or is given it; a result is there. Else
  /// null.
  const TriangleResult* asks_limit() const { return tests_.at(stages_ - 5); }
  const TriangleResult* told_limit() const { return tests_.at(stages_ - 4); }
  const TriangleResult* asks_best() const { return tests_.at(stages_ - 2); }
  const TriangleResult* told_best() const { return tests_.at(stages_ - 1); }
  const TriangleResult* result() const { return tests_.at(stages_); }

  /// A test begins in this cycle.
  void begin(const TriangleRay& ray, const Triangle& triangle, uint64_t tag) {
    TriangleResult& begun = tests_.begin();
    begun = {tag, triangle.number, false, 0};
    begun.hit = meets_triangle(narrow_, ray, triangle, begun.t);
  }
  /// The end of a cycle. `limit`, `best`: of the tests that are given them.
  void clock(const Limit& limit, const Best& best) {
    if (TriangleResult* const limited = tests_.at(stages_ - 4))
      limited->hit = limited->hit && is_within(*limited, limit);
    if (TriangleResult* const compared = tests_.at(stages_ - 1))
      compared->hit = compared->hit && counts(*compared, best);
    tests_.clock();
  }

  // ---- Where what a test is given is known: its limit as it begins, its best hit once its result is there

  void begin(const TriangleRay& ray, const Triangle& triangle, uint64_t tag, const Limit& limit) {
    begin(ray, triangle, tag);
    TriangleResult& begun = *tests_.at(0);
    begun.hit = begun.hit && is_within(begun, limit);
  }
  static bool counts(const TriangleResult& result, const Best& best) {
    return triangle::is_nearer(result.t, result.number, best.t, best.number);
  }
  /// The end of so many cycles.
  void pass(uint64_t cycles) { tests_.pass(cycles); }

 private:
  static bool is_within(const TriangleResult& result, const Limit& limit) {
    return triangle::within_limit(result.t, std::ldexp(1.0, limit.scale), limit.limit);
  }

  static constexpr uint32_t kMostStages = 30 + 32 / 2;
  NarrowFloat narrow_;
  uint32_t stages_;
  PipeItems<TriangleResult, kMostStages> tests_;
};

}  // namespace raypool
