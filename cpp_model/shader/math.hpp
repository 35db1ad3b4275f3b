// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// GLSL's functions in the kernel language: short sequences of instructions without tables. Each takes the kernel first.
//
// Errors are in units in the last place (ulp) of the result, with SlowUnit::Exact and 24 bits of significand; the
// Newton units add the error of their divisions and roots, a shorter significand its roundings. NaN gives NaN, and
// infinities and zeros give what C's functions of the same names give, except where a comment says otherwise. Every
// function treats a subnormal operand either as the number that it is or as a zero.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "kernel/kernel.hpp"

namespace raypool::shader::math {

template <typename K>
struct Pair {
  typename K::Float x, y;
};
template <typename K>
struct Quad {
  typename K::Float x, y, z, w;
};

namespace detail {

inline constexpr uint32_t kSign = 0x80000000u;
inline constexpr uint32_t kMagnitude = 0x7fffffffu;
inline constexpr uint32_t kInfinity = 0x7f800000u;
inline constexpr float kSmallestNormal = 0x1p-126f;
inline constexpr float kInfinite = std::numeric_limits<float>::infinity();
inline constexpr float kPi = 3.14159265f;
inline constexpr float kHalfPi = 1.57079633f;
/// pi is kPiHigh + kPiLow. The high part has 8 bits: its product with an integer below 2^16 is exact.
inline constexpr float kPiHigh = 3.140625f;
inline constexpr float kPiLow = 9.67653590e-4f;
inline constexpr float kLog2E = 1.44269504f;
inline constexpr float kLn2 = 0.693147181f;
/// From here on every float is an integer.
inline constexpr float kNoFraction = 0x1p23f;

/// c[0] + c[1] x + c[2] x^2 + ...
template <typename K, size_t kTerms>
typename K::Float polynomial(const typename K::Float& x, const float (&c)[kTerms]) {
  using Float = typename K::Float;
  Float sum = multiply_add(x, c[kTerms - 1], c[kTerms - 2]);
  for (size_t i = kTerms - 2; i-- > 0;) sum = multiply_add(sum, x, c[i]);
  return sum;
}

template <typename K>
typename K::Int sign_of(const typename K::Float& x) {
  return as_int(x) & kSign;
}
/// `magnitude`, which has no sign, with the sign of x.
template <typename K>
typename K::Float with_sign_of(const typename K::Float& magnitude, const typename K::Float& x) {
  return as_float(as_int(magnitude) | sign_of<K>(x));
}
/// `value` with its sign changed where x has one.
template <typename K>
typename K::Float times_sign_of(const typename K::Float& value, const typename K::Float& x) {
  return as_float(as_int(value) ^ sign_of<K>(x));
}

/// sin(r) / r, of r^2 in 0 .. (pi/2)^2.
template <typename K>
typename K::Float sine_ratio(const typename K::Float& square) {
  return polynomial<K>(square, {1.0f, -0.166666597f, 0.00833306927f, -0.000198097739f, 2.60608181e-06f});
}
/// atan(t) of t in 0 .. 1.
template <typename K>
typename K::Float arc_tangent(const typename K::Float& t) {
  return t * polynomial<K>(t * t, {1.0f, -0.333284914f, 0.198978648f, -0.135445297f, 0.0848399624f, -0.037795607f,
                                   0.00810594577f});
}

}  // namespace detail

// Rounding. A result of zero is +0. Numbers from 2^23 on, infinities and NaNs are returned as they are.

template <typename K>
typename K::Float trunc(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float truncated = to_float(to_int(x));
  return select(abs(x) < detail::kNoFraction, truncated, x);
}
template <typename K>
typename K::Float floor(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  Float result = x;
  k.if_(abs(x) < detail::kNoFraction, [&] {
    result = to_float(to_int(x));
    k.if_(result > x, [&] { result -= 1.0f; });
  });
  return result;
}
template <typename K>
typename K::Float ceil(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  Float result = x;
  k.if_(abs(x) < detail::kNoFraction, [&] {
    result = to_float(to_int(x));
    k.if_(result < x, [&] { result += 1.0f; });
  });
  return result;
}
/// To the nearest integer, a tie to the even one: GLSL's round() and roundEven(). Keeps the sign of zeros. Needs a
/// significand of 24 bits.
template <typename K>
typename K::Float round(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float magnitude = abs(x);
  const Float rounded = (magnitude + detail::kNoFraction) - detail::kNoFraction;
  return select(magnitude < detail::kNoFraction, detail::with_sign_of<K>(rounded, x), x);
}
/// x - floor(x). 1 where x is below 0 by less than half a unit in the last place of 1; NaN of infinities.
template <typename K>
typename K::Float fract(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float whole = math::floor(k, x);
  return x - whole;
}
/// x - trunc(x), what modf() returns beside trunc(x); NaN of infinities.
template <typename K>
typename K::Float modf_fraction(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float whole = math::trunc(k, x);
  return x - whole;
}
/// x - y floor(x / y): GLSL's mod(), with the sign of y.
template <typename K>
typename K::Float mod(K& k, const typename K::Float& x, const typename K::Float& y) {
  using Float = typename K::Float;
  const Float quotient = math::floor(k, x / y);
  return x - y * quotient;
}
/// x - y trunc(x / y): SPIR-V's OpFRem, with the sign of x.
template <typename K>
typename K::Float rem(K& k, const typename K::Float& x, const typename K::Float& y) {
  using Float = typename K::Float;
  const Float quotient = math::trunc(k, x / y);
  return x - y * quotient;
}

// Selection

template <typename K>
typename K::Float abs(K&, const typename K::Float& x) {
  return abs(x);
}
template <typename K>
typename K::Int abs(K&, const typename K::Int& x) {
  return max(x, -x);
}
/// -1, 0 or 1; 0 of a NaN.
template <typename K>
typename K::Float sign(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  Float result(0.0f);
  k.if_(x > 0.0f, [&] { result = 1.0f; });
  k.if_(x < 0.0f, [&] { result = -1.0f; });
  return result;
}
template <typename K>
typename K::Int sign(K&, const typename K::Int& x) {
  return max(min(x, 1), -1);
}
/// The number if one operand is a NaN: GLSL's min() and SPIR-V's NMin.
template <typename K>
typename K::Float min(K&, const typename K::Float& x, const typename K::Float& y) {
  return min(x, y);
}
template <typename K>
typename K::Float max(K&, const typename K::Float& x, const typename K::Float& y) {
  return max(x, y);
}
/// `least` of a NaN: GLSL's clamp() and SPIR-V's NClamp.
template <typename K>
typename K::Float clamp(K&, const typename K::Float& x, const typename K::Float& least,
                        const typename K::Float& largest) {
  return min(max(x, least), largest);
}
template <typename K>
typename K::Int clamp(K&, const typename K::Int& x, const typename K::Int& least, const typename K::Int& largest) {
  return min(max(x, least), largest);
}
template <typename K>
typename K::Int clamp_unsigned(K&, const typename K::Int& x, const typename K::Int& least,
                               const typename K::Int& largest) {
  return min_unsigned(max_unsigned(x, least), largest);
}
/// 0 where x < edge, else 1.
template <typename K>
typename K::Float step(K& k, const typename K::Float& edge, const typename K::Float& x) {
  using Float = typename K::Float;
  Float result(1.0f);
  k.if_(x < edge, [&] { result = 0.0f; });
  return result;
}
/// 0 of a NaN.
template <typename K>
typename K::Float smoothstep(K&, const typename K::Float& low, const typename K::Float& high,
                             const typename K::Float& x) {
  using Float = typename K::Float;
  const Float range = high - low;
  const Float t = min(max((x - low) / range, 0.0f), 1.0f);
  const Float slope = multiply_add(t, -2.0f, 3.0f);
  return t * t * slope;
}
/// x + a (y - x), which is x for a = 0, and y but for a rounding for a = 1.
template <typename K>
typename K::Float mix(K&, const typename K::Float& x, const typename K::Float& y, const typename K::Float& a) {
  using Float = typename K::Float;
  const Float difference = y - x;
  return multiply_add(a, difference, x);
}
template <typename K>
typename K::Bool isnan(K&, const typename K::Float& x) {
  return x != x;  // NOLINT(misc-redundant-expression): of NaN alone
}
template <typename K>
typename K::Bool isinf(K&, const typename K::Float& x) {
  return (as_int(x) & detail::kMagnitude) == detail::kInfinity;
}

// Roots and angles

/// Half an ulp.
template <typename K>
typename K::Float sqrt(K&, const typename K::Float& x) {
  return sqrt(x);
}
/// Half an ulp.
template <typename K>
typename K::Float inversesqrt(K&, const typename K::Float& x) {
  return rsqrt(x);
}
template <typename K>
typename K::Float radians(K&, const typename K::Float& degrees) {
  return degrees * 0.0174532925f;
}
template <typename K>
typename K::Float degrees(K&, const typename K::Float& radians) {
  return radians * 57.2957795f;
}

/// Absolute error below 2^-22 for |x| up to 2^13, and below |x| 2^-22 up to 2^22; further on the machine's floats do
/// not hold x modulo pi well enough, and the result, at most about 1.2, is soon 0. NaN of infinities.
template <typename K>
typename K::Float sin(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Float half = detail::with_sign_of<K>(0.5f, x);
  const Int turns = to_int(multiply_add(x, 0.318309886f, half));  // half ones
  const Float whole = to_float(turns);
  Float rest = multiply_add(whole, -detail::kPiHigh, x);
  rest = multiply_add(whole, -detail::kPiLow, rest);
  const Float square = rest * rest;
  const Float result = as_float(as_int(rest * detail::sine_ratio<K>(square)) ^ (turns << 31));
  return select(square > 4.0f, x - x, result);  // NOLINT(misc-redundant-expression): 0, or NaN
}
/// As sin().
template <typename K>
typename K::Float cos(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Float magnitude = abs(x);
  // |x| = (turns - 1/2) pi + rest
  const Int turns = to_int(multiply_add(magnitude, 0.318309886f, 1.0f));
  const Float whole = to_float(turns) - 0.5f;
  Float rest = multiply_add(whole, -detail::kPiHigh, magnitude);
  rest = multiply_add(whole, -detail::kPiLow, rest);
  const Float square = rest * rest;
  const Float result = as_float(as_int(rest * detail::sine_ratio<K>(square)) ^ (turns << 31));
  return select(square > 4.0f, x - x, result);  // NOLINT(misc-redundant-expression): 0, or NaN
}
/// 4 ulp for |x| up to pi/4; beyond, the tangent of an x that is off by less than 2^-23, or |x| 2^-23 from 2^12 on.
/// Soon 0 beyond 2^22, NaN of infinities.
template <typename K>
typename K::Float tan(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  using Bool = typename K::Bool;
  const Float half = detail::with_sign_of<K>(0.5f, x);
  const Int turns = to_int(multiply_add(x, 0.636619772f, half));  // quarters
  const Float whole = to_float(turns);
  Float rest = multiply_add(whole, -0.5f * detail::kPiHigh, x);
  rest = multiply_add(whole, -0.5f * detail::kPiLow, rest);
  const Float square = rest * rest;
  const Float sine = rest * multiply_add(square, -0.0957806557f, 1.0f);
  const Float cosine = detail::polynomial<K>(square, {1.0f, -0.429114491f, 0.00970926974f});
  const Int odd = turns << 31;
  const Bool is_odd = odd < 0;
  const Float numerator = select(is_odd, cosine, sine);
  const Float denominator = select(is_odd, sine, cosine);
  const Float result = as_float(as_int(numerator / denominator) ^ odd);
  return select(square > 1.0f, x - x, result);  // NOLINT(misc-redundant-expression): 0, or NaN
}
/// 5 ulp. NaN beyond -1 .. 1.
template <typename K>
typename K::Float asin(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  using Bool = typename K::Bool;
  // Of a number above 1/2: pi/2 - 2 asin(sqrt((1 - x) / 2))
  const Float magnitude = abs(x);
  const Bool large = magnitude > 0.5f;
  Float square = multiply_add(magnitude, -0.5f, 0.5f);
  const Float sine = select(large, sqrt(square), magnitude);
  square = select(large, square, x * x);
  const Float angle =
      sine * detail::polynomial<K>(square, {1.0f, 0.166655704f, 0.0754081309f, 0.0400122143f, 0.0500073433f});
  const Float rest = multiply_add(angle, -2.0f, detail::kHalfPi);
  return detail::times_sign_of<K>(select(large, rest, angle), x);
}
/// 16 ulp. NaN beyond -1 .. 1.
template <typename K>
typename K::Float acos(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float magnitude = abs(x);
  const Float root = sqrt(1.0f - magnitude);
  Float angle = root * detail::polynomial<K>(magnitude, {1.57079518f, -0.214509994f, 0.087855801f, -0.0448994674f,
                                                         0.0192807149f, -0.00430973107f});
  k.if_(x < 0.0f, [&] { angle = detail::kPi - angle; });
  return angle;
}
/// 16 ulp.
template <typename K>
typename K::Float atan(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float magnitude = abs(x);
  const Float tangent = min(magnitude, rcp(magnitude));
  Float angle = detail::arc_tangent<K>(tangent);
  k.if_(magnitude > 1.0f, [&] { angle = detail::kHalfPi - angle; });
  return detail::with_sign_of<K>(angle, x);
}
/// The angle of (x, y): GLSL's atan(y, x). 16 ulp where neither is subnormal. Zeros as C has it: atan2(0, -0) is pi.
/// NaN of two infinities; a NaN beside a number may give a number.
template <typename K>
typename K::Float atan2(K& k, const typename K::Float& y, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float width = abs(x);
  const Float height = abs(y);
  const Float larger = max(max(width, height), detail::kSmallestNormal);
  Float angle = detail::arc_tangent<K>(min(width, height) / larger);
  k.if_(height > width, [&] { angle = detail::kHalfPi - angle; });
  k.if_(as_int(x) < 0, [&] { angle = detail::kPi - angle; });
  return detail::with_sign_of<K>(angle, y);
}

// Exponentials

/// 2 ulp; 0 where the result is below 2^-126.5. From 2^127.5 on 100 ulp. Powers of integers are exact.
template <typename K>
typename K::Float exp2(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  Float exponent = x;
  k.if_(x < -127.0f, [&] { exponent = -127.0f; });
  const Int biased = min(to_int(exponent + 127.5f), 254);  // rounded to nearest
  const Float fraction = exponent - (to_float(biased) - 127.0f);
  const Float power = detail::polynomial<K>(
      fraction, {1.0f, 0.693147182f, 0.240226507f, 0.0555033907f, 0.00961774401f, 0.0013399804f, 0.000155766626f});
  return power * as_float(biased << 23);
}
/// 3 + |x| ulp; 0 where the result is below 2^-126.5.
template <typename K>
typename K::Float exp(K& k, const typename K::Float& x) {
  return math::exp2(k, x * detail::kLog2E);
}
/// 3 ulp, but in 1/2 .. 2 at most 5 ulp of the result and 2^-22 absolutely. -infinity of zeros and subnormal numbers,
/// NaN of numbers below zero.
template <typename K>
typename K::Float log2(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  // x = 2^e m with m in sqrt(1/2) .. sqrt(2), and log(m) = 2 artanh((m - 1) / (m + 1))
  const Int exponent = (as_int(x) - 0x3f3504f3) & 0xff800000u;
  const Float mantissa = as_float(as_int(x) - exponent);
  const Float ratio = (mantissa - 1.0f) / (mantissa + 1.0f);
  const Float factor = detail::polynomial<K>(ratio * ratio, {2.88539052f, 0.961566806f, 0.596460104f});
  Float result = multiply_add(ratio, factor, to_float(exponent >> 23));
  result = select(x >= detail::kSmallestNormal, result, -detail::kInfinite);
  k.if_(x < 0.0f, [&] { result = std::numeric_limits<float>::quiet_NaN(); });
  return select(x < detail::kInfinite, result, x);
}
/// As log2(), with 6 ulp in 1/2 .. 2 and 4 elsewhere.
template <typename K>
typename K::Float log(K& k, const typename K::Float& x) {
  return math::log2(k, x) * detail::kLn2;
}
/// exp2(y log2(x)): NaN where x < 0, or where both are zero.
template <typename K>
typename K::Float pow(K& k, const typename K::Float& x, const typename K::Float& y) {
  return math::exp2(k, y * math::log2(k, x));
}
/// Absolute error 2^-23 near 0, 2 + 2|x| ulp where |x| is 1 or above.
template <typename K>
typename K::Float sinh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float half_power =
      math::exp2(k, multiply_add(abs(x), detail::kLog2E, -1.0f));  // no overflow before the result's
  const Float result = multiply_add(rcp(half_power), -0.25f, half_power);
  return detail::times_sign_of<K>(result, x);
}
/// 4 + 2|x| ulp.
template <typename K>
typename K::Float cosh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float half_power = math::exp2(k, multiply_add(abs(x), detail::kLog2E, -1.0f));
  return multiply_add(rcp(half_power), 0.25f, half_power);
}
/// Absolute error 2^-22.
template <typename K>
typename K::Float tanh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float power = math::exp2(k, x * (2.0f * detail::kLog2E));
  return multiply_add(rcp(power + 1.0f), -2.0f, 1.0f);
}
/// Absolute error 2^-22 near 0, 4 ulp where |x| is 1 or above; infinite from 2^64 on.
template <typename K>
typename K::Float asinh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float magnitude = abs(x);
  const Float root = sqrt(multiply_add(magnitude, magnitude, 1.0f));
  return detail::times_sign_of<K>(math::log(k, magnitude + root), x);
}
/// Absolute error 2^-22 near 1, 4 ulp where x is 2 or above; infinite from 2^64 on. NaN below 1.
template <typename K>
typename K::Float acosh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float below = x - 1.0f;
  const Float root = sqrt(below * (x + 1.0f));
  return math::log(k, x + root);
}
/// Absolute error 2^-22 near 0, 6 ulp where |x| is 1/2 or above. NaN beyond -1 .. 1.
template <typename K>
typename K::Float atanh(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  const Float above = x + 1.0f;
  return math::log2(k, above / (1.0f - x)) * (0.5f * detail::kLn2);
}

