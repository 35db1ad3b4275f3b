// The triangle test. Included in a namespace of each set of instructions it is compiled for, after simd4.hpp,
// prepared_ray.hpp and bits.hpp, and so without a guard. Every operation rounds the same way in each.

#include "machine/traverser/triangle_interval.hpp"

/// Coordinates of a triangle of a leaf.
struct LaneCorners {
  const TriangleBlock& block;
  unsigned lane;
  float operator()(int corner, int axis) const { return block.vertices[corner][axis][lane]; }
};

/// What is hit at t becomes the candidate if it is one of the ray's hits, nearer than the best, or as near with a lower
/// number. The candidate's u and v are left to the caller.
inline bool take(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, float t, Candidate& best) {
  if (!within_limit(t, ray.t_scale, ray.limit)) return false;
  if (!is_nearer(t, block.triangles[lane], best.t, best.triangle)) return false;
  best.t = t;
  best.triangle = block.triangles[lane];
  best.block = &block;
  best.lane = lane;
  return true;
}

/// The same where the ray meets the triangle's plane at t, and hits the triangle.
inline bool take_if_nearer(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, float t,
                           Candidate& best) {
  return move_into_own_box(ray, LaneCorners{block, lane}, t) && take(ray, block, lane, t, best);
}

/// Finishes a triangle with edge functions that agree in sign; true when it becomes the candidate.
inline bool accept(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, double u, double v, double w,
                   Candidate& best) {
  const double determinant = u + v + w;
  if (determinant == 0) return false;
  double z[3];
  for (int corner = 0; corner < 3; ++corner) {
    z[corner] = static_cast<double>(block.vertices[corner][ray.kz][lane]) - ray.origin[ray.kz];
  }
  const double sum = u * z[0] + v * z[1] + w * z[2];
  double exact_t = sum / determinant * ray.inverse_z;
  // Near the plane, compared with the triangle's size, the edge functions' roundings would decide on which side of it
  // the ray begins: a triangle of 1e9 would be met or not met at random, and a surface could shadow itself.
  if (std::fabs(sum) < kCancelled * (std::fabs(u * z[0]) + std::fabs(v * z[1]) + std::fabs(w * z[2]))) {
    exact_t = plane_t(ray, block, lane);
  }
  if (!take_if_nearer(ray, block, lane, static_cast<float>(exact_t), best)) return false;
  best.u = v / determinant;
  best.v = w / determinant;
  return true;
}

/// Tests the triangles of a leaf; true when one became the candidate.
inline bool intersect_block(const PreparedRay& ray, const TriangleBlock& block, Candidate& best) {
  const Float4 ox = splat4(ray.origin[ray.kx]), oy = splat4(ray.origin[ray.ky]), oz = splat4(ray.origin[ray.kz]);
  const Float4 sx = splat4(ray.shear_x), sy = splat4(ray.shear_y);
  Float4 x[3], y[3];
  for (int corner = 0; corner < 3; ++corner) {
    const Float4 z = load4(block.vertices[corner][ray.kz]) - oz;
    x[corner] = (load4(block.vertices[corner][ray.kx]) - ox) - sx * z;
    y[corner] = (load4(block.vertices[corner][ray.ky]) - oy) - sy * z;
  }
  const Float4 u = x[2] * y[1] - y[2] * x[1];
  const Float4 v = x[0] * y[2] - y[0] * x[2];
  const Float4 w = x[1] * y[0] - y[1] * x[0];
  const Float4 zero = splat4(0);
  const unsigned used = (1u << block.count) - 1;
  const unsigned negative = mask4((u < zero) | (v < zero) | (w < zero)),
                 positive = mask4((u > zero) | (v > zero) | (w > zero));
  const Float4 least = splat4(kLeastWeight);
  const auto is_small = [&](const Float4& weight) { return (weight < least) & (weight > -least); };
  const unsigned small = mask4(is_small(u) | is_small(v) | is_small(w));
  bool found = false;
  for (unsigned lanes = ~(negative & positive) & used; lanes != 0; lanes &= lanes - 1) {
    const auto lane = lowest(lanes);
    double du = u[lane], dv = v[lane], dw = w[lane];
    if ((small >> lane & 1u) != 0) {
      // Products of floats are exact in double: the sign is that of the exact edge function.
      auto edge = [&](int a, int b) {
        return static_cast<double>(x[a][lane]) * y[b][lane] - static_cast<double>(y[a][lane]) * x[b][lane];
      };
      du = edge(2, 1), dv = edge(0, 2), dw = edge(1, 0);
      if ((du < 0 || dv < 0 || dw < 0) && (du > 0 || dv > 0 || dw > 0)) continue;
    }
    found |= accept(ray, block, lane, du, dv, dw, best);
  }
  return found;
}
