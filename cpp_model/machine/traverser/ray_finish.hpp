// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_ray_finish.v: what a ray carries on of its hit, once it is known which triangle it has hit and when:
// the time, where in the triangle, and the triangle's normal; without double.
// docs/machine/ray-finish.md defines them, and explains why.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "arith/narrow_float.hpp"
#include "bits.hpp"
#include "machine/common/pipe_items.hpp"
#include "machine/traverser/triangle_pipe.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool {

/// A number as significand x 2^exponent.
struct Significand {
  uint64_t value = 0;
  int exponent = 0;
  bool negative = false;

  Significand() = default;
  /// Of `bits`, up to 53, of which the first is a one; x is zero or has no more, nor is it subnormal.
  Significand(double x, int bits) : negative(std::signbit(x)) {
    uint64_t word = 0;
    std::memcpy(&word, &x, sizeof word);
    if (x == 0) return;
    const uint64_t first = uint64_t{1} << 52;
    value = (first | (word & (first - 1))) >> (53 - bits);
    exponent = static_cast<int>(word >> 52 & 0x7ff) - 1023 - (bits - 1);
  }

  /// So many units of 2^unit, cut off; 2^unit is not below its last bit.
  uint64_t units(int unit) const { return value == 0 || unit - exponent > 31 ? 0 : value >> (unit - exponent); }
};

/// rtl/arith/rp_cross_products.v: a b - c d, with one rounding to 32 bits, to nearest even.
inline Significand cross_product(const Significand& a, const Significand& b, const Significand& c,
                                 const Significand& d) {
  using Wide = unsigned __int128;
  struct Product {
    Wide value;
    int exponent;
    bool negative;
  };
  Product higher{Wide{a.value} * b.value, a.exponent + b.exponent, a.negative != b.negative};
  Product lower{Wide{c.value} * d.value, c.exponent + d.exponent, c.negative == d.negative};
  if (higher.value == 0 || (lower.value != 0 && lower.exponent > higher.exponent)) std::swap(higher, lower);

  // The lower one at the place of the other. If it is moved by more than two places, the difference has lost one bit at
  // the most, so what lies behind three more bits only shows that it is there.
  const int distance = lower.value == 0 ? 0 : std::min(higher.exponent - lower.exponent, 127);
  const Wide most = higher.value << 3, whole = lower.value << 3;
  Wide less = whole >> distance;
  if (less << distance != whole) less |= 1;
  Wide sum = most + less;
  Significand result;
  result.negative = higher.negative;
  if (lower.negative != higher.negative) {
    sum = most < less ? less - most : most - less;
    result.negative = higher.negative != (most < less);
  }
  if (sum == 0) return {};
  const auto top = static_cast<uint64_t>(sum >> 64);
  const int first = top != 0 ? 64 + leading_one(top) : leading_one(static_cast<uint64_t>(sum));
  const int drop = first - 31;
  result.exponent = higher.exponent - 3 + drop;
  if (drop <= 0) {
    result.value = static_cast<uint64_t>(sum) << -drop;
    return result;
  }
  result.value = static_cast<uint64_t>(sum >> drop);
  const Wide half = Wide{1} << (drop - 1), off = sum & (2 * half - 1);
  result.value += off > half || (off == half && result.value % 2 != 0) ? 1 : 0;
  if (result.value >> 32 == 0) return result;
  result.value >>= 1;
  ++result.exponent;
  return result;
}

/// value x 2^exponent, and less than one more with `rest`, as a float: rounded once, to nearest even, where it is
/// subnormal too. It must have 25 bits or no rest, and not be too large.
inline float rounded_to_float(uint64_t value, int exponent, bool rest) {
  if (value >> 62 != 0) {
    rest |= (value & 3) != 0;
    value >>= 2;
    exponent += 2;
  }
  if (value == 0) return 0;
  const int first = leading_one(value), drop = std::max(first - 23, -149 - exponent);
  if (drop <= 0) return std::ldexp(static_cast<float>(value), exponent);
  if (drop > 62) return 0;
  const uint64_t half = uint64_t{1} << (drop - 1), off = value & (2 * half - 1);
  uint64_t kept = value >> drop;
  kept += off > half || (off == half && (rest || kept % 2 != 0)) ? 1 : 0;
  return std::ldexp(static_cast<float>(kept), exponent + drop);
}

