// Triangle tests of fewer bits: with 53 the engines' own test, with fewer what the header defines, whatever the tree,
// and with no gap between triangles.
#include "scene/narrow_triangles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/hard_rays.hpp"
#include "scene/simd4.hpp"
#include "scene/test_traversal.hpp"

namespace raypool {
namespace {

#include "scene/triangle_test.hpp"

constexpr TriangleTime kTimes[] = {TriangleTime::Floats, TriangleTime::Products, TriangleTime::Plane};
constexpr uint32_t kWidths[] = {53, 52, 40, 32, 28, 25, 24};

Traversal tested(const Traversal& tree, TriangleTime time, uint32_t bits) {
  Traversal result = tree;
  result.set_triangle_test(TriangleTest(time, bits));
  return result;
}

/// x in so many bits: its neighbours, and which of them it is nearer to, by integers of 128 bits.
double nearest_number(__int128 value, int bits) {
  const bool negative = value < 0;
  auto size = static_cast<unsigned __int128>(negative ? -value : value);
  int drop = 0;
  while (size >> (bits + drop) != 0) ++drop;
  unsigned __int128 kept = size >> drop;
  const unsigned __int128 rest = size - (kept << drop),
                          half = drop == 0 ? 1 : static_cast<unsigned __int128>(1) << (drop - 1);
  if (drop > 0 && (rest > half || (rest == half && kept % 2 != 0))) ++kept;
  const double result = std::ldexp(static_cast<double>(static_cast<uint64_t>(kept)), drop);
  return negative ? -result : result;
}

/// An integer of so many bits at most, most of them zeros or ones at the end now and then, so that sums and products
/// are ties, or nearly.
int64_t integer(std::mt19937_64& random, int bits) {
  const uint64_t size = random() >> (64 - bits);
  const uint64_t low = (uint64_t{1} << (random() % static_cast<uint64_t>(bits))) - 1;
  const uint64_t value = random() % 3 == 0 ? size : random() % 2 == 0 ? size & ~low : size | low;
  return random() % 2 == 0 ? static_cast<int64_t>(value) : -static_cast<int64_t>(value);
}

TEST(NarrowFloat, RoundsEachOperationOnce) {
  std::mt19937_64 random(3);
  for (const uint32_t width : kWidths) {
    const NarrowFloat narrow(width);
    const int bits = static_cast<int>(width);
    int ties = 0;
    for (int i = 0; i < 100000; ++i) {
      const int64_t a = integer(random, bits), b = integer(random, bits);
      const int shift = static_cast<int>(random() % 40);
      const double x = std::ldexp(static_cast<double>(a), shift), y = static_cast<double>(b);
      const __int128 sum = (static_cast<__int128>(a) << shift) + b, product = static_cast<__int128>(a) * b;
      ASSERT_EQ(narrow.add(x, y), nearest_number(sum, bits)) << width << ": " << x << " + " << y;
      ASSERT_EQ(narrow.subtract(x, -y), nearest_number(sum, bits));
      ASSERT_EQ(narrow.multiply(x, y), std::ldexp(nearest_number(product, bits), shift)) << width << ": " << x << y;
      // Once more through double, which is what rounding once is not.
      ties += std::ldexp(nearest_number(static_cast<__int128>(static_cast<double>(a) * static_cast<double>(b)), bits),
                         shift) != narrow.multiply(x, y);
      if (b == 0) continue;
      // The quotient is the number of `width` bits from which a is less than half a unit away, times b.
      const double quotient = narrow.divide(x, y);
      int exponent = 0;
      const auto q = static_cast<__int128>(std::ldexp(std::frexp(std::fabs(quotient), &exponent), bits));
      const auto n = static_cast<unsigned __int128>(a < 0 ? -a : a), d = static_cast<unsigned __int128>(b < 0 ? -b : b);
      // n 2^shift / d = q 2^(exponent - bits), within half a unit.
      int up = shift - (exponent - bits);
      __int128 scaled = static_cast<__int128>(n), unit = static_cast<__int128>(d);
      up >= 0 ? scaled <<= up : unit <<= -up;
      const __int128 rest = scaled - q * unit, off = rest < 0 ? -rest : rest;
      ASSERT_TRUE(2 * off < unit || (2 * off == unit && q % 2 == 0)) << width << ": " << x << " / " << y;
      ASSERT_TRUE(a == 0 || (quotient < 0) == ((a < 0) != (b < 0)));
    }
    if (width > 26 && width < 53) {
      EXPECT_GT(ties, 0) << "no product shows that it was rounded once";
    }
  }
}

TEST(NarrowFloat, ADifferenceOfProductsIsRoundedOnce) {
  std::mt19937_64 random(4);
  for (const uint32_t width : kWidths) {
    const NarrowFloat narrow(width);
    int cancelled = 0;
    for (int i = 0; i < 100000; ++i) {
      const int64_t a = integer(random, 24), b = integer(random, 24);
      const int64_t c = random() % 2 == 0 ? a + static_cast<int64_t>(random() % 3) - 1 : integer(random, 23);
      const int64_t d = random() % 2 == 0 ? b : integer(random, 24);
      if (std::llabs(c) >> 24 != 0) continue;
      const __int128 exact = static_cast<__int128>(a) * b - static_cast<__int128>(c) * d;
      cancelled += exact != 0 && (exact < 0 ? -exact : exact) < 1 << 24;
      const auto number = [](int64_t value) { return static_cast<float>(value); };
      ASSERT_EQ(narrow.difference(number(a), number(b), number(c), number(d)),
                nearest_number(exact, static_cast<int>(width)));
    }
    EXPECT_GT(cancelled, 1000);
  }
}

TEST(NarrowTriangles, With53BitsHitsAreThoseOfTheEngines) {
  int hits = 0, rays = 0;
  const auto compare = [&](const Scene& scene, int count, uint32_t seed) {
    const Traversal engines(scene), narrow = tested(engines, TriangleTime::Floats, 53);
    for (const RayQuery& ray : hard_rays(scene, count, seed)) {
      Hit expected, found;
      const bool hit = engines.nearest(ray, expected);
      ASSERT_EQ(narrow.nearest(ray, found), hit);
      ASSERT_EQ(narrow.occluded(ray), hit);
      ASSERT_TRUE(!hit || test::same(found, expected)) << found.triangle << " at " << found.t;
      hits += hit;
      ++rays;
    }
  };
  compare(make_cornell(0.3), 6000, 1);
  compare(make_room(0.05), 6000, 2);
  compare(test::ball({1000, -2000, 500}, 24), 6000, 3);
  for (const int scale : {-140, -126, -100, -40, 0, 30, 58}) {
    const float size = std::ldexp(1.0f, scale);
    for (const float away : {0.0f, 1.0f, 3000.0f}) compare(soup(7, 60, size, {away * size, -away * size, 0}), 600, 4);
  }
  EXPECT_GT(hits, rays / 4);
}

/// The header's steps with 24 bits, in the processor's floats.
class InFloats {
 public:
  InFloats(const PreparedRay& ray, const TriangleBlock& block) : ray_(ray), block_(block) {
    for (int k = 0; k < 3; ++k) {
      z_[k] = at(k, ray.kz) - ray.origin[ray.kz];
      x_[k] = at(k, ray.kx) - ray.origin[ray.kx] - ray.shear_x * z_[k];
      y_[k] = at(k, ray.ky) - ray.origin[ray.ky] - ray.shear_y * z_[k];
    }
  }
  bool inside() const {
    const double u = exact(2, 1), v = exact(0, 2), w = exact(1, 0);
    return (u >= 0 && v >= 0 && w >= 0) != (u <= 0 && v <= 0 && w <= 0);
  }
  float t(TriangleTime time) const {
    if (time == TriangleTime::Plane) {
      const float t = plane(time);
      return in_front() == 0 ? -1 : in_front() == 3 && !(t > 0) ? 0x1p-149f : t;
    }
    float u = x_[2] * y_[1] - y_[2] * x_[1], v = x_[0] * y_[2] - y_[0] * x_[2], w = x_[1] * y_[0] - y_[1] * x_[0];
    if (time == TriangleTime::Products || std::min({std::fabs(u), std::fabs(v), std::fabs(w)}) < 0x1p-100f) {
      u = static_cast<float>(exact(2, 1)), v = static_cast<float>(exact(0, 2)), w = static_cast<float>(exact(1, 0));
    }
    const float p = u * z_[0], q = v * z_[1], r = w * z_[2], sum = p + q + r;
    if (std::fabs(sum) < 0.5f * (std::fabs(p) + std::fabs(q) + std::fabs(r))) return plane(time);
    return sum / (u + v + w) * (1 / static_cast<float>(ray_.direction[ray_.kz]));
  }

