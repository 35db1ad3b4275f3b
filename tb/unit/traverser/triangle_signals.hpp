// A ray and a triangle at the ports of the triangle pipe, and of what stands before it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "bits.hpp"
#include "machine/traverser/triangle_ray.hpp"

namespace raypool::bench {

inline uint64_t number(double x) {
  uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

/// A ray's components as the set-up has them: sign, 11 bits of exponent, 23 of fraction; four words.
inline void set_direction(const TriangleRay& ray, uint32_t* words) {
  std::fill_n(words, 4, 0);
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint64_t bits = number(ray.direction[axis]) >> 29;
    for (uint32_t bit = 0; bit < 35; ++bit) {
      words[(35 * axis + bit) / 32] |= static_cast<uint32_t>(bits >> bit & 1) << (35 * axis + bit) % 32;
    }
  }
}

template <typename Floats>
void set_floats(uint32_t* words, const Floats& floats) {
  for (const float x : floats) *words++ = as_bits(x);
}

/// Of a unit with ports of these names.
template <typename Unit>
void set_triangle_ray(Unit& unit, const TriangleRay& ray) {
  set_floats(&unit.origin_i[0], ray.origin);
  set_floats(&unit.padded_lower_i[0], ray.padded[0]);
  set_floats(&unit.padded_upper_i[0], ray.padded[1]);
  set_floats(&unit.inverse_i[0], ray.inverse);
  unit.main_axis_i = static_cast<uint8_t>(ray.kz);
  unit.shear_i = uint64_t{as_bits(ray.shear_y)} << 32 | as_bits(ray.shear_x);
  set_direction(ray, &unit.direction_i[0]);
}

}  // namespace raypool::bench
