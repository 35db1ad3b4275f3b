// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// On which side of a triangle's edges a ray passes, exactly: what hardware compares, in integers, in place of adding
// products of doubles. docs/machine/triangle-test.md has the argument.
#pragma once

#include <cstdint>

#include "bits.hpp"

namespace raypool {

/// As hardware takes a float, which has no infinite numbers here: the largest exponent is one like the others.
inline double edge_number(float x) {
  const uint32_t word = as_bits(x);
  if ((word >> 23 & 0xff) != 0xff) return static_cast<double>(x);
  return 2 * static_cast<double>(as_float(word - (1u << 23)));
}

/// Sign of ax by - ay bx: -1, 0 or 1. A double has both products exactly: the 48 bits that they can have, and exponents
/// below the least one.
inline int edge_sign(float ax, float ay, float bx, float by) {
  const double a = edge_number(ax) * edge_number(by), b = edge_number(ay) * edge_number(bx);
  return static_cast<int>(a > b) - static_cast<int>(a < b);
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
