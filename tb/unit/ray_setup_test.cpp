// The set-up of a ray: the class against rational numbers, and against what engines prepare.
#include "machine/ray_setup.hpp"

#include <gtest/gtest.h>

#include <array>

#include "scene/narrow_boxes.hpp"
#include "unit/exact_rational.hpp"
#include "unit/hard_words.hpp"

namespace raypool::bench {
namespace {

RayQuery query_of(const RayWords& ray) {
  return {
      {ray.origin[0], ray.origin[1], ray.origin[2]}, {ray.direction[0], ray.direction[1], ray.direction[2]}, ray.limit};
}
Bounds bounds_of(const RootBox& root) {
  return {{root.lower[0], root.lower[1], root.lower[2]}, {root.upper[0], root.upper[1], root.upper[2]}};
}

void expect_the_same_axis(const BoxRay::Axis& a, const BoxRay::Axis& b) {
  ASSERT_EQ(as_bits(a.origin), as_bits(b.origin));
  ASSERT_EQ(a.backwards, b.backwards);
  ASSERT_EQ(a.still, b.still);
  ASSERT_EQ(a.reciprocal, b.reciprocal);
  ASSERT_EQ(a.exponent, b.exponent);
  ASSERT_EQ(a.padding, b.padding);
}

void expect_the_same(const RaySetup& setup, const PreparedRay& ray, const BoxRay& box) {
  ASSERT_EQ(setup.limit, ray.limit);
  ASSERT_EQ(std::ldexp(1.0, setup.scale), ray.t_scale);
  ASSERT_EQ(setup.box.limit, box.limit);
  ASSERT_EQ(setup.triangle.kz, ray.kz);
  ASSERT_EQ(setup.triangle.kx, ray.kx);
  ASSERT_EQ(setup.triangle.ky, ray.ky);
  ASSERT_EQ(as_bits(setup.triangle.shear_x), as_bits(ray.shear_x));
  ASSERT_EQ(as_bits(setup.triangle.shear_y), as_bits(ray.shear_y));
  for (int axis = 0; axis < 3; ++axis) {
    ASSERT_NO_FATAL_FAILURE(expect_the_same_axis(setup.box.axes[axis], box.axes[axis]));
    ASSERT_EQ(as_bits(setup.triangle.origin[axis]), as_bits(ray.origin[axis]));
    for (int side = 0; side < 2; ++side) {
      ASSERT_EQ(as_bits(setup.triangle.padded[side][axis]), as_bits(ray.padded[side][axis]));
    }
    ASSERT_EQ(as_bits(setup.triangle.inverse[axis]), as_bits(ray.inverse[axis]));
    ASSERT_EQ(setup.triangle.near_side[axis], ray.near_side[axis]);
    ASSERT_EQ(setup.triangle.direction[axis], ray.direction[axis]);
    ASSERT_EQ(std::signbit(setup.triangle.direction[axis]), std::signbit(ray.direction[axis]));
  }
}

TEST(RaySetup, IsWhatEnginesPrepare) {
  HardWords words(1);
  std::array<int, HardWords::kKinds> valid{}, invalid{};
  int clamped = 0, subnormal_shears = 0, minus_zeros = 0, least_limits = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    words.draw();
    const int bits = kLeastBoxBits + i % (kMostBoxBits - kLeastBoxBits + 1);
    const RayQuery query = query_of(words.ray);
    const Bounds bounds = bounds_of(words.root);
    const RaySetup setup(words.ray, words.root, bits);
    const PreparedRay ray = prepare(query, bounds);
    ASSERT_EQ(setup.valid, ray.valid) << "ray " << i;
    ++(setup.valid ? valid : invalid)[words.kind];
    if (!setup.valid) continue;
    const BoxRay box = narrow_ray(query, ray, bounds, static_cast<uint32_t>(bits));
    ASSERT_NO_FATAL_FAILURE(expect_the_same(setup, ray, box)) << "ray " << i << ", kind " << words.kind;
    for (const float inverse : ray.inverse) clamped += std::fabs(inverse) == 0x1p100f;
    subnormal_shears += ray.shear_x != 0 && std::fabs(ray.shear_x) < 0x1p-126f;
    for (const float x : words.ray.direction) minus_zeros += as_bits(x) == 0x80000000;
    least_limits += ray.limit < 0x1p-126f;
  }
  for (const int count : valid) EXPECT_GT(count, 10'000);
  for (const int count : invalid) EXPECT_GT(count, 1'000);
  EXPECT_GT(clamped, 100'000);
  EXPECT_GT(subnormal_shears, 50'000);
  EXPECT_GT(minus_zeros, 5'000);
  EXPECT_GT(least_limits, 100);
}

/// Of two floats, whose bits are even or not, and a number between: is the float the one that it is rounded to?
bool is_nearest(float rounded, const Exact& exact) {
  const Exact twice = exact + exact, here = Exact(rounded);
  for (const float next : {next_above(rounded), next_below(rounded)}) {
    if (std::isinf(next)) continue;
    const Exact middle = here + Exact(next);
    const bool above = next > rounded;
    if (above ? middle < twice : twice < middle) return false;
    if (!(middle < twice) && !(twice < middle) && (as_bits(rounded) & 1) != 0) return false;
  }
  return true;
}

TEST(RaySetup, RoundsQuotientsOnceAndReciprocalsDown) {
  HardWords words(2);
  int rays = 0, ties = 0, subnormal = 0, nothing = 0;
  for (int i = 0; i < 150'000; ++i) {
    words.draw();
    const int bits = kLeastBoxBits + i % (kMostBoxBits - kLeastBoxBits + 1);
    const RaySetup setup(words.ray, words.root, bits);
    if (!setup.valid) continue;
    ++rays;
    const TriangleRay& ray = setup.triangle;
    const Exact z(ray.direction[ray.kz]);
    for (const int axis : {ray.kx, ray.ky}) {
      const float shear = axis == ray.kx ? ray.shear_x : ray.shear_y;
      const Exact quotient = Exact(ray.direction[axis]) / z;
      ASSERT_TRUE(is_nearest(shear, quotient)) << "ray " << i;
      ASSERT_EQ(std::signbit(shear), std::signbit(ray.direction[axis]) != std::signbit(ray.direction[ray.kz]));
      subnormal += shear != 0 && std::fabs(shear) < 0x1p-126f;
      nothing += shear == 0 && ray.direction[axis] != 0;
      const Exact steps = quotient * Exact(0x1p150);
      for (const double odd : {1.0, -1.0, 3.0, -3.0, 5.0, -5.0}) ties += (steps - Exact(odd)).sign() == 0;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray.direction[axis];
      const double clamped = std::fabs(d) < 0x1p-100 ? std::copysign(0x1p-100, d) : d;
      ASSERT_TRUE(is_nearest(ray.inverse[axis], Exact(1) / Exact(clamped)));
      const BoxRay::Axis& box = setup.box.axes[axis];
      const double unit = std::ldexp(1.0, box.exponent), m = box.reciprocal;
      ASSERT_EQ(box.reciprocal >> (bits - 1), 1u);
      const Exact inverse = Exact(1) / Exact(box.still ? 1.0 : std::fabs(words.ray.direction[axis]));
      ASSERT_FALSE(inverse < Exact(m * unit));
      ASSERT_TRUE(inverse < Exact((m + 1) * unit));
    }
  }
  EXPECT_GT(rays, 100'000);
  EXPECT_GT(subnormal, 10'000);
  EXPECT_GT(ties, 100);
  EXPECT_GT(nothing, 100);
}

struct Scenes {
  int rays = 0, tiny = 0;
};

/// What docs/traverser.md asks of the padding ("No hit is lost", 4), in rational numbers, and how much more there is.
void expect_padding(const HardWords& words, const RaySetup& setup, Scenes& seen) {
  const Exact u(0x1p-24);
  Exact distance;
  for (int axis = 0; axis < 3; ++axis) {
    const Exact origin(words.ray.origin[axis]);
    for (const Exact& each : {origin - Exact(words.root.lower[axis]), Exact(words.root.upper[axis]) - origin}) {
      if (distance < each) distance = each;
      if (distance < Exact() - each) distance = Exact() - each;
    }
  }
  const Exact share = Exact(0x1p-20) * distance;
  seen.tiny += distance < Exact(0x1p-106);
  for (int axis = 0; axis < 3; ++axis) {
    const float o = words.ray.origin[axis];
    const float lower = setup.triangle.padded[0][axis], upper = setup.triangle.padded[1][axis];
    // A slab is never widened by less than the share of a distance that was rounded itself.
    ASSERT_FALSE(Exact(lower) < Exact(o) + share * (Exact(1) - u));
    ASSERT_FALSE(Exact(o) - share * (Exact(1) - u) < Exact(upper));
    const Exact up = Exact(lower) - Exact(o), down = Exact(o) - Exact(upper), &widened = up < down ? down : up;
    const Exact largest(std::max(std::fabs(words.root.lower[axis]), std::fabs(words.root.upper[axis])));
    const Exact needs =
        widened + (Exact(12.1) * u + Exact(0x1p-98)) * (distance + widened) + u * largest + Exact(0x1p-148);
    const Exact padding(std::ldexp(1.0, setup.box.axes[axis].padding));
    ASSERT_TRUE(needs < padding);
    const Exact less = Exact(0.5) * padding, most = widened + share + u * largest;
    ASSERT_FALSE(most * Exact(1 + 0x1p-17) + Exact(0x1p-143) < less);
  }
  ++seen.rays;
}

TEST(RaySetup, PadsAsTheProofAsks) {
  HardWords words(3);
  Scenes seen;
  for (int i = 0; i < 150'000; ++i) {
    words.draw();
    const RaySetup setup(words.ray, words.root, 12);
    const bool at_the_end =
        std::any_of(&words.ray.origin[0], &words.ray.origin[3], [](float x) { return std::fabs(x) > 0x1p127f; });
    if (!setup.valid || at_the_end) continue;
    ASSERT_NO_FATAL_FAILURE(expect_padding(words, setup, seen)) << "ray " << i << ", kind " << words.kind;
  }
  EXPECT_GT(seen.rays, 100'000);
  EXPECT_GT(seen.tiny, 10'000);
}

// In double the same comes out, unless the padding is so small that it is a subnormal float.
TEST(RaySetup, NeedsNoDouble) {
  HardWords words(4);
  int rays = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    words.draw();
    const RaySetup setup(words.ray, words.root, 12);
    const PreparedRay ray = prepare(query_of(words.ray), bounds_of(words.root));
    if (!setup.valid || ray.reach < 0x1p-106f) continue;
    const double padding = 0x1p-20 * static_cast<double>(ray.reach);
    for (int axis = 0; axis < 3; ++axis) {
      const double o = words.ray.origin[axis];
      ASSERT_EQ(setup.triangle.padded[0][axis], next_above(static_cast<float>(o + padding))) << "ray " << i;
      ASSERT_EQ(setup.triangle.padded[1][axis], next_below(static_cast<float>(o - padding))) << "ray " << i;
    }
    ++rays;
  }
  EXPECT_GT(rays, 500'000);
}

}  // namespace
}  // namespace raypool::bench