  float plane(TriangleTime time) const {
    Vec3 a[3];
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) a[k][axis] = at(k, axis) - ray_.origin[axis];
    }
    Vec3 side[2];
    for (int k = 0; k < 2; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        side[k][axis] = time == TriangleTime::Floats ? a[k + 1][axis] - a[0][axis] : at(k + 1, axis) - at(0, axis);
      }
    }
    const Vec3 normal = cross(side[0], side[1]);
    return dot(normal, a[0]) / dot(normal, Vec3d{ray_.direction[0], ray_.direction[1], ray_.direction[2]}.as<float>());
  }
  int in_front() const {
    int count = 0;
    for (const float z : z_) count += z * static_cast<float>(ray_.direction[ray_.kz]) > 0;
    return count;
  }

 private:
  float at(int corner, int axis) const { return block_.vertices[corner][axis][0]; }
  double exact(int a, int b) const {
    return static_cast<double>(x_[a]) * static_cast<double>(y_[b]) -
           static_cast<double>(y_[a]) * static_cast<double>(x_[b]);
  }
  const PreparedRay& ray_;
  const TriangleBlock& block_;
  float x_[3], y_[3], z_[3];
};

TEST(NarrowTriangles, With24BitsEveryStepIsOneOfFloats) {
  int hits[3] = {}, from_plane = 0;
  for (uint32_t seed = 1; seed <= 4000; ++seed) {
    const Scene scene = soup(seed, 1, seed % 3 == 0 ? 1 : 100, {seed % 2 == 0 ? 0 : 300.0f, 7, -3});
    const Bvh bvh = build_bvh(scene);
    if (bvh.blocks.empty()) continue;
    TriangleBlock block = bvh.blocks[0];
    block.count = 1;
    std::mt19937 random(seed);
    const auto uniform = [&](float low, float high) {
      return std::uniform_real_distribution<float>(low, high)(random);
    };
    for (int i = 0; i < 20; ++i) {
      const float s = uniform(0, 1), r = uniform(0, 1 - s);
      const Vec3 a = scene.corner(0, 0), b = scene.corner(0, 1), c = scene.corner(0, 2);
      const Vec3 aim = i % 5 == 0 ? b : a + (b - a) * s + (c - a) * r;
      const Vec3 origin = aim + Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)} * (i % 4 == 0 ? 0.001f : 50);
      const PreparedRay ray = prepare({origin, aim - origin, test::kInfinity}, bvh.bounds);
      if (!ray.valid) continue;
      const InFloats floats(ray, block);
      for (const TriangleTime time : kTimes) {
        Candidate expected, found;
        const bool hit = floats.inside() && take_if_nearer(ray, block, 0, floats.t(time), expected);
        ASSERT_EQ(TriangleTest(time, 24)(ray, block, found), hit) << seed << ' ' << i;
        ASSERT_EQ(as_bits(found.t), as_bits(expected.t)) << seed << ' ' << i;
        hits[static_cast<int>(time)] += hit;
      }
      from_plane +=
          floats.inside() && as_bits(floats.t(TriangleTime::Floats)) == as_bits(floats.t(TriangleTime::Plane));
    }
  }
  for (const int count : hits) EXPECT_GT(count, 20000);
  EXPECT_GT(from_plane, 1000);
}

