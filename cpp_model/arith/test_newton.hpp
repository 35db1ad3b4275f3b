// The Newton units as docs/machine/float-units.md defines them, in fractions: the oracle of their bits. Shares nothing
// with the model that it checks, nor with the RTL's seed table: seeds are found by comparing squares, numbers are taken
// apart by frexp and put together by ldexp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "arith/test_oracle.hpp"
#include "bits.hpp"

namespace raypool::arith::newton_oracle {

/// numerator / 2^bits.
struct Fraction {
  int64_t numerator;
  int bits;

  Fraction widened(int to) const { return {numerator * (int64_t{1} << (to - bits)), to}; }
  /// Rounded down to a multiple of 2^-to.
  Fraction floor(int to) const { return to >= bits ? widened(to) : Fraction{numerator >> (bits - to), to}; }
  Fraction half() const { return {numerator, bits + 1}; }
};
inline Fraction operator*(Fraction a, Fraction b) { return {a.numerator * b.numerator, a.bits + b.bits}; }
inline Fraction operator+(Fraction a, Fraction b) {
  const int bits = a.bits > b.bits ? a.bits : b.bits;
  return {a.widened(bits).numerator + b.widened(bits).numerator, bits};
}
/// 1 - a - 2^-bits, the next number below 1 - a.
inline Fraction just_below_one_minus(Fraction a) { return {(int64_t{1} << a.bits) - a.numerator - 1, a.bits}; }

/// The nearest n/512 to 1/m in the middle m of the i-th of 128 parts of 1 .. 2; to 1/sqrt(m), of 64 parts of 1 .. 2 and
/// of 2 .. 4. As m is odd/256, or odd/128 and twice that, no n/512 and a half is met exactly.
inline Fraction nearest_seed(int i, bool root) {
  const int64_t m = root ? (2 * (i % 64) + 129) * (i < 64 ? 1 : 2) : 2 * i + 257;  // times 128, or 256
  int64_t n = 512;
  // (2n - 1) / 1024 above 1/m, or its square.
  while (root ? (2 * n - 1) * (2 * n - 1) * m > int64_t{1} << 27 : (2 * n - 1) * m > int64_t{1} << 18) --n;
  return {n, 9};
}
inline const std::array<std::array<Fraction, 128>, 2>& seeds() {
  static const std::array<std::array<Fraction, 128>, 2> kSeeds = [] {
    std::array<std::array<Fraction, 128>, 2> all{};
    for (int root = 0; root < 2; ++root) {
      for (int i = 0; i < 128; ++i) all[root][i] = nearest_seed(i, root != 0);
    }
    return all;
  }();
  return kSeeds;
}

/// About w/v, or w/sqrt(v): 30 bits. v and w have 23.
inline Fraction estimate(Fraction v, Fraction w, bool root, SlowUnit unit) {
  // The part of 1 .. 2, or of 1 .. 2 and 2 .. 4, that v lies in.
  const bool from_two = v.numerator >= int64_t{2} << 23;
  const Fraction part = v.floor(!root ? 7 : from_two ? 5 : 6);
  const Fraction seed = seeds()[root][part.numerator - (!root ? 128 : from_two ? 0 : 64)];
  if (unit == SlowUnit::Newton0) return (w * seed).floor(30);
  Fraction e = root ? just_below_one_minus(v * seed * seed).half() : just_below_one_minus(v * seed);
  const Fraction y = (seed + seed * e.floor(18) + Fraction{1, 16}).floor(15);
  const Fraction n = (w * y).floor(30);
  if (unit == SlowUnit::Newton1) return n;
  const Fraction t = (v * y).floor(30);
  e = root ? just_below_one_minus(t * y).half() : just_below_one_minus(t);
  return (n + n.floor(18) * e.floor(28)).floor(30);
}

/// q * 2^exponent rounded to nearest even, to the significand and to what subnormal numbers there are with it, and
/// never to another exponent.
inline double rounded(Fraction q, int exponent, int significand) {
  if (q.numerator < int64_t{1} << 30) q.numerator = int64_t{1} << 30;
  if (q.numerator >= int64_t{2} << 30) q.numerator = (int64_t{2} << 30) - 1;
  const int below = std::min(std::max(0, -126 - exponent), 30);  // the normal numbers
  const int lost = 31 - significand + below;
  int64_t kept = q.numerator >> lost;
  const int64_t rest = q.numerator - (kept << lost), half = int64_t{1} << (lost - 1);
  const bool next_exponent =
      kept + 1 == 1 << significand || kept + 1 == 1 << (significand - 1);  // normal numbers follow upon subnormal ones
  if ((rest > half || (rest == half && kept % 2 != 0)) && !next_exponent) ++kept;
  return std::ldexp(static_cast<double>(kept), exponent + 1 - significand + below);
}

/// The result for numbers that are neither zero nor infinite nor NaN; n is 1 for frcp, of
/// roots d alone counts and is positive.
inline double finite(Operation operation, double n, double d, SlowUnit unit, bool flush, int significand) {
  const bool root = operation == Operation::Sqrt || operation == Operation::Rsqrt;
  int n_exponent = 0, d_exponent = 0;
  const auto mantissa = [](double x, int& exponent) {  // 1 .. 2
    const double half = std::frexp(std::fabs(x), &exponent);
    --exponent;
    return Fraction{static_cast<int64_t>(std::ldexp(half, 24)), 23};
  };
  Fraction w = mantissa(n, n_exponent), v = mantissa(d, d_exponent);
  int exponent = n_exponent - d_exponent;
  if (root) {
    if (d_exponent % 2 != 0) v.numerator *= 2, --d_exponent;
    w = operation == Operation::Sqrt ? v : Fraction{2 << 23, 23};
    exponent = operation == Operation::Sqrt ? d_exponent / 2 : -d_exponent / 2 - 1;
    if (operation == Operation::Rsqrt && v.numerator == 1 << 23) return std::ldexp(1.0, -d_exponent / 2);
  } else if (w.numerator < v.numerator) {
    w.numerator *= 2, --exponent;
  }
  const double sign = !root && std::signbit(n) != std::signbit(d) ? -1.0 : 1.0;
  if (flush && exponent < -126) return sign * 0.0;
  return sign * rounded(estimate(v, w, root, unit), exponent, significand);
}

inline uint32_t result(Operation operation, uint32_t a, uint32_t b, SlowUnit unit, bool flush, uint32_t significand) {
  const auto number = [flush, significand](uint32_t bits) {
    const float value = as_float(bits >> (24 - significand) << (24 - significand));
    return flush && std::fabs(value) < 0x1p-126f ? std::copysign(0.0, value) : double{value};
  };
  const bool divides = operation == Operation::Div;
  const double n = divides ? number(a) : 1.0, d = divides ? number(b) : number(a);
  const bool root = operation == Operation::Sqrt || operation == Operation::Rsqrt;
  double value = 0;
  if (std::isnormal(n) && std::isnormal(d) && !(root && d < 0)) {  // a double: every float but zero is normal
    value = finite(operation, n, d, unit, flush, static_cast<int>(significand));
  } else {
    const double divisor = root ? std::sqrt(d) : d;
    value = operation == Operation::Sqrt ? divisor : n / divisor;
  }
  const auto narrow = static_cast<float>(value);
  return std::isnan(narrow) ? 0x7fc00000u : as_bits(narrow);
}

/// Whether a Newton result has sign and exponent of the correctly rounded one, subnormal numbers and zero
/// sharing one. The tie of a largest mantissa over a power of two, below the smallest normal number,
/// becomes that in the exact unit alone.
inline bool keeps_exponent(Operation operation, uint32_t a, uint32_t b, uint32_t newton, uint32_t exact,
                           uint32_t significand) {
  const uint32_t largest = 0x007fffffu >> (24 - significand) << (24 - significand);
  const bool tie = operation == Operation::Div && (a & largest) == largest && (b & largest) == 0;
  if (tie && (exact & 0x7fffffffu) == 0x00800000u) return newton >> 23 == exact >> 31 << 8;
  return newton >> 23 == exact >> 23;
}

}  // namespace raypool::arith::newton_oracle
