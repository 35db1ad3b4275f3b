// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The kernel language recorded: each operation becomes an instruction of intermediate
// code. kernel.hpp describes the language.
// A value owns a virtual register or predicate. Operands are taken as
// Float/Int/BoolOperand, which record the source line.
#pragma once

#include <cstdint>
#include <utility>

#include "bits.hpp"
#include "kernel/recorder.hpp"
#include "machine/common/packages.hpp"

namespace raypool::kernel {
namespace recorded {

class Bool;
class Int;
class Float;

/// !condition, not yet computed. Use it at once: it does not follow later assignments to the condition.
class Negation {
 public:
  explicit Negation(const Condition& condition) : condition_(condition) {}
  const Condition& condition() const { return condition_; }

 private:
  Condition condition_;
};

class BoolOperand {
 public:
  BoolOperand(const Bool& value, Location where = Location::here());
  BoolOperand(const Negation& value, Location where = Location::here())
      : condition_{value.condition().predicate, value.condition().negated, where} {}
  BoolOperand(bool literal, Location where = Location::here());
  const Condition& condition() const { return condition_; }
  const Location& where() const { return condition_.where; }
  /// The predicate, negated by an instruction if need be.
  int positive() const {
    return condition_.negated ? Recorder::active().materialise(condition_) : condition_.predicate;
  }

 private:
  Condition condition_;
};

class IntOperand {
 public:
  IntOperand(const Int& value, Location place = Location::here());
  IntOperand(int literal, Location place = Location::here()) : IntOperand(static_cast<uint32_t>(literal), place) {}
  IntOperand(uint32_t literal, Location place = Location::here())
      : number(Recorder::active().emit_constant(literal, place)), where(place) {}
  int number;
  Location where;
};

class FloatOperand {
 public:
  FloatOperand(const Float& value, Location place = Location::here());
  FloatOperand(float literal, Location place = Location::here())
      : number(Recorder::active().emit_constant(as_bits(literal), place)), where(place) {}
  int number;
  Location where;
};

/// A virtual register or predicate that is copied with an instruction, and handed over without one when it is moved.
class Bool {
 public:
  Bool(bool literal, Location where = Location::here())
      : number_(Recorder::active().emit_predicates(literal ? Opcode::Pand : Opcode::Pxor, 0, 0, where)) {}
  Bool(const Negation& value) : number_(Recorder::active().materialise(value.condition())) {}
  Bool(const Bool& other, Location where = Location::here())
      : number_(Recorder::active().emit_predicates(Opcode::Pand, other.number_, other.number_, where)) {}
  Bool(Bool&& other) noexcept : number_(other.number_) {}
  Bool& operator=(const Bool& other) {
    Recorder::active().assign_predicate(number_, other.number_, false);
    return *this;
  }
  // Assigning records an instruction, which may be refused: it can throw.
  Bool& operator=(Bool&& other) {  // NOLINT(performance-noexcept-move-constructor)
    Recorder::active().assign_predicate(number_, other.number_, true);
    return *this;
  }
  static Bool of(int number) { return Bool(number, 0); }
  int number() const { return number_; }

 private:
  Bool(int number, int) : number_(number) {}
  int number_;
};

class Int {
 public:
  Int(int literal, Location where = Location::here()) : Int(static_cast<uint32_t>(literal), where) {}
  Int(uint32_t literal, Location where = Location::here())
      : number_(Recorder::active().emit_constant(literal, where)) {}
  Int(const Int& other, Location where = Location::here())
      : number_(Recorder::active().emit_copy(other.number_, where)) {}
  Int(Int&& other) noexcept : number_(other.number_) {}
  Int& operator=(const Int& other) {
    Recorder::active().assign_register(number_, other.number_, false);
    return *this;
  }
  Int& operator=(Int&& other) {  // NOLINT(performance-noexcept-move-constructor): as Bool
    Recorder::active().assign_register(number_, other.number_, true);
    return *this;
  }
  Int& operator+=(const IntOperand& b);
  Int& operator-=(const IntOperand& b);
  Int& operator*=(const IntOperand& b);
  struct Number {
    int value;
  };
  explicit Int(Number number) : number_(number.value) {}
  int number() const { return number_; }

