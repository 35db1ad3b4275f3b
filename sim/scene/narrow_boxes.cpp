#include "scene/narrow_boxes.hpp"

#include <algorithm>
#include <cmath>

namespace raypool {
namespace {

/// p: 2^p exceeds what the padded bounds of the test in single precision, its roundings, and those of a compressed
/// node's planes come to on this axis. docs/traverser.md has each term.
int padding_exponent(const PreparedRay& ray, const Bounds& bounds, int axis) {
  const double origin = ray.origin[axis];
  const double padded = std::max(ray.padded[0][axis] - origin, origin - ray.padded[1][axis]);
  const double largest = std::max(std::fabs(bounds.lower[axis]), std::fabs(bounds.upper[axis]));
  const double least = (1 + 0x1p-19) * padded + 0x1p-20 * ray.reach + 0x1p-24 * largest + 0x1p-147;
  return std::ilogb(least) + 1;
}

}  // namespace

BoxRay narrow_ray(const RayQuery& query, const PreparedRay& ray, const Bounds& bounds, uint32_t bits) {
  const float origin[3] = {query.origin.x, query.origin.y, query.origin.z};
  const float direction[3] = {query.direction.x, query.direction.y, query.direction.z};
  BoxRay result(origin, direction, query.limit, static_cast<int>(bits));
  for (int axis = 0; axis < 3; ++axis) result.axes[axis].padding = padding_exponent(ray, bounds, axis);
  return result;
}

}  // namespace raypool
