// GLSL's own functions, as the extended instructions of GLSL.std.450.
#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include "bits.hpp"
#include "shader/lowering.hpp"
#include "shader/math.hpp"

namespace raypool::shader {

void Lowering::glsl(const Line& line) {
  std::vector<Value> operands;
  for (size_t i = 2; i < line.operands.size(); ++i) {
    const uint32_t id = line.operands[i];
    // The second result of modf and frexp goes to a pointer.
    operands.push_back(module_.type(type_of(id)).kind == TypeKind::Pointer ? Value{} : get(id));
  }
  std::optional<Value> result = glsl_of_vectors(line, operands);
  if (!result) result = glsl_of_floats(line, operands);
  if (!result) result = glsl_of_integers(line, operands);
  if (!result) {
    fail(fmt::format("function {} of GLSL.std.450 is not supported: write the shader without it", line.operands.at(1)));
  }
  set(line, *result);
}

/// Component by component.
// NOLINTNEXTLINE(readability-function-size): a list of functions
std::optional<Value> Lowering::glsl_of_floats(const Line& line, const std::vector<Value>& operands) {
  const Value& first = operands.at(0);
  const auto one = [&](const auto& function) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) {
      const RecordedFloat x = as_float(first[i]);
      value[i] = of(function(k_, x));
    }
    return value;
  };
  const auto two = [&](const auto& function) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) {
      const RecordedFloat x = as_float(first[i]), y = as_float(operands.at(1).at(i));
      value[i] = of(function(k_, x, y));
    }
    return value;
  };
  const auto three = [&](const auto& function) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) {
      const RecordedFloat x = as_float(first[i]), y = as_float(operands.at(1).at(i)),
                          z = as_float(operands.at(2).at(i));
      value[i] = of(function(k_, x, y, z));
    }
    return value;
  };
  const auto plain = [&](Opcode opcode) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) value[i] = binary(opcode, first[i], operands.at(1).at(i));
    return value;
  };
  switch (line.operands.at(1)) {
    case GLSLstd450Round:
    case GLSLstd450RoundEven:
      return one([](auto& k, const auto& x) { return math::round(k, x); });
    case GLSLstd450Trunc:
      return one([](auto& k, const auto& x) { return math::trunc(k, x); });
    case GLSLstd450FAbs: {
      Value value = first;
      for (Scalar& scalar : value) scalar = immediate(Opcode::And, scalar, 0x7fffffffu);
      return value;
    }
    case GLSLstd450FSign:
      return one([](auto& k, const auto& x) { return math::sign(k, x); });
    case GLSLstd450Floor:
      return one([](auto& k, const auto& x) { return math::floor(k, x); });
    case GLSLstd450Ceil:
      return one([](auto& k, const auto& x) { return math::ceil(k, x); });
    case GLSLstd450Fract:
      return one([](auto& k, const auto& x) { return math::fract(k, x); });
    case GLSLstd450Radians:
      return one([](auto& k, const auto& x) { return math::radians(k, x); });
    case GLSLstd450Degrees:
      return one([](auto& k, const auto& x) { return math::degrees(k, x); });
    case GLSLstd450Sin:
      return one([](auto& k, const auto& x) { return math::sin(k, x); });
    case GLSLstd450Cos:
      return one([](auto& k, const auto& x) { return math::cos(k, x); });
    case GLSLstd450Tan:
      return one([](auto& k, const auto& x) { return math::tan(k, x); });
    case GLSLstd450Asin:
      return one([](auto& k, const auto& x) { return math::asin(k, x); });
    case GLSLstd450Acos:
      return one([](auto& k, const auto& x) { return math::acos(k, x); });
    case GLSLstd450Atan:
      return one([](auto& k, const auto& x) { return math::atan(k, x); });
    case GLSLstd450Sinh:
      return one([](auto& k, const auto& x) { return math::sinh(k, x); });
    case GLSLstd450Cosh:
      return one([](auto& k, const auto& x) { return math::cosh(k, x); });
    case GLSLstd450Tanh:
      return one([](auto& k, const auto& x) { return math::tanh(k, x); });
    case GLSLstd450Asinh:
      return one([](auto& k, const auto& x) { return math::asinh(k, x); });
    case GLSLstd450Acosh:
      return one([](auto& k, const auto& x) { return math::acosh(k, x); });
    case GLSLstd450Atanh:
      return one([](auto& k, const auto& x) { return math::atanh(k, x); });
    case GLSLstd450Atan2:
      return two([](auto& k, const auto& x, const auto& y) { return math::atan2(k, x, y); });
    case GLSLstd450Pow:
      return two([](auto& k, const auto& x, const auto& y) { return math::pow(k, x, y); });
    case GLSLstd450Exp:
      return one([](auto& k, const auto& x) { return math::exp(k, x); });
    case GLSLstd450Log:
      return one([](auto& k, const auto& x) { return math::log(k, x); });
    case GLSLstd450Exp2:
      return one([](auto& k, const auto& x) { return math::exp2(k, x); });
    case GLSLstd450Log2:
      return one([](auto& k, const auto& x) { return math::log2(k, x); });
    case GLSLstd450Sqrt: {
      Value value = first;
      for (Scalar& scalar : value) scalar = unary(Opcode::Fsqrt, scalar);
      return value;
    }
    case GLSLstd450InverseSqrt: {
      Value value = first;
      for (Scalar& scalar : value) scalar = unary(Opcode::Frsqrt, scalar);
      return value;
    }
    case GLSLstd450FMin:
    case GLSLstd450NMin:
      return plain(Opcode::Fmin);
    case GLSLstd450FMax:
    case GLSLstd450NMax:
      return plain(Opcode::Fmax);
    case GLSLstd450FClamp:
    case GLSLstd450NClamp: {
      Value value(first.size());
      for (size_t i = 0; i < value.size(); ++i)
        value[i] = binary(Opcode::Fmin, binary(Opcode::Fmax, first[i], operands.at(1).at(i)), operands.at(2).at(i));
      return value;
    }
    case GLSLstd450FMix:
      return three([](auto& k, const auto& x, const auto& y, const auto& a) { return math::mix(k, x, y, a); });
    case GLSLstd450Step:
      return two([](auto& k, const auto& edge, const auto& x) { return math::step(k, edge, x); });
    case GLSLstd450SmoothStep:
      return three(
          [](auto& k, const auto& low, const auto& high, const auto& x) { return math::smoothstep(k, low, high, x); });
    case GLSLstd450Fma: {
      Value value(first.size());
      for (size_t i = 0; i < value.size(); ++i)
        value[i] = multiply_add(first[i], operands.at(1).at(i), operands.at(2).at(i));
      return value;
    }
    case GLSLstd450Modf:
    case GLSLstd450ModfStruct: {
      const Value whole = one([](auto& k, const auto& x) { return math::trunc(k, x); });
      Value fraction = one([](auto& k, const auto& x) { return math::modf_fraction(k, x); });
      return with_second(line, fraction, whole, line.operands[1] == GLSLstd450Modf);
    }
    case GLSLstd450Frexp:
    case GLSLstd450FrexpStruct: {
      const Value significand = one([](auto& k, const auto& x) { return math::frexp_significand(k, x); });
      const Value exponent = one([](auto& k, const auto& x) { return math::frexp_exponent(k, x); });
      return with_second(line, significand, exponent, line.operands[1] == GLSLstd450Frexp);
    }
    case GLSLstd450Ldexp: {
      Value value(first.size());
      for (size_t i = 0; i < value.size(); ++i) {
        const RecordedFloat x = as_float(first[i]);
        const RecordedInt n = as_int(operands.at(1).at(i));
        value[i] = of(math::ldexp(k_, x, n));
      }
      return value;
    }
    default:
      return std::nullopt;
  }
}

