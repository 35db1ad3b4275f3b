// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The kernel language. A kernel is a template over K, written once:
//
//   template <typename K>
//   void scale(K& k) {
//     using Int = typename K::Int;
//     using Float = typename K::Float;
//     const Int index = k.thread();
//     k.if_(index < k.int_argument(0), [&] {
//       const Int address = k.int_argument(1) + (index << 2);
//       k.store(address, 0, k.load_float(address) * 0.5f);
//     });
//   }
//
// With K = NativeKernel it runs as C++, one thread at a time; with K = RecordedKernel, through add_kernel(), it becomes
// machine code. Both give the same bits. docs/use/kernels.md has the language's rules and lists its operations.
#pragma once

#include "kernel/compiler.hpp"
#include "kernel/native.hpp"
#include "kernel/recorded.hpp"

namespace raypool::kernel {

/// Three floats.
template <typename K>
struct Vector {
  typename K::Float x, y, z;

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(const Vector& a, const Vector& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  friend Vector operator*(const typename K::Float& a, const Vector& b) { return {a * b.x, a * b.y, a * b.z}; }
  friend typename K::Float dot(const Vector& a, const Vector& b) {
    return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
  }
};

template <typename K>
Vector<K> vector_argument(K& k, int number) {
  return {k.float_argument(number), k.float_argument(number + 1), k.float_argument(number + 2)};
}
template <typename K>
Vector<K> vector_word(K& k, int number) {
  return {k.float_word(number), k.float_word(number + 1), k.float_word(number + 2)};
}
template <typename K>
Vector<K> vector_load(K& k, const typename K::Int& address, int offset) {
  return {k.load_float(address, offset), k.load_float(address, offset + 4), k.load_float(address, offset + 8)};
}
template <typename K>
void set_vector_word(K& k, int number, const Vector<K>& value) {
  k.set_word(number, value.x);
  k.set_word(number + 1, value.y);
  k.set_word(number + 2, value.z);
}

}  // namespace raypool::kernel
