// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Arithmetic with a significand of so many bits, as a unit of that width would have it.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

namespace raypool {

inline constexpr uint32_t kLeastTimeBits = 24, kMostTimeBits = 53;

/// Every operation rounds its exact result once, to nearest even, to `bits` bits of significand, 24 .. 53. Exponents
/// are a double's: neither operands nor results may be so small or large that double would lose what an operation
/// rounds off, which nothing made of up to five floats is. Infinities and NaNs are as in double; with 53 bits all is.
class NarrowFloat {
 public:
  explicit NarrowFloat(uint32_t bits) : drop_(static_cast<int>(kMostTimeBits - bits)) {}

  double add(double a, double b) const {
    const double sum = a + b;
    if (drop_ == 0) return sum;
    const double other = sum - a;
    return rounded(sum, (a - (sum - other)) + (b - other));
  }
  double subtract(double a, double b) const { return add(a, -b); }
  double multiply(double a, double b) const {
    const double product = a * b;
    return drop_ == 0 ? product : rounded(product, std::fma(a, b, -product));
  }
  double divide(double a, double b) const {
    const double quotient = a / b;
    if (drop_ == 0) return quotient;
    const double rest = std::fma(-quotient, b, a);
    return rounded(quotient, b < 0 ? -rest : rest);
  }
  /// a b - c d of floats, with one rounding: the products are exact.
  double difference(float a, float b, float c, float d) const {
    return subtract(static_cast<double>(a) * static_cast<double>(b), static_cast<double>(c) * static_cast<double>(d));
  }

 private:
  /// What a double is rounded to that stands for itself and a rest, which is too small to show in it: only its sign
  /// matters, and only where the double is a tie.
  double rounded(double value, double rest) const {
    uint64_t word = 0;
    std::memcpy(&word, &value, sizeof word);
    const uint64_t unit = uint64_t{1} << drop_, half = unit / 2, below = word & (unit - 1);
    bool up = below > half;
    if (below == half) up = rest == 0 ? (word & unit) != 0 : (rest > 0) == (value > 0);
    word = word - below + (up ? unit : 0);
    std::memcpy(&value, &word, sizeof value);
    return value;
  }

  int drop_;
};

}  // namespace raypool
