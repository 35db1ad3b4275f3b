// For tests: ray kernels of which some wait for their rays (chip.miss_records).
#pragma once

#include <utility>

#include "kernel/kernel.hpp"
#include "kernel/ray_kernels.hpp"
#include "kernel/ray_program.hpp"

namespace raypool::test {

/// Makes of an eye ray's hit a reflection that returns; of every second pixel any hit ends it, and of every second row
/// the flag `met` is set beforehand. It goes half as far as the eye ray, so that some meet nothing in a closed box.
template <typename K>
void cast_returning(K& k) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const kernel::Vector<K> direction = vector_word(k, word::kDirection), normal = vector_word(k, word::kNormal);
  const Float projection = dot(direction, normal);
  const kernel::Vector<K> origin = kernel::secondary_origin(k, direction, normal, projection > 0.0f);
  const Float minus_twice = projection * -2.0f;
  const Int pixel = k.int_word(word::kPixel);
  set_vector_word(k, word::kOrigin, origin);
  set_vector_word(k, word::kDirection, direction + minus_twice * normal);
  k.set_word(word::kLimit, k.float_word(word::kDistance) * 0.5f);
  k.set_word(word::kFlags,
             k.int_word(word::kFlags) + 1 + Int(kReturnsFlag) + ((pixel & 1) << 29) + (((pixel >> 16) & 1) << 28));
}

/// Makes of what has come back of a returning ray a colour, in a shadow ray without a direction, which nothing blocks.
template <typename K>
void show(K& k) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const Int flags = k.int_word(word::kFlags);
  k.set_word(word::kColor, k.float_word(word::kDistance) + 1.0f);
  k.set_word(word::kColor + 1, k.float_word(word::kBarycentric) + to_float(k.int_word(word::kTriangle)));
  k.set_word(word::kColor + 2, to_float((flags >> 28) & 7));
  set_vector_word(k, word::kDirection, kernel::Vector<K>{Float(0.0f), Float(0.0f), Float(0.0f)});
  k.set_word(word::kLimit, Float(1.0f));
  k.set_word(word::kFlags, (flags & 0xff) | Int(kShadowFlag));
}

/// The built-in kernels, but reflections return: cast_returning() and show().
inline const RayProgram& returning_kernels(const KernelTarget& target) {
  return program_for(target, [](const KernelTarget& of) {
    RayFunctions functions = built_in_ray_program(of).functions;
    const auto secondary = [](auto& k) {
      k.ray_in();
      k.if_((k.int_word(word::kFlags) & 0xff) == 1, [&] { cast_returning(k); }, [&] { show(k); });
      k.ray_out();
    };
    functions[RayKernel::CastSecondary] = kernel::record_kernel("cast_secondary", secondary, of);
    return make_ray_program(std::move(functions), of);
  });
}

}  // namespace raypool::test