// Parts of floats

/// x 2^n, for n up to 254 (GLSL leaves it open above 128).
template <typename K>
typename K::Float ldexp(K&, const typename K::Float& x, const typename K::Int& n) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  // In two steps, since no float is 2^128; the first has the smaller half of a negative n.
  const Int exponent = min(max(n, -252), 254);
  const Int half = exponent >> 1;
  const Float first = x * as_float((half + 127) << 23);
  return first * as_float((exponent - half + 127) << 23);
}
/// What frexp() returns: x with the exponent of 1/2. Zeros, subnormal numbers, infinities and NaNs as they are.
template <typename K>
typename K::Float frexp_significand(K&, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Int field = as_int(x) & detail::kInfinity;
  const Float significand = as_float(((as_int(x) ^ field)) | 0x3f000000);
  return select(less_unsigned(field - 0x00800000, typename K::Int(0x7f000000)), significand, x);
}
/// The exponent n beside it, x = significand 2^n; 0 of zeros, subnormal numbers, infinities and NaNs.
template <typename K>
typename K::Int frexp_exponent(K&, const typename K::Float& x) {
  using Int = typename K::Int;
  const Int field = as_int(x) & detail::kInfinity;
  const Int exponent = shift_right_logical(field, typename K::Int(23)) - 126;
  return select(less_unsigned(field - 0x00800000, typename K::Int(0x7f000000)), exponent, typename K::Int(0));
}

