#include "scene/prepared_ray.hpp"

#include <algorithm>
#include <cstring>

#include "machine/traverser/ray_setup.hpp"

namespace raypool {
namespace {

/// 2^exponent, of a normal number.
double power_of_two(int exponent) {
  const uint64_t bits = static_cast<uint64_t>(exponent + 1023) << 52;
  double result = 0;
  std::memcpy(&result, &bits, sizeof result);
  return result;
}

/// Of a normal number: it lies in 2^exponent .. 2^(exponent + 1).
int exponent_of(double x) {
  uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return static_cast<int>(bits >> 52 & 0x7ff) - 1023;
}

}  // namespace

PreparedRay prepare(const RayQuery& query, const Bounds& bounds) {
  PreparedRay ray;
  float distance = 0, largest = 0;
  bool finite = true;
  for (int axis = 0; axis < 3; ++axis) {
    const float o = query.origin[axis], d = query.direction[axis];
    finite &= std::isfinite(o) & std::isfinite(d);
    distance = std::max({distance, std::fabs(bounds.lower[axis] - o), std::fabs(bounds.upper[axis] - o)});
    largest = std::max(largest, std::fabs(d));
  }
  if (!finite || !(largest > 0) || !(distance <= kLargestDistance) || !(query.limit > 0)) return ray;
  ray.valid = true;

  const int exponent = exponent_of(largest);  // every float but zero is a normal double
  ray.t_scale = power_of_two(-exponent);
  ray.limit = query.limit;
  const double internal_limit = static_cast<double>(query.limit) * power_of_two(exponent);
  ray.internal_limit = static_cast<float>(internal_limit);
  if (static_cast<double>(ray.internal_limit) < internal_limit) ray.internal_limit = next_above(ray.internal_limit);

  ray.reach = distance;
  const float padding = kPadding * distance;
  double* const direction = ray.direction;
  double inverse[3];
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = query.origin[axis];
    ray.padded[0][axis] = next_above(query.origin[axis] + padding);
    ray.padded[1][axis] = next_below(query.origin[axis] - padding);
    direction[axis] = static_cast<double>(query.direction[axis]) * ray.t_scale;
    // Along such an axis the ray does not move at all, compared with the padding; a finite inverse keeps NaN out.
    const double smallest = 0x1p-100;
    const double d = std::fabs(direction[axis]) < smallest ? std::copysign(smallest, direction[axis]) : direction[axis];
    inverse[axis] = 1.0 / d;
    ray.inverse[axis] = static_cast<float>(inverse[axis]);
    ray.near_side[axis] = ray.inverse[axis] < 0 ? 1 : 0;
  }

  ray.kz = 0;
  if (std::fabs(direction[1]) > std::fabs(direction[ray.kz])) ray.kz = 1;
  if (std::fabs(direction[2]) > std::fabs(direction[ray.kz])) ray.kz = 2;
  ray.kx = ray.kz == 2 ? 0 : ray.kz + 1;
  ray.ky = ray.kz == 0 ? 2 : ray.kz - 1;
  ray.inverse_z = inverse[ray.kz];
  // The scale cancels: these are quotients of the floats that were given, rounded once.
  ray.shear_x = query.direction[ray.kx] / query.direction[ray.kz];
  ray.shear_y = query.direction[ray.ky] / query.direction[ray.kz];
  return ray;
}

double plane_t(const PreparedRay& ray, const TriangleBlock& block, unsigned lane) {
  Vec3d corners[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][axis] = static_cast<double>(block.vertices[corner][axis][lane]) - ray.origin[axis];
    }
  }
  const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return dot(normal, corners[0]) / dot(normal, Vec3d{ray.direction[0], ray.direction[1], ray.direction[2]});
}

}  // namespace raypool
