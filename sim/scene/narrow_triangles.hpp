// The triangle test with significands of few bits where the engines' has double: candidates for one definition that
// hardware and native code share. docs/studies/test-widths.md shows what each does to pictures; engines do not use it.
#pragma once

#include <cstdint>

#include "arith/narrow_float.hpp"
#include "scene/bvh.hpp"
#include "scene/prepared_ray.hpp"

namespace raypool {

/// What t is computed from.
enum class TriangleTime : uint8_t {
  Floats,    ///< as engines do: interpolated by edge functions of rounded products; of exact ones where one is small
  Products,  ///< interpolated by edge functions of exact products, each rounded once
  Plane,     ///< the triangle's plane
};

/// Whether, and where, a ray hits a triangle. What is computed, in this order; fl() rounds to a float, rb() to `bits`
/// bits, both to nearest even:
///
/// 1. z = fl(vz - oz), x = fl(fl(vx - ox) - fl(sx z)), y = fl(fl(vy - oy) - fl(sy z)), of each corner.
/// 2. The signs of u = x2 y1 - y2 x1, v = x0 y2 - y0 x2, w = x1 y0 - y1 x0, exactly
/// (machine/traverser/triangle_edges.hpp). It is
///    a miss if one is above and one below zero,
///    or all are zero.
/// 3. u, v, w: rb(x2 y1 - y2 x1) and so on. Floats: fl(fl(x2 y1) - fl(y2 x1)), unless that is less than 2^-100 for one
/// of them.
/// 4. det = rb(rb(u + v) + w); z = rb(vz - oz) of each corner; p = rb(u z0), q = rb(v z1), r = rb(w z2);
///    t = rb(rb(rb(rb(p + q) + r) / det) rb(1 / dz)).
/// 5. If |rb(rb(p + q) + r)| is less than half of rb(rb(|p| + |q|) + |r|), and for Plane always, t is the plane's:
///    rb((n . a) / (n . d)), with a = rb(v0 - o), n = (v1 - v0) x (v2 - v0); each difference, product and sum of a, n
///    and the two scalar products is rb(), sums from left to right. Floats: v1 - v0 is rb(rb(v1 - o) - rb(v0 - o)), and
///    so on.
/// 6. t = fl(t). Plane: if (vz - oz) dz is above zero for all corners, a t that is not, or is NaN, counts as 2^-149; if
///    it is for none, it is a miss. t must be above zero, and is moved into the interval of the triangle's own box, in
///    floats. It must be below the ray's limit and the best hit's, or as far with a lower number.
///
/// With Floats and 53 bits that is what engines do, bit for bit; Plane is what machine/traverser/triangle_pipe.hpp
/// does.
class TriangleTest {
 public:
  /// `bits`: kLeastTimeBits .. kMostTimeBits.
  TriangleTest(TriangleTime time, uint32_t bits) : time_(time), narrow_(bits) {}

  /// Tests the triangles of a leaf; true when one became the candidate.
  bool operator()(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) const;

 private:
  bool accept(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, Candidate& best) const;
  double interpolated_t(const PreparedRay& ray, const Triangle& triangle, const double (&weights)[3],
                        double determinant) const;

  TriangleTime time_;
  NarrowFloat narrow_;
};

}  // namespace raypool
