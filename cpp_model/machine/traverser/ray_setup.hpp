// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_ray_setup.v: what is computed once of a ray, for box_pipe.hpp and triangle_pipe.hpp, in integers and
// in floats of which every operation is rounded once, to nearest even. docs/machine/ray-setup.md shows why that is all.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "bits.hpp"
#include "machine/common/pipe_items.hpp"
#include "machine/traverser/box_ray.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool {

/// Of the largest distance; the triangle test and the slabs err by less than half of it. 2^-20.
inline constexpr float kPadding = 8 * kUlp;
inline constexpr float kLargestDistance = 1e18f;  ///< products of two distances stay finite

/// The next float towards infinity; not of a NaN or infinity. std::nextafter is a call, and a ray needs six.
inline float next_above(float x) {
  const uint32_t bits = as_bits(x + 0.0f);  // -0 becomes +0
  return as_float(bits + 1 - (bits >> 31) * 2);
}
inline float next_below(float x) { return -next_above(-x); }

/// p: 2^p exceeds what the padded bounds of the test in single precision, its roundings, and those of a compressed
/// node's planes come to on this axis. docs/machine/box-test.md has each term. `padding`: of the ray; `largest`:
/// coordinate of the scene's box on this axis.
inline int padding_exponent(float origin, float padded_lower, float padded_upper, float padding, float largest) {
  const float widened = std::max(padded_lower - origin, origin - padded_upper);
  const float least = widened + (padding + 0x1p-24f * largest);
  const uint32_t above = as_bits(least) + 32;
  if (above >> 23 != 0) return static_cast<int>(above >> 23) - 126;
  return leading_one(above) - 148;
}

/// The words in which a ray comes to the traverser.
struct RayWords {
  float origin[3], direction[3];
  float limit;
};

/// Bounds of the scene's vertices.
struct RootBox {
  float lower[3], upper[3];
};

struct RaySetup {
  bool valid = false;  ///< false: the ray hits nothing, and nothing else is set
  BoxRay box;
  TriangleRay triangle;  ///< its direction's doubles are floats times a power of two, so that none is rounded
  float limit = 0;
  int scale = 0;  ///< time on the ray is internal time x 2^scale

  /// `bits`: of the box test.
  RaySetup(const RayWords& ray, const RootBox& root, int bits) : box(ray.origin, ray.direction, ray.limit, bits) {
    float distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
      distance = std::max(
          {distance, std::fabs(root.lower[axis] - ray.origin[axis]), std::fabs(root.upper[axis] - ray.origin[axis])});
    }
    if (!box.valid || !(distance <= kLargestDistance)) return;
    valid = true;
    limit = ray.limit;

    const auto size = [&](int axis) { return as_bits(ray.direction[axis]) & 0x7fffffff; };
    triangle.kz = 0;
    for (const int axis : {1, 2}) triangle.kz = size(axis) > size(triangle.kz) ? axis : triangle.kz;
    triangle.kx = (triangle.kz + 1) % 3;
    triangle.ky = (triangle.kz + 2) % 3;
    triangle.shear_x = ray.direction[triangle.kx] / ray.direction[triangle.kz];
    triangle.shear_y = ray.direction[triangle.ky] / ray.direction[triangle.kz];
    const int exponent = exponent_of(ray.direction[triangle.kz]);
    scale = -exponent;

    const float padding = kPadding * distance;
    for (int axis = 0; axis < 3; ++axis) {
      const float origin = ray.origin[axis], direction = ray.direction[axis];
      triangle.origin[axis] = origin;
      triangle.padded[0][axis] = next_above(origin + padding);
      triangle.padded[1][axis] = next_below(origin - padding);
      triangle.direction[axis] = std::ldexp(static_cast<double>(direction), scale);
      triangle.inverse[axis] = inverse_of(direction, exponent);
      triangle.near_side[axis] = triangle.inverse[axis] < 0 ? 1 : 0;
      box.axes[axis].padding = padding_exponent(origin, triangle.padded[0][axis], triangle.padded[1][axis], padding,
                                                std::max(std::fabs(root.lower[axis]), std::fabs(root.upper[axis])));
    }
  }

 private:
  /// Of a finite float that is not zero: its size lies in 2^exponent .. 2^(exponent + 1).
  static int exponent_of(float x) {
    const FloatParts parts(x);
    return parts.unit + leading_one(parts.value);
  }
  /// 1 / (x 2^-largest). A component below 2^-100 counts as that: along such an axis the ray does not move at all,
  /// compared with the padding, and a finite inverse keeps NaN out.
  static float inverse_of(float x, int largest) {
    const int places = x == 0 ? 101 : largest - exponent_of(x);
    if (places > 100) return std::copysign(0x1p100f, x);
    FloatParts parts(x);
    while ((parts.value >> 23) == 0) parts.value <<= 1;
    const float quotient = 1.0f / as_float(0x3f800000 | (parts.value & 0x7fffff));
    return std::copysign(as_float(as_bits(quotient) + (static_cast<uint32_t>(places) << 23)), x);
  }
};

/// The pipe: a ray may begin when three cycles have passed since the last one did. It never waits.
class RaySetupPipe {
 public:
  static constexpr int kStages = 27;
  static constexpr int kApart = 3;  ///< cycles from a ray to the next one, or more

  struct Result {
    uint32_t tag = 0;
    RaySetup setup{{}, {}, 0};
  };

  /// Null: none is there.
  const Result* result() const { return rays_.at(kStages); }

  /// The end of a cycle. `ray`: null, none begins.
  void clock(const Result* ray) {
    if (ray != nullptr) rays_.begin() = *ray;
    rays_.clock();
  }

 private:
  PipeItems<Result, kStages> rays_;
};

}  // namespace raypool
