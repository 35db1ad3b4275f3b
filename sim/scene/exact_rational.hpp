// Rational numbers, for oracles: what is right is computed without any rounding, and compared.
#pragma once

#include <gmp.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>

#include "bits.hpp"

namespace raypool {

/// A rational number.
class Exact {
 public:
  Exact(double value = 0) {  // NOLINT(google-explicit-constructor)
    mpq_init(q_);
    mpq_set_d(q_, value);
  }
  Exact(const Exact& other) {
    mpq_init(q_);
    mpq_set(q_, other.q_);
  }
  Exact& operator=(const Exact& other) {
    if (this != &other) mpq_set(q_, other.q_);
    return *this;
  }
  ~Exact() { mpq_clear(q_); }
  friend Exact operator+(const Exact& a, const Exact& b) { return made(mpq_add, a, b); }
  friend Exact operator-(const Exact& a, const Exact& b) { return made(mpq_sub, a, b); }
  friend Exact operator*(const Exact& a, const Exact& b) { return made(mpq_mul, a, b); }
  friend Exact operator/(const Exact& a, const Exact& b) { return made(mpq_div, a, b); }
  friend bool operator<(const Exact& a, const Exact& b) { return mpq_cmp(a.q_, b.q_) < 0; }
  friend bool operator==(const Exact& a, const Exact& b) { return mpq_equal(a.q_, b.q_) != 0; }
  /// To so many bits, at most 53, to nearest even; it must not be smaller or larger than normal doubles are.
  double rounded(int bits) const {
    if (sign() == 0) return 0;
    mpz_t n, d, rest;
    mpz_inits(n, d, rest, nullptr);
    mpz_abs(n, mpq_numref(q_));
    mpz_set(d, mpq_denref(q_));
    // A quotient of bits + 1 or bits + 2 bits.
    const long shift = bits + 1 - (static_cast<long>(mpz_sizeinbase(n, 2)) - static_cast<long>(mpz_sizeinbase(d, 2)));
    mpz_mul_2exp(shift > 0 ? n : d, shift > 0 ? n : d, static_cast<mp_bitcnt_t>(shift > 0 ? shift : -shift));
    mpz_tdiv_qr(n, rest, n, d);
    uint64_t kept = mpz_get_ui(n);
    const int drop = static_cast<int>(mpz_sizeinbase(n, 2)) - bits;
    const uint64_t half = uint64_t{1} << (drop - 1), off = kept & (2 * half - 1);
    const bool exact = mpz_sgn(rest) == 0;
    mpz_clears(n, d, rest, nullptr);
    kept >>= drop;
    kept += off > half || (off == half && (!exact || kept % 2 != 0)) ? 1 : 0;
    return std::ldexp(static_cast<double>(kept) * sign(), drop - static_cast<int>(shift));
  }
  /// The nearest float, of two the even one; infinity beyond the largest.
  float nearest_float() const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (sign() == 0) return 0;
    const Exact size = sign() < 0 ? Exact() - *this : *this;
    // 2^exponent <= size < 2^(exponent + 1)
    long exponent =
        static_cast<long>(mpz_sizeinbase(mpq_numref(q_), 2)) - static_cast<long>(mpz_sizeinbase(mpq_denref(q_), 2));
    if (exponent > 128 || exponent < -151) return exponent > 0 ? kInfinity * static_cast<float>(sign()) : 0;
    if (size < Exact(std::ldexp(1.0, static_cast<int>(exponent)))) --exponent;
    if (exponent < -150) return 0;
    if (exponent == -150) return size == Exact(0x1p-150) ? 0 : 0x1p-149f * static_cast<float>(sign());
    const double kept = rounded(exponent < -126 ? static_cast<int>(exponent) + 150 : 24);
    return std::fabs(kept) < 0x1p128 ? static_cast<float>(kept) : kInfinity * static_cast<float>(sign());
  }
  /// A double near it, for what is printed.
  double approximately() const { return mpq_get_d(q_); }
  /// "numerator/denominator" in lowest terms, or the integer.
  std::string text() const {
    char* const digits = mpq_get_str(nullptr, 10, q_);
    std::string result(digits);
    void (*release)(void*, size_t) = nullptr;
    mp_get_memory_functions(nullptr, nullptr, &release);
    release(digits, result.size() + 1);
    return result;
  }
  /// -1, 0 or 1.
  int sign() const { return mpq_sgn(q_); }

 private:
  template <typename Operation>
  static Exact made(Operation operation, const Exact& a, const Exact& b) {
    Exact result;
    operation(result.q_, a.q_, b.q_);
    return result;
  }
  mpq_t q_;
};

/// Is this finite float the one that a number is rounded to, to nearest even?
inline bool is_nearest(float rounded, const Exact& exact) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Exact twice = exact + exact, here = Exact(rounded);
  for (const float next : {std::nextafter(rounded, kInfinity), std::nextafter(rounded, -kInfinity)}) {
    if (std::isinf(next)) continue;
    const Exact middle = here + Exact(next);
    const bool above = next > rounded;
    if (above ? middle < twice : twice < middle) return false;
    if (!(middle < twice) && !(twice < middle) && (as_bits(rounded) & 1) != 0) return false;
  }
  return true;
}

}  // namespace raypool
