// Exact reference of a * b + c for narrow formats, in 128-bit integers: for up to 5 exponent and 10 mantissa bits no
// digit is lost, and the only rounding is the one at the end. Shares nothing with the RTL or the model of arithmetic.
#pragma once

#include <cstdint>

namespace raypool {

/// Bits of a number: sign, exponent, mantissa. `flush`: subnormal operands count as zero and results that are tiny
/// after rounding to the mantissa's bits become the zero of their sign.
class ExactFloat {
 public:
  ExactFloat(int exponent_bits, int mantissa_bits, bool flush)
      : e_(exponent_bits), m_(mantissa_bits), bias_((1 << (exponent_bits - 1)) - 1), flush_(flush) {}

  uint32_t nan() const { return ((1u << (e_ + 1)) - 1) << (m_ - 1); }
  uint32_t infinity() const { return ((1u << e_) - 1) << m_; }
  uint32_t sign_bit() const { return 1u << (e_ + m_); }
  uint32_t one() const { return static_cast<uint32_t>(bias_) << m_; }

  uint32_t fma(uint32_t a, uint32_t b, uint32_t c) const {
    if (is_nan(a) || is_nan(b) || is_nan(c)) return nan();
    const uint32_t sign = (a ^ b) & sign_bit();
    if (is_infinite(a) || is_infinite(b)) {
      if (mantissa(a) == 0 || mantissa(b) == 0) return nan();
      if (is_infinite(c) && (c & sign_bit()) != sign) return nan();
      return sign | infinity();
    }
    if (is_infinite(c)) return c;
    // Everything in units of 2^(2 * lowest), lowest = the exponent of the smallest subnormal number.
    const __int128 product = signed_value(mantissa(a) * mantissa(b), sign) << (scale(a) + scale(b));
    const __int128 addend = signed_value(mantissa(c), c & sign_bit()) << (scale(c) + bias_ + m_ - 1);
    const __int128 sum = product + addend;
    if (sum == 0) return mantissa(a) != 0 && mantissa(b) != 0 ? 0 : (sign == (c & sign_bit()) ? sign : 0);
    return round(sum < 0 ? -sum : sum, sum < 0 ? sign_bit() : 0);
  }
  /// The product with one rounding: an exact zero has the product's sign.
  uint32_t mul(uint32_t a, uint32_t b) const { return fma(a, b, (a ^ b) & sign_bit()); }
  uint32_t add(uint32_t a, uint32_t b) const { return fma(a, one(), b); }
  uint32_t sub(uint32_t a, uint32_t b) const { return fma(a, one(), b ^ sign_bit()); }

 private:
  uint32_t field(uint32_t a) const { return a >> m_ & ((1u << e_) - 1); }
  uint32_t fraction(uint32_t a) const { return a & ((1u << m_) - 1); }
  bool is_nan(uint32_t a) const { return field(a) == (1u << e_) - 1 && fraction(a) != 0; }
  bool is_infinite(uint32_t a) const { return field(a) == (1u << e_) - 1 && fraction(a) == 0; }
  uint32_t mantissa(uint32_t a) const {
    if (field(a) == 0) return flush_ ? 0 : fraction(a);
    return fraction(a) | 1u << m_;
  }
  int scale(uint32_t a) const { return field(a) == 0 ? 0 : static_cast<int>(field(a)) - 1; }
  static __int128 signed_value(uint32_t magnitude, uint32_t negative) {
    return negative != 0 ? -static_cast<__int128>(magnitude) : static_cast<__int128>(magnitude);
  }

  uint32_t round(unsigned __int128 magnitude, uint32_t sign) const {
    const auto upper = static_cast<uint64_t>(magnitude >> 64), lower = static_cast<uint64_t>(magnitude);
    const int top = upper != 0 ? 127 - __builtin_clzll(upper) : 63 - __builtin_clzll(lower);  // of the leading one
    // Bit `unit` weighs as much as the smallest subnormal number.
    const int unit = bias_ + m_ - 1;
    int last = top - m_;
    if (!flush_ && last < unit) last = unit;
    uint32_t kept = 0;
    if (last <= 0) {
      kept = static_cast<uint32_t>(magnitude) << -last;
    } else {
      kept = static_cast<uint32_t>(magnitude >> last);
      const unsigned __int128 half = static_cast<unsigned __int128>(1) << (last - 1);
      const unsigned __int128 tail = magnitude & (2 * half - 1);
      if (tail > half || (tail == half && kept % 2 != 0)) ++kept;
    }
    if (kept >> (m_ + 1) != 0) kept >>= 1, ++last;
    if (kept >> m_ == 0) return sign | kept;  // subnormal; exact zeros do not come here
    const int exponent = last - unit + 1;
    if (exponent < 1) return sign;  // only when flushing
    if (exponent >= (1 << e_) - 1) return sign | infinity();
    return sign | static_cast<uint32_t>(exponent) << m_ | (kept & ((1u << m_) - 1));
  }

  int e_, m_, bias_;
  bool flush_;
};

}  // namespace raypool
