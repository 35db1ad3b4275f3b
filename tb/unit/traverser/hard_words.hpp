// Rays as the words in which they come, and the box of a scene, that are hard to set up.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "bits.hpp"
#include "machine/traverser/ray_setup.hpp"
#include "scene/hard_rays.hpp"

namespace raypool::bench {

class HardWords {
 public:
  enum Kind : uint32_t {
    Plain,         ///< some units around a box of some units
    Soup,          ///< through vertices, edges and planes of triangles of any size and place
    AnyBits,       ///< all words are: infinite, NaN, subnormal
    LongAndShort,  ///< components from subnormal to the largest
    Ties,          ///< what a component is of the largest lies between two subnormal floats
    Equal,         ///< components of one size, zeros of both signs
    Tiny,          ///< the scene too, so that its padding is subnormal
    Far,           ///< from the scene, nearly or just too far
    kKinds
  };

  explicit HardWords(uint32_t seed) : random_(seed), soup_(soup(seed, 60, 1, {})) {}

  void draw() {
    kind = static_cast<Kind>(random_() % kKinds);
    for (int axis = 0; axis < 3; ++axis) {
      const float a = uniform(-4, 4), b = one_of(8) ? a : uniform(-4, 4);
      root.lower[axis] = std::min(a, b);
      root.upper[axis] = std::max(a, b);
      ray.origin[axis] = uniform(-8, 8);
      ray.direction[axis] = one_of(4) ? uniform(-1, 1) * 0x1p-16f : uniform(-1, 1);
    }
    if (kind == Soup) set_soup();
    if (kind == Tiny) scale(-150 + static_cast<int>(random_() % 50));
    if (kind == Far) set_far();
    for (int axis = 0; axis < 3; ++axis) {
      if (kind == AnyBits) {
        ray.origin[axis] = as_float(word());
        ray.direction[axis] = as_float(word());
      }
      if (kind == LongAndShort) ray.direction[axis] = finite(static_cast<int>(random_() % 255));
      if (kind == LongAndShort && one_of(3)) ray.origin[axis] = finite(static_cast<int>(random_() % 187));
      if (kind == Equal || one_of(40)) ray.direction[axis] = one_of(2) ? 0.0f : one_of(2) ? 1.0f : -1.0f;
      if (one_of(40)) ray.direction[axis] = finite(0);
      if (one_of(40)) ray.origin[axis] = one_of(2) ? -0.0f : one_of(2) ? root.lower[axis] : root.upper[axis];
      if (one_of(20) && ray.direction[axis] == 0) ray.direction[axis] = -0.0f;
    }
    if (kind == Ties) set_ties();
    ray.limit = !one_of(3) ? INFINITY : one_of(2) ? uniform(0, 9) : as_float(word());
    if (one_of(40)) ray.limit = one_of(2) ? -0.0f : 0.0f;
  }
  /// A ray at a scene with this box, some from nearby.
  void draw_for(const RootBox& box) {
    draw();
    root = box;
    if (!one_of(2)) return;
    for (int axis = 0; axis < 3; ++axis) {
      const float size = root.upper[axis] - root.lower[axis];
      ray.origin[axis] = root.lower[axis] + size * uniform(-1, 2);
    }
  }
  bool one_of(uint32_t n) { return random_() % n == 0; }

  Kind kind = Plain;
  RayWords ray{};
  RootBox root{};

 private:
  uint32_t word() { return static_cast<uint32_t>(random_()); }
  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  /// Of this exponent, as it is stored, with few bits or many.
  float finite(int exponent) {
    const uint32_t fraction = one_of(4) ? word() & 0x600000 : one_of(4) ? 0 - word() % 4 : word();
    return as_float((word() & 0x80000000) | static_cast<uint32_t>(exponent) << 23 | (fraction & 0x7fffff));
  }
  void scale(int exponent) {
    for (int axis = 0; axis < 3; ++axis) {
      for (float* x : {&ray.origin[axis], &root.lower[axis], &root.upper[axis]}) *x = std::ldexp(*x, exponent);
    }
  }
  void set_soup() {
    if (rays_.empty()) rays_ = hard_rays(soup_, 600, word());
    const RayQuery query = rays_.back();
    rays_.pop_back();
    const Bounds bounds = soup_.bounds();
    const float away = one_of(2) ? uniform(0, 3000) : 0;
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = query.origin[axis] + away;
      ray.direction[axis] = query.direction[axis];
      root.lower[axis] = bounds.lower[axis] + away;
      root.upper[axis] = bounds.upper[axis] + away;
    }
    if (one_of(2)) scale(static_cast<int>(random_() % 190) - 140);
  }
  void set_far() {
    const int axis = static_cast<int>(random_() % 3);
    const bool at_the_end = one_of(2);
    if (at_the_end) root.lower[axis] = 0;
    ray.origin[axis] = at_the_end ? as_float(as_bits(kLargestDistance) + word() % 5 - 2) : finite(60 + 127);
    if (one_of(16)) {  // the scene too, where nothing is left to add
      for (float* x : {&ray.origin[axis], &root.lower[axis], &root.upper[axis]}) *x = as_float(0x7f7fffff);
    }
  }
  /// A component x so many places below the largest, a power of two, that its last bit is half of a subnormal unit; or
  /// that it is but nearly so. Or half of a subnormal unit, an odd number of times, for a largest one of few bits.
  void set_ties() {
    if (one_of(2)) {
      const int exponent = 1 + static_cast<int>(random_() % 115), largest = static_cast<int>(random_() % 3);
      const auto odd = [&](uint32_t below) { return static_cast<float>(1 | word() % below); };
      const float most = odd(4096);
      for (float& x : ray.direction) x = std::ldexp(most * odd(2048), exponent - 150) * (one_of(2) ? -1.0f : 1.0f);
      ray.direction[largest] = std::ldexp(most, exponent);
      return;
    }
    const int places = 1 + static_cast<int>(random_() % 24), largest = static_cast<int>(random_() % 3);
    const int exponent = 1 + static_cast<int>(random_() % 126);
    for (int axis = 0; axis < 3; ++axis) {
      const float x = as_float((word() & 0x80000000) | 0x3f800000 | (word() >> 9 << (places - 1) & 0x7fffff) |
                               (places < 24 ? 1u << (places - 1) : 0));
      ray.direction[axis] = axis == largest ? std::ldexp(1.0f, exponent) : std::ldexp(x, exponent - 126 - places);
    }
    if (one_of(4)) ray.direction[largest] *= 1 + 0x1p-23f * static_cast<float>(word() % 16);
  }

  std::mt19937 random_;
  Scene soup_;
  std::vector<RayQuery> rays_;
};

}  // namespace raypool::bench