// Conversions

/// The float of an unsigned integer, rounded once.
template <typename K>
typename K::Float unsigned_to_float(K&, const typename K::Int& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Float low = to_float(x & 0xffff);
  const Float high = to_float(shift_right_logical(x, Int(16)));
  return multiply_add(high, 65536.0f, low);
}
/// Towards zero, at most 2^32 - 1; NaN gives 0. Numbers below zero become signed integers, as in C.
template <typename K>
typename K::Int float_to_unsigned(K& k, const typename K::Float& x) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  using Bool = typename K::Bool;
  const Bool large = x >= 0x1p31f;
  Float rest = x;
  k.if_(large, [&] { rest -= 0x1p31f; });
  Int result = to_int(rest);
  k.if_(large, [&] { result = result ^ detail::kSign; });
  return result;
}

namespace detail {

// To nearest; a tie may go either way. NaN gives the least.
template <typename K>
typename K::Int unorm(const typename K::Float& x, float scale) {
  return to_int(multiply_add(min(max(x, 0.0f), 1.0f), scale, 0.5f));
}
/// With `scale` + 1 added.
template <typename K>
typename K::Int snorm(const typename K::Float& x, float scale) {
  return to_int(multiply_add(min(max(x, -1.0f), 1.0f), scale, scale + 1.5f));
}
template <typename K>
typename K::Float from_snorm(const typename K::Int& value, float scale) {
  return max(to_float(value) * (1.0f / scale), -1.0f);
}
/// 16 bits of a half float, to nearest even.
template <typename K>
typename K::Int half(K& k, const typename K::Float& x) {
  using Int = typename K::Int;
  const Int magnitude = as_int(x) & kMagnitude;
  // A sum with 1/2 has 2^-24, the least half float, as its last bit.
  const Int subnormal = as_int(as_float(magnitude) + 0.5f) - 0x3f000000;
  const Int capped = min(magnitude, 0x47800000);  // 2^16
  const Int odd = shift_right_logical(capped, Int(13)) & 1;
  const Int normal = shift_right_logical(odd + (capped + 0xc8000fffu), Int(13));
  Int bits = select(magnitude < 0x38800000, subnormal, normal);
  k.if_(magnitude > kInfinity, [&] { bits = 0x7e00; });
  return bits | (shift_right_logical(as_int(x), Int(16)) & 0x8000);
}
/// The float of a half float's bits 14:0, which are in 27:13, and of a sign in bit 31.
template <typename K>
typename K::Float from_half(K& k, const typename K::Int& magnitude, const typename K::Int& sign) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  Int bits = magnitude + 0x38000000;
  k.if_(magnitude >= 0x0f800000, [&] { bits += 0x38000000; });  // infinity, NaN
  const Float subnormal = to_float(magnitude) * 0x1p-37f;
  const Float result = select(magnitude < 0x00800000, subnormal, as_float(bits));
  return as_float(as_int(result) | sign);
}

}  // namespace detail

