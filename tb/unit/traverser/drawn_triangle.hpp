// A triangle and a ray that is set up, drawn at random of hard kinds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "bits.hpp"
#include "machine/traverser/triangle_ray.hpp"
#include "scene/prepared_ray.hpp"

namespace raypool::bench {

/// Of one of these kinds.
enum Kind : uint32_t {
  Aimed,      ///< at a point in it
  Whole,      ///< small integers: at corners and edges, exactly
  EdgeOn,     ///< the ray lies in its plane, exactly or nearly
  Large,      ///< corners of up to 1e9, the ray near the plane
  AroundIt,   ///< the origin lies within its box
  AnyFloats,  ///< all of them are
  Padded,     ///< the whole triangle lies before or behind the origin, nearer than boxes are padded
  Sliver,     ///< corner 2 lies next to the line through the others, exactly on it or 2^-4 to 2^-24 of a unit from it
  Unequal,    ///< seen from the origin a corner, or an axis, is much smaller than the others
  kKinds
};

inline PreparedRay prepared(const Vec3& origin, const Vec3& direction, const Triangle& triangle) {
  Bounds bounds{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (const auto& corner : triangle.corners) {
    for (int axis = 0; axis < 3; ++axis) {
      bounds.lower[axis] = std::min(bounds.lower[axis], corner[axis]);
      bounds.upper[axis] = std::max(bounds.upper[axis], corner[axis]);
    }
  }
  return prepare({origin, direction, INFINITY}, bounds);
}

class Drawn {
 public:
  PreparedRay ray;
  Triangle triangle{};
  Kind kind;

  explicit Drawn(std::mt19937& random) : kind(static_cast<Kind>(random() % kKinds)), random_(random) {
    Vec3 origin = point(), direction = point();
    Vec3 corners[3] = {point(), point(), point()};
    if (kind == Sliver) {
      const float away = std::ldexp(random_() % 8 == 0 ? 0.0f : 1.0f, -4 - static_cast<int>(random_() % 21));
      corners[2] = corners[0] + (corners[1] - corners[0]) * uniform(-1, 2) + point() * away;
    }
    if (kind == Aimed || kind == Large || kind == AroundIt || kind == Sliver) {
      const float s = uniform(0, 1), r = uniform(0, 1 - s);
      const Vec3 aim = corners[0] + (corners[1] - corners[0]) * s + (corners[2] - corners[0]) * r;
      if (kind == AroundIt) origin = aim + point() * 0x1p-20f;
      if (kind == Large) origin = aim + Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)} * 100.0f;
      direction = aim - origin;
    }
    if (kind == Whole) direction = corners[random_() % 3] - origin;
    if (kind == EdgeOn) {
      corners[2] = origin + direction * static_cast<float>(random_() % 5);
      if (random_() % 2 == 0) corners[1] = corners[0] + direction * 2.0f;
      if (random_() % 4 == 0) corners[random_() % 3].x += 0x1p-20f;
    }
    if (kind == Unequal) {
      origin = {0, 0, 0};
      const int axis = static_cast<int>(random_() % 3), places = static_cast<int>(random_() % 145);
      Vec3& small = corners[random_() % 3];
      if (random_() % 2 == 0)
        small = small * std::ldexp(1.0f, -places);
      else
        for (Vec3& corner : corners) corner[axis] = std::ldexp(corner[axis], -places);
    }
    if (kind == Padded) {
      for (Vec3& corner : corners) corner = origin + direction * uniform(-4e-7f, 4e-7f);
    }
    if (random_() % 32 == 0) corners[1] = corners[0];
    if (random_() % 4 == 0) still(direction);
    if (random_() % 5 == 0) direction = direction * -1.0f;
    scale(origin, direction, corners);
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) triangle.corners[corner][axis] = corners[corner][axis];
    }
    ray = prepared(origin, direction, triangle);
    triangle.number = random_();
  }

 private:
  float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
  float any(float most) {
    const auto exponent = random_() % 70 + 62;  // up to 2^4
    return kind == AnyFloats ? as_float((random_() & 0x807fffff) | exponent << 23) : uniform(-most, most);
  }
  Vec3 point() {
    const auto whole = [&] { return static_cast<float>(random_() % 9) - 4; };
    if (kind == Whole || kind == EdgeOn) return {whole(), whole(), whole()};
    const float most = kind == Large ? 1e9f : 16;
    return {any(most), any(most), any(most)};
  }
  void still(Vec3& direction) {
    const float size[] = {0, -0.0f, 0x1p-149f, 0x1p-101f, 0x1p-60f};
    direction[static_cast<int>(random_() % 3)] = size[random_() % 5];
  }
  /// Subnormal to huge, and directions of another size than the triangle.
  void scale(Vec3& origin, Vec3& direction, Vec3 (&corners)[3]) {
    const int small = random_() % 8 == 0 ? -147 : -130, large = kind == Large ? 28 : 54;
    const int size = random_() % 3 == 0 ? std::uniform_int_distribution<int>(small, large)(random_) : 0;
    const int length = random_() % 3 == 0 ? std::uniform_int_distribution<int>(-150, 90)(random_) : 0;
    const auto by = [](Vec3& v, int exponent) {
      for (int axis = 0; axis < 3; ++axis) v[axis] = std::ldexp(v[axis], exponent);
    };
    by(origin, size);
    by(direction, length);
    for (Vec3& corner : corners) by(corner, size);
  }
  std::mt19937& random_;
};

}  // namespace raypool::bench
