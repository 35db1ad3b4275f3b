// The triangle test. Included in a namespace of each set of instructions it is compiled for, after simd4.hpp,
// prepared_ray.hpp and bits.hpp, and so without a guard. Every operation rounds the same way in each.

// Of the library's functions, which may exist once in a program, none may be compiled for a processor that the
// program's user need not have.
inline float smaller(float a, float b) { return b < a ? b : a; }
inline float larger(float a, float b) { return a < b ? b : a; }

/// Where the ray is in the triangle's own box: the arithmetic of a node's boxes. False when it misses it.
inline bool own_box_interval(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, float& near,
                             float& far) {
  near = 0;
  far = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = block.vertices[0][axis][lane], b = block.vertices[1][axis][lane], c = block.vertices[2][axis][lane];
    const float bounds[2] = {smaller(smaller(a, b), c), larger(larger(a, b), c)};
    const int first = ray.near_side[axis], second = 1 - first;
    near = larger(near, (bounds[first] - ray.padded[first][axis]) * ray.inverse[axis]);
    far = smaller(far, (bounds[second] - ray.padded[second][axis]) * ray.inverse[axis]);
  }
  near *= kNearScale;
  far *= kFarScale;
  return near <= far;
}

/// Where the ray meets the triangle's plane at t, and hits the triangle, it becomes the candidate if it is one of the
/// ray's hits, nearer than the best, or as near with a lower number. The candidate's u and v are left to the caller.
inline bool take_if_nearer(const PreparedRay& ray, const TriangleBlock& block, unsigned lane, float t,
                           Candidate& best) {
  float near = 0, far = 0;
  if (!(t > 0) || !own_box_interval(ray, block, lane, near, far)) return false;
  t = smaller(larger(t, near), far);
  const auto ray_t = static_cast<float>(static_cast<double>(t) * ray.t_scale);
  if (!(ray_t > 0 && ray_t < ray.limit)) return false;
  const uint32_t triangle = block.triangles[lane];
  if (!(t < best.t || (t == best.t && triangle < best.triangle))) return false;
  best.t = t;
  best.triangle = triangle;
  best.block = &block;
  best.lane = lane;
  return true;
}

/// Finishes a triangle whose edge functions agree in sign; true when it becomes the candidate.
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
  const unsigned zeros = mask4((u == zero) | (v == zero) | (w == zero));
  bool found = false;
  for (unsigned lanes = ~(negative & positive) & used; lanes != 0; lanes &= lanes - 1) {
    const auto lane = lowest(lanes);
    double du = u[lane], dv = v[lane], dw = w[lane];
    if ((zeros >> lane & 1u) != 0) {
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