 private:
  int number_;
};

class Float {
 public:
  Float(float literal, Location where = Location::here())
      : number_(Recorder::active().emit_constant(as_bits(literal), where)) {}
  Float(const Float& other, Location where = Location::here())
      : number_(Recorder::active().emit_copy(other.number_, where)) {}
  Float(Float&& other) noexcept : number_(other.number_) {}
  Float& operator=(const Float& other) {
    Recorder::active().assign_register(number_, other.number_, false);
    return *this;
  }
  Float& operator=(Float&& other) {  // NOLINT(performance-noexcept-move-constructor): as Bool
    Recorder::active().assign_register(number_, other.number_, true);
    return *this;
  }
  Float& operator+=(const FloatOperand& b);
  Float& operator-=(const FloatOperand& b);
  Float& operator*=(const FloatOperand& b);
  struct Number {
    int value;
  };
  explicit Float(Number number) : number_(number.value) {}
  int number() const { return number_; }

 private:
  int number_;
};

inline BoolOperand::BoolOperand(const Bool& value, Location where) : condition_{value.number(), false, where} {}
inline BoolOperand::BoolOperand(bool literal, Location where)
    : condition_{Recorder::active().emit_predicates(literal ? Opcode::Pand : Opcode::Pxor, 0, 0, where), false, where} {
}
inline IntOperand::IntOperand(const Int& value, Location place) : number(value.number()), where(place) {}
inline FloatOperand::FloatOperand(const Float& value, Location place) : number(value.number()), where(place) {}

// Helpers: an instruction with one or two operands, as a value of the language.
inline Int int_value(int number) { return Int(Int::Number{number}); }
inline Float float_value(int number) { return Float(Float::Number{number}); }
template <typename Operand>
int unary(Opcode opcode, const Operand& a) {
  return Recorder::active().emit_unary(opcode, a.number, a.where);
}
template <typename Operand>
int binary(Opcode opcode, const Operand& a, const Operand& b) {
  return Recorder::active().emit_binary(opcode, a.number, b.number, a.where);
}
template <typename Operand>
Bool compare(Opcode opcode, const Operand& a, const Operand& b) {
  return Bool::of(binary(opcode, a, b));
}

// Conditions
inline Negation operator!(const BoolOperand& a) {
  Condition condition = a.condition();
  condition.negated = !condition.negated;
  return Negation(condition);
}
inline Bool operator&&(const BoolOperand& a, const BoolOperand& b) {
  Recorder& recorder = Recorder::active();
  if (b.condition().negated)
    return Bool::of(recorder.emit_predicates(Opcode::Pandn, a.positive(), b.condition().predicate, a.where()));
  if (a.condition().negated)
    return Bool::of(
        recorder.emit_predicates(Opcode::Pandn, b.condition().predicate, a.condition().predicate, a.where()));
  return Bool::of(recorder.emit_predicates(Opcode::Pand, a.condition().predicate, b.condition().predicate, a.where()));
}
inline Bool operator||(const BoolOperand& a, const BoolOperand& b) {
  const int px = a.positive();
  return Bool::of(Recorder::active().emit_predicates(Opcode::Por, px, b.positive(), a.where()));
}
inline Bool operator^(const BoolOperand& a, const BoolOperand& b) {
  const int px = a.positive();
  return Bool::of(Recorder::active().emit_predicates(Opcode::Pxor, px, b.positive(), a.where()));
}

// Integers
inline Int operator+(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Iadd, a, b)); }
inline Int operator-(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Isub, a, b)); }
inline Int operator*(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Imul, a, b)); }
inline Int operator&(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::And, a, b)); }
inline Int operator|(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Or, a, b)); }
inline Int operator^(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Xor, a, b)); }
inline Int operator<<(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Shl, a, b)); }
inline Int operator>>(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Sar, a, b)); }
inline Int shift_right_logical(const IntOperand& a, const IntOperand& b) {
  return int_value(binary(Opcode::Shr, a, b));
}
inline Int operator~(const IntOperand& a) {
  return int_value(Recorder::active().emit_immediate(Opcode::Xor, a.number, ~0u, a.where));
}
inline Int operator-(const IntOperand& a) {
  const int zero = Recorder::active().emit_constant(0, a.where);
  return int_value(Recorder::active().emit_binary(Opcode::Isub, zero, a.number, a.where));
}
inline Int min(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Imin, a, b)); }
inline Int max(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Imax, a, b)); }
inline Int min_unsigned(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Umin, a, b)); }
inline Int max_unsigned(const IntOperand& a, const IntOperand& b) { return int_value(binary(Opcode::Umax, a, b)); }
inline Int select(const BoolOperand& condition, const IntOperand& a, const IntOperand& b) {
  return int_value(Recorder::active().emit_select(condition.condition(), a.number, b.number, condition.where()));
}
inline Bool operator==(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ieq, a, b); }
inline Bool operator!=(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ine, a, b); }
inline Bool operator<(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ilt, a, b); }
inline Bool operator<=(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ile, a, b); }
inline Bool operator>(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Igt, a, b); }
inline Bool operator>=(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ige, a, b); }
inline Bool less_unsigned(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ult, a, b); }
inline Bool less_equal_unsigned(const IntOperand& a, const IntOperand& b) { return compare(Opcode::Ule, a, b); }
inline Int& Int::operator+=(const IntOperand& b) { return *this = IntOperand(*this, b.where) + b; }
inline Int& Int::operator-=(const IntOperand& b) { return *this = IntOperand(*this, b.where) - b; }
inline Int& Int::operator*=(const IntOperand& b) { return *this = IntOperand(*this, b.where) * b; }

