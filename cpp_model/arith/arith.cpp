// The slow unit: exact results from the host's double precision, Newton results by the RTL's own integer steps
// (rtl/arith/rp_slow_newton.v).
#include "arith/arith.hpp"

#include <array>
#include <cstring>

#include "bits.hpp"

namespace raypool::arith {

using namespace detail;

namespace {

enum class SlowOperation : uint8_t { Divide, Root, InverseRoot, Reciprocal };

constexpr bool is_root(SlowOperation operation) {
  return operation == SlowOperation::Root || operation == SlowOperation::InverseRoot;
}

/// A finite number other than zero: mantissa * 2^(exponent - 23), mantissa in 2^23 .. 2^24-1.
struct Normalised {
  uint32_t mantissa;
  int exponent;
};

Normalised normalise(uint32_t bits) {
  const uint32_t fraction = bits & 0x007fffffu;
  const int field = static_cast<int>(bits >> 23 & 0xff);
  if (field != 0) return {fraction | 0x00800000u, field - 127};
  const int shift = __builtin_clz(fraction) - 8;
  return {fraction << shift, -126 - shift};
}

// Seeds, 8 bits s of the number (256 + s) / 512. Entry i of the reciprocal table is 1/m for the middle m of
// 1 + i/128 .. 1 + (i+1)/128; entry 64*odd + i of the other one is 1/sqrt(m * (odd ? 2 : 1)) for the
// middle m of 1 + i/64 .. 1 + (i+1)/64.
std::array<uint8_t, 128> make_reciprocal_seeds() {
  std::array<uint8_t, 128> seeds{};
  for (int i = 0; i < 128; ++i) seeds[i] = static_cast<uint8_t>(std::lround(512.0 / (1.0 + (i + 0.5) / 128)) - 256);
  return seeds;
}

std::array<uint8_t, 128> make_inverse_root_seeds() {
  std::array<uint8_t, 128> seeds{};
  for (int i = 0; i < 128; ++i) {
    const double middle = (1.0 + (i % 64 + 0.5) / 64) * (i < 64 ? 1 : 2);
    seeds[i] = static_cast<uint8_t>(std::lround(512.0 / std::sqrt(middle)) - 256);
  }
  return seeds;
}

const std::array<uint8_t, 128> kReciprocalSeeds = make_reciprocal_seeds();
const std::array<uint8_t, 128> kInverseRootSeeds = make_inverse_root_seeds();

/// w/v, or w/sqrt(v) for a root, with 30 fraction bits. v and w have 23; the true
/// result is in 1 .. 2, and so is this one.
uint32_t newton_quotient(uint32_t v, uint32_t w, bool root, SlowUnit steps) {
  constexpr int64_t kOne = 1;
  // y: approximation of 1/v or 1/sqrt(v), first with 9 fraction bits, then with 15.
  const uint32_t seed =
      root ? kInverseRootSeeds[v >> 24 ? 64 + (v >> 18 & 63) : v >> 17 & 63] : kReciprocalSeeds[v >> 16 & 127];
  const int64_t y0 = 256 + seed;
  int64_t y = y0 << 6;
  if (steps != SlowUnit::Newton0) {
    const int64_t t = v * y0;                                   // 32 fraction bits
    const int64_t e = root ? ((kOne << 41) - 1 - t * y0) >> 24  // 18: half of what is missing to 1
                           : ((kOne << 32) - 1 - t) >> 14;
    y = ((y0 << 18) + y0 * e + 2048) >> 12;
  }
  int64_t quotient = w * y >> 8;  // 30 fraction bits
  if (steps == SlowUnit::Newton2) {
    const int64_t t = v * y >> 8;                              // 30
    const int64_t e = root ? ((kOne << 45) - 1 - t * y) >> 18  // 28
                           : ((kOne << 30) - 1 - t) >> 2;
    quotient = ((quotient << 16) + (quotient >> 12) * e) >> 16;
  }
  if (quotient < kOne << 30) return 1u << 30;
  if (quotient >= kOne << 31) return (1u << 31) - 1;
  return static_cast<uint32_t>(quotient);
}

/// 1/sqrt(x) of a positive finite x, correctly rounded.
uint32_t exact_inverse_root(float x) {
  const double estimate = 1.0 / std::sqrt(double{x});
  uint64_t bits;
  std::memcpy(&bits, &estimate, 8);
  // Far enough from the middle between two floats, the double's own error does not matter.
  constexpr uint64_t kBelow = (uint64_t{1} << 29) - 1, kMiddle = uint64_t{1} << 28;
  const uint64_t tail = bits & kBelow;
  if (tail < kMiddle - 16 || tail > kMiddle + 16) return as_bits(static_cast<float>(estimate));
  // Otherwise ask whether middle^2 * x is above 1, in integers: middle has 25 bits, x 24.
  const uint64_t middle = (bits & ((uint64_t{1} << 52) - 1)) >> 28 | uint64_t{1} << 24 | 1;
  const int middle_exponent = static_cast<int>(bits >> 52) - 1023 - 24;
  const Normalised number = normalise(as_bits(x));
  const unsigned __int128 product = static_cast<unsigned __int128>(middle * middle) * number.mantissa;
  const int one = -(2 * middle_exponent + number.exponent - 23);  // the bit of `product` that weighs 1
  const bool above = product >= static_cast<unsigned __int128>(1) << one;
  const uint32_t truncated = static_cast<uint32_t>(((bits >> 52) - 1023 + 127) << 23 | (bits >> 29 & 0x7fffff));
  return above ? truncated : truncated + 1;
}

uint32_t exact(uint32_t a, uint32_t b, SlowOperation operation, Mode mode) {
  const float x = as_float(a), y = as_float(b);
  if (mode.narrow()) {
    // No inverse root is so near to a middle that the two roundings of its double matter: raypool_arith_test goes
    // through all of them.
    if (operation == SlowOperation::InverseRoot) return narrowed(1 / std::sqrt(double{x}), mode);
    return narrowed(operation == SlowOperation::Root ? std::sqrt(double{x}) : double{x} / double{y}, mode);
  }
  switch (operation) {
    case SlowOperation::Root:
      return canonical(std::sqrt(x));
    case SlowOperation::InverseRoot:
      return exact_inverse_root(x);
    default:
      break;
  }
  const uint32_t quotient = canonical(x / y);
  // No quotient of floats is near enough to kTinyLimit for the double's rounding to cross it.
  return flushes(mode) ? flush_tiny(quotient, double{x} / double{y}) : quotient;
}

/// Newton modes: both numbers finite and not zero, x of a root positive; a is 1 for a reciprocal.
uint32_t newton(uint32_t a, uint32_t b, SlowOperation operation, Mode mode) {
  const uint32_t sign = is_root(operation) ? 0 : (a ^ b) & kSign;
  uint32_t v, w;
  int exponent;
  if (is_root(operation)) {
    const Normalised x = normalise(a);
    const int odd = x.exponent & 1;
    const int half = (x.exponent - odd) / 2;
    v = x.mantissa << odd;
    if (operation == SlowOperation::InverseRoot) {
      if (v == 1u << 23) return static_cast<uint32_t>(127 - half) << 23;
      w = 2u << 23;
      exponent = 127 - half - 1;
    } else {
      w = v;
      exponent = 127 + half;
    }
  } else {
    const Normalised n = normalise(a), d = normalise(b);
    const bool smaller = n.mantissa < d.mantissa;
    v = d.mantissa;
    w = n.mantissa << smaller;
    exponent = 127 + n.exponent - d.exponent - smaller;
  }
  if (exponent >= 255) return sign | kInfinity;
  const int below = 24 - static_cast<int>(mode.significand);  // bits of a word that a float lacks
  if (exponent < (flushes(mode) ? 1 : below - 23)) return sign;
  const uint32_t quotient = newton_quotient(v, w, is_root(operation), mode.slow_unit);
  // Round to nearest even at bit 7, or further up for a subnormal result or a shorter significand.
  const int cut = 7 + below + (exponent < 1 ? 1 - exponent : 0);
  const uint64_t half = uint64_t{1} << (cut - 1);
  const uint64_t kept = quotient >> cut;
  const uint64_t tail = quotient & (2 * half - 1);
  const uint64_t magnitude = (exponent < 1 ? 0 : static_cast<uint64_t>(exponent - 1) << (23 - below)) + kept;
  // True quotients are not so near to 2 that a rounding changes the exponent; an estimate may be.
  const uint64_t fraction = 0x007fffffu >> below;
  const bool may_carry = (magnitude & fraction) != fraction;
  const bool up = tail > half || (tail == half && kept % 2 != 0);
  return sign | static_cast<uint32_t>(magnitude + (up && may_carry ? 1 : 0)) << below;
}

uint32_t finite(uint32_t a, uint32_t b, SlowOperation operation, Mode mode) {
  return mode.slow_unit == SlowUnit::Exact ? exact(a, b, operation, mode) : newton(a, b, operation, mode);
}

bool is_zero(uint32_t a) { return (a & kMagnitude) == 0; }
bool is_infinite(uint32_t a) { return (a & kMagnitude) == kInfinity; }

uint32_t quotient_of(uint32_t a, uint32_t b, SlowOperation operation, Mode mode) {
  if (is_nan(a) || is_nan(b)) return kQuietNan;
  const uint32_t sign = (a ^ b) & kSign;
  if (is_zero(a)) return is_zero(b) ? kQuietNan : sign;
  if (is_infinite(a)) return is_infinite(b) ? kQuietNan : sign | kInfinity;
  if (is_infinite(b)) return sign;
  if (is_zero(b)) return sign | kInfinity;
  return finite(a, b, operation, mode);
}

}  // namespace

uint32_t detail::narrowed(double value, Mode mode) {
  if (std::isnan(value)) return kQuietNan;
  uint64_t bits;
  std::memcpy(&bits, &value, 8);
  const auto sign = static_cast<uint32_t>(bits >> 63) << 31;
  const int exponent = static_cast<int>(bits >> 52 & 0x7ff) - 1023;
  if (exponent > 127) return sign | kInfinity;
  const auto significand = static_cast<int>(mode.significand);
  const bool tiny = exponent < -126;
  // The last bits of 53 are rounded away; more of them where the numbers end.
  const int cut = 53 - significand + (tiny && !flushes(mode) ? -126 - exponent : 0);
  if (cut > 53) return sign;
  const uint64_t mantissa = (bits & ((uint64_t{1} << 52) - 1)) | uint64_t{1} << 52;
  const uint64_t half = uint64_t{1} << (cut - 1), tail = mantissa & (2 * half - 1);
  uint64_t kept = mantissa >> cut;
  if (tail > half || (tail == half && kept % 2 != 0)) ++kept;
  const auto aligned = static_cast<uint32_t>(kept << (kFullSignificand - mode.significand));
  if (!tiny) return sign | ((static_cast<uint32_t>(exponent + 126) << 23) + aligned);  // the leading one adds to it
  if (!flushes(mode)) return sign | aligned;
  return exponent == -127 && aligned == 2 * kSmallestNormal ? sign | kSmallestNormal : sign;
}

uint32_t detail::narrowed_sum(float x, float y, float z, Mode mode) {
  const double product = double{x} * double{y}, addend = z;  // exact
  double sum = product + addend;
  if (std::isfinite(sum)) {
    // Knuth's two-sum gives what the addition lost. A sum that lost anything is made odd, as it lies between an even
    // and an odd number (Boldo and Melquiond, Emulation of FMA and correctly rounded sums, 2008).
    const double virtual_addend = sum - product;
    const double rest = (product - (sum - virtual_addend)) + (addend - virtual_addend);
    uint64_t bits;
    std::memcpy(&bits, &sum, 8);
    if (rest != 0 && bits % 2 == 0) sum = std::nextafter(sum, rest > 0 ? INFINITY : -INFINITY);
  }
  return narrowed(sum, mode);
}

uint32_t div(uint32_t a, uint32_t b, Mode mode) {
  return quotient_of(operand(a, mode), operand(b, mode), SlowOperation::Divide, mode);
}

uint32_t rcp(uint32_t a, Mode mode) {
  return quotient_of(as_bits(1.0f), operand(a, mode), SlowOperation::Reciprocal, mode);
}

uint32_t sqrt(uint32_t a, Mode mode) {
  a = operand(a, mode);
  if (is_zero(a)) return a;
  if (is_nan(a) || a & kSign) return kQuietNan;
  if (is_infinite(a)) return a;
  return finite(a, 0, SlowOperation::Root, mode);
}

uint32_t rsqrt(uint32_t a, Mode mode) {
  a = operand(a, mode);
  if (is_zero(a)) return a | kInfinity;
  if (is_nan(a) || a & kSign) return kQuietNan;
  if (is_infinite(a)) return 0;
  return finite(a, 0, SlowOperation::InverseRoot, mode);
}

}  // namespace raypool::arith
