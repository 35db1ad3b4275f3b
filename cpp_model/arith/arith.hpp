// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Arithmetic of the Flt and Slw ALUs and of the float compares, bit for bit as the RTL does it. Values are IEEE-754
// single bit patterns. Round to nearest even; every NaN result is 7FC00000. docs/use/arithmetic.md has the rules.
// Needs the host's default floating-point environment: nearest even, and neither flush-to-zero nor denormals-are-zero
// set in MXCSR. What the kernels use most is inline and runs on the host's own unit.
#pragma once

#include <cmath>
#include <cstdint>

#include "bits.hpp"
#include "config/configuration.hpp"

namespace raypool::arith {

inline constexpr uint32_t kFullSignificand = 24;   ///< single precision's
inline constexpr uint32_t kLeastSignificand = 11;  ///< half precision's

/// The modes that change results.
struct Mode {
  Subnormals subnormals = Subnormals::Ieee;
  SlowUnit slow_unit = SlowUnit::Exact;
  bool fused = false;                       ///< the machine has a fused multiply-add; muladd() uses it
  uint32_t significand = kFullSignificand;  ///< bits with the leading one, 11 .. 24

  bool narrow() const { return significand != kFullSignificand; }
};

/// The mode of a machine.
inline Mode mode_of(const Configuration& configuration) {
  return {configuration.subnormals, configuration.slow_unit, configuration.fma, configuration.significand};
}

inline constexpr uint32_t kQuietNan = 0x7fc00000u;

namespace detail {

inline constexpr uint32_t kSign = 0x80000000u;
inline constexpr uint32_t kMagnitude = 0x7fffffffu;
inline constexpr uint32_t kInfinity = 0x7f800000u;  ///< also the mask of the exponent
inline constexpr uint32_t kSmallestNormal = 0x00800000u;
/// A magnitude below this rounds, to 24 bits and with any exponent allowed, to less
/// than the smallest normal number 2^-126.
inline constexpr double kTinyLimit = 0x1p-126 - 0x1p-151;

inline bool is_nan(uint32_t a) { return (a & kMagnitude) > kInfinity; }
inline bool flushes(Mode mode) { return mode.subnormals != Subnormals::Ieee; }
/// A subnormal number becomes the zero of its sign.
inline uint32_t flushed(uint32_t a) { return (a & kInfinity) == 0 ? a & kSign : a; }
/// An operand as the unit sees it: what is below its significand counts as zero.
inline uint32_t operand(uint32_t a, Mode mode) {
  a &= ~uint32_t{0} << (kFullSignificand - mode.significand);
  return flushes(mode) ? flushed(a) : a;
}
inline uint32_t canonical(float value) {
  const uint32_t bits = as_bits(value);
  return is_nan(bits) ? kQuietNan : bits;
}
/// Integers in the order of the numbers, -0 before +0. Not for NaNs.
inline int32_t order(uint32_t a) { return static_cast<int32_t>(a & kSign ? a ^ kMagnitude : a); }
/// The `flush` result for the correctly rounded `rounded` of the same sign; `exact` is the true value, or one on the
/// same side of kTinyLimit.
inline uint32_t flush_tiny(uint32_t rounded, double exact) {
  if ((rounded & kMagnitude) == kSmallestNormal && std::fabs(exact) < kTinyLimit) return rounded & kSign;
  return flushed(rounded);
}
/// The same for x * y + z: a double may not hold its exact value.
inline uint32_t flush_tiny_sum(uint32_t rounded, float x, float y, float z) {
  if ((rounded & kMagnitude) != kSmallestNormal) return flushed(rounded);
  // Knuth's two-sum: product + z = sum + rest exactly.
  const double product = double{x} * double{y}, addend = z;
  const double sum = product + addend;
  const double virtual_addend = sum - product;
  const double rest = (product - (sum - virtual_addend)) + (addend - virtual_addend);
  const double beyond = rounded & kSign ? -rest : rest;
  const double magnitude = std::fabs(sum);
  return magnitude < kTinyLimit || (magnitude == kTinyLimit && beyond < 0) ? rounded & kSign : rounded;
}

/// `value` with a significand of less than 24 bits, rounded to nearest even; subnormal numbers as the mode has them.
/// Of sums, products, quotients and roots the host's double is enough, although it is rounded too: it has two bits more
/// than twice as many (Figueroa, When is double rounding innocuous?, 1995).
uint32_t narrowed(double value, Mode mode);
/// x * y + z, rounded once, likewise.
uint32_t narrowed_sum(float x, float y, float z, Mode mode);

}  // namespace detail

inline uint32_t add(uint32_t a, uint32_t b, Mode mode) {
  const float x = as_float(detail::operand(a, mode)), y = as_float(detail::operand(b, mode));
  if (mode.narrow()) return detail::narrowed(double{x} + double{y}, mode);
  const uint32_t sum = detail::canonical(x + y);
  return detail::operand(sum, mode);  // a subnormal sum is exact, so there is no rounding to look behind
}

inline uint32_t sub(uint32_t a, uint32_t b, Mode mode) {
  const float x = as_float(detail::operand(a, mode)), y = as_float(detail::operand(b, mode));
  if (mode.narrow()) return detail::narrowed(double{x} - double{y}, mode);
  const uint32_t sum = detail::canonical(x - y);
  return detail::operand(sum, mode);
}

inline uint32_t mul(uint32_t a, uint32_t b, Mode mode) {
  const float x = as_float(detail::operand(a, mode)), y = as_float(detail::operand(b, mode));
  if (mode.narrow()) return detail::narrowed(double{x} * double{y}, mode);
  const uint32_t product = detail::canonical(x * y);
  return detail::flushes(mode) ? detail::flush_tiny(product, double{x} * double{y})
                               : product;  // the double product is exact
}

/// a * b + c, rounded once.
inline uint32_t fma(uint32_t a, uint32_t b, uint32_t c, Mode mode) {
  const float x = as_float(detail::operand(a, mode)), y = as_float(detail::operand(b, mode));
  const float z = as_float(detail::operand(c, mode));
  if (mode.narrow()) return detail::narrowed_sum(x, y, z, mode);
  const uint32_t rounded = detail::canonical(std::fma(x, y, z));
  return detail::flushes(mode) ? detail::flush_tiny_sum(rounded, x, y, z) : rounded;
}

/// a * b + c as the machine of this mode computes it: rounded once if it can, else twice.
inline uint32_t muladd(uint32_t a, uint32_t b, uint32_t c, Mode mode) {
  return mode.fused ? fma(a, b, c, mode) : add(mul(a, b, mode), c, mode);
}

inline uint32_t min(uint32_t a, uint32_t b, Mode mode) {
  a = detail::operand(a, mode), b = detail::operand(b, mode);
  if (detail::is_nan(a)) return detail::is_nan(b) ? kQuietNan : b;
  return detail::is_nan(b) || detail::order(a) <= detail::order(b) ? a : b;
}

inline uint32_t max(uint32_t a, uint32_t b, Mode mode) {
  a = detail::operand(a, mode), b = detail::operand(b, mode);
  if (detail::is_nan(a)) return detail::is_nan(b) ? kQuietNan : b;
  return detail::is_nan(b) || detail::order(a) >= detail::order(b) ? a : b;
}

/// Signed, to nearest even.
inline uint32_t from_int(uint32_t a, Mode mode) {
  const auto value = static_cast<int32_t>(a);
  return mode.narrow() ? detail::narrowed(value, mode) : as_bits(static_cast<float>(value));
}

/// Towards zero, saturating; NaN gives 0.
inline uint32_t to_int(uint32_t a, Mode mode) {
  a = detail::operand(a, mode);
  if (detail::is_nan(a)) return 0;
  const float value = as_float(a);
  if (value >= 0x1p31f) return 0x7fffffffu;
  if (value < -0x1p31f) return 0x80000000u;
  return static_cast<uint32_t>(static_cast<int32_t>(value));
}

inline bool equal(uint32_t a, uint32_t b, Mode mode) {  ///< false with a NaN
  return as_float(detail::operand(a, mode)) == as_float(detail::operand(b, mode));
}
inline bool not_equal(uint32_t a, uint32_t b, Mode mode) { return !equal(a, b, mode); }  ///< true with a NaN
inline bool less(uint32_t a, uint32_t b, Mode mode) {                                    ///< false with a NaN
  return as_float(detail::operand(a, mode)) < as_float(detail::operand(b, mode));
}
inline bool less_equal(uint32_t a, uint32_t b, Mode mode) {  ///< false with a NaN
  return as_float(detail::operand(a, mode)) <= as_float(detail::operand(b, mode));
}
inline bool greater(uint32_t a, uint32_t b, Mode mode) { return less(b, a, mode); }
inline bool greater_equal(uint32_t a, uint32_t b, Mode mode) { return less_equal(b, a, mode); }

// The slow unit. Exact: each correctly rounded. Newton modes: what the RTL's table and steps give, which
// docs/machine/float-units.md defines. Zeros, infinities, NaNs and powers of four under rsqrt are exact in every mode.
uint32_t div(uint32_t a, uint32_t b, Mode mode);
uint32_t sqrt(uint32_t a, Mode mode);
uint32_t rsqrt(uint32_t a, Mode mode);  ///< one rounding; rsqrt(+-0) = +-infinity
uint32_t rcp(uint32_t a, Mode mode);

}  // namespace raypool::arith
