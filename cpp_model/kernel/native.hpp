// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The kernel language run as C++: one thread at a time, every operation with the bits the machine
// gives. kernel.hpp describes the language.
#pragma once

#include <algorithm>
#include <cstdint>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "kernel/kernels.hpp"

namespace raypool::kernel {

/// What a thread reads from ray words that were never written: a NaN that shows up in pictures and comparisons.
inline constexpr uint32_t kUndefinedWord = 0x7fdeadadu;

/// kFused: as a machine with arithmetic.fma computes. kNarrow: with a significand of less than 24 bits, the thread's.
template <Subnormals kSubnormals, SlowUnit kSlowUnit, bool kFused = false, bool kNarrow = false>
class NativeKernel {
  static inline thread_local uint32_t significand = arith::kFullSignificand;

 public:
  /// For the operators below, which see no kernel: that of the thread's last one.
  static arith::Mode mode() {
    return {kSubnormals, kSlowUnit, kFused, kNarrow ? significand : arith::kFullSignificand};
  }

  struct Bool {
    bool value;
    Bool(bool literal) : value(literal) {}
    friend Bool operator&&(Bool a, Bool b) { return a.value & b.value; }
    friend Bool operator||(Bool a, Bool b) { return a.value | b.value; }
    friend Bool operator^(Bool a, Bool b) { return a.value != b.value; }
    friend Bool operator!(Bool a) { return !a.value; }
  };

  struct Float;
  struct Int {
    uint32_t bits;
    Int(int literal) : bits(static_cast<uint32_t>(literal)) {}
    Int(uint32_t literal) : bits(literal) {}
    int32_t value() const { return static_cast<int32_t>(bits); }

    friend Int operator+(Int a, Int b) { return a.bits + b.bits; }
    friend Int operator-(Int a, Int b) { return a.bits - b.bits; }
    friend Int operator*(Int a, Int b) { return a.bits * b.bits; }
    friend Int operator&(Int a, Int b) { return a.bits & b.bits; }
    friend Int operator|(Int a, Int b) { return a.bits | b.bits; }
    friend Int operator^(Int a, Int b) { return a.bits ^ b.bits; }
    friend Int operator<<(Int a, Int b) { return a.bits << (b.bits & 31); }
    friend Int operator>>(Int a, Int b) { return a.value() >> (b.bits & 31); }
    friend Int operator-(Int a) { return 0u - a.bits; }
    friend Int operator~(Int a) { return ~a.bits; }
    Int& operator+=(Int b) { return *this = *this + b; }
    Int& operator-=(Int b) { return *this = *this - b; }
    Int& operator*=(Int b) { return *this = *this * b; }
    friend Bool operator==(Int a, Int b) { return a.bits == b.bits; }
    friend Bool operator!=(Int a, Int b) { return a.bits != b.bits; }
    friend Bool operator<(Int a, Int b) { return a.value() < b.value(); }
    friend Bool operator<=(Int a, Int b) { return a.value() <= b.value(); }
    friend Bool operator>(Int a, Int b) { return a.value() > b.value(); }
    friend Bool operator>=(Int a, Int b) { return a.value() >= b.value(); }
    friend Bool less_unsigned(Int a, Int b) { return a.bits < b.bits; }
    friend Bool less_equal_unsigned(Int a, Int b) { return a.bits <= b.bits; }
    friend Int shift_right_logical(Int a, Int b) { return a.bits >> (b.bits & 31); }
    friend Int min(Int a, Int b) { return a.value() < b.value() ? a : b; }
    friend Int max(Int a, Int b) { return a.value() > b.value() ? a : b; }
    friend Int min_unsigned(Int a, Int b) { return a.bits < b.bits ? a : b; }
    friend Int max_unsigned(Int a, Int b) { return a.bits > b.bits ? a : b; }
    friend Int select(Bool condition, Int a, Int b) { return condition.value ? a : b; }
    friend Float to_float(Int a) { return Float::of_bits(arith::from_int(a.bits, mode())); }
    friend Float as_float(Int a) { return Float::of_bits(a.bits); }
  };

  struct Float {
    uint32_t bits;
    Float(float literal) : bits(as_bits(literal)) {}
    static Float of_bits(uint32_t bits) {
      Float result(0.0f);
      result.bits = bits;
      return result;
    }

