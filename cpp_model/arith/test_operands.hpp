// Operands for tests of arithmetic: the special values, and random pairs weighted towards cancellation, halfway cases,
// overflow and the edge of the subnormal numbers. The same seed gives the same operands everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "bits.hpp"

namespace raypool::arith {

/// `a` with its last five bits where those of a shorter significand are, so that neighbours stay neighbours, and what
/// has few bits few bits.
inline uint32_t brought_up(uint32_t a, uint32_t significand) {
  const uint32_t below = 24 - significand;
  return below == 0 ? a : (a & ~uint32_t{0} << below) ^ (a & 31) << below;
}

/// The special values, of a short significand also those of the long one.
inline std::vector<uint32_t> special_operands(uint32_t significand = 24) {
  std::vector<uint32_t> values;
  const auto push = [&](uint32_t value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
  };
  for (const uint32_t magnitude :
       {0x00000000u, 0x00000001u, 0x00000002u, 0x00000003u, 0x00400000u, 0x007ffffeu, 0x007fffffu, 0x00800000u,
        0x00800001u, 0x00ffffffu, 0x01000000u, 0x01000001u, 0x0b800000u, 0x1fffffffu, 0x20000000u, 0x33800000u,
        0x34000000u, 0x3effffffu, 0x3f000000u, 0x3f3504f3u, 0x3f7fffffu, 0x3f800000u, 0x3f800001u, 0x3fb504f3u,
        0x3fffffffu, 0x40000000u, 0x40400000u, 0x407fffffu, 0x40800000u, 0x4b000000u, 0x4b000001u, 0x4b7fffffu,
        0x4b800000u, 0x4effffffu, 0x4f000000u, 0x4f000001u, 0x5f000000u, 0x7e800000u, 0x7effffffu, 0x7f000000u,
        0x7f000001u, 0x7f7ffffeu, 0x7f7fffffu, 0x7f800000u, 0x7f800001u, 0x7fbfffffu, 0x7fc00000u, 0x7fffffffu}) {
    for (const uint32_t value : {magnitude, magnitude | 0x80000000u}) push(value), push(brought_up(value, significand));
  }
  return values;
}

/// The special values and the two neighbours of each.
inline std::vector<uint32_t> boundary_operands(uint32_t significand = 24) {
  std::vector<uint32_t> values;
  for (const uint32_t special : special_operands()) {
    for (const uint32_t step : {0u, 1u, 0xffffffffu}) {
      const uint32_t value = brought_up(special + step, significand);
      if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
    }
  }
  return values;
}

class OperandSource {
 public:
  explicit OperandSource(uint64_t seed, uint32_t significand = 24)
      : random_(seed), significand_(significand), specials_(special_operands()) {}

  std::pair<uint32_t, uint32_t> next() {
    const auto [a, b] = next_long();
    return {shortened(a), shortened(b)};
  }

  /// An addend for a * b: anything, special, cancelling all or nearly all of the product, at every alignment to it, or
  /// at the edge of the subnormal numbers.
  uint32_t third(uint32_t a, uint32_t b) { return shortened(third_long(a, b)); }

 private:
  /// Of a shorter significand the special bits of most operands are brought up to its end; below it some have something
  /// that must not be looked at.
  uint32_t shortened(uint32_t a) {
    if (significand_ == 24) return a;
    const uint32_t below = ~(~uint32_t{0} << (24 - significand_));
    const uint32_t kept = range(0, 2) != 0 ? brought_up(a, significand_) : a & ~below;
    return range(0, 3) != 0 ? kept : kept | (bits() & below);
  }

  uint32_t third_long(uint32_t a, uint32_t b) {
    const uint32_t product = as_bits(as_float(a) * as_float(b));
    const uint32_t c = bits();
    switch (random_() % 9) {
      case 0:
        return c;
      case 1:
        return special();
      case 2:  // the rounded product itself: what is left is its rounding error
        return product ^ 0x80000000u;
      case 3:
        return (product ^ 0x80000000u) + static_cast<uint32_t>(range(-3, 3));
      case 4:  // cancellation, small shifts
        return exponent((c & 0x7fffffffu) | (~product & 0x80000000u), field(product) + range(-2, 2));
      case 5:  // every alignment
        return exponent(c, field(product) + range(-51, 30));
      case 6:  // halfway sums
        return few_bits(exponent(c, field(product) + range(-51, 30)));
      case 7:  // results at the edge of the subnormal numbers
        return exponent(c, range(0, 3));
      default:  // few bits below everything
        return (c & 0x807fffffu) >> range(0, 22) | (c & 0x80000000u);
    }
  }

