// What the lines of a shader compute.
#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"
#include "shader/lowering.hpp"
#include "shader/math.hpp"

namespace raypool::shader {

// NOLINTNEXTLINE(readability-function-size): a list of instructions
void Lowering::operation(const Line& line) {
  switch (line.op) {
    case spv::Op::OpAccessChain:
    case spv::Op::OpInBoundsAccessChain:
      return access(line);
    case spv::Op::OpLoad:
      return load(line);
    case spv::Op::OpStore:
      return store(line);
    case spv::Op::OpTraceRayKHR:
      return trace(line);
    case spv::Op::OpExecuteCallableKHR:
      return execute_callable(line);
    case spv::Op::OpImageWrite:
      return write_picture(line);
    case spv::Op::OpImageSampleExplicitLod:
    case spv::Op::OpImageSampleImplicitLod:
      return sample(line);
    case spv::Op::OpImageFetch:
      return fetch(line);
    case spv::Op::OpImageQuerySizeLod:
    case spv::Op::OpImageQuerySize:
      return query_size(line);
    case spv::Op::OpImage:
      images_[line.id] = images_.at(line.operands.at(0));
      return;
    case spv::Op::OpArrayLength: {
      Pointer pointer = pointer_of(line.operands.at(0));
      const uint32_t member = line.operands.at(1);
      const Type& block = module_.type(pointer.type);
      const uint32_t offset = module_.layout(pointer.type, member).offset;
      const uint32_t stride = std::max(1u, module_.type(block.members.at(member)).stride);
      set(line, {Scalar::constant(pointer.size < offset ? 0 : (pointer.size - offset) / stride)});
      return;
    }
    case spv::Op::OpReadClockKHR:
      // A picture must not depend on what draws it, so time passes from sample to sample.
      return set(line, {of(k_.int_argument(argument::kSample)), Scalar::constant(0)});
    case spv::Op::OpFunctionCall:
      fail(fmt::format("function '{}' calls itself, and there is no stack for it: write it as a loop",
                       module_.name_of(line.operands.at(0))));
    case spv::Op::OpExtInst:
      if (!module_.is_glsl_set(line.operands.at(0))) return;  // debug text
      return glsl(line);
    default:
      break;
  }
  if (wide_integers(line) || arithmetic(line) || conversion(line) || comparison(line) || logic(line) ||
      composite(line) || matrix(line))
    return;
  switch (line.op) {
    case spv::Op::OpImageRead:
      fail("imageLoad is not supported, as other kernels add to the picture meanwhile: carry the value in the payload");
    case spv::Op::OpReportIntersectionKHR:
      fail("intersection shaders are not supported: triangles are tested by the traverser");
    case spv::Op::OpControlBarrier:
    case spv::Op::OpMemoryBarrier:
      fail("barriers are not supported: threads share nothing");
    case spv::Op::OpImageGather:
    case spv::Op::OpImageDrefGather:
      fail("textureGather is not supported: fetch the four texels with texelFetch");
    case spv::Op::OpImageSampleDrefExplicitLod:
    case spv::Op::OpImageSampleDrefImplicitLod:
      fail("sampler2DShadow is not supported: sample a sampler2D and compare");
    case spv::Op::OpImageSampleProjExplicitLod:
    case spv::Op::OpImageSampleProjImplicitLod:
      fail("textureProj is not supported: divide by the last coordinate, and use textureLod");
    case spv::Op::OpRayQueryInitializeKHR:
    case spv::Op::OpRayQueryProceedKHR:
      fail("rayQueryEXT is not supported: trace with traceRayEXT, which the traverser does for a thread of its own");
    case spv::Op::OpDPdx:
    case spv::Op::OpDPdy:
    case spv::Op::OpFwidth:
      fail("derivatives are not supported: threads have no neighbours");
    default:
      break;
  }
  if (line.op >= spv::Op::OpAtomicLoad && line.op <= spv::Op::OpAtomicXor)
    fail("atomic operations are not supported: write to a place of the thread's own");
  fail(fmt::format("SPIR-V instruction {} is not supported: write the shader without it",
                   static_cast<uint32_t>(line.op)));
}

/// A product that an addition in the same block takes in, and nothing else.
bool Lowering::is_fused_later(const Line& line) const {
  if (module_.uses(line.id) != 1 || module_.decorations(line.id).no_contraction) return false;
  for (const Line& other : module_.block(current_).lines) {
    if (other.op != spv::Op::OpFAdd) continue;
    if (other.operands.at(0) != line.id && other.operands.at(1) != line.id) continue;
    return !module_.decorations(other.id).no_contraction;
  }
  return false;
}

void Lowering::product(const Line& line) {
  const Value a = get(line.operands.at(0));
  Value b = get(line.operands.at(1));
  if (b.size() < a.size()) b.resize(a.size(), b.at(0));  // times a scalar
  if (is_fused_later(line)) {
    products_[line.id] = {a, b};
    return;
  }
  Value value(a.size());
  for (size_t i = 0; i < a.size(); ++i) value[i] = binary(Opcode::Fmul, a[i], b[i]);
  set(line, value);
}

// NOLINTNEXTLINE(readability-function-size): a list of instructions
bool Lowering::arithmetic(const Line& line) {
  const auto each = [&](const auto& of_scalars) { return set_each(line, of_scalars); };
  const auto plain = [&](Opcode opcode) {
    return each([&](const Scalar& a, const Scalar& b) { return narrowed_result(line, binary(opcode, a, b)); });
  };
  const auto exact = [&](const auto& function) {
    return each([&](const Scalar& a, const Scalar& b) {
      const RecordedInt first = as_int(a), second = as_int(b);
      return narrowed_result(line, of(function(first, second)));
    });
  };
  switch (line.op) {
    case spv::Op::OpFMul:
    case spv::Op::OpVectorTimesScalar:
      product(line);
      return true;
    case spv::Op::OpFAdd: {
      for (const size_t taken : {0u, 1u}) {
        const auto found = products_.find(line.operands.at(taken));
        if (found == products_.end()) continue;
        const Product fused = found->second;
        products_.erase(found);
        const Value c = get(line.operands.at(1 - taken));
        Value value(c.size());
        for (size_t i = 0; i < c.size(); ++i) value[i] = multiply_add(fused.a[i], fused.b[i], c[i]);
        set(line, value);
        return true;
      }
      return plain(Opcode::Fadd);
    }
    case spv::Op::OpFSub:
      return plain(Opcode::Fsub);
    case spv::Op::OpFDiv:
      return each([&](const Scalar& a, const Scalar& b) {
        if (a.is_constant() && a.bits == as_bits(1.0f)) return unary(Opcode::Frcp, b);
        return binary(Opcode::Fdiv, a, b);
      });
    case spv::Op::OpFNegate:
      return each([&](const Scalar& a, const Scalar&) { return negate(a); });
    case spv::Op::OpFMod:
      return each([&](const Scalar& a, const Scalar& b) {
        const RecordedFloat first = as_float(a), second = as_float(b);
        return of(math::mod(k_, first, second));
      });
    case spv::Op::OpFRem:
      return each([&](const Scalar& a, const Scalar& b) {
        const RecordedFloat first = as_float(a), second = as_float(b);
        return of(math::rem(k_, first, second));
      });
    case spv::Op::OpIAdd:
      return plain(Opcode::Iadd);
    case spv::Op::OpISub:
      return plain(Opcode::Isub);
    case spv::Op::OpIMul:
      return plain(Opcode::Imul);
    case spv::Op::OpSNegate:
      return each([&](const Scalar& a, const Scalar&) {
        return narrowed_result(line, binary(Opcode::Isub, Scalar::constant(0), a));
      });
    case spv::Op::OpUDiv:
      return each([&](const Scalar& a, const Scalar& b) {
        if (b.is_constant() && b.bits != 0 && (b.bits & (b.bits - 1)) == 0)
          return immediate(Opcode::Shr, a, log2_of(b.bits));
        const RecordedInt first = as_int(a), second = as_int(b);
        return of(math::divide_unsigned(k_, first, second));
      });
    case spv::Op::OpUMod:
      return each([&](const Scalar& a, const Scalar& b) {
        if (b.is_constant() && b.bits != 0 && (b.bits & (b.bits - 1)) == 0)
          return immediate(Opcode::And, a, b.bits - 1);
        const RecordedInt first = as_int(a), second = as_int(b);
        return of(math::remainder_unsigned(k_, first, second));
      });
    case spv::Op::OpSDiv:
      return exact([&](const RecordedInt& a, const RecordedInt& b) { return math::divide_signed(k_, a, b); });
    case spv::Op::OpSRem:
      return exact([&](const RecordedInt& a, const RecordedInt& b) { return math::remainder_signed(k_, a, b); });
    case spv::Op::OpSMod:
      return exact([&](const RecordedInt& a, const RecordedInt& b) { return math::modulo_signed(k_, a, b); });
    case spv::Op::OpShiftLeftLogical:
      return plain(Opcode::Shl);
    case spv::Op::OpShiftRightLogical:
      return plain(Opcode::Shr);
    case spv::Op::OpShiftRightArithmetic:
      return plain(Opcode::Sar);
    case spv::Op::OpBitwiseAnd:
      return plain(Opcode::And);
    case spv::Op::OpBitwiseOr:
      return plain(Opcode::Or);
    case spv::Op::OpBitwiseXor:
      return plain(Opcode::Xor);
    case spv::Op::OpNot:
      return each(
          [&](const Scalar& a, const Scalar&) { return narrowed_result(line, immediate(Opcode::Xor, a, ~0u)); });
    case spv::Op::OpBitReverse:
      return exact([&](const RecordedInt& a, const RecordedInt&) { return math::bit_reverse(k_, a); });
    case spv::Op::OpBitCount:
      return exact([&](const RecordedInt& a, const RecordedInt&) { return math::bit_count(k_, a); });
    case spv::Op::OpBitFieldInsert:
    case spv::Op::OpBitFieldSExtract:
    case spv::Op::OpBitFieldUExtract: {
      const Value base = get(line.operands.at(0));
      const bool inserts = line.op == spv::Op::OpBitFieldInsert;
      const Value inserted = inserts ? get(line.operands.at(1)) : base;
      const RecordedInt offset = as_int(get_scalar(line.operands.at(inserts ? 2 : 1)));
      const RecordedInt bits = as_int(get_scalar(line.operands.at(inserts ? 3 : 2)));
      Value value(base.size());
      for (size_t i = 0; i < base.size(); ++i) {
        const RecordedInt whole = as_int(base[i]);
        if (inserts) {
          const RecordedInt part = as_int(inserted[i]);
          value[i] = of(math::bitfield_insert(k_, whole, part, offset, bits));
        } else if (line.op == spv::Op::OpBitFieldSExtract) {
          value[i] = of(math::bitfield_extract_signed(k_, whole, offset, bits));
        } else {
          value[i] = of(math::bitfield_extract_unsigned(k_, whole, offset, bits));
        }
      }
      set(line, value);
      return true;
    }
    case spv::Op::OpUMulExtended:
    case spv::Op::OpSMulExtended: {
      const Value a = get(line.operands.at(0)), b = get(line.operands.at(1));
      Value value(2 * a.size());
      for (size_t i = 0; i < a.size(); ++i) {
        value[i] = binary(Opcode::Imul, a[i], b[i]);
        value[a.size() + i] = upper_product(a[i], b[i], line.op == spv::Op::OpSMulExtended);
      }
      set(line, value);
      return true;
    }
    case spv::Op::OpIAddCarry:
    case spv::Op::OpISubBorrow: {
      const Value a = get(line.operands.at(0)), b = get(line.operands.at(1));
      Value value(2 * a.size());
      for (size_t i = 0; i < a.size(); ++i) {
        const bool adds = line.op == spv::Op::OpIAddCarry;
        value[i] = binary(adds ? Opcode::Iadd : Opcode::Isub, a[i], b[i]);
        const Scalar over = adds ? compare(Opcode::Ult, value[i], a[i]) : compare(Opcode::Ult, a[i], b[i]);
        value[a.size() + i] = select(over, Scalar::constant(1), Scalar::constant(0));
      }
      set(line, value);
      return true;
    }
    default:
      return false;
  }
}

/// Bits 63:32 of a product, from those of its 16-bit halves.
Scalar Lowering::upper_product(const Scalar& a, const Scalar& b, bool is_signed) {
  const auto low = [&](const Scalar& x) { return immediate(Opcode::And, x, 0xffff); };
  const auto high = [&](const Scalar& x) { return immediate(Opcode::Shr, x, 16); };
  const Scalar cross = binary(Opcode::Imul, high(a), low(b));
  const Scalar carried = binary(Opcode::Iadd, cross, high(binary(Opcode::Imul, low(a), low(b))));
  const Scalar other = binary(Opcode::Iadd, binary(Opcode::Imul, low(a), high(b)), low(carried));
  Scalar upper = binary(Opcode::Iadd, binary(Opcode::Imul, high(a), high(b)), high(carried));
  upper = binary(Opcode::Iadd, upper, high(other));
  if (!is_signed) return upper;
  // A negative factor counts 2^32 less.
  const auto if_negative = [&](const Scalar& x, const Scalar& y) {
    return binary(Opcode::And, immediate(Opcode::Sar, x, 31), y);
  };
  return binary(Opcode::Isub, binary(Opcode::Isub, upper, if_negative(a, b)), if_negative(b, a));
}

uint32_t Lowering::log2_of(uint32_t power) {
  uint32_t log2 = 0;
  while (1u << log2 != power) ++log2;
  return log2;
}

/// Of the line's type, which may have fewer than 32 bits.
Scalar Lowering::narrowed_result(const Line& line, const Scalar& value) {
  const Type& its = module_.type(line.type);
  return narrowed(its.kind == TypeKind::Vector ? its.element : line.type, value);
}

// NOLINTNEXTLINE(readability-function-size): a list of instructions
bool Lowering::conversion(const Line& line) {
  const auto each = [&](const auto& of_scalar) {
    Value value = get(line.operands.at(0));
    for (Scalar& scalar : value) scalar = of_scalar(scalar);
    set(line, value);
    return true;
  };
  switch (line.op) {
    case spv::Op::OpConvertFToS:
      return each([&](const Scalar& a) { return narrowed_result(line, unary(Opcode::F2i, a)); });
    case spv::Op::OpConvertSToF:
      return each([&](const Scalar& a) {
        if (a.is_constant()) return Scalar::constant(as_bits(static_cast<float>(static_cast<int32_t>(a.bits))));
        return unary(Opcode::I2f, a);
      });
    case spv::Op::OpConvertFToU:
      return each([&](const Scalar& a) {
        const RecordedFloat value = as_float(a);
        return narrowed_result(line, of(math::float_to_unsigned(k_, value)));
      });
    case spv::Op::OpConvertUToF:
      return each([&](const Scalar& a) {
        if (a.is_constant()) return Scalar::constant(as_bits(static_cast<float>(a.bits)));
        if (a.part != Scalar::Part::None) return unary(Opcode::I2f, a);  // 16 bits
        const RecordedInt value = as_int(a);
        return of(math::unsigned_to_float(k_, value));
      });
    case spv::Op::OpUConvert:
    case spv::Op::OpSConvert:
      // A narrow value is kept with zeros or its sign above it: it has its 32 bits already.
      return each([&](const Scalar& a) { return narrowed_result(line, a); });
    case spv::Op::OpFConvert:
      fail("floats of other than 32 bits are not supported: use float");
    case spv::Op::OpBitcast:
      if (module_.type(line.type).kind == TypeKind::Pointer) {
        // Its low word, as the memory has 32-bit addresses.
        set_address(line, get_scalar(line.operands.at(0)));
        return true;
      }
      return each([&](const Scalar& a) { return narrowed_result(line, a); });
    case spv::Op::OpConvertUToPtr:
      set_address(line, get_scalar(line.operands.at(0)));
      return true;
    case spv::Op::OpCopyObject:
    case spv::Op::OpCopyLogical:
      if (pointers_.count(line.operands.at(0)) != 0)
        pointers_[line.id] = pointers_.at(line.operands[0]);
      else if (images_.count(line.operands[0]) != 0)
        images_[line.id] = images_.at(line.operands[0]);
      else
        set(line, get(line.operands[0]));
      return true;
    case spv::Op::OpUndef:
      set(line, Value(module_.scalars(line.type)));
      return true;
    default:
      return false;
  }
}

// NOLINTNEXTLINE(readability-function-size): a list of instructions
bool Lowering::comparison(const Line& line) {
  const auto each = [&](const auto& of_scalars) { return set_each(line, of_scalars); };
  const auto plain = [&](Opcode opcode) {
    return each([&](const Scalar& a, const Scalar& b) { return compare(opcode, a, b); });
  };
  // True where either is a NaN: the inverse of the opposite, which is false there.
  const auto unordered = [&](Opcode opposite) {
    return each([&](const Scalar& a, const Scalar& b) { return inverse(compare(opposite, a, b)); });
  };
  const auto differs = [&](const Scalar& a, const Scalar& b) {
    return either(compare(Opcode::Flt, a, b), compare(Opcode::Fgt, a, b));
  };
  switch (line.op) {
    case spv::Op::OpIEqual:
      return plain(Opcode::Ieq);
    case spv::Op::OpINotEqual:
      return plain(Opcode::Ine);
    case spv::Op::OpSLessThan:
      return plain(Opcode::Ilt);
    case spv::Op::OpSLessThanEqual:
      return plain(Opcode::Ile);
    case spv::Op::OpSGreaterThan:
      return plain(Opcode::Igt);
    case spv::Op::OpSGreaterThanEqual:
      return plain(Opcode::Ige);
    case spv::Op::OpULessThan:
      return plain(Opcode::Ult);
    case spv::Op::OpULessThanEqual:
      return plain(Opcode::Ule);
    case spv::Op::OpUGreaterThan:
      return plain(Opcode::Ugt);
    case spv::Op::OpUGreaterThanEqual:
      return plain(Opcode::Uge);
    case spv::Op::OpFOrdEqual:
      return plain(Opcode::Feq);
    case spv::Op::OpFUnordNotEqual:
      return plain(Opcode::Fne);
    case spv::Op::OpFOrdNotEqual:
      return each(differs);
    case spv::Op::OpFUnordEqual:
      return each([&](const Scalar& a, const Scalar& b) { return inverse(differs(a, b)); });
    case spv::Op::OpFOrdLessThan:
      return plain(Opcode::Flt);
    case spv::Op::OpFOrdLessThanEqual:
      return plain(Opcode::Fle);
    case spv::Op::OpFOrdGreaterThan:
      return plain(Opcode::Fgt);
    case spv::Op::OpFOrdGreaterThanEqual:
      return plain(Opcode::Fge);
    case spv::Op::OpFUnordLessThan:
      return unordered(Opcode::Fge);
    case spv::Op::OpFUnordLessThanEqual:
      return unordered(Opcode::Fgt);
    case spv::Op::OpFUnordGreaterThan:
      return unordered(Opcode::Fle);
    case spv::Op::OpFUnordGreaterThanEqual:
      return unordered(Opcode::Flt);
    case spv::Op::OpIsNan:
      return each([&](const Scalar& a, const Scalar&) { return compare(Opcode::Fne, a, a); });
    case spv::Op::OpIsInf:
      return each([&](const Scalar& a, const Scalar&) {
        return compare(Opcode::Ieq, immediate(Opcode::And, a, 0x7fffffffu), Scalar::constant(0x7f800000u));
      });
    default:
      return false;
  }
}

bool Lowering::logic(const Line& line) {
  const auto each = [&](const auto& of_scalars) { return set_each(line, of_scalars); };
  const auto differ = [&](const Scalar& a, const Scalar& b) {
    if (a.is_constant()) return a.bits != 0 ? inverse(b) : b;
    if (b.is_constant()) return b.bits != 0 ? inverse(a) : a;
    const Scalar value = Scalar::in_predicate(recorder_.emit_predicates(Opcode::Pxor, a.number, b.number, where_));
    return a.negated != b.negated ? inverse(value) : value;
  };
  switch (line.op) {
    case spv::Op::OpLogicalAnd:
      return each([&](const Scalar& a, const Scalar& b) { return both(a, b); });
    case spv::Op::OpLogicalOr:
      return each([&](const Scalar& a, const Scalar& b) { return either(a, b); });
    case spv::Op::OpLogicalNot:
      return each([&](const Scalar& a, const Scalar&) { return inverse(a); });
    case spv::Op::OpLogicalNotEqual:
      return each(differ);
    case spv::Op::OpLogicalEqual:
      return each([&](const Scalar& a, const Scalar& b) { return inverse(differ(a, b)); });
    case spv::Op::OpAny:
    case spv::Op::OpAll: {
      const bool any = line.op == spv::Op::OpAny;
      Scalar result = Scalar::constant(any ? 0 : 1);
      for (const Scalar& scalar : get(line.operands.at(0)))
        result = any ? either(result, scalar) : both(result, scalar);
      set(line, {result});
      return true;
    }
    case spv::Op::OpSelect: {
      const Value chosen = get(line.operands.at(0)), a = get(line.operands.at(1)), b = get(line.operands.at(2));
      set(line, select(line.type, chosen, a, b));
      return true;
    }
    default:
      return false;
  }
}

/// The part of so many scalars with this number, which is known only when the shader runs.
Value Lowering::dynamic_part(const Value& whole, uint32_t part_scalars, const Scalar& index) {
  if (index.is_constant()) {
    const size_t first = static_cast<size_t>(index.bits) * part_scalars;
    if (first + part_scalars > whole.size()) return Value(part_scalars);
    return {whole.begin() + static_cast<std::ptrdiff_t>(first),
            whole.begin() + static_cast<std::ptrdiff_t>(first + part_scalars)};
  }
  Value part(whole.begin(), whole.begin() + part_scalars);
  for (uint32_t n = 1; n < whole.size() / part_scalars; ++n) {
    const Scalar chosen = compare(Opcode::Ieq, index, Scalar::constant(n));
    for (uint32_t i = 0; i < part_scalars; ++i) part[i] = select(chosen, whole[n * part_scalars + i], part[i]);
  }
  return part;
}

// NOLINTNEXTLINE(readability-function-size): a list of instructions
bool Lowering::composite(const Line& line) {
  // Where a part lies in the scalars of a value.
  const auto place = [&](uint32_t type, size_t first_index) {
    size_t offset = 0;
    for (size_t i = first_index; i < line.operands.size(); ++i) {
      const Type& its = module_.type(type);
      const uint32_t index = line.operands[i];
      if (its.kind == TypeKind::Struct) {
        for (uint32_t m = 0; m < index; ++m) offset += module_.scalars(its.members.at(m));
        type = its.members.at(index);
      } else {
        type = its.element;
        offset += static_cast<size_t>(index) * module_.scalars(type);
      }
    }
    return offset;
  };
  switch (line.op) {
    case spv::Op::OpCompositeConstruct: {
      Value value;
      for (const uint32_t part : line.operands) {
        const Value its = get(part);
        value.insert(value.end(), its.begin(), its.end());
      }
      set(line, value);
      return true;
    }
    case spv::Op::OpCompositeExtract: {
      const Value whole = get(line.operands.at(0));
      const size_t offset = place(type_of(line.operands[0]), 1), size = module_.scalars(line.type);
      set(line, {whole.begin() + static_cast<std::ptrdiff_t>(offset),
                 whole.begin() + static_cast<std::ptrdiff_t>(offset + size)});
      return true;
    }
    case spv::Op::OpCompositeInsert: {
      const Value part = get(line.operands.at(0));
      Value whole = get(line.operands.at(1));
      std::copy(part.begin(), part.end(), whole.begin() + static_cast<std::ptrdiff_t>(place(line.type, 2)));
      set(line, whole);
      return true;
    }
    case spv::Op::OpVectorShuffle: {
      const Value a = get(line.operands.at(0)), b = get(line.operands.at(1));
      Value value;
      for (size_t i = 2; i < line.operands.size(); ++i) {
        const uint32_t index = line.operands[i];
        value.push_back(index == 0xffffffffu ? Scalar{} : index < a.size() ? a[index] : b.at(index - a.size()));
      }
      set(line, value);
      return true;
    }
    case spv::Op::OpVectorExtractDynamic: {
      const Value whole = get(line.operands.at(0));
      set(line, dynamic_part(whole, 1, get_scalar(line.operands.at(1))));
      return true;
    }
    case spv::Op::OpVectorInsertDynamic: {
      Value whole = get(line.operands.at(0));
      const Scalar part = get_scalar(line.operands.at(1)), index = get_scalar(line.operands.at(2));
      for (uint32_t i = 0; i < whole.size(); ++i)
        whole[i] = select(compare(Opcode::Ieq, index, Scalar::constant(i)), part, whole[i]);
      set(line, whole);
      return true;
    }
    default:
      return false;
  }
}

Scalar Lowering::dot(const Value& a, const Value& b) {
  Scalar sum = binary(Opcode::Fmul, a.at(0), b.at(0));
  for (size_t i = 1; i < a.size(); ++i) sum = multiply_add(a[i], b[i], sum);
  return sum;
}

// NOLINTNEXTLINE(readability-function-size): a list of instructions
bool Lowering::matrix(const Line& line) {
  const auto column = [](const Value& whole, size_t rows, size_t number) {
    return Value(whole.begin() + static_cast<std::ptrdiff_t>(rows * number),
                 whole.begin() + static_cast<std::ptrdiff_t>(rows * (number + 1)));
  };
  const auto times = [&](const Value& whole, size_t rows, const Value& vector) {
    Value sum(rows);
    for (size_t r = 0; r < rows; ++r) {
      sum[r] = binary(Opcode::Fmul, whole[r], vector[0]);
      for (size_t c = 1; c < vector.size(); ++c) sum[r] = multiply_add(whole[c * rows + r], vector[c], sum[r]);
    }
    return sum;
  };
  switch (line.op) {
    case spv::Op::OpDot:
      set(line, {dot(get(line.operands.at(0)), get(line.operands.at(1)))});
      return true;
    case spv::Op::OpMatrixTimesScalar: {
      Value value = get(line.operands.at(0));
      const Scalar factor = get_scalar(line.operands.at(1));
      for (Scalar& scalar : value) scalar = binary(Opcode::Fmul, scalar, factor);
      set(line, value);
      return true;
    }
    case spv::Op::OpMatrixTimesVector: {
      const Value whole = get(line.operands.at(0)), vector = get(line.operands.at(1));
      set(line, times(whole, whole.size() / vector.size(), vector));
      return true;
    }
    case spv::Op::OpVectorTimesMatrix: {
      const Value vector = get(line.operands.at(0)), whole = get(line.operands.at(1));
      Value value;
      for (size_t c = 0; c < whole.size() / vector.size(); ++c)
        value.push_back(dot(vector, column(whole, vector.size(), c)));
      set(line, value);
      return true;
    }
    case spv::Op::OpMatrixTimesMatrix: {
      const Value a = get(line.operands.at(0)), b = get(line.operands.at(1));
      const size_t columns = module_.type(line.type).count, rows = module_.scalars(line.type) / columns;
      const size_t inner = b.size() / columns;
      Value value;
      for (size_t c = 0; c < columns; ++c) {
        const Value part = times(a, rows, column(b, inner, c));
        value.insert(value.end(), part.begin(), part.end());
      }
      set(line, value);
      return true;
    }
    case spv::Op::OpOuterProduct: {
      const Value a = get(line.operands.at(0)), b = get(line.operands.at(1));
      Value value;
      for (const Scalar& factor : b)
        for (const Scalar& scalar : a) value.push_back(binary(Opcode::Fmul, scalar, factor));
      set(line, value);
      return true;
    }
    case spv::Op::OpTranspose: {
      const Value whole = get(line.operands.at(0));
      const size_t rows = module_.type(line.type).count, columns = whole.size() / rows;
      Value value;
      for (size_t r = 0; r < rows; ++r)
        for (size_t c = 0; c < columns; ++c) value.push_back(whole[c * rows + r]);
      set(line, value);
      return true;
    }
    default:
      return false;
  }
}

}  // namespace raypool::shader
