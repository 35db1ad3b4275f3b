// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where a hit may lie, and which of two counts. Included in a namespace, after triangle_ray.hpp, and so without a
// guard: sim/scene has it once for each set of instructions. Every operation rounds the same way in each. `corner(i,
// axis)` is a coordinate of the triangle.

// Of the library's functions, which may exist once in a program, none may be compiled for a processor that the
// program's user need not have.
inline float smaller(float a, float b) { return b < a ? b : a; }
inline float larger(float a, float b) { return a < b ? b : a; }

/// Where the ray is in the triangle's own box: the arithmetic of a node's boxes. False when it misses it.
template <typename Corner>
inline bool own_box_interval(const TriangleRay& ray, const Corner& corner, float& near, float& far) {
  near = 0;
  far = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = corner(0, axis), b = corner(1, axis), c = corner(2, axis);
    const float bounds[2] = {smaller(smaller(a, b), c), larger(larger(a, b), c)};
    const int first = ray.near_side[axis], second = 1 - first;
    near = larger(near, (bounds[first] - ray.padded[first][axis]) * ray.inverse[axis]);
    far = smaller(far, (bounds[second] - ray.padded[second][axis]) * ray.inverse[axis]);
  }
  near *= kNearScale;
  far *= kFarScale;
  return near <= far;
}

/// Moves t, which must be above zero, into that interval; false when it is not, or there is none.
template <typename Corner>
inline bool move_into_own_box(const TriangleRay& ray, const Corner& corner, float& t) {
  float near = 0, far = 0;
  if (!(t > 0) || !own_box_interval(ray, corner, near, far)) return false;
  t = smaller(larger(t, near), far);
  return true;
}

/// A hit at internal t, which times scale is the ray's, is one of the ray's.
inline bool within_limit(float t, double scale, float limit) {
  const auto ray_t = static_cast<float>(static_cast<double>(t) * scale);
  return ray_t > 0 && ray_t < limit;
}

/// It counts, and no longer the best one so far: it is nearer, or as near with a lower number.
inline bool is_nearer(float t, uint32_t triangle, float best_t, uint32_t best_triangle) {
  return t < best_t || (t == best_t && triangle < best_triangle);
}
