// Integers of 64 bits: addresses of buffers, of which the machine uses the low word, and what is computed of them.
#include "shader/lowering.hpp"

namespace raypool::shader {
namespace {

constexpr uint32_t kWordBits = 32, kBits = 64;

}  // namespace

Value Lowering::wide_sum(bool adds, const Value& a, const Value& b) {
  const Opcode opcode = adds ? Opcode::Iadd : Opcode::Isub;
  const Scalar low = binary(opcode, a.at(0), b.at(0));
  const Scalar over = adds ? compare(Opcode::Ult, low, a[0]) : compare(Opcode::Ult, a[0], b[0]);
  const Scalar carry = select(over, Scalar::constant(1), Scalar::constant(0));
  return {low, binary(opcode, binary(opcode, a.at(1), b.at(1)), carry)};
}

Value Lowering::wide_product(const Value& a, const Value& b) {
  const Scalar cross =
      binary(Opcode::Iadd, binary(Opcode::Imul, a.at(1), b.at(0)), binary(Opcode::Imul, a.at(0), b.at(1)));
  return {binary(Opcode::Imul, a[0], b[0]), binary(Opcode::Iadd, upper_product(a[0], b[0], false), cross)};
}

/// By less than 64 places.
Value Lowering::wide_shift(bool is_left, const Value& a, uint32_t places) {
  const Opcode moves = is_left ? Opcode::Shl : Opcode::Shr, fills = is_left ? Opcode::Shr : Opcode::Shl;
  const size_t from = is_left ? 0 : 1, to = 1 - from;  // bits go from one word to the other
  Value value(2, Scalar::constant(0));
  if (places >= kWordBits) {
    value[to] = immediate(moves, a.at(from), places - kWordBits);
    return value;
  }
  value[from] = immediate(moves, a.at(from), places);
  value[to] = immediate(moves, a.at(to), places);
  if (places != 0) value[to] = binary(Opcode::Or, value[to], immediate(fills, a[from], kWordBits - places));
  return value;
}

/// Of one integer, whose scalars `a` are, and of a second one, if there is one. Nothing: it is not supported.
std::optional<Value> Lowering::of_wide(const Line& line, bool gives, const Value& a, const Value& b) {
  switch (line.op) {
    case spv::Op::OpIAdd:
    case spv::Op::OpISub:
      return wide_sum(line.op == spv::Op::OpIAdd, a, b);
    case spv::Op::OpIMul:
      return wide_product(a, b);
    case spv::Op::OpUConvert:
    case spv::Op::OpSConvert:
      if (!gives) return Value{narrowed_result(line, a.at(0))};
      if (line.op == spv::Op::OpUConvert) return Value{a.at(0), Scalar::constant(0)};
      return Value{a.at(0), immediate(Opcode::Sar, a[0], kWordBits - 1)};
    case spv::Op::OpShiftLeftLogical:
    case spv::Op::OpShiftRightLogical:
      if (!b.at(0).is_constant() || b[0].bits >= kBits) return std::nullopt;
      return wide_shift(line.op == spv::Op::OpShiftLeftLogical, a, b[0].bits);
    case spv::Op::OpIEqual:
    case spv::Op::OpINotEqual: {
      const Scalar equal = both(compare(Opcode::Ieq, a.at(0), b.at(0)), compare(Opcode::Ieq, a.at(1), b.at(1)));
      return Value{line.op == spv::Op::OpIEqual ? equal : inverse(equal)};
    }
    default:
      return std::nullopt;
  }
}

/// Whether the line has been one of 64-bit integers. What it does scalar by scalar is left to others.
bool Lowering::wide_integers(const Line& line) {
  const auto is_pointer = [&](uint32_t type) { return type != 0 && module_.type(type).kind == TypeKind::Pointer; };
  const auto is_wide = [&](uint32_t type) {
    if (type == 0) return false;
    return module_.is_wide(module_.type(type).kind == TypeKind::Vector ? module_.type(type).element : type);
  };
  if (line.operands.empty()) return false;
  const uint32_t given = type_of(line.operands[0]);
  const bool gives = is_wide(line.type), takes = is_wide(given);
  if (line.op == spv::Op::OpConvertPtrToU || (line.op == spv::Op::OpBitcast && is_pointer(given))) {
    const auto [base, offset] = address(pointer_of(line.operands[0]));
    Value value(module_.scalars(line.type), Scalar::constant(0));
    value.at(0) = binary(Opcode::Iadd, base, Scalar::constant(offset));
    set(line, value);
    return true;
  }
  if ((!gives && !takes) || is_pointer(line.type)) return false;
  switch (line.op) {
    case spv::Op::OpBitwiseAnd:
    case spv::Op::OpBitwiseOr:
    case spv::Op::OpBitwiseXor:
    case spv::Op::OpNot:
    case spv::Op::OpBitcast:
    case spv::Op::OpSelect:
    case spv::Op::OpCopyObject:
    case spv::Op::OpCompositeConstruct:
    case spv::Op::OpCompositeExtract:
    case spv::Op::OpUndef:
      return false;
    default:
      break;
  }
  if (module_.type(gives ? line.type : given).kind == TypeKind::Int) {
    const Value a = get(line.operands[0]);
    if (const auto value = of_wide(line, gives, a, line.operands.size() > 1 ? get(line.operands[1]) : a)) {
      set(line, *value);
      return true;
    }
  }
  const bool is_of_float = line.op == spv::Op::OpConvertFToU || line.op == spv::Op::OpConvertFToS;
  if (!takes && !is_of_float) return false;  // a part of something that has some
  fail(
      "of 64-bit integers, which hold addresses, this is not supported: add, subtract, multiply, compare for "
      "equality, shift by a constant or convert them, one at a time, or compute in uint");
}

}  // namespace raypool::shader