/// To nearest even; x in the low half.
template <typename K>
typename K::Int pack_half_2x16(K& k, const typename K::Float& x, const typename K::Float& y) {
  using Int = typename K::Int;
  const Int high = detail::half(k, y) << 16;
  return high | detail::half(k, x);
}
template <typename K>
Pair<K> unpack_half_2x16(K& k, const typename K::Int& bits) {
  using Float = typename K::Float;
  Float x = detail::from_half(k, (bits & 0x7fff) << 13, (bits << 16) & detail::kSign);
  Float y = detail::from_half(k, (bits >> 3) & 0x0fffe000, bits & detail::kSign);
  return {std::move(x), std::move(y)};
}
/// To nearest, a tie either way; a value within 2^-8 of a tie may be taken for one in the 16-bit functions, within
/// 2^-16 in the 8-bit functions.
template <typename K>
typename K::Int pack_unorm_2x16(K&, const typename K::Float& x, const typename K::Float& y) {
  using Int = typename K::Int;
  const Int low = detail::unorm<K>(x, 65535.0f);
  return (detail::unorm<K>(y, 65535.0f) << 16) | low;
}
template <typename K>
typename K::Int pack_snorm_2x16(K&, const typename K::Float& x, const typename K::Float& y) {
  using Int = typename K::Int;
  const Int low = detail::snorm<K>(x, 32767.0f);
  return ((detail::snorm<K>(y, 32767.0f) << 16) | low) ^ 0x80008000u;
}
template <typename K>
typename K::Int pack_unorm_4x8(K&, const typename K::Float& x, const typename K::Float& y, const typename K::Float& z,
                               const typename K::Float& w) {
  using Int = typename K::Int;
  Int bits = (detail::unorm<K>(w, 255.0f) << 8) | detail::unorm<K>(z, 255.0f);
  bits = (bits << 8) | detail::unorm<K>(y, 255.0f);
  return (bits << 8) | detail::unorm<K>(x, 255.0f);
}
template <typename K>
typename K::Int pack_snorm_4x8(K&, const typename K::Float& x, const typename K::Float& y, const typename K::Float& z,
                               const typename K::Float& w) {
  using Int = typename K::Int;
  Int bits = (detail::snorm<K>(w, 127.0f) << 8) | detail::snorm<K>(z, 127.0f);
  bits = (bits << 8) | detail::snorm<K>(y, 127.0f);
  return ((bits << 8) | detail::snorm<K>(x, 127.0f)) ^ 0x80808080u;
}
/// 1 ulp, like the three below.
template <typename K>
Pair<K> unpack_unorm_2x16(K&, const typename K::Int& bits) {
  using Int = typename K::Int;
  constexpr float kUnit = 1.0f / 65535.0f;
  return {to_float(bits & 0xffff) * kUnit, to_float(shift_right_logical(bits, Int(16))) * kUnit};
}
template <typename K>
Pair<K> unpack_snorm_2x16(K&, const typename K::Int& bits) {
  return {detail::from_snorm<K>((bits << 16) >> 16, 32767.0f), detail::from_snorm<K>(bits >> 16, 32767.0f)};
}
template <typename K>
Quad<K> unpack_unorm_4x8(K&, const typename K::Int& bits) {
  using Int = typename K::Int;
  constexpr float kUnit = 1.0f / 255.0f;
  return {to_float(bits & 255) * kUnit, to_float(shift_right_logical(bits, Int(8)) & 255) * kUnit,
          to_float(shift_right_logical(bits, Int(16)) & 255) * kUnit,
          to_float(shift_right_logical(bits, Int(24))) * kUnit};
}
template <typename K>
Quad<K> unpack_snorm_4x8(K&, const typename K::Int& bits) {
  return {detail::from_snorm<K>((bits << 24) >> 24, 127.0f), detail::from_snorm<K>((bits << 16) >> 24, 127.0f),
          detail::from_snorm<K>((bits << 8) >> 24, 127.0f), detail::from_snorm<K>(bits >> 24, 127.0f)};
}