// Triangles that are seen edge-on but for rounding, with a plane that gives any t: those in front of the ray are hit
// all the same, somewhere in their box, and those behind it are not.
TEST(NarrowTriangles, ATriangleInFrontIsHitWhateverItsPlaneGives) {
  std::mt19937 random(6);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  const auto whole = [&](int below) { return static_cast<float>(random() % static_cast<unsigned>(below)); };
  int lost = 0, not_a_number = 0, behind = 0;
  for (int i = 0; i < 40000; ++i) {
    std::array<Vec3, 3> corners;
    RayQuery query{{}, {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, test::kInfinity};
    const Vec3 side{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const bool turned = i % 3 == 0;
    if (i % 4 == 0) {  // just behind the origin, nearer than the box is padded
      float last = 0;
      for (Vec3& corner : corners) {
        const float along = uniform(1, 4);
        corner = query.direction * along + side * uniform(-1e-6f, 1e-6f);
        last = std::max(last, along);
      }
      query.origin = query.direction * (turned ? 0 : last * (1 + 2e-7f));
    } else if (i % 2 == 0) {
      for (Vec3& corner : corners) corner = query.direction * uniform(1, 4) + side * uniform(-1, 1);
      query.origin = side * uniform(-1, 1);
    } else {  // in the plane x = 3 y, exactly
      for (Vec3& corner : corners) corner = {3 * whole(40), 0, 200 + whole(100)}, corner.y = corner.x / 3;
      query.origin = {3 * whole(40), 0, -whole(30)};
      query.origin.y = query.origin.x / 3;
      query.direction = {3 * whole(9), 0, 60 + whole(50)};
      query.direction.y = query.direction.x / 3;
    }
    if (turned) query.direction = query.direction * -1.0f;
    const Bvh bvh = build_bvh(scene_of({corners}));
    if (bvh.blocks.empty()) continue;
    TriangleBlock block = bvh.blocks[0];
    block.count = 1;
    const PreparedRay ray = prepare(query, bvh.bounds);
    const InFloats floats(ray, block);
    if (!ray.valid || !floats.inside() || floats.in_front() % 3 != 0) continue;
    float near = 0, far = 0;
    const bool in_box = own_box_interval(ray, LaneCorners{block, 0}, near, far) && far > 0;
    const float t = floats.plane(TriangleTime::Plane);
    for (const uint32_t bits : kWidths) {
      Candidate best;
      const bool hit = TriangleTest(TriangleTime::Plane, bits)(ray, block, best);
      ASSERT_EQ(hit, floats.in_front() == 3 && in_box) << i << ", " << bits << " bits";
      ASSERT_TRUE(!hit || (best.t >= near && best.t <= far));
    }
    lost += in_box && floats.in_front() == 3 && t <= 0;
    not_a_number += in_box && floats.in_front() == 3 && std::isnan(t);
    behind += floats.in_front() == 0 && in_box && t > 0;
  }
  EXPECT_GT(lost, 50);
  EXPECT_GT(not_a_number, 100);
  EXPECT_GT(behind, 0);
}

TEST(NarrowTriangles, AnswersDoNotDependOnTheTree) {
  for (const TriangleTime time : kTimes) {
    for (const uint32_t bits : {24u, 28u, 53u}) {
      for (const Scene& scene : {test::ball({300, 20, 7}, 16), soup(5, 200, 1, {100, 7, -3})}) {
        const Traversal good = tested(Traversal(scene), time, bits);
        Traversal bad = good;
        bad.set_bvh(test::random_tree(good.bvh(), bits));
        int hits = 0;
        for (const RayQuery& ray : hard_rays(scene, 3000, bits)) {
          Hit a, b;
          const bool hit = good.nearest(ray, a);
          ASSERT_EQ(bad.nearest(ray, b), hit);
          ASSERT_TRUE(!hit || test::same(a, b)) << a.triangle << " at " << a.t << ", " << b.triangle << " at " << b.t;
          ASSERT_EQ(bad.occluded(ray), hit);
          hits += hit;
        }
        EXPECT_GT(hits, 300);
      }
    }
  }
}

// Through the edges and vertices of a grid, and of the same grid a second time: the lowest number wins.
TEST(NarrowTriangles, TiesAreTheLowestNumbers) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (int copy = 0; copy < 2; ++copy) {
    for (int i = 0; i < 16; ++i) {
      const auto x = static_cast<float>(i % 4), y = static_cast<float>(i / 4);
      const Vec3 a{x, y, 3}, b{x + 1, y, 3}, c{x + 1, y + 1, 3}, d{x, y + 1, 3};
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  const Scene scene = scene_of(triangles);
  const Traversal engines(scene);
  for (const TriangleTime time : kTimes) {
    for (const uint32_t bits : kWidths) {
      const Traversal narrow = tested(engines, time, bits);
      for (int i = 0; i < 17 * 17; ++i) {
        const float x = 0.25f * static_cast<float>(i % 17), y = 0.25f * static_cast<float>(i / 17);
        for (const float z : {1.0f, 0x1p-100f, 0x1.8p60f}) {
          Hit expected, found;
          ASSERT_TRUE(engines.nearest({{x, y, 0}, {0, 0, z}, test::kInfinity}, expected));
          ASSERT_TRUE(narrow.nearest({{x, y, 0}, {0, 0, z}, test::kInfinity}, found)) << x << ' ' << y;
          ASSERT_EQ(found.triangle, expected.triangle) << x << ' ' << y;
          ASSERT_LT(found.triangle, 32u);
          ASSERT_EQ(found.t, expected.t);
        }
      }
    }
  }
}

}  // namespace
}  // namespace raypool
