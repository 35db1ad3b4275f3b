// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a shader computes while it becomes a kernel: scalars in virtual registers and predicates, or known already.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shader/resources.hpp"

namespace raypool::shader {

struct Scalar {
  enum class Kind : uint8_t { Undefined, Constant, Register, Predicate };
  /// Halves of the ray's pixel word, which need not be put together again.
  enum class Part : uint8_t { None, PixelX, PixelY };
  Kind kind = Kind::Undefined;
  uint32_t bits = 0;  ///< of a constant; a condition's are 0 or 1
  int number = 0;     ///< register or predicate
  bool negated = false;
  Part part = Part::None;

  static Scalar constant(uint32_t bits) { return {Kind::Constant, bits, 0, false, Part::None}; }
  static Scalar in_register(int number) { return {Kind::Register, 0, number, false, Part::None}; }
  static Scalar in_predicate(int number, bool negated = false) {
    return {Kind::Predicate, 0, number, negated, Part::None};
  }
  bool is_constant() const { return kind == Kind::Constant; }
  bool is_undefined() const { return kind == Kind::Undefined; }
  friend bool operator==(const Scalar& a, const Scalar& b) {
    return a.kind == b.kind && a.bits == b.bits && a.number == b.number && a.negated == b.negated;
  }
};

/// The scalars of a value of any type, in the order of its parts; matrices by columns.
using Value = std::vector<Scalar>;

/// An index that is known only when the shader runs, and how many scalars or bytes it counts.
struct DynamicIndex {
  Scalar index;
  uint32_t stride = 0;
  uint32_t count = 0;  ///< valid ones; 0: of a runtime array
};

struct Pointer {
  enum class To : uint8_t { Variable, Memory, Words, Textures, Picture, Nothing, Tree };
  To to = To::Variable;
  uint32_t type = 0;      ///< of what it points to
  uint32_t variable = 0;  ///< Variable: its id
  uint32_t offset = 0;    ///< Variable: scalars; Memory, Words: bytes; Textures: elements
  std::vector<DynamicIndex> dynamic;
  std::optional<Scalar> base;                ///< Memory: a register with an address, which the offset is added to
  const std::vector<Word>* words = nullptr;  ///< Words
  uint32_t size = 0;                         ///< Memory: bytes behind `offset` 0; 0: not known
  /// Of the vectors and matrices below, in bytes.
  uint32_t component_stride = 4, column_stride = 0;
};

}  // namespace raypool::shader