// Floats
inline Float operator+(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fadd, a, b)); }
inline Float operator-(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fsub, a, b)); }
inline Float operator*(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fmul, a, b)); }
inline Float operator/(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fdiv, a, b)); }
inline Float multiply_add(const FloatOperand& a, const FloatOperand& b, const FloatOperand& c) {
  return float_value(Recorder::active().emit_multiply_add(a.number, b.number, c.number, a.where));
}
inline Float operator-(const FloatOperand& a) {
  return float_value(Recorder::active().emit_immediate(Opcode::Xor, a.number, 0x80000000u, a.where));
}
inline Float abs(const FloatOperand& a) {
  return float_value(Recorder::active().emit_immediate(Opcode::And, a.number, 0x7fffffffu, a.where));
}
inline Float min(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fmin, a, b)); }
inline Float max(const FloatOperand& a, const FloatOperand& b) { return float_value(binary(Opcode::Fmax, a, b)); }
inline Float sqrt(const FloatOperand& a) { return float_value(unary(Opcode::Fsqrt, a)); }
inline Float rsqrt(const FloatOperand& a) { return float_value(unary(Opcode::Frsqrt, a)); }
inline Float rcp(const FloatOperand& a) { return float_value(unary(Opcode::Frcp, a)); }
inline Float select(const BoolOperand& condition, const FloatOperand& a, const FloatOperand& b) {
  return float_value(Recorder::active().emit_select(condition.condition(), a.number, b.number, condition.where()));
}
inline Bool operator==(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Feq, a, b); }
inline Bool operator!=(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Fne, a, b); }
inline Bool operator<(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Flt, a, b); }
inline Bool operator<=(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Fle, a, b); }
inline Bool operator>(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Fgt, a, b); }
inline Bool operator>=(const FloatOperand& a, const FloatOperand& b) { return compare(Opcode::Fge, a, b); }
inline Float& Float::operator+=(const FloatOperand& b) { return *this = FloatOperand(*this, b.where) + b; }
inline Float& Float::operator-=(const FloatOperand& b) { return *this = FloatOperand(*this, b.where) - b; }
inline Float& Float::operator*=(const FloatOperand& b) { return *this = FloatOperand(*this, b.where) * b; }

// Conversions; the `as_` ones keep the bits.
inline Int to_int(const FloatOperand& a) { return int_value(unary(Opcode::F2i, a)); }
inline Float to_float(const IntOperand& a) { return float_value(unary(Opcode::I2f, a)); }
inline Int as_int(const FloatOperand& a) { return int_value(Recorder::active().emit_copy(a.number, a.where)); }
inline Float as_float(const IntOperand& a) { return float_value(Recorder::active().emit_copy(a.number, a.where)); }

}  // namespace recorded

