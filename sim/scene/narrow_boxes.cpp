#include "scene/narrow_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "machine/traverser/ray_setup.hpp"

namespace raypool {

BoxRay narrow_ray(const RayQuery& query, const PreparedRay& ray, const Bounds& bounds, uint32_t bits) {
  const float origin[3] = {query.origin.x, query.origin.y, query.origin.z};
  const float direction[3] = {query.direction.x, query.direction.y, query.direction.z};
  BoxRay result(origin, direction, query.limit, static_cast<int>(bits));
  const float padding = kPadding * ray.reach;
  for (int axis = 0; axis < 3; ++axis) {
    const float largest = std::max(std::fabs(bounds.lower[axis]), std::fabs(bounds.upper[axis]));
    result.axes[axis].padding =
        padding_exponent(ray.origin[axis], ray.padded[0][axis], ray.padded[1][axis], padding, largest);
  }
  return result;
}

}  // namespace raypool
