// On which side of a triangle's edges a ray passes, in integers, against rational numbers: subnormal, huge and equal
// products included; and the engines' way to the same sign. And the Verilog against its class.
#include "machine/traverser/triangle_edges.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cmath>
#include <deque>
#include <random>

#include "Vtriangle_edges.h"
#include "scene/exact_rational.hpp"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

Exact product(float a, float b) { return Exact(static_cast<double>(a)) * Exact(static_cast<double>(b)); }

int exact_sign(float ax, float ay, float bx, float by) { return (product(ax, by) - product(ay, bx)).sign(); }

/// As engines decide it: in floats, and where that gives zero in double.
int engines_sign(float ax, float ay, float bx, float by) {
  double edge = static_cast<double>(ax * by - ay * bx);
  if (edge == 0) {
    edge = static_cast<double>(ax) * static_cast<double>(by) - static_cast<double>(ay) * static_cast<double>(bx);
  }
  return edge < 0 ? -1 : edge > 0 ? 1 : 0;
}

float any_float(std::mt19937& random, int least, int most) {
  const auto exponent = static_cast<uint32_t>(std::uniform_int_distribution<int>(least, most)(random) + 127);
  return as_float((random() & 0x807fffff) | exponent << 23);
}
float next_to(std::mt19937& random, float x) {
  const uint32_t moved = as_bits(x) + random() % 3 - 1;
  return std::isfinite(as_float(moved)) ? as_float(moved) : x;
}

struct Counts {
  int signs[3] = {};  ///< -1, 0, 1
  int close = 0;      ///< products that are equal in floats, but not exactly
  int subnormal = 0;
};

void check(float ax, float ay, float bx, float by, bool engines, Counts& counts) {
  const int sign = exact_sign(ax, ay, bx, by);
  ASSERT_EQ(edge_sign(ax, ay, bx, by), sign) << ax << ' ' << ay << ", " << bx << ' ' << by;
  if (engines) {
    ASSERT_EQ(engines_sign(ax, ay, bx, by), sign) << ax << ' ' << ay << ", " << bx << ' ' << by;
  }
  ++counts.signs[sign + 1];
  counts.close += sign != 0 && ax * by == ay * bx;
  for (const float x : {ax, ay, bx, by}) counts.subnormal += x != 0 && std::fabs(x) < 0x1p-126f;
}

TEST(TriangleEdges, SignsAreThoseOfRationalNumbers) {
  std::mt19937 random(1);
  Counts counts;
  for (int i = 0; i < 400000; ++i) {
    // All floats, of which engines take those with finite products: no distance is above 2e18.
    const bool engines = i % 2 == 0;
    const int most = engines ? 60 : 127, least = i % 4 < 2 ? -127 : most - 6;
    float ax = any_float(random, least, most), by = any_float(random, least, most);
    float ay = i % 3 == 0 ? next_to(random, ax) : any_float(random, least, most);
    float bx = i % 3 != 2 ? next_to(random, by) : any_float(random, least, most);
    if (i % 7 == 0) ay = ax, bx = next_to(random, by);
    if (i % 11 == 0) ay = ax * 2, bx = by / 2;
    if (i % 13 == 0) ax = as_float(random() & 0x807fffff);
    if (i % 17 == 0) ay = random() % 2 == 0 ? 0.0f : -0.0f;
    if (i % 19 == 0) bx = -bx, by = -by;
    if (!std::isfinite(ay)) continue;
    ASSERT_NO_FATAL_FAILURE(check(ax, ay, bx, by, engines, counts));
  }
  for (const int count : counts.signs) EXPECT_GT(count, 10000);
  EXPECT_GT(counts.close, 10000);
  EXPECT_GT(counts.subnormal, 10000);
}

TEST(TriangleEdges, SignsOfSpecialValuesAreThoseOfRationalNumbers) {
  std::vector<float> values;
  for (const float x : {0.0f, 0x1p-149f, 0x1.8p-148f, 0x1.fffffcp-127f, 0x1p-126f, 0x1.fffffep-126f, 0x1p-63f, 1.0f,
                        0x1.000002p0f, 0x1.fffffep0f, 0x1p60f, 0x1.fffffep127f}) {
    values.push_back(x);
    values.push_back(-x);
  }
  Counts counts;
  for (const float ax : values) {
    for (const float ay : values) {
      for (const float bx : values) {
        for (const float by : values) {
          const bool engines =
              std::fabs(ax) < 0x1p62f && std::fabs(ay) < 0x1p62f && std::fabs(bx) < 0x1p62f && std::fabs(by) < 0x1p62f;
          ASSERT_NO_FATAL_FAILURE(check(ax, ay, bx, by, engines, counts));
        }
      }
    }
  }
}

// What a ray's set-up divides (scene/prepared_ray.cpp, in double) is what a divider of floats gives: reciprocals and
// shears are quotients of floats, rounded once, where they are not subnormal.
TEST(TriangleEdges, AShearIsAQuotientOfFloats) {
  std::mt19937 random(2);
  for (int i = 0; i < 2000000; ++i) {
    const float z = any_float(random, 0, 0);
    float x = any_float(random, i % 2 == 0 ? -1 : -125, -1);
    if (i % 5 == 0) x = next_to(random, z) / 2;
    const double inverse = 1.0 / static_cast<double>(z);
    ASSERT_EQ(as_bits(static_cast<float>(static_cast<double>(x) * inverse)), as_bits(x / z)) << x << " / " << z;
    ASSERT_EQ(as_bits(static_cast<float>(1.0 / static_cast<double>(x))), as_bits(1 / x));
  }
}

