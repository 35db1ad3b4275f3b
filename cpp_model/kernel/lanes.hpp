// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Words of sixteen threads side by side, and the arithmetic of arith.hpp on them. Vector extensions of GCC and Clang
// give the operators: each lane rounds as its scalar form does. Compile with -Wno-psabi; all is inlined, so that no
// vector is passed between files for different processors.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "arith/arith.hpp"

namespace raypool::kernel {

inline constexpr size_t kLanes = 16;
using Words = uint32_t __attribute__((vector_size(4 * kLanes)));
/// Of comparisons: all bits, or none.
using Ints = int32_t __attribute__((vector_size(4 * kLanes)));
using Floats = float __attribute__((vector_size(4 * kLanes)));

[[gnu::always_inline]] inline Words words_of(Ints value) { return reinterpret_cast<Words>(value); }
[[gnu::always_inline]] inline Words words_of(Floats value) { return reinterpret_cast<Words>(value); }
[[gnu::always_inline]] inline Ints ints_of(Words value) { return reinterpret_cast<Ints>(value); }
[[gnu::always_inline]] inline Floats floats_of(Words value) { return reinterpret_cast<Floats>(value); }
[[gnu::always_inline]] inline Words chosen(Words mask, Words a, Words b) { return (a & mask) | (b & ~mask); }

/// In a mode; `kPlain`: which has subnormal numbers and whole significands, as most machines do.
template <bool kPlain>
class LaneArithmetic {
 public:
  explicit LaneArithmetic(const arith::Mode& mode) : mode_(mode) {}

  [[gnu::always_inline]] Words add(const Words& a, const Words& b) const {
    if constexpr (kPlain) return canonical(floats_of(a) + floats_of(b));
    return each(arith::add, a, b);
  }
  [[gnu::always_inline]] Words sub(const Words& a, const Words& b) const {
    if constexpr (kPlain) return canonical(floats_of(a) - floats_of(b));
    return each(arith::sub, a, b);
  }
  [[gnu::always_inline]] Words mul(const Words& a, const Words& b) const {
    if constexpr (kPlain) return canonical(floats_of(a) * floats_of(b));
    return each(arith::mul, a, b);
  }
  [[gnu::always_inline]] Words fma(const Words& a, const Words& b, const Words& c) const {
    Words result{};
    for (size_t l = 0; l < kLanes; ++l) result[l] = arith::fma(a[l], b[l], c[l], mode_);
    return result;
  }
  [[gnu::always_inline]] Words min(const Words& a, const Words& b) const {
    if constexpr (kPlain) return nearer(words_of(order(a) <= order(b)), a, b);
    return each(arith::min, a, b);
  }
  [[gnu::always_inline]] Words max(const Words& a, const Words& b) const {
    if constexpr (kPlain) return nearer(words_of(order(a) >= order(b)), a, b);
    return each(arith::max, a, b);
  }
  [[gnu::always_inline]] Words from_int(const Words& a) const {
    if constexpr (kPlain) return words_of(__builtin_convertvector(ints_of(a), Floats));
    return each(arith::from_int, a);
  }
  [[gnu::always_inline]] Words to_int(const Words& a) const { return each(arith::to_int, a); }

  [[gnu::always_inline]] Words div(const Words& a, const Words& b) const {
    if (kPlain && mode_.slow_unit == SlowUnit::Exact) return canonical(floats_of(a) / floats_of(b));
    return each(arith::div, a, b);
  }
  [[gnu::always_inline]] Words rcp(const Words& a) const {
    if (kPlain && mode_.slow_unit == SlowUnit::Exact) return canonical(1.0f / floats_of(a));
    return each(arith::rcp, a);
  }
  [[gnu::always_inline]] Words sqrt(const Words& a) const {
    if (!kPlain || mode_.slow_unit != SlowUnit::Exact) return each(arith::sqrt, a);
    Floats root{};
    for (size_t l = 0; l < kLanes; ++l) root[l] = std::sqrt(floats_of(a)[l]);
    return canonical(root);
  }
  [[gnu::always_inline]] Words rsqrt(const Words& a) const { return each(arith::rsqrt, a); }

  [[gnu::always_inline]] Words equal(const Words& a, const Words& b) const {
    if constexpr (kPlain) return words_of(floats_of(a) == floats_of(b));
    return each_mask(arith::equal, a, b);
  }
  [[gnu::always_inline]] Words not_equal(const Words& a, const Words& b) const { return ~equal(a, b); }
  [[gnu::always_inline]] Words less(const Words& a, const Words& b) const {
    if constexpr (kPlain) return words_of(floats_of(a) < floats_of(b));
    return each_mask(arith::less, a, b);
  }
  [[gnu::always_inline]] Words less_equal(const Words& a, const Words& b) const {
    if constexpr (kPlain) return words_of(floats_of(a) <= floats_of(b));
    return each_mask(arith::less_equal, a, b);
  }

 private:
  [[gnu::always_inline]] static Words is_number(const Words& a) {
    return words_of((a & arith::detail::kMagnitude) <= arith::detail::kInfinity);
  }
  [[gnu::always_inline]] static Words canonical(const Floats& value) {
    return chosen(is_number(words_of(value)), words_of(value), Words{} + arith::kQuietNan);
  }
  /// As arith::detail::order.
  [[gnu::always_inline]] static Ints order(const Words& a) {
    return ints_of(a ^ (words_of(ints_of(a) >> 31) & arith::detail::kMagnitude));
  }
  /// Of two numbers; a NaN is left out.
  [[gnu::always_inline]] static Words nearer(const Words& is_first, const Words& a, const Words& b) {
    const Words a_is = is_number(a), b_is = is_number(b);
    const Words of_numbers = chosen(is_first, a, b), quiet = Words{} + arith::kQuietNan;
    return chosen(a_is, chosen(b_is, of_numbers, a), chosen(b_is, b, quiet));
  }

  template <typename Operation>
  [[gnu::always_inline]] Words each(const Operation& operation, const Words& a) const {
    Words result{};
    for (size_t l = 0; l < kLanes; ++l) result[l] = operation(a[l], mode_);
    return result;
  }
  template <typename Operation>
  [[gnu::always_inline]] Words each(const Operation& operation, const Words& a, const Words& b) const {
    Words result{};
    for (size_t l = 0; l < kLanes; ++l) result[l] = operation(a[l], b[l], mode_);
    return result;
  }
  template <typename Operation>
  [[gnu::always_inline]] Words each_mask(const Operation& operation, const Words& a, const Words& b) const {
    Words result{};
    for (size_t l = 0; l < kLanes; ++l) result[l] = operation(a[l], b[l], mode_) ? ~0u : 0u;
    return result;
  }

  arith::Mode mode_;
};

}  // namespace raypool::kernel