/// Of what a ray has hit at an internal time, neither below zero nor infinite; coordinates must be finite, and no two
/// of triangle and origin further apart than kLargestDistance.
struct RayFinish {
  float t = 0;                  ///< internal t x 2^scale
  float u = 0, v = 0;           ///< shares of corners 1 and 2 in the point; 0 where the ray sees no area
  float normal[3] = {0, 0, 0};  ///< of length 1, along (1 - 0) x (2 - 0); 0 where the triangle has no area

  RayFinish() = default;
  RayFinish(const TriangleRay& ray, const Triangle& triangle, float internal_t, int scale)
      : t(static_cast<float>(std::ldexp(static_cast<double>(internal_t), scale))) {
    set_shares(ray, triangle);
    set_normal(triangle);
  }

 private:
  static constexpr int kSideBits = 36;  ///< of a triangle's sides

  /// An edge's cross product is the weight of the corner opposite: of a hit all have one sign, so sizes do.
  void set_shares(const TriangleRay& ray, const Triangle& triangle) {
    const CornersInView view(ray, triangle);
    Significand x[3], y[3], weights[3];
    for (int corner = 0; corner < 3; ++corner) {
      x[corner] = Significand(static_cast<double>(view.x[corner]), 24);
      y[corner] = Significand(static_cast<double>(view.y[corner]), 24);
    }
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      weights[k] = cross_product(x[b], y[a], y[b], x[a]);
    }
    const int unit = largest_exponent(weights);
    uint64_t sum = 0;
    for (const Significand& weight : weights) sum += weight.units(unit);
    if (sum == 0) return;
    const int more = sum >> 33 != 0 ? 2 : sum >> 32 != 0 ? 1 : 0;
    u = share(weights[1], sum >> more, unit + more);
    v = share(weights[2], sum >> more, unit + more);
  }
  static float share(const Significand& weight, uint64_t sum, int unit) {
    const uint64_t dividend = weight.value << 32;
    return rounded_to_float(dividend / sum, weight.exponent - unit - 32, dividend % sum != 0);
  }

  /// The size's root has 31 bits, and so has its reciprocal, with one more: both are cut off.
  void set_normal(const Triangle& triangle) {
    const NarrowFloat narrow(kSideBits);
    Significand sides[2][3], along[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 2; ++i) {
        sides[i][axis] = Significand(narrow.subtract(triangle(i + 1, axis), triangle(0, axis)), kSideBits);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      along[axis] = cross_product(sides[0][a], sides[1][b], sides[0][b], sides[1][a]);
    }
    int unit = largest_exponent(along) + 1;
    uint64_t sum = 0;
    for (const Significand& each : along) sum += each.units(unit) * each.units(unit);
    if (sum == 0) return;
    if (sum >> 62 != 0) {
      sum >>= 2;
      ++unit;
    }
    const uint64_t reciprocal = (uint64_t{1} << 62) / root_of(sum);
    for (int axis = 0; axis < 3; ++axis) {
      const Significand& each = along[axis];
      const float size = rounded_to_float(each.value * reciprocal, each.exponent - unit - 62, false);
      normal[axis] = each.negative ? -size : size;
    }
  }
  /// Cut off. Double is off by one at most.
  static uint64_t root_of(uint64_t x) {
    auto root = static_cast<uint64_t>(std::sqrt(static_cast<double>(x)));
    while (root * root > x) --root;
    while ((root + 1) * (root + 1) <= x) ++root;
    return root;
  }
  /// Of those that are not zero; else whatever.
  static int largest_exponent(const Significand (&numbers)[3]) {
    int largest = -1024;
    for (const Significand& number : numbers) {
      if (number.value != 0) largest = std::max(largest, number.exponent);
    }
    return largest;
  }
};

/// The pipe: a ray may begin when three cycles have passed since the last one did. It never waits.
class RayFinishPipe {
 public:
  static constexpr int kStages = 66;
  static constexpr int kApart = 3;  ///< cycles from a ray to the next one, or more

  struct Start {
    uint64_t tag;
    TriangleRay ray;
    Triangle triangle;
    float t;  ///< internal
    int scale;
  };
  struct Result {
    uint64_t tag = 0;
    RayFinish finish;
  };

  /// Null: none is there.
  const Result* result() const { return rays_.at(kStages); }

  /// The end of a cycle. `ray`: null, none begins.
  void clock(const Start* ray) {
    if (ray != nullptr) rays_.begin() = {ray->tag, RayFinish(ray->ray, ray->triangle, ray->t, ray->scale)};
    rays_.clock();
  }

 private:
  PipeItems<Result, kStages> rays_;
};

}  // namespace raypool