/// Two results: the second goes to where the last operand points, or behind the first.
Value Lowering::with_second(const Line& line, Value first, const Value& second, bool by_pointer) {
  if (by_pointer)
    store_to(pointer_of(line.operands.back()), second);
  else
    first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::optional<Value> Lowering::glsl_of_integers(const Line& line, const std::vector<Value>& operands) {
  const Value& first = operands.at(0);
  const auto one = [&](const auto& function) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) {
      const RecordedInt x = as_int(first[i]);
      value[i] = of(function(k_, x));
    }
    return value;
  };
  const auto plain = [&](Opcode opcode) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i) value[i] = binary(opcode, first[i], operands.at(1).at(i));
    return value;
  };
  const auto clamp = [&](Opcode least, Opcode most) {
    Value value(first.size());
    for (size_t i = 0; i < value.size(); ++i)
      value[i] = binary(most, binary(least, first[i], operands.at(1).at(i)), operands.at(2).at(i));
    return value;
  };
  switch (line.operands.at(1)) {
    case GLSLstd450SAbs:
      return one([](auto& k, const auto& x) { return math::abs(k, x); });
    case GLSLstd450SSign:
      return one([](auto& k, const auto& x) { return math::sign(k, x); });
    case GLSLstd450SMin:
      return plain(Opcode::Imin);
    case GLSLstd450SMax:
      return plain(Opcode::Imax);
    case GLSLstd450UMin:
      return plain(Opcode::Umin);
    case GLSLstd450UMax:
      return plain(Opcode::Umax);
    case GLSLstd450SClamp:
      return clamp(Opcode::Imax, Opcode::Imin);
    case GLSLstd450UClamp:
      return clamp(Opcode::Umax, Opcode::Umin);
    case GLSLstd450FindILsb:
      return one([](auto& k, const auto& x) { return math::find_lsb(k, x); });
    case GLSLstd450FindSMsb:
      return one([](auto& k, const auto& x) { return math::find_smsb(k, x); });
    case GLSLstd450FindUMsb:
      return one([](auto& k, const auto& x) { return math::find_umsb(k, x); });
    default:
      return std::nullopt;
  }
}