// Bits of integers

/// Number of the lowest bit that is 1; -1 of 0.
template <typename K>
typename K::Int find_lsb(K&, const typename K::Int& x) {
  using Int = typename K::Int;
  const Int field = as_int(to_float(x & -x)) & detail::kInfinity;  // bit 31 alone becomes -2^31
  return max(shift_right_logical(field, Int(23)) - 127, -1);
}

namespace detail {

/// Number of the highest bit that is 1 of a signed integer that is not negative; -1 of 0.
template <typename K>
typename K::Int highest_bit(const typename K::Int& x) {
  using Int = typename K::Int;
  // The bit below the highest one is cleared, so that the conversion does not round up to the next power of two.
  const Int cleared = x & ~(x >> 1);
  return max((as_int(to_float(cleared)) >> 23) - 127, -1);
}

}  // namespace detail

/// Number of the highest bit that is 1; -1 of 0.
template <typename K>
typename K::Int find_umsb(K& k, const typename K::Int& x) {
  using Int = typename K::Int;
  Int result = detail::highest_bit<K>(x);
  k.if_(x < 0, [&] { result = 31; });
  return result;
}
/// Number of the highest bit that differs from the sign; -1 of 0 and -1.
template <typename K>
typename K::Int find_smsb(K&, const typename K::Int& x) {
  return detail::highest_bit<K>(x ^ (x >> 31));
}
template <typename K>
typename K::Int bit_count(K&, const typename K::Int& x) {
  using Int = typename K::Int;
  Int sum = x - (shift_right_logical(x, Int(1)) & 0x55555555);
  sum = (sum & 0x33333333) + (shift_right_logical(sum, Int(2)) & 0x33333333);
  sum = (sum + shift_right_logical(sum, Int(4))) & 0x0f0f0f0f;
  return shift_right_logical(sum * 0x01010101, Int(24));
}
template <typename K>
typename K::Int bit_reverse(K&, const typename K::Int& x) {
  using Int = typename K::Int;
  Int bits = (x << 16) | shift_right_logical(x, Int(16));
  constexpr uint32_t kMasks[] = {0x00ff00ffu, 0x0f0f0f0fu, 0x33333333u, 0x55555555u};
  int distance = 8;
  for (const uint32_t mask : kMasks) {
    bits = ((bits & mask) << distance) | (shift_right_logical(bits, Int(distance)) & mask);
    distance >>= 1;
  }
  return bits;
}
/// 0 for no bits. Undefined where offset + bits is above 32, like the two below.
template <typename K>
typename K::Int bitfield_extract_signed(K& k, const typename K::Int& value, const typename K::Int& offset,
                                        const typename K::Int& bits) {
  using Int = typename K::Int;
  const Int unused = 32 - bits;
  Int result = (value << (unused - offset)) >> unused;
  k.if_(bits == 0, [&] { result = 0; });
  return result;
}
template <typename K>
typename K::Int bitfield_extract_unsigned(K& k, const typename K::Int& value, const typename K::Int& offset,
                                          const typename K::Int& bits) {
  using Int = typename K::Int;
  const Int unused = 32 - bits;
  Int result = shift_right_logical(value << (unused - offset), unused);
  k.if_(bits == 0, [&] { result = 0; });
  return result;
}
/// `base` with the bits from `offset` on from `insert`.
template <typename K>
typename K::Int bitfield_insert(K& k, const typename K::Int& base, const typename K::Int& insert,
                                const typename K::Int& offset, const typename K::Int& bits) {
  using Int = typename K::Int;
  Int mask = shift_right_logical(Int(~0u), 32 - bits);
  k.if_(bits == 0, [&] { mask = 0; });
  return base ^ (((insert << offset) ^ base) & (mask << offset));
}

