// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The ray kernels' source. kernels.hpp describes what each is for, packages.hpp what the words hold,
// docs/use/kernels.md has the formulas.
#pragma once

#include <limits>
#include <optional>

#include "kernel/kernel.hpp"
#include "kernel/kernels.hpp"

namespace raypool::kernel {

template <typename K>
void cast_eye(K& k) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  const Int thread = k.thread();
  // Thread and block both become x | y << 16: their sum is the pixel.
  const Int pixel = (thread & k.int_argument(argument::kTileMask)) +
                    (shift_right_logical(thread, k.int_argument(argument::kTileWidthLog2)) << 16) + k.block();
  const Int x = pixel & 0xffff;
  const Int y = shift_right_logical(pixel, 16);
  const Float column = to_float(x);
  const Float row = to_float(y);
  for (int axis = 0; axis < 3; ++axis) {
    k.set_word(word::kOrigin + axis, k.int_argument(argument::kEye + axis));
    k.set_word(word::kDirection + axis, multiply_add(row, k.float_argument(argument::kStepY + axis),
                                                     multiply_add(column, k.float_argument(argument::kStepX + axis),
                                                                  k.float_argument(argument::kCorner + axis))));
    k.set_word(word::kColor + axis, Float(1.0f));
  }
  k.set_word(word::kLimit, Float(std::numeric_limits<float>::infinity()));
  k.set_word(word::kPixel, pixel);
  k.set_word(word::kFlags, Int(1));
  k.if_(x < k.int_argument(argument::kWidth) && y < k.int_argument(argument::kHeight), [&] { k.ray_out(); });
}

/// What the light gives through the hit: the shadow ray's direction, from `origin` to the light,
/// and by how much the surface faces it.
template <typename K>
struct Lighting {
  Vector<K> direction;
  typename K::Float cosine;               // 0 if the light is behind the surface; but with culling
  std::optional<typename K::Bool> lit{};  // with culling: whether it is not behind
};

/// The package's words up to the limit are those of a normal intersection; `back` is set if the ray met the normal's
/// back side.
template <typename K>
Lighting<K> light_hit(K& k, const Vector<K>& origin, const Vector<K>& normal, const typename K::Bool& back) {
  using Float = typename K::Float;
  const Vector<K> direction = vector_argument(k, argument::kLight) - origin;
  Float cosine = dot(normal, direction) * rsqrt(dot(direction, direction));
  k.if_(back, [&] { cosine = -cosine; });
  // 0 * infinity, from a light that lies on the surface, is not lit, or becomes 0 too; the largest cosine is 1, even
  // where the square of the distance is less than the smallest number.
  if (!k.culling()) return {direction, min(max(cosine, 0.0f), 1.0f)};
  const typename K::Bool lit = cosine > 0.0f;
  return {direction, min(cosine, 1.0f), lit};
}

/// The slice holds the shadow ray: it leaves, but for where it is known to add nothing.
template <typename K>
void shadow_ray_out(K& k, const Lighting<K>& light) {
  if (light.lit) {
    k.if_(*light.lit, [&] { k.ray_out(); });
  } else {
    k.ray_out();
  }
}

/// By how much secondary rays leave the surface at a hit: more than it can be off its plane.
template <typename K>
typename K::Float surface_offset(K& k, const typename K::Float& distance, const Vector<K>& hit) {
  const typename K::Float largest = max(max(abs(hit.x), abs(hit.y)), abs(hit.z));
  return (largest + distance) * k.float_argument(argument::kOffset);
}

/// Where secondary rays begin: at the hit, moved off the surface to the side from which the ray came.
template <typename K>
Vector<K> secondary_origin(K& k, const Vector<K>& direction, const Vector<K>& normal, const typename K::Bool& back) {
  using Float = typename K::Float;
  const Float distance = k.float_word(word::kDistance);
  const Vector<K> hit = {multiply_add(distance, direction.x, k.float_word(word::kOrigin)),
                         multiply_add(distance, direction.y, k.float_word(word::kOrigin + 1)),
                         multiply_add(distance, direction.z, k.float_word(word::kOrigin + 2))};
  Float offset = surface_offset(k, distance, hit);
  k.if_(back, [&] { offset = -offset; });
  return {multiply_add(offset, normal.x, hit.x), multiply_add(offset, normal.y, hit.y),
          multiply_add(offset, normal.z, hit.z)};
}