/// Of whole vectors and matrices, and of packed words.
// NOLINTNEXTLINE(readability-function-size): a list of functions
std::optional<Value> Lowering::glsl_of_vectors(const Line& line, const std::vector<Value>& operands) {
  const Value& a = operands.at(0);
  const auto times = [&](const Value& vector, const Scalar& factor) {
    Value value = vector;
    for (Scalar& scalar : value) scalar = binary(Opcode::Fmul, scalar, factor);
    return value;
  };
  switch (line.operands.at(1)) {
    case GLSLstd450Length:
      if (a.size() == 1) return Value{immediate(Opcode::And, a[0], 0x7fffffffu)};
      return Value{unary(Opcode::Fsqrt, dot(a, a))};
    case GLSLstd450Distance: {
      Value difference(a.size());
      for (size_t i = 0; i < a.size(); ++i) difference[i] = binary(Opcode::Fsub, a[i], operands.at(1).at(i));
      if (a.size() == 1) return Value{immediate(Opcode::And, difference[0], 0x7fffffffu)};
      return Value{unary(Opcode::Fsqrt, dot(difference, difference))};
    }
    case GLSLstd450Normalize: {
      if (a.size() == 1) {
        const RecordedFloat x = as_float(a[0]);
        return Value{of(math::sign(k_, x))};
      }
      return times(a, unary(Opcode::Frsqrt, dot(a, a)));
    }
    case GLSLstd450Cross: {
      const Value& b = operands.at(1);
      Value value(3);
      for (size_t i = 0; i < 3; ++i) {
        const size_t j = (i + 1) % 3, k = (i + 2) % 3;
        value[i] = binary(Opcode::Fsub, binary(Opcode::Fmul, a.at(j), b.at(k)), binary(Opcode::Fmul, a.at(k), b.at(j)));
      }
      return value;
    }
    case GLSLstd450FaceForward: {
      const Scalar faces = compare(Opcode::Flt, dot(operands.at(2), operands.at(1)), Scalar::constant(0));
      Value value(a.size());
      for (size_t i = 0; i < a.size(); ++i) value[i] = select(faces, a[i], negate(a[i]));
      return value;
    }
    case GLSLstd450Reflect: {
      const Value& n = operands.at(1);
      const Scalar twice = binary(Opcode::Fmul, dot(n, a), Scalar::constant(as_bits(-2.0f)));
      Value value(a.size());
      for (size_t i = 0; i < a.size(); ++i) value[i] = multiply_add(twice, n[i], a[i]);
      return value;
    }
    case GLSLstd450Refract: {
      const Value& n = operands.at(1);
      const Scalar eta = operands.at(2).at(0), one = Scalar::constant(as_bits(1.0f));
      const Scalar cosine = dot(n, a);
      const Scalar rest = binary(Opcode::Fsub, one, binary(Opcode::Fmul, cosine, cosine));
      const Scalar k = binary(Opcode::Fsub, one, binary(Opcode::Fmul, binary(Opcode::Fmul, eta, eta), rest));
      const Scalar total = compare(Opcode::Flt, k, Scalar::constant(0));
      const Scalar root = unary(Opcode::Fsqrt, binary(Opcode::Fmax, k, Scalar::constant(0)));
      const Scalar along = negate(multiply_add(eta, cosine, root));
      Value value(a.size());
      for (size_t i = 0; i < a.size(); ++i)
        value[i] = select(total, Scalar::constant(0), multiply_add(along, n[i], binary(Opcode::Fmul, eta, a[i])));
      return value;
    }
    case GLSLstd450Determinant:
      return Value{determinant(a)};
    case GLSLstd450MatrixInverse:
      return inverse_matrix(a);
    case GLSLstd450PackHalf2x16:
    case GLSLstd450PackUnorm2x16:
    case GLSLstd450PackSnorm2x16: {
      const RecordedFloat x = as_float(a.at(0)), y = as_float(a.at(1));
      if (line.operands[1] == GLSLstd450PackHalf2x16) return Value{of(math::pack_half_2x16(k_, x, y))};
      if (line.operands[1] == GLSLstd450PackUnorm2x16) return Value{of(math::pack_unorm_2x16(k_, x, y))};
      return Value{of(math::pack_snorm_2x16(k_, x, y))};
    }
    case GLSLstd450PackUnorm4x8:
    case GLSLstd450PackSnorm4x8: {
      const RecordedFloat x = as_float(a.at(0)), y = as_float(a.at(1)), z = as_float(a.at(2)), w = as_float(a.at(3));
      if (line.operands[1] == GLSLstd450PackUnorm4x8) return Value{of(math::pack_unorm_4x8(k_, x, y, z, w))};
      return Value{of(math::pack_snorm_4x8(k_, x, y, z, w))};
    }
    case GLSLstd450UnpackHalf2x16:
    case GLSLstd450UnpackUnorm2x16:
    case GLSLstd450UnpackSnorm2x16: {
      const RecordedInt packed = as_int(a.at(0));
      const auto both_of = [&](const auto& pair) { return Value{of(pair.x), of(pair.y)}; };
      if (line.operands[1] == GLSLstd450UnpackHalf2x16) return both_of(math::unpack_half_2x16(k_, packed));
      if (line.operands[1] == GLSLstd450UnpackUnorm2x16) return both_of(math::unpack_unorm_2x16(k_, packed));
      return both_of(math::unpack_snorm_2x16(k_, packed));
    }
    case GLSLstd450UnpackUnorm4x8:
    case GLSLstd450UnpackSnorm4x8: {
      const RecordedInt packed = as_int(a.at(0));
      const auto all_of = [&](const auto& quad) { return Value{of(quad.x), of(quad.y), of(quad.z), of(quad.w)}; };
      if (line.operands[1] == GLSLstd450UnpackUnorm4x8) return all_of(math::unpack_unorm_4x8(k_, packed));
      return all_of(math::unpack_snorm_4x8(k_, packed));
    }
    default:
      return std::nullopt;
  }
}

