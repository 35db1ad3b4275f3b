// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Reads textures in the kernel language. resources.hpp has the layout of a texture record and of texels; the centre of
// texel (0, 0) is at 1/2 of its width and height, as in GLSL. Colours are linear, 0 .. 1.
#pragma once

#include <cstdint>
#include <utility>

#include "shader/math.hpp"
#include "shader/resources.hpp"

namespace raypool::shader {

/// A colour; a channel that the kernel does not use costs nothing.
template <typename K>
using Texel = math::Quad<K>;

namespace detail {

// Byte offsets in a texture record.
inline constexpr int kTexels = 0;
inline constexpr int kWidth = 4;
inline constexpr int kHeight = 8;
inline constexpr int kWrap = 12;
inline constexpr float kUnit = 1.0f / 65535.0f;

/// The coordinate moved into 0 .. 1, as `wrap`, whose bits 1:0 are a Wrap, has it. Coordinates from 2^31 on, infinities
/// and NaNs become one in 0 .. 1 too.
template <typename K>
typename K::Float wrapped(K& k, const typename K::Float& coordinate, const typename K::Int& wrap) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  using Bool = typename K::Bool;
  const Int mode = wrap & 3;
  const Bool mirror = mode == to_underlying(Wrap::Mirror);
  Float inside = coordinate;
  k.if_(mode != to_underlying(Wrap::Clamp), [&] {
    // Mirror repeats what is twice as wide: the texture, and the texture mirrored.
    k.if_(mirror, [&] { inside *= 0.5f; });
    inside -= to_float(to_int(inside));
    k.if_(inside < 0.0f, [&] { inside += 1.0f; });
    k.if_(mirror, [&] {
      inside = min(inside, 1.0f - inside);
      inside += inside;
    });
  });
  return min(max(inside, 0.0f), 1.0f);
}

/// Along one axis: the first of two neighbouring texels, the step to the other, and the other's weight.
template <typename K>
struct Neighbours {
  typename K::Int first, step;
  typename K::Float weight;
};

/// `wrap`: bits 1:0 are a Wrap.
template <typename K>
Neighbours<K> neighbours(K& k, const typename K::Float& coordinate, const typename K::Int& size,
                         const typename K::Int& wrap) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  using Bool = typename K::Bool;
  const Float place = multiply_add(wrapped(k, coordinate, wrap), to_float(size), 0.5f);
  Int second = min(to_int(place), size);  // a short significand may have rounded it up
  Float weight = place - to_float(second);
  Int first = second - 1;
  // Beyond the edge is the texel at the other end with Repeat, else the one at this end.
  const Bool repeat = (wrap & 3) == to_underlying(Wrap::Repeat);
  const Int last = size - 1;
  k.if_(first < 0, [&] { first = select(repeat, last, 0); });
  k.if_(second > last, [&] { second = select(!repeat, last, 0); });
  second -= first;
  return {std::move(first), std::move(second), std::move(weight)};
}

/// The texel that the coordinate lies in.
template <typename K>
typename K::Int nearest(K& k, const typename K::Float& coordinate, const typename K::Int& size,
                        const typename K::Int& wrap) {
  using Float = typename K::Float;
  const Float place = wrapped(k, coordinate, wrap) * to_float(size);
  return min(to_int(place), size - 1);
}

/// The low or the high 16 bits of a word as a number 0 .. 65535.
template <typename K>
typename K::Float half_word(const typename K::Int& word, bool high) {
  using Int = typename K::Int;
  return high ? to_float(shift_right_logical(word, Int(16))) : to_float(word & 0xffff);
}

template <typename K>
Texel<K> unpacked(const typename K::Int& red_green, const typename K::Int& blue_alpha) {
  return {half_word<K>(red_green, false) * kUnit, half_word<K>(red_green, true) * kUnit,
          half_word<K>(blue_alpha, false) * kUnit, half_word<K>(blue_alpha, true) * kUnit};
}