/// What a kernel is given when it is recorded.
class RecordedKernel {
 public:
  using Bool = recorded::Bool;
  using Int = recorded::Int;
  using Float = recorded::Float;
  using BoolOperand = recorded::BoolOperand;

  /// `layout`: of what the kernel imports.
  explicit RecordedKernel(Recorder& recorder, bool culling = false, const RecordLayout& layout = {})
      : recorder_(recorder), culling_(culling), layout_(layout) {}

  bool culling() const { return culling_; }

  Int thread(Location where = Location::here()) { return index(Opcode::Tid, where); }
  Int block(Location where = Location::here()) { return index(Opcode::Block, where); }
  Int threads(Location where = Location::here()) { return index(Opcode::Threads, where); }
  Int blocks(Location where = Location::here()) { return index(Opcode::Blocks, where); }
  Int unit(Location where = Location::here()) { return index(Opcode::Unit, where); }
  Int int_argument(int number, Location where = Location::here()) {
    return recorded::int_value(argument(number, where));
  }
  Float float_argument(int number, Location where = Location::here()) {
    return recorded::float_value(argument(number, where));
  }

  Int load_int(const Int& address, int offset = 0, Location where = Location::here()) {
    return recorded::int_value(load(address, offset, where));
  }
  Float load_float(const Int& address, int offset = 0, Location where = Location::here()) {
    return recorded::float_value(load(address, offset, where));
  }
  void store(const Int& address, int offset, const Int& value, Location where = Location::here()) {
    store_number(address, offset, value.number(), where);
  }
  void store(const Int& address, int offset, const Float& value, Location where = Location::here()) {
    store_number(address, offset, value.number(), where);
  }

  /// The data cache forgets the line, so that a load sees what another unit has stored.
  void invalidate(const Int& address, int offset, const Location& where = Location::here());
  /// Waits until all that the thread has stored is in the memory, where other units see it: no ray leaves before.
  void wait_for_stores(const Int& address, int offset, const Location& where = Location::here());

  void ray_in(Location where = Location::here()) { recorder_.emit(Opcode::Rin, where); }
  void ray_out(Location where = Location::here()) { recorder_.emit(Opcode::Rout, where); }
  void frame_out(Location where = Location::here()) { recorder_.emit(Opcode::Rfb, where); }
  Int int_word(int number, Location where = Location::here()) { return recorded::int_value(word(number, where)); }
  Float float_word(int number, Location where = Location::here()) { return recorded::float_value(word(number, where)); }
  void set_word(int number, const Int& value, Location where = Location::here()) {
    write_word(number, value.number(), where);
  }
  void set_word(int number, const Float& value, Location where = Location::here()) {
    write_word(number, value.number(), where);
  }

  template <typename Then>
  void if_(const BoolOperand& condition, const Then& then) {
    recorder_.begin_if(condition.condition());
    then();
    recorder_.end_if();
  }
  template <typename Then, typename Else>
  void if_(const BoolOperand& condition, const Then& then, const Else& otherwise) {
    recorder_.begin_if(condition.condition());
    then();
    recorder_.begin_else();
    otherwise();
    recorder_.end_if();
  }
  template <typename ConditionOf, typename Body>
  void while_(const ConditionOf& condition, const Body& body, Location where = Location::here()) {
    const Bool first = condition();
    recorder_.begin_loop(first.number(), where);
    body();
    const Bool again = condition();
    recorder_.end_loop(again.number(), true);
  }

 private:
  Int index(Opcode opcode, const Location& where) { return recorded::int_value(recorder_.emit_value(opcode, where)); }
  int argument(int number, const Location& where);
  int load(const Int& address, int offset, const Location& where);
  void store_number(const Int& address, int offset, int value, const Location& where);
  uint8_t place(int number, const Location& where) const;
  int word(int number, const Location& where);
  void write_word(int number, int value, const Location& where);

  Recorder& recorder_;
  bool culling_;
  RecordLayout layout_;
};

}  // namespace raypool::kernel