/// Of a matrix by columns, of two to four of them.
Scalar Lowering::determinant(const Value& matrix) {
  if (matrix.size() == 4)
    return binary(Opcode::Fsub, binary(Opcode::Fmul, matrix[0], matrix[3]), binary(Opcode::Fmul, matrix[2], matrix[1]));
  const size_t size = matrix.size() == 9 ? 3 : 4;
  std::optional<Scalar> sum;
  for (size_t column = 0; column < size; ++column) {
    const Scalar part = binary(Opcode::Fmul, matrix[column * size], determinant(without(matrix, size, 0, column)));
    sum = !sum ? part : binary(column % 2 != 0 ? Opcode::Fsub : Opcode::Fadd, *sum, part);
  }
  return *sum;
}

/// Without a row and a column.
Value Lowering::without(const Value& matrix, size_t size, size_t row, size_t column) {
  Value rest;
  for (size_t c = 0; c < size; ++c)
    for (size_t r = 0; r < size; ++r)
      if (c != column && r != row) rest.push_back(matrix[c * size + r]);
  return rest;
}

Value Lowering::inverse_matrix(const Value& matrix) {
  const size_t size = matrix.size() == 4 ? 2 : matrix.size() == 9 ? 3 : 4;
  const Scalar factor = unary(Opcode::Frcp, determinant(matrix));
  Value value(matrix.size());
  for (size_t c = 0; c < size; ++c) {
    for (size_t r = 0; r < size; ++r) {
      const Value rest = without(matrix, size, c, r);
      const Scalar cofactor = binary(Opcode::Fmul, rest.size() == 1 ? rest[0] : determinant(rest), factor);
      value[c * size + r] = (c + r) % 2 != 0 ? negate(cofactor) : cofactor;
    }
  }
  return value;
}

}  // namespace raypool::shader