template <typename K>
void cast_secondary_direct(K& k) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  using Bool = typename K::Bool;
  k.ray_in();
  const Vector<K> direction = vector_word(k, word::kDirection);
  const Vector<K> normal = vector_word(k, word::kNormal);
  const Bool back = dot(direction, normal) > 0.0f;
  const Vector<K> origin = secondary_origin(k, direction, normal, back);
  set_vector_word(k, word::kOrigin, origin);
  const Lighting<K> light = light_hit(k, origin, normal, back);
  set_vector_word(k, word::kDirection, light.direction);
  const Int material = k.int_word(word::kMaterial);
  for (int i = 0; i < 3; ++i) {
    const Float reflected = k.float_word(word::kColor + i) * k.load_float(material, kMaterialDiffuse + 4 * i);
    k.set_word(word::kColor + i, reflected * (light.cosine * k.float_argument(argument::kLightColor + i)));
  }
  k.set_word(word::kLimit, Float(1.0f));
  k.set_word(word::kFlags, k.int_word(word::kFlags) | kShadowFlag);
  shadow_ray_out(k, light);
}

/// `limit_missing`: the package has no limit, so that the reflection ray needs its own.
template <typename K>
void cast_secondary(K& k, bool limit_missing = false) {
  using Int = typename K::Int;
  using Float = typename K::Float;
  using Bool = typename K::Bool;
  k.ray_in();
  // The reflection ray is made in place: it keeps pixel and limit. What the shadow ray needs stays in registers.
  const Vector<K> direction = vector_word(k, word::kDirection);
  const Vector<K> normal = vector_word(k, word::kNormal);
  const Float projection = dot(direction, normal);
  const Bool back = projection > 0.0f;
  const Vector<K> origin = secondary_origin(k, direction, normal, back);
  set_vector_word(k, word::kOrigin, origin);
  const Float minus_twice = projection * -2.0f;
  set_vector_word(k, word::kDirection,
                  {multiply_add(minus_twice, normal.x, direction.x), multiply_add(minus_twice, normal.y, direction.y),
                   multiply_add(minus_twice, normal.z, direction.z)});
  // With culling the light is looked at later, so that more time lies between the two rays of a warp: the first one has
  // left when the second one is there.
  std::optional<Lighting<K>> light;
  if (!k.culling()) light = light_hit(k, origin, normal, back);
  const Int material = k.int_word(word::kMaterial);
  const auto contribution = [&](int i) {
    const Float throughput = k.float_word(word::kColor + i);
    k.set_word(word::kColor + i, throughput * k.load_float(material, kMaterialReflectance + 4 * i));
    if (!light) return throughput * k.load_float(material, kMaterialDiffuse + 4 * i);
    return throughput * k.load_float(material, kMaterialDiffuse + 4 * i) *
           (light->cosine * k.float_argument(argument::kLightColor + i));
  };
  const Float red = contribution(0);
  const Float green = contribution(1);
  const Float blue = contribution(2);
  const Int pixel = k.int_word(word::kPixel);
  const Int flags = k.int_word(word::kFlags);
  k.set_word(word::kFlags, flags + 1);
  if (limit_missing) k.set_word(word::kLimit, Float(std::numeric_limits<float>::infinity()));
  k.ray_out();

  // The slice that is current now holds nothing of this thread's: all twelve words are written.
  set_vector_word(k, word::kOrigin, origin);
  if (!light) {
    // What is known goes first, and leaves its registers to the light.
    k.set_word(word::kPixel, pixel);
    k.set_word(word::kFlags, flags | kShadowFlag);
    light = light_hit(k, origin, normal, back);
  }
  set_vector_word(k, word::kDirection, light->direction);
  k.set_word(word::kLimit, Float(1.0f));
  if (k.culling()) {
    k.set_word(word::kColor, red * (light->cosine * k.float_argument(argument::kLightColor)));
    k.set_word(word::kColor + 1, green * (light->cosine * k.float_argument(argument::kLightColor + 1)));
    k.set_word(word::kColor + 2, blue * (light->cosine * k.float_argument(argument::kLightColor + 2)));
  } else {
    k.set_word(word::kPixel, pixel);
    k.set_word(word::kColor, red);
    k.set_word(word::kColor + 1, green);
    k.set_word(word::kColor + 2, blue);
    k.set_word(word::kFlags, flags | kShadowFlag);
  }
  shadow_ray_out(k, *light);
}

template <typename K>
void shade(K& k) {
  // A shadow intersection holds pixel and contribution where the frame buffer's port takes them.
  k.ray_in();
  k.frame_out();
}

/// The one of this name.
template <typename K>
void run_kernel(RayKernel which, K& k) {
  switch (which) {
    case RayKernel::CastEye:
      return cast_eye(k);
    case RayKernel::CastSecondary:
      return cast_secondary(k);
    case RayKernel::CastSecondaryDirect:
      return cast_secondary_direct(k);
    case RayKernel::Shade:
      return shade(k);
  }
}

}  // namespace raypool::kernel
