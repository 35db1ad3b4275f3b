// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the set-up of a ray computes once for the narrow box test (box_pipe.hpp): reciprocals of `bits` bits, rounded
// down, and times as keys that are compared like integers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "bits.hpp"

namespace raypool {

inline constexpr int kLeastBoxBits = 6, kMostBoxBits = 16;
inline constexpr int kKeyBias = 512;
inline constexpr uint32_t kKeyExponents = 1024;
inline constexpr int kNoPadding = -256;  ///< finer than any float

/// Key of a time that no other exceeds.
constexpr uint32_t infinite_key(int bits) { return (kKeyExponents << (bits - 1)) - 1; }

/// Key of value x 2^unit, of which `bits` bits are kept; of two times the later one's is not less. Zero is 0, else the
/// exponent of the leading bit, with a bias of 512, above bits - 1 bits of fraction.
inline uint32_t time_key(uint64_t value, int unit, int bits) {
  if (value == 0) return 0;
  const int leading = leading_one(value);
  const int drop = leading - (bits - 1);
  const uint64_t kept = drop > 0 ? value >> drop : value << -drop;
  const uint32_t fraction = static_cast<uint32_t>(kept) & ((1u << (bits - 1)) - 1);
  return (static_cast<uint32_t>(leading + unit + kKeyBias) << (bits - 1)) + fraction;
}

/// A float as value x 2^unit, without its sign. Must be finite.
struct FloatParts {
  uint32_t value;
  int unit;
  explicit FloatParts(float x) {
    const uint32_t exponent = as_bits(x) >> 23 & 0xff;
    const auto normal = static_cast<uint32_t>(exponent != 0);
    value = (as_bits(x) & 0x7fffff) | normal << 23;
    unit = static_cast<int>(exponent - normal) - 149;
  }
};

struct BoxRay {
  struct Axis {
    float origin = 0;
    bool backwards = false;  ///< the direction is negative
    bool still = false;      ///< it is zero, of either sign: the reciprocal is that of 1
    /// m, of `bits` bits, the first of them 1: 1/|direction| lies in m .. m + 1, x 2^exponent.
    uint32_t reciprocal = 0;
    int exponent = 0;
    int padding = kNoPadding;  ///< boxes are met with planes nearer than 2^padding to those of boxes that are
  };
  bool valid = false;  ///< false: it meets no box, and nothing else is set
  int bits = 0;
  Axis axes[3];
  uint32_t limit = 0;  ///< a key

  /// A direction that is all zero, a component of origin or direction that is infinite or NaN, and a limit that is NaN
  /// or not above zero meet nothing, as everywhere (scene/traversal.hpp). Subnormal numbers keep their values.
  BoxRay(const float (&origin)[3], const float (&direction)[3], float ray_limit, int significand_bits)
      : bits(significand_bits) {
    bool finite = true, moves = false;
    for (int i = 0; i < 3; ++i) {
      finite &= std::isfinite(origin[i]) && std::isfinite(direction[i]);
      moves |= direction[i] != 0;
    }
    if (!finite || !moves || !(ray_limit > 0)) return;
    valid = true;
    for (int i = 0; i < 3; ++i) {
      axes[i].origin = origin[i];
      axes[i].still = direction[i] == 0;
      axes[i].backwards = direction[i] < 0;
      set_reciprocal(axes[i], axes[i].still ? 1.0f : direction[i]);
    }
    limit = key(ray_limit);
  }

  /// Of the ray's limit, or of the best hit so far: t x 2^scale, neither NaN nor negative.
  uint32_t key(float t, int scale = 0) const {
    if (std::isinf(t)) return infinite_key(bits);
    const FloatParts parts(t);
    return time_key(parts.value, parts.unit + scale, bits);
  }

 private:
  void set_reciprocal(Axis& axis, float of) const {
    FloatParts parts(of);
    for (; (parts.value >> 23) == 0; parts.value <<= 1) --parts.unit;
    const uint64_t dividend = uint64_t{1} << (bits + 23);
    axis.reciprocal = static_cast<uint32_t>(dividend / parts.value);
    axis.exponent = -parts.unit - (bits + 23);
    if ((axis.reciprocal >> bits) != 0) {  // of a power of two
      axis.reciprocal >>= 1;
      ++axis.exponent;
    }
  }
};

}  // namespace raypool
