// Scalars of a shader as instructions.
#include "arith/arith.hpp"
#include "bits.hpp"
#include "shader/lowering.hpp"

namespace raypool::shader {

using kernel::Condition;

Value Lowering::get(uint32_t id) {
  const auto product = products_.find(id);
  if (product != products_.end()) {
    // No sum takes it in: it becomes a multiplication.
    const Product waiting = product->second;
    products_.erase(product);
    Value value(waiting.a.size());
    for (size_t i = 0; i < value.size(); ++i) value[i] = kept(id, i, binary(Opcode::Fmul, waiting.a[i], waiting.b[i]));
    values_[id] = value;
  }
  const auto found = values_.find(id);
  if (found == values_.end()) fail("this value is not supported: use numbers, vectors, matrices, arrays and structs");
  return found->second;
}

void Lowering::set(const Line& line, Value value) {
  for (size_t i = 0; i < value.size(); ++i) value[i] = kept(line.id, i, value[i]);
  values_[line.id] = std::move(value);
}

/// A scalar of a value, in its variable if it has one.
Scalar Lowering::kept(uint32_t id, size_t number, const Scalar& scalar) {
  const auto variables = kept_.find(id);
  if (variables == kept_.end()) return scalar;
  // What is held across a trace comes from the path's record, whatever it was.
  const bool is_held = waits_ != nullptr && waits_->values.count(id) != 0 && module_.scalars(type_of(id)) != 0;
  if (!is_held && (scalar.is_constant() || scalar.is_undefined())) return scalar;
  assign(variables->second.at(number), scalar);
  return variables->second.at(number);
}

int Lowering::reg(const Scalar& scalar) {
  switch (scalar.kind) {
    case Scalar::Kind::Register:
      return scalar.number;
    case Scalar::Kind::Predicate:
      return recorder_.emit_select(condition(scalar), recorder_.emit_constant(1, where_),
                                   recorder_.emit_constant(0, where_), where_);
    default:
      return recorder_.emit_constant(scalar.bits, where_);
  }
}

Condition Lowering::condition(const Scalar& scalar) {
  if (scalar.kind == Scalar::Kind::Predicate) return {scalar.number, scalar.negated, where_};
  // One of an array of constants, chosen by an index.
  if (scalar.kind == Scalar::Kind::Register)
    return {compare(Opcode::Ine, scalar, Scalar::constant(0)).number, false, where_};
  return {0, scalar.bits == 0, where_};
}

int Lowering::predicate(const Scalar& scalar) {
  if (scalar.kind == Scalar::Kind::Predicate && !scalar.negated) return scalar.number;
  if (scalar.kind == Scalar::Kind::Predicate) return recorder_.materialise(condition(scalar));
  if (scalar.kind == Scalar::Kind::Register) return condition(scalar).predicate;
  return recorder_.emit_predicates(scalar.bits != 0 ? Opcode::Pand : Opcode::Pxor, 0, 0, where_);
}

Lowering::RecordedInt Lowering::as_int(const Scalar& scalar) { return RecordedInt(RecordedInt::Number{reg(scalar)}); }
Lowering::RecordedFloat Lowering::as_float(const Scalar& scalar) {
  return RecordedFloat(RecordedFloat::Number{reg(scalar)});
}
Lowering::RecordedBool Lowering::as_bool(const Scalar& scalar) { return RecordedBool::of(predicate(scalar)); }

// NOLINTNEXTLINE(readability-function-size): a list of instructions
Scalar Lowering::binary(Opcode opcode, const Scalar& a, const Scalar& b) {
  if (a.is_constant() && b.is_constant()) {
    switch (opcode) {
      case Opcode::Iadd:
        return Scalar::constant(a.bits + b.bits);
      case Opcode::Isub:
        return Scalar::constant(a.bits - b.bits);
      case Opcode::Imul:
        return Scalar::constant(a.bits * b.bits);
      case Opcode::And:
        return Scalar::constant(a.bits & b.bits);
      case Opcode::Or:
        return Scalar::constant(a.bits | b.bits);
      case Opcode::Xor:
        return Scalar::constant(a.bits ^ b.bits);
      case Opcode::Shl:
        return Scalar::constant(a.bits << (b.bits & 31));
      case Opcode::Shr:
        return Scalar::constant(a.bits >> (b.bits & 31));
      case Opcode::Sar:
        return Scalar::constant(static_cast<uint32_t>(static_cast<int32_t>(a.bits) >> (b.bits & 31)));
      // Of floats the compiler knows the nearest, whatever the machine would make of them.
      case Opcode::Fadd:
        return Scalar::constant(arith::add(a.bits, b.bits, {}));
      case Opcode::Fsub:
        return Scalar::constant(arith::sub(a.bits, b.bits, {}));
      case Opcode::Fmul:
        return Scalar::constant(arith::mul(a.bits, b.bits, {}));
      case Opcode::Fdiv:
        return Scalar::constant(arith::div(a.bits, b.bits, {}));
      case Opcode::Fmin:
        return Scalar::constant(arith::min(a.bits, b.bits, {}));
      case Opcode::Fmax:
        return Scalar::constant(arith::max(a.bits, b.bits, {}));
      default:
        break;
    }
  }
  const auto is = [](const Scalar& scalar, uint32_t bits) { return scalar.is_constant() && scalar.bits == bits; };
  switch (opcode) {
    case Opcode::Iadd:
    case Opcode::Or:
    case Opcode::Xor:
      if (is(a, 0)) return b;
      if (is(b, 0)) return a;
      break;
    case Opcode::Isub:
    case Opcode::Shl:
    case Opcode::Shr:
    case Opcode::Sar:
      if (is(b, 0)) return a;
      break;
    case Opcode::Imul:
      if (is(b, 1)) return a;
      if (is(a, 1)) return b;
      if (b.is_constant() && b.bits != 0 && (b.bits & (b.bits - 1)) == 0) return scaled(a, b.bits);
      if (a.is_constant() && a.bits != 0 && (a.bits & (a.bits - 1)) == 0) return scaled(b, a.bits);
      break;
    case Opcode::Fmul:
      if (is(b, as_bits(1.0f))) return a;
      if (is(a, as_bits(1.0f))) return b;
      break;
    default:
      break;
  }
  const int first = reg(a);
  return Scalar::in_register(recorder_.emit_binary(opcode, first, reg(b), where_));
}

Scalar Lowering::compare(Opcode opcode, const Scalar& a, const Scalar& b) {
  if (a.is_constant() && b.is_constant()) {
    const auto sa = static_cast<int32_t>(a.bits), sb = static_cast<int32_t>(b.bits);
    switch (opcode) {
      case Opcode::Ieq:
        return Scalar::constant(a.bits == b.bits);
      case Opcode::Ine:
        return Scalar::constant(a.bits != b.bits);
      case Opcode::Ilt:
        return Scalar::constant(sa < sb);
      case Opcode::Ile:
        return Scalar::constant(sa <= sb);
      case Opcode::Igt:
        return Scalar::constant(sa > sb);
      case Opcode::Ige:
        return Scalar::constant(sa >= sb);
      case Opcode::Ult:
        return Scalar::constant(a.bits < b.bits);
      case Opcode::Ule:
        return Scalar::constant(a.bits <= b.bits);
      case Opcode::Ugt:
        return Scalar::constant(a.bits > b.bits);
      case Opcode::Uge:
        return Scalar::constant(a.bits >= b.bits);
      case Opcode::Feq:
        return Scalar::constant(arith::equal(a.bits, b.bits, {}));
      case Opcode::Fne:
        return Scalar::constant(arith::not_equal(a.bits, b.bits, {}));
      case Opcode::Flt:
        return Scalar::constant(arith::less(a.bits, b.bits, {}));
      case Opcode::Fle:
        return Scalar::constant(arith::less_equal(a.bits, b.bits, {}));
      case Opcode::Fgt:
        return Scalar::constant(arith::greater(a.bits, b.bits, {}));
      case Opcode::Fge:
        return Scalar::constant(arith::greater_equal(a.bits, b.bits, {}));
      default:
        break;
    }
  }
  const int first = reg(a);
  return Scalar::in_predicate(recorder_.emit_binary(opcode, first, reg(b), where_));
}

Scalar Lowering::unary(Opcode opcode, const Scalar& a) {
  if (a.is_constant()) {
    switch (opcode) {
      case Opcode::Frcp:
        return Scalar::constant(arith::rcp(a.bits, {}));
      case Opcode::Fsqrt:
        return Scalar::constant(arith::sqrt(a.bits, {}));
      case Opcode::Frsqrt:
        return Scalar::constant(arith::rsqrt(a.bits, {}));
      case Opcode::I2f:
        return Scalar::constant(arith::from_int(a.bits, {}));
      case Opcode::F2i:
        return Scalar::constant(arith::to_int(a.bits, {}));
      default:
        break;
    }
  }
  return Scalar::in_register(recorder_.emit_unary(opcode, reg(a), where_));
}

Scalar Lowering::immediate(Opcode opcode, const Scalar& a, uint32_t bits) {
  return binary(opcode, a, Scalar::constant(bits));
}

Scalar Lowering::multiply_add(const Scalar& a, const Scalar& b, const Scalar& c) {
  if (a.is_constant() && b.is_constant()) return binary(Opcode::Fadd, binary(Opcode::Fmul, a, b), c);
  const int first = reg(a), second = reg(b);
  return Scalar::in_register(recorder_.emit_multiply_add(first, second, reg(c), where_));
}

Scalar Lowering::scaled(const Scalar& index, uint32_t stride) {
  if (index.is_constant()) return Scalar::constant(index.bits * stride);
  if (stride == 1) return index;
  if ((stride & (stride - 1)) == 0 && stride != 0) {
    uint32_t shift = 0;
    while (1u << shift != stride) ++shift;
    return immediate(Opcode::Shl, index, shift);
  }
  return immediate(Opcode::Imul, index, stride);
}

Scalar Lowering::inverse(Scalar a) {
  if (a.is_constant()) return Scalar::constant(a.bits ^ 1);
  a.negated = !a.negated;
  return a;
}

Scalar Lowering::both(const Scalar& a, const Scalar& b) {
  if (a.is_constant()) return a.bits != 0 ? b : a;
  if (b.is_constant()) return b.bits != 0 ? a : b;
  if (b.negated) return Scalar::in_predicate(recorder_.emit_predicates(Opcode::Pandn, predicate(a), b.number, where_));
  if (a.negated) return Scalar::in_predicate(recorder_.emit_predicates(Opcode::Pandn, b.number, a.number, where_));
  return Scalar::in_predicate(recorder_.emit_predicates(Opcode::Pand, a.number, b.number, where_));
}

Scalar Lowering::either(const Scalar& a, const Scalar& b) {
  if (a.is_constant()) return a.bits != 0 ? a : b;
  if (b.is_constant()) return b.bits != 0 ? b : a;
  if (a.negated && b.negated) {
    const Scalar all = both(inverse(a), inverse(b));
    return inverse(all);
  }
  const int first = predicate(a);
  return Scalar::in_predicate(recorder_.emit_predicates(Opcode::Por, first, predicate(b), where_));
}

Scalar Lowering::select(const Scalar& chosen, const Scalar& a, const Scalar& b) {
  if (chosen.is_constant()) return chosen.bits != 0 ? a : b;
  if (a == b || b.is_undefined()) return a;
  if (a.is_undefined()) return b;
  if (a.kind == Scalar::Kind::Predicate || b.kind == Scalar::Kind::Predicate) {
    if (a.is_constant()) return a.bits != 0 ? either(chosen, b) : both(inverse(chosen), b);
    if (b.is_constant()) return b.bits != 0 ? either(inverse(chosen), a) : both(chosen, a);
    const Scalar yes = both(chosen, a);
    return either(yes, both(inverse(chosen), b));
  }
  const int first = reg(a);
  return Scalar::in_register(recorder_.emit_select(condition(chosen), first, reg(b), where_));
}

Value Lowering::select(uint32_t type, const Value& conditions, const Value& a, const Value& b) {
  Value value(a.size());
  for (uint32_t i = 0; i < value.size(); ++i) {
    const Scalar& chosen = conditions[conditions.size() == 1 ? 0 : i];
    const bool is_known = chosen.is_constant() || !a[i].is_constant() || !b[i].is_constant() || a[i] == b[i];
    if (is_known || !is_condition(type, i))
      value[i] = select(chosen, a[i], b[i]);
    else
      value[i] = a[i].bits != 0 ? chosen : inverse(chosen);
  }
  return value;
}

Scalar Lowering::copy(const Scalar& a) {
  if (a.kind == Scalar::Kind::Register) return Scalar::in_register(recorder_.emit_copy(a.number, where_));
  if (a.kind == Scalar::Kind::Predicate) return Scalar::in_predicate(recorder_.materialise(condition(a)));
  return a;
}

Scalar Lowering::declare(bool is_condition) {
  return is_condition ? Scalar::in_predicate(recorder_.declare_predicate())
                      : Scalar::in_register(recorder_.declare_register());
}

void Lowering::assign(Scalar& variable, const Scalar& source) {
  if (source.is_undefined()) return;
  if (variable.kind == Scalar::Kind::Predicate) {
    recorder_.assign_predicate(variable.number, predicate(source), false);
  } else {
    recorder_.assign_register(variable.number, reg(source), source.kind != Scalar::Kind::Register);
  }
}

bool Lowering::is_condition(uint32_t type, uint32_t scalar) const {
  const Type& its = module_.type(type);
  switch (its.kind) {
    case TypeKind::Bool:
      return true;
    case TypeKind::Vector:
    case TypeKind::Matrix:
    case TypeKind::Array:
      return is_condition(its.element, scalar % std::max(1u, module_.scalars(its.element)));
    case TypeKind::Struct:
      for (const uint32_t member : its.members) {
        const uint32_t size = module_.scalars(member);
        if (scalar < size) return is_condition(member, scalar);
        scalar -= size;
      }
      return false;
    default:
      return false;
  }
}

/// A result of fewer than 32 bits, with zeros or its sign above them.
Scalar Lowering::narrowed(uint32_t type, const Scalar& value) {
  const Type& its = module_.type(type);
  if (its.kind != TypeKind::Int || its.bits >= 32) return value;
  if (!its.is_signed) return immediate(Opcode::And, value, (1u << its.bits) - 1);
  return immediate(Opcode::Sar, immediate(Opcode::Shl, value, 32 - its.bits), 32 - its.bits);
}

}  // namespace raypool::shader
