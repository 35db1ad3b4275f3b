#include "scene/double_traversal.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace raypool {
namespace {

__extension__ typedef __float128 Quad;

/// A double-precision triple product of this share of its factors' lengths has a sign that can be trusted.
constexpr double kSureShare = 1e-14;

/// d . (b x c) with the sign of the exact value.
double volume(const Vec3d& d, const Vec3d& b, const Vec3d& c) {
  const double value = dot(d, cross(b, c));
  double bound = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    bound += std::fabs(d[axis]) * (std::fabs(b[i] * c[j]) + std::fabs(b[j] * c[i]));
  }
  if (std::fabs(value) > kSureShare * bound) return value;
  return static_cast<double>(dot(d.as<Quad>(), cross(b.as<Quad>(), c.as<Quad>())));
}

/// A triangle of a block, where it is hit nearer than `best`, or as near with a lower number, becomes `best`.
void take_if_nearer(const TriangleBlock& block, unsigned lane, const Vec3d& origin, const Vec3d& direction,
                    DoubleHit& best) {
  Vec3d corners[3];
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) corners[k][axis] = static_cast<double>(block.vertices[k][axis][lane]);
  }
  const Vec3d a = corners[0] - origin, b = corners[1] - origin, c = corners[2] - origin;
  const double u = volume(direction, c, b), v = volume(direction, a, c), w = volume(direction, b, a);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return;
  if (u + v + w == 0) return;
  // From the plane, not from the weights: exact for the coordinates that a plane keeps constant.
  const Vec3d plane = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double t = dot(plane, a) / dot(plane, direction);
  const uint32_t triangle = block.triangles[lane];
  if (!(t > 0) || !(t < best.t || (t == best.t && triangle < best.triangle && best.triangle != kNoTriangle))) return;
  best = {triangle, t};
}

}  // namespace

DoubleHit DoubleTraversal::trace(const Vec3d& origin, const Vec3d& direction, double limit, bool any) const {
  DoubleHit best;
  best.t = limit;
  if (bvh_.nodes.empty()) return best;
  double inverse[3], reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = direction[axis];
    inverse[axis] = 1 / (std::fabs(d) < 1e-200 ? std::copysign(1e-200, d) : d);
    reach = std::max({reach, std::fabs(origin[axis]), std::fabs(static_cast<double>(bvh_.bounds.lower[axis])),
                      std::fabs(static_cast<double>(bvh_.bounds.upper[axis]))});
  }
  const double padding = 1e-15 * reach;

  struct Entry {
    uint32_t child;
    double t;
  };
  std::vector<Entry> stack = {{0, 0}};
  while (!stack.empty()) {
    const Entry top = stack.back();
    stack.pop_back();
    if (top.t > best.t) continue;
    if ((top.child & kLeafBit) != 0) {
      const TriangleBlock& block = bvh_.blocks[top.child & ~kLeafBit];
      for (unsigned lane = 0; lane < block.count; ++lane) take_if_nearer(block, lane, origin, direction, best);
      if (any && best.triangle != kNoTriangle) return best;
      continue;
    }
    const BvhNode& node = bvh_.nodes[top.child];
    const size_t base = stack.size();
    for (int i = 0; i < kBvhWidth && node.children[i] != kNoChild; ++i) {
      double near = 0, far = best.t;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = (static_cast<double>(node.bounds[0][axis][i]) - padding - origin[axis]) * inverse[axis];
        const double high = (static_cast<double>(node.bounds[1][axis][i]) + padding - origin[axis]) * inverse[axis];
        near = std::max(near, std::min(low, high) * (1 - 1e-14));
        far = std::min(far, std::max(low, high) * (1 + 1e-14));
      }
      if (!(near <= far)) continue;
      // The nearest child on top.
      size_t place = stack.size();
      stack.push_back({});
      for (; place > base && stack[place - 1].t < near; --place) stack[place] = stack[place - 1];
      stack[place] = {node.children[i], near};
    }
  }
  return best;
}

}  // namespace raypool