// Division of integers, exact in every arithmetic mode. A quotient is estimated from below, a few bits at a time, until
// the rest is less than the divisor: log2(quotient) / 6 + 2 rounds of ten instructions at most. Where the divisor is 0,
// which GLSL leaves undefined, the quotient is the dividend.

namespace detail {

/// Leaves the remainder in `rest`, and adds the quotient to *quotient if there is one.
template <typename K>
void divide(K& k, typename K::Int& rest, const typename K::Int& divisor, const typename K::Float& scale,
            typename K::Int* quotient) {
  using Int = typename K::Int;
  k.while_([&] { return less_equal_unsigned(divisor, rest); },
           [&] {
             const Int estimate = to_int(to_float(shift_right_logical(rest, Int(1))) * scale);
             const Int part = max(estimate, 1);
             if (quotient != nullptr) *quotient += part;
             rest -= part * divisor;
           });
}
/// 2 / divisor, too small by one part in 64, which is more than the units of all modes are off.
template <typename K>
typename K::Float division_scale(K& k, const typename K::Int& divisor) {
  using Float = typename K::Float;
  Float result = to_float(divisor);
  k.if_(divisor < 0, [&] { result += 0x1p32f; });
  return rcp(result) * 1.96875f;
}

}  // namespace detail

template <typename K>
typename K::Int divide_unsigned(K& k, const typename K::Int& a, const typename K::Int& b) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Int divisor = max_unsigned(b, 1);
  const Float scale = detail::division_scale(k, divisor);
  Int rest = a;
  Int quotient(0);
  detail::divide(k, rest, divisor, scale, &quotient);
  return quotient;
}
template <typename K>
typename K::Int remainder_unsigned(K& k, const typename K::Int& a, const typename K::Int& b) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Int divisor = max_unsigned(b, 1);
  const Float scale = detail::division_scale(k, divisor);
  Int rest = a;
  detail::divide(k, rest, divisor, scale, nullptr);
  return rest;
}
/// Towards zero: GLSL's /.
template <typename K>
typename K::Int divide_signed(K& k, const typename K::Int& a, const typename K::Int& b) {
  using Int = typename K::Int;
  const Int quotient = math::divide_unsigned(k, math::abs(k, a), math::abs(k, b));
  const Int sign = (a ^ b) >> 31;
  return (quotient ^ sign) - sign;
}
/// With the sign of a: SPIR-V's OpSRem.
template <typename K>
typename K::Int remainder_signed(K& k, const typename K::Int& a, const typename K::Int& b) {
  using Int = typename K::Int;
  const Int remainder = math::remainder_unsigned(k, math::abs(k, a), math::abs(k, b));
  const Int sign = a >> 31;
  return (remainder ^ sign) - sign;
}
/// With the sign of b: SPIR-V's OpSMod, which compilers make of GLSL's %.
template <typename K>
typename K::Int modulo_signed(K& k, const typename K::Int& a, const typename K::Int& b) {
  using Int = typename K::Int;
  Int result = math::remainder_signed(k, a, b);
  k.if_(result != 0, [&] { k.if_((result ^ b) < 0, [&] { result += b; }); });
  return result;
}

}  // namespace raypool::shader::math