  // NOLINTNEXTLINE(readability-function-size): a list of kinds of pairs
  std::pair<uint32_t, uint32_t> next_long() {
    uint32_t a = bits(), b = bits();
    switch (random_() % 19) {
      case 0:  // anything
        break;
      case 1:  // special and anything
        (range(0, 1) != 0 ? a : b) = special();
        break;
      case 2: {  // both special; what is equal, or equal but for its sign, is so too
        a = special();
        const int same = range(0, 3);
        b = same > 1 ? special() : a ^ static_cast<uint32_t>(same) << 31;
        break;
      }
      case 3:  // cancellation, small shifts
        b = exponent(b, field(a) + range(-2, 2));
        break;
      case 4:  // nearly equal
        b = (a + static_cast<uint32_t>(range(-3, 3))) ^ (bits() & 0x80000000u);
        break;
      case 5:  // every alignment
        b = exponent(b, field(a) + range(-27, 27));
        break;
      case 6:  // halfway sums
        a = few_bits(a), b = few_bits(exponent(b, field(a) + range(-26, 26)));
        break;
      case 7:  // products near 2
        a = few_bits(a), b = exponent(few_bits(b), 254 - field(a) + range(-3, 3));
        break;
      case 8:  // product near overflow
        b = exponent(b, 127 + 254 - field(a) + range(-2, 2));
        break;
      case 9:  // product near or below the smallest normal number
        b = exponent(b, 127 - field(a) + range(-26, 3));
        break;
      case 10:  // quotient there
        b = exponent(b, field(a) + 127 + range(-3, 27));
        break;
      case 11:  // product next to 2^-126, the smallest normal number, or twice that
        b = partner(a, exponent(0, range(1, 2))) + static_cast<uint32_t>(range(-2, 2));
        break;
      case 12: {  // quotient next to a power of two, most of them below: in the middle and at both ends of the range
        constexpr int kFields[] = {127, 255, 2, 1, 0, -1};
        const int wanted = kFields[random_() % 6];
        const uint32_t near = a + static_cast<uint32_t>(range(-1, 4) * (1 << range(0, 4)));
        b = exponent(near, range(std::max(1, 128 - wanted), std::min(254, 381 - wanted)));
        a = exponent(a, field(b) - 127 + wanted);
        break;
      }
      case 13:  // subnormal operands
        a = exponent(a, range(0, 3)), b = exponent(b, range(0, 26));
        break;
      case 14:  // one bit of a fraction alone makes a NaN, a subnormal number, or the difference of two numbers
        a = (a & 0x80000000u) | static_cast<uint32_t>(range(0, 1) * 255) << 23 | 1u << range(0, 22);
        break;
      case 15:
        b = a ^ 1u << range(0, 31);
        break;
      case 16:
        b = last_bit_partner(a, b);
        break;
      case 17:  // integers in the middle between two floats, or next to it
        a = middle_integer(), b = middle_integer();
        break;
      default:
        halfway_quotient(a, b);
        break;
    }
    return {a, b};
  }

  uint32_t bits() { return static_cast<uint32_t>(random_()); }
  uint32_t special() {
    static constexpr uint32_t kEnds[] = {0, 1, 0x7f7fffff, 0x7f800000, 0x7fc00000};
    if (range(0, 2) == 0) return kEnds[random_() % std::size(kEnds)] | (bits() & 0x80000000u);
    return specials_[random_() % specials_.size()];
  }
  int range(int low, int high) { return low + static_cast<int>(random_() % static_cast<uint64_t>(high - low + 1)); }
  static int field(uint32_t a) { return static_cast<int>(a >> 23 & 0xff); }
  static uint32_t exponent(uint32_t a, int field) {
    if (field < 0) field = 0;
    if (field > 255) field = 255;
    return (a & 0x807fffffu) | static_cast<uint32_t>(field) << 23;
  }
  /// About product / a.
  static uint32_t partner(uint32_t a, uint32_t product) {
    const float x = as_float(a);
    return as_bits(as_float(product) / (x != 0 ? x : 1));
  }
  /// A factor for a, which becomes odd, so that the last bits of the product decide how it is rounded; half of the
  /// products are at the edge of the subnormal numbers.
  uint32_t last_bit_partner(uint32_t& a, uint32_t b) {
    a |= 1;
    const uint32_t odd = (a & 0x7fffffu) | 0x800000u;
    uint32_t inverse = odd;  // modulo 2^32: right in 3 bits, and in twice as many after each step
    for (int step = 0; step < 4; ++step) inverse *= 2 - odd * inverse;
    static constexpr uint32_t kEnds[] = {0, 1u << 22, 1u << 23};
    const uint32_t end = kEnds[random_() % 3] + static_cast<uint32_t>(range(-1, 1) * (1 << range(0, 3)));
    const int wanted = range(0, 1) != 0 ? 127 - field(a) + range(-4, 2) : 254 - field(a) + range(-30, 30);
    return exponent((b & 0x80000000u) | (end * inverse & 0x7fffffu), wanted);
  }
  uint32_t middle_integer() {
    const int shift = std::max(1, range(-5, 7));  // 2^31 and more are negative
    const uint32_t magnitude =
        (((bits() | 0x80000000u) & ~0xffu) >> shift) + (0x80u >> shift) + static_cast<uint32_t>(range(-1, 1));
    return range(0, 1) != 0 ? magnitude : 0u - magnitude;
  }
  /// a / b is in the middle between two subnormal numbers, or next to it.
  void halfway_quotient(uint32_t& a, uint32_t& b) {
    const int quotient = range(0, 2047) * 2 + 1, divisor = range(1, 4095), power = range(30, 100);
    const float dividend = std::ldexp(static_cast<float>(quotient * divisor), power - 150);
    const float by = std::ldexp(static_cast<float>(divisor), power);
    const uint32_t signs_a = a & 0x80000000u, signs_b = b & 0x80000000u;
    a = (as_bits(dividend) + static_cast<uint32_t>(range(-1, 1))) | signs_a, b = as_bits(by) | signs_b;
  }
  /// A fraction of few ones at its head and its tail, from which sums and products on
  /// the middle between two floats come.
  uint32_t few_bits(uint32_t a) {
    const uint32_t head = 0x7fffffu & ~((1u << range(8, 23)) - 1u), tail = (1u << range(0, 4)) - 1u;
    return (a & (0xff800000u | head)) | (a & tail);
  }

  std::mt19937_64 random_;
  uint32_t significand_;
  std::vector<uint32_t> specials_;
};

}  // namespace raypool::arith
