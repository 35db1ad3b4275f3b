#include <algorithm>
#include <cmath>

#include "rivals/rivals.hpp"

namespace raypool::referee {

FloatMeeting moeller_trumbore(const RayQuery& ray, const Corners& corners) {
  constexpr float kEpsilon = 0.000001f;
  const Vec3 edge1 = corners[1] - corners[0], edge2 = corners[2] - corners[0];
  const Vec3 p = cross(ray.direction, edge2);
  const float determinant = dot(edge1, p);
  if (determinant > -kEpsilon && determinant < kEpsilon) return {};
  const float inverse = 1.0f / determinant;
  const Vec3 from = ray.origin - corners[0];
  const float u = dot(from, p) * inverse;
  if (u < 0 || u > 1) return {};
  const Vec3 q = cross(from, edge1);
  const float v = dot(ray.direction, q) * inverse;
  if (v < 0 || u + v > 1) return {};
  return {true, dot(edge2, q) * inverse};
}

FloatMeeting woop(const RayQuery& ray, const Corners& corners) {
  // The axis along which the direction is largest becomes z; the winding is kept.
  const Vec3& d = ray.direction;
  const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
  const int kz = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
  int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  if (d[kz] < 0) std::swap(kx, ky);
  const float sx = d[kx] / d[kz], sy = d[ky] / d[kz], sz = 1.0f / d[kz];
  float x[3], y[3], z[3];
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 a = corners[i] - ray.origin;
    x[i] = a[kx] - sx * a[kz];
    y[i] = a[ky] - sy * a[kz];
    z[i] = sz * a[kz];
  }
  float u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
  if (u == 0 || v == 0 || w == 0) {
    const auto edge = [&](int a, int b) {
      return static_cast<float>(static_cast<double>(x[a]) * static_cast<double>(y[b]) -
                                static_cast<double>(y[a]) * static_cast<double>(x[b]));
    };
    u = edge(2, 1), v = edge(0, 2), w = edge(1, 0);
  }
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return {};
  const float determinant = u + v + w;
  if (determinant == 0) return {};
  return {true, (u * z[0] + v * z[1] + w * z[2]) * (1.0f / determinant)};
}

FloatMeeting baldwin_weber(const RayQuery& ray, const Corners& corners) {
  // The transformation makes the triangle the one of (0, 0), (1, 0), (0, 1) in z = 0. Its free column is that of the
  // axis along which the normal is largest, k; the others follow it.
  const Vec3 a = corners[0], e1 = corners[1] - a, e2 = corners[2] - a, n = cross(e1, e2);
  const float nx = std::fabs(n.x), ny = std::fabs(n.y), nz = std::fabs(n.z);
  const int k = nx > ny && nx > nz ? 0 : ny > nz ? 1 : 2, i = (k + 1) % 3, j = (k + 2) % 3;
  float rows[3][4] = {};
  rows[0][i] = e2[j] / n[k], rows[0][j] = -e2[i] / n[k];
  rows[0][3] = (e2[i] * a[j] - e2[j] * a[i]) / n[k];
  rows[1][i] = -e1[j] / n[k], rows[1][j] = e1[i] / n[k];
  rows[1][3] = (e1[j] * a[i] - e1[i] * a[j]) / n[k];
  rows[2][k] = 1, rows[2][i] = n[i] / n[k], rows[2][j] = n[j] / n[k];
  rows[2][3] = -dot(a, n) / n[k];
  const auto along = [&](int row, const Vec3& v) {
    return rows[row][0] * v.x + rows[row][1] * v.y + rows[row][2] * v.z;
  };
  const float t = -(along(2, ray.origin) + rows[2][3]) / along(2, ray.direction);
  const Vec3 at = ray.origin + ray.direction * t;
  const float u = along(0, at) + rows[0][3], v = along(1, at) + rows[1][3];
  return {u >= 0 && v >= 0 && u + v <= 1, t};
}

FloatMeeting pluecker(const RayQuery& ray, const Corners& corners) {
  const Vec3 moment = cross(ray.origin, ray.direction);
  float sides[3];
  for (size_t i = 0; i < 3; ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % 3];
    sides[i] = dot(b - a, moment) + dot(cross(a, b), ray.direction);
  }
  const bool above = sides[0] > 0 || sides[1] > 0 || sides[2] > 0, below = sides[0] < 0 || sides[1] < 0 || sides[2] < 0;
  if (above == below) return {};
  const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return {true, dot(normal, corners[0] - ray.origin) / dot(normal, ray.direction)};
}

}  // namespace raypool::referee