/// Both channels of a word, filtered: four texels from `address` on, in steps of `right` and `down` bytes.
template <typename K>
math::Pair<K> filtered(K& k, const typename K::Int& address, const typename K::Int& right, const typename K::Int& down,
                       const typename K::Float& x_weight, const typename K::Float& y_weight, int offset) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  const auto row = [&](const Int& left) {
    const Int a = k.load_int(left, offset);
    const Int b = k.load_int(left + right, offset);
    Float low = half_word<K>(a, false);
    low = multiply_add(x_weight, half_word<K>(b, false) - low, low);
    Float high = half_word<K>(a, true);
    high = multiply_add(x_weight, half_word<K>(b, true) - high, high);
    return math::Pair<K>{std::move(low), std::move(high)};
  };
  math::Pair<K> sum = row(address);
  const math::Pair<K> below = row(address + down);
  sum.x = multiply_add(y_weight, below.x - sum.x, sum.x) * kUnit;
  sum.y = multiply_add(y_weight, below.y - sum.y, sum.y) * kUnit;
  return sum;
}

/// Where the four texels around (u, v) are.
template <typename K>
struct Footprint {
  typename K::Int address, right, down;  ///< bytes
  typename K::Float x_weight, y_weight;
};

template <typename K>
Footprint<K> footprint(K& k, const typename K::Int& record, const typename K::Float& u, const typename K::Float& v) {
  using Int = typename K::Int;
  Neighbours<K> y = neighbours(k, v, k.load_int(record, kHeight), k.load_int(record, kWrap) >> 2);
  const Int width = k.load_int(record, kWidth);
  Int address = y.first * width;
  Int down = (y.step * width) << 3;
  Neighbours<K> x = neighbours(k, u, k.load_int(record, kWidth), k.load_int(record, kWrap));
  address = ((address + x.first) << 3) + k.load_int(record, kTexels);
  return {std::move(address), x.step << 3, std::move(down), std::move(x.weight), std::move(y.weight)};
}

template <typename K>
Texel<K> filtered(K& k, const Footprint<K>& at) {
  math::Pair<K> red_green = filtered(k, at.address, at.right, at.down, at.x_weight, at.y_weight, 0);
  math::Pair<K> blue_alpha = filtered(k, at.address, at.right, at.down, at.x_weight, at.y_weight, 4);
  return {std::move(red_green.x), std::move(red_green.y), std::move(blue_alpha.x), std::move(blue_alpha.y)};
}

}  // namespace detail

/// Between the four texels around (u, v), whatever filter the record names. Every coordinate, also a NaN, gives colours
/// of the texture.
template <typename K>
Texel<K> sample_bilinear(K& k, const typename K::Int& record, const typename K::Float& u, const typename K::Float& v) {
  return detail::filtered(k, detail::footprint(k, record, u, v));
}

/// The texel that (u, v) lies in.
template <typename K>
Texel<K> sample_nearest(K& k, const typename K::Int& record, const typename K::Float& u, const typename K::Float& v) {
  using Int = typename K::Int;
  const Int row = detail::nearest(k, v, k.load_int(record, detail::kHeight), k.load_int(record, detail::kWrap) >> 2);
  const Int width = k.load_int(record, detail::kWidth);
  const Int column = detail::nearest(k, u, width, k.load_int(record, detail::kWrap));
  const Int address = ((row * width + column) << 3) + k.load_int(record, detail::kTexels);
  return detail::unpacked<K>(k.load_int(address), k.load_int(address, 4));
}

/// As the record says: GLSL's textureLod() at level 0.
template <typename K>
Texel<K> sample(K& k, const typename K::Int& record, const typename K::Float& u, const typename K::Float& v) {
  using Float = typename K::Float;
  using Int = typename K::Int;
  detail::Footprint<K> at = detail::footprint(k, record, u, v);
  const Int nearest = k.load_int(record, detail::kWrap) & kTextureNearest;
  // The nearer of two neighbours along each axis has all of the weight.
  k.if_(nearest != 0, [&] {
    at.x_weight = math::step(k, Float(0.5f), at.x_weight);
    at.y_weight = math::step(k, Float(0.5f), at.y_weight);
  });
  return detail::filtered(k, at);
}

/// Texel (x, y), which must be in the texture: GLSL's texelFetch() at level 0.
template <typename K>
Texel<K> fetch_texel(K& k, const typename K::Int& record, const typename K::Int& x, const typename K::Int& y) {
  using Int = typename K::Int;
  const Int place = y * k.load_int(record, detail::kWidth) + x;
  const Int address = (place << 3) + k.load_int(record, detail::kTexels);
  return detail::unpacked<K>(k.load_int(address), k.load_int(address, 4));
}

}  // namespace raypool::shader
