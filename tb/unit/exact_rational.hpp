// Rational numbers, for oracles of benches.
#pragma once

#include <gmp.h>

namespace raypool::bench {

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

}  // namespace raypool::bench