TEST(TriangleEdges, InsideIsWhereSignsAgree) {
  const float x[3] = {-1, 3, 0};
  const auto inside = [&](float py, float qy, float ry) {
    const float y[3] = {py, qy, ry};
    return TriangleEdges(x, y).inside();
  };
  EXPECT_TRUE(inside(-1, -1, 2));
  EXPECT_FALSE(inside(1, 1, 2));
  EXPECT_TRUE(inside(0, 0, 2)) << "on an edge";
  EXPECT_TRUE(inside(-1, -1, 0)) << "on a corner";
  EXPECT_FALSE(inside(0, 0, 0)) << "seen edge-on";
  const float turned_x[3] = {3, -1, 0}, y[3] = {-1, -1, 2};
  EXPECT_TRUE(TriangleEdges(turned_x, y).inside()) << "the other winding";
  const TriangleEdges edges(x, y);
  EXPECT_NE(edges.signs[0], 0);
  EXPECT_EQ(edges.signs[0], edges.signs[1]);
  EXPECT_EQ(edges.signs[0], edges.signs[2]);
}

/// Corners around a ray: some random, some with edges that go through the ray or nearly so.
struct Corners {
  std::array<float, 3> x, y;

  explicit Corners(std::mt19937& random) {
    const uint32_t what = random() % 8;
    const int most = what == 0 ? 127 : 20, least = what == 1 ? -127 : -20;
    for (int corner = 0; corner < 3; ++corner) {
      x[corner] = what == 2 ? as_float(random() & 0x807fffff) : any_float(random, least, most);
      y[corner] = any_float(random, least, most);
    }
    const uint32_t a = random() % 3, b = (a + 1) % 3;
    if (what == 3) x[b] = x[a], y[b] = next_to(random, y[a]);
    if (what == 4) x[b] = -2 * x[a], y[b] = next_to(random, -2 * y[a]);
    if (what == 5) x[b] = x[a], y[b] = y[a], x[(b + 1) % 3] = x[a], y[(b + 1) % 3] = y[a];
    if (what == 6) (random() % 2 == 0 ? x : y)[a] = random() % 2 == 0 ? 0.0f : -0.0f;
    if (what == 6 && random() % 3 == 0) x[b] = y[b] = 0;
    for (int corner = 0; corner < 3; ++corner) {
      if (!std::isfinite(x[corner])) x[corner] = 1;
      if (!std::isfinite(y[corner])) y[corner] = -1;
    }
  }
  TriangleEdges edges() const { return {{x[0], x[1], x[2]}, {y[0], y[1], y[2]}}; }
};

TEST(TriangleEdgesInVerilog, AgreesWithItsClassInEveryCycle) {
  Clocked<Vtriangle_edges> bench(3);
  Vtriangle_edges& u = *bench.u;
  struct Stage {
    bool valid = false;
    std::array<int, 3> signs{};
    bool inside = false;
  };
  constexpr size_t kMoves = 5;
  std::deque<Stage> stages(kMoves);  // the last one is at the outputs
  std::array<std::array<uint32_t, 3>, 3> seen{};
  uint64_t inside = 0, outside = 0, edge_on = 0, stood = 0;
  for (uint32_t cycle = 0; cycle < 400'000; ++cycle) {
    const Corners corners(bench.random);
    const bool valid = !bench.one_of(5), ready = !bench.one_of(4);
    u.valid_i = valid;
    u.ready_i = ready;
    for (int corner = 0; corner < 3; ++corner) {
      u.x_i[corner] = as_bits(corners.x[corner]);
      u.y_i[corner] = as_bits(corners.y[corner]);
    }
    u.eval();
    const Stage& shown = stages.back();
    const bool moves = !shown.valid || ready;
    ASSERT_EQ(u.ready_o, moves) << "cycle " << cycle;
    ASSERT_EQ(u.valid_o, shown.valid) << "cycle " << cycle;
    if (shown.valid) {
      for (int edge = 0; edge < 3; ++edge) {
        ASSERT_EQ(u.negative_o >> edge & 1, shown.signs[edge] < 0) << "edge " << edge << ", cycle " << cycle;
        ASSERT_EQ(u.zero_o >> edge & 1, shown.signs[edge] == 0) << "edge " << edge << ", cycle " << cycle;
        ++seen[edge][shown.signs[edge] + 1];
      }
      ASSERT_EQ(u.inside_o, shown.inside) << "cycle " << cycle;
      ++(shown.inside ? inside : outside);
      edge_on += shown.signs[0] == 0 && shown.signs[1] == 0 && shown.signs[2] == 0;
      stood += !ready;
    }
    bench.clock();
    if (!moves) continue;
    stages.pop_back();
    const TriangleEdges edges = corners.edges();
    stages.push_front({valid, {edges.signs[0], edges.signs[1], edges.signs[2]}, edges.inside()});
  }
  for (const auto& edge : seen)
    for (const uint32_t count : edge) EXPECT_GT(count, 10'000u);
  EXPECT_GT(inside, 20'000u);
  EXPECT_GT(outside, 20'000u);
  EXPECT_GT(edge_on, 5'000u);
  EXPECT_GT(stood, 50'000u);
}

}  // namespace
}  // namespace raypool::bench
