// What cases of a corpus are drawn from: numbers of a seed, whole points that floats hold exactly, small meshes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "scene/prepared_ray.hpp"
#include "scene/vec.hpp"

namespace raypool::referee {

using Corners = std::array<Vec3, 3>;
using Point3 = Vector3<int64_t>;
/// Corners by number, three a triangle.
struct Mesh {
  std::vector<Point3> points;
  std::vector<std::array<size_t, 3>> triangles;
};
struct DrawnCase {
  RayQuery ray;
  std::vector<Corners> triangles;
};

class Draw {
 public:
  Draw(uint64_t seed, uint64_t number) {
    std::seed_seq words{static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32), static_cast<uint32_t>(number),
                        static_cast<uint32_t>(number >> 32)};
    random_.seed(words);
  }
  /// 0 .. n - 1
  uint64_t below(uint64_t n) { return random_() % n; }
  bool one_of(uint64_t n) { return below(n) == 0; }
  int64_t from_to(int64_t low, int64_t high) {
    return low + static_cast<int64_t>(below(static_cast<uint64_t>(high - low) + 1));
  }
  int small(int low, int high) { return static_cast<int>(from_to(low, high)); }
  double share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * share(); }
  Point3 point(int64_t reach) {
    const int64_t x = from_to(-reach, reach), y = from_to(-reach, reach);
    return {x, y, from_to(-reach, reach)};
  }
  /// Not zero.
  Point3 direction(int64_t reach) {
    Point3 p = point(reach);
    if (p.x == 0 && p.y == 0 && p.z == 0) p[small(0, 2)] = one_of(2) ? 1 : -1;
    return p;
  }
  Vec3d place(double reach) {
    const double x = uniform(-reach, reach), y = uniform(-reach, reach);
    return {x, y, uniform(-reach, reach)};
  }
  /// So many floats up or down; usually one.
  float nudged(float x) {
    const float towards = one_of(2) ? INFINITY : -INFINITY;
    for (uint64_t i = one_of(3) ? 1 + below(4) : 1; i > 0; --i) x = std::nextafter(x, towards);
    return x;
  }
  Vec3 nudged(Vec3 v) {
    float& x = v[small(0, 2)];
    x = nudged(x);
    return v;
  }
  template <typename T>
  const T& any(const std::vector<T>& list) {
    return list[below(list.size())];
  }
  uint64_t word() { return random_(); }
  template <typename T>
  void shuffle(std::vector<T>& list) {
    for (size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[below(i)]);
  }

 private:
  std::mt19937_64 random_;
};

/// A whole number of below 2^24 times 2^exponent is a float.
inline Vec3 on_grid(const Point3& p, int exponent) {
  const auto at = [&](int64_t x) { return std::ldexp(static_cast<float>(x), exponent); };
  return {at(p.x), at(p.y), at(p.z)};
}

/// A closed mesh around the origin, a multiple of 4 in all coordinates, none above 4 reach: a tetrahedron, an
/// octahedron, a box or two pyramids.
Mesh closed_mesh(Draw& draw, int64_t reach);
/// Triangles in another order, each beginning with any of its corners, in floats.
std::vector<Corners> triangles_of(Draw& draw, const Mesh& mesh, int exponent);

}  // namespace raypool::referee
