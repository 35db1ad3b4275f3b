// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// On which side of a triangle's edges a ray passes, exactly, in integers: what hardware compares in place of adding
// products of doubles. docs/traverser.md has the argument.
#pragma once

#include <cstdint>

#include "bits.hpp"

namespace raypool {

/// The product of two finite floats, exactly: value x 2^unit with a sign. `value` has 48 bits, the first of them 1,
/// unless the product is zero.
struct ExactProduct {
  bool negative;
  int unit;
  uint64_t value;

  ExactProduct(float a, float b) : negative((as_bits(a) ^ as_bits(b)) >> 31 != 0) {
    const Parts x(a), y(b);
    value = uint64_t{x.value} * y.value;
    unit = x.unit + y.unit;
    if (value != 0 && value >> 47 == 0) value <<= 1, --unit;
  }
  /// -1, 0 or 1: it is less than the other, equal, more.
  int compared_with(const ExactProduct& other) const {
    const int sign = value == 0 ? 0 : negative ? -1 : 1, other_sign = other.value == 0 ? 0 : other.negative ? -1 : 1;
    if (sign != other_sign) return sign < other_sign ? -1 : 1;
    if (sign == 0 || (unit == other.unit && value == other.value)) return 0;
    const bool smaller = unit != other.unit ? unit < other.unit : value < other.value;
    return smaller == negative ? 1 : -1;
  }

 private:
  /// A float's significand, its leading bit at 23 also where the float is subnormal, and what its last bit weighs.
  struct Parts {
    uint32_t value;
    int unit;
    explicit Parts(float x) {
      const uint32_t exponent = as_bits(x) >> 23 & 0xff;
      value = (as_bits(x) & 0x7fffff) | (exponent != 0 ? 1u << 23 : 0);
      unit = static_cast<int>(exponent != 0 ? exponent : 1) - 150;
      while (value != 0 && value >> 23 == 0) value <<= 1, --unit;
    }
  };
};

/// Sign of ax by - ay bx: -1, 0 or 1. No argument may be infinite or NaN.
inline int edge_sign(float ax, float ay, float bx, float by) {
  return ExactProduct(ax, by).compared_with(ExactProduct(ay, bx));
}

/// The ray passes within the triangle or on its border: no two of its edges have it on different sides. x, y: of the
/// corners, across the ray. Where all three signs are zero the triangle is seen edge-on, and has no inside.
struct TriangleEdges {
  int signs[3];  ///< of the edge functions u, v, w, opposite corners 0, 1, 2

  TriangleEdges(const float (&x)[3], const float (&y)[3])
      : signs{edge_sign(x[2], y[2], x[1], y[1]), edge_sign(x[0], y[0], x[2], y[2]), edge_sign(x[1], y[1], x[0], y[0])} {
  }

  bool inside() const {
    bool negative = false, positive = false;
    for (const int sign : signs) negative |= sign<0, positive |= sign> 0;
    return negative != positive;
  }
};

}  // namespace raypool