    friend Float operator+(Float a, Float b) { return of_bits(arith::add(a.bits, b.bits, mode())); }
    friend Float operator-(Float a, Float b) { return of_bits(arith::sub(a.bits, b.bits, mode())); }
    friend Float operator*(Float a, Float b) { return of_bits(arith::mul(a.bits, b.bits, mode())); }
    friend Float operator/(Float a, Float b) { return of_bits(arith::div(a.bits, b.bits, mode())); }
    friend Float multiply_add(Float a, Float b, Float c) {
      return of_bits(arith::muladd(a.bits, b.bits, c.bits, mode()));
    }
    friend Float operator-(Float a) { return of_bits(a.bits ^ 0x80000000u); }
    Float& operator+=(Float b) { return *this = *this + b; }
    Float& operator-=(Float b) { return *this = *this - b; }
    Float& operator*=(Float b) { return *this = *this * b; }
    friend Bool operator==(Float a, Float b) { return arith::equal(a.bits, b.bits, mode()); }
    friend Bool operator!=(Float a, Float b) { return arith::not_equal(a.bits, b.bits, mode()); }
    friend Bool operator<(Float a, Float b) { return arith::less(a.bits, b.bits, mode()); }
    friend Bool operator<=(Float a, Float b) { return arith::less_equal(a.bits, b.bits, mode()); }
    friend Bool operator>(Float a, Float b) { return arith::greater(a.bits, b.bits, mode()); }
    friend Bool operator>=(Float a, Float b) { return arith::greater_equal(a.bits, b.bits, mode()); }
    friend Float min(Float a, Float b) { return of_bits(arith::min(a.bits, b.bits, mode())); }
    friend Float max(Float a, Float b) { return of_bits(arith::max(a.bits, b.bits, mode())); }
    friend Float abs(Float a) { return of_bits(a.bits & 0x7fffffffu); }
    friend Float sqrt(Float a) { return of_bits(arith::sqrt(a.bits, mode())); }
    friend Float rsqrt(Float a) { return of_bits(arith::rsqrt(a.bits, mode())); }
    friend Float rcp(Float a) { return of_bits(arith::rcp(a.bits, mode())); }
    friend Float select(Bool condition, Float a, Float b) { return condition.value ? a : b; }
    friend Int to_int(Float a) { return arith::to_int(a.bits, mode()); }
    friend Int as_int(Float a) { return a.bits; }
  };

  explicit NativeKernel(NativeThread& thread) : thread_(thread) {
    if (kNarrow) significand = thread.mode.significand;
    words_.fill(kUndefinedWord);
  }

  bool culling() const { return thread_.culling; }
  Int thread() const { return thread_.thread; }
  Int block() const { return thread_.block; }
  Int threads() const { return thread_.threads; }
  Int blocks() const { return thread_.blocks; }
  Int int_argument(int number) const { return (*thread_.arguments)[number]; }
  Float float_argument(int number) const { return Float::of_bits((*thread_.arguments)[number]); }

  Int load_int(Int address, int offset = 0) const {
    return thread_.memory->load(address.bits + static_cast<uint32_t>(offset));
  }
  Float load_float(Int address, int offset = 0) const { return Float::of_bits(load_int(address, offset).bits); }
  void store(Int address, int offset, Int value) {
    thread_.memory->store(address.bits + static_cast<uint32_t>(offset), value.bits);
  }
  void store(Int address, int offset, Float value) { store(address, offset, as_int(value)); }

  void ray_in() { words_ = thread_.input; }
  Int int_word(int number) const { return words_[number]; }
  Float float_word(int number) const { return Float::of_bits(words_[number]); }
  void set_word(int number, Int value) { words_[number] = value.bits; }
  void set_word(int number, Float value) { words_[number] = value.bits; }
  void ray_out() {
    Ray ray;
    std::copy_n(words_.begin(), ray.size(), ray.begin());
    thread_.rays.push_back(ray);
    words_.fill(kUndefinedWord);
  }
  void frame_out() {
    thread_.frame.push_back(
        {words_[word::kPixel], {words_[word::kColor], words_[word::kColor + 1], words_[word::kColor + 2]}});
    words_.fill(kUndefinedWord);
  }

  template <typename Then>
  void if_(Bool condition, const Then& then) {
    if (condition.value) then();
  }
  template <typename Then, typename Else>
  void if_(Bool condition, const Then& then, const Else& otherwise) {
    if (condition.value)
      then();
    else
      otherwise();
  }
  template <typename Condition, typename Body>
  void while_(const Condition& condition, const Body& body) {
    while (Bool(condition()).value) body();
  }

 private:
  NativeThread& thread_;
  Intersection words_;
};

}  // namespace raypool::kernel
