// The finish of a ray: its class against rational numbers and integers, how far it is from what is exact, and the
// Verilog against the class, all outputs in every cycle.
#include "machine/traverser/ray_finish.hpp"

#include <gmp.h>
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "Vray_finish_16.h"
#include "scene/exact_rational.hpp"
#include "scene/vec.hpp"
#include "unit/common/clocked.hpp"
#include "unit/traverser/drawn_triangle.hpp"
#include "unit/traverser/triangle_signals.hpp"

namespace raypool::bench {
namespace {

/// A number of 32 bits as units of 2^unit, cut off.
uint64_t units_of(double x, int unit) { return static_cast<uint64_t>(std::ldexp(std::fabs(x), -unit)); }
/// Of the first bit of the largest of these.
int exponent_of(const double (&numbers)[3]) {
  double most = 0;
  for (const double x : numbers) most = std::max(most, std::fabs(x));
  return most == 0 ? 0 : std::ilogb(most);
}
int bits_of(uint64_t x) { return x == 0 ? 0 : 64 - __builtin_clzll(x); }

/// A cross product of a triangle's sides or corners, with one rounding.
double cross_of(double a, double b, double c, double d) {
  return (Exact(a) * Exact(b) - Exact(c) * Exact(d)).rounded(32);
}

/// The shares of corners 1 and 2, as docs/machine/ray-finish.md defines them, or no area.
struct Shares {
  Exact u, v;
  bool area = false;

  Shares(const TriangleRay& ray, const Triangle& triangle) {
    const CornersInView view(ray, triangle);
    double weights[3];
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      weights[k] = cross_of(view.x[b], view.y[a], view.y[b], view.x[a]);
    }
    const int unit = exponent_of(weights) - 31;
    uint64_t sum = 0;
    for (const double weight : weights) sum += units_of(weight, unit);
    if (sum == 0) return;
    area = true;
    const int drop = bits_of(sum) - 32;
    const Exact kept(std::ldexp(static_cast<double>(sum >> drop), unit + drop));
    u = Exact(std::fabs(weights[1])) / kept;
    v = Exact(std::fabs(weights[2])) / kept;
  }
};

/// The components of the unit normal, before they are rounded.
struct Normal {
  Exact sizes[3];
  bool negative[3];
  bool area = false;

  explicit Normal(const Triangle& triangle) {
    double sides[2][3], along[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 2; ++i) {
        sides[i][axis] = (Exact(triangle(i + 1, axis)) - Exact(triangle(0, axis))).rounded(36);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      along[axis] = cross_of(sides[0][a], sides[1][b], sides[0][b], sides[1][a]);
      negative[axis] = along[axis] < 0;
    }
    int unit = exponent_of(along) - 30;
    uint64_t sum = 0;
    for (const double each : along) sum += units_of(each, unit) * units_of(each, unit);
    if (sum == 0) return;
    area = true;
    if (bits_of(sum) > 62) {
      sum /= 4;
      ++unit;
    }
    mpz_t root;
    mpz_init_set_ui(root, sum);
    mpz_sqrt(root, root);
    const uint64_t reciprocal = (uint64_t{1} << 62) / mpz_get_ui(root);
    mpz_clear(root);
    for (int axis = 0; axis < 3; ++axis) {
      sizes[axis] = Exact(std::fabs(along[axis])) * Exact(std::ldexp(static_cast<double>(reciprocal), -62 - unit));
    }
  }
};

/// A hit's t and its ray's scale, most so that the time is a float; rounded ones, subnormal and infinite too.
struct Time {
  float t;
  int scale;

  explicit Time(std::mt19937& random) : t(as_float(static_cast<uint32_t>(random() % 0x7f800000))) {
    if (random() % 8 == 0) t = as_float(static_cast<uint32_t>(random() % 0x800000));
    if (random() % 32 == 0) t = 0;
    scale = random() % 2 == 0 ? static_cast<int>(random() % 512) - 256 : static_cast<int>(random() % 40) - 20;
    if (random() % 4 == 0) scale = std::max(-256, -150 - std::ilogb(t + 0x1p-149f) + static_cast<int>(random() % 26));
  }
};

TEST(RayFinish, FollowsItsDefinitionInRationalNumbers) {
  std::mt19937 random(1);
  std::array<int, kKinds> areas{};
  int no_share = 0, no_normal = 0, subnormal_shares = 0, subnormal_normals = 0, subnormal_times = 0, infinite = 0;
  for (int i = 0; i < 60'000; ++i) {
    const Drawn test(random);
    const Time time(random);
    if (!test.ray.valid) continue;
    SCOPED_TRACE(i);
    const RayFinish finish(test.ray, test.triangle, time.t, time.scale);
    const Exact t = Exact(time.t) * Exact(std::ldexp(1.0, time.scale));
    if (std::isinf(finish.t)) {
      ASSERT_FALSE(t < Exact(0x1.ffffffp127));
    } else {
      ASSERT_TRUE(is_nearest(finish.t, t));
    }
    subnormal_times += finish.t != 0 && finish.t < 0x1p-126f;
    infinite += std::isinf(finish.t);

    const Shares shares(test.ray, test.triangle);
    ASSERT_TRUE(is_nearest(finish.u, shares.u)) << finish.u << ", kind " << test.kind;
    ASSERT_TRUE(is_nearest(finish.v, shares.v)) << finish.v << ", kind " << test.kind;
    subnormal_shares += finish.u != 0 && finish.u < 0x1p-126f;
    no_share += !shares.area;

    const Normal normal(test.triangle);
    for (int axis = 0; axis < 3; ++axis) {
      const float component = finish.normal[axis];
      ASSERT_TRUE(is_nearest(std::fabs(component), normal.sizes[axis])) << component << ", kind " << test.kind;
      ASSERT_EQ(std::signbit(component), normal.area && normal.negative[axis]);
      subnormal_normals += component != 0 && std::fabs(component) < 0x1p-126f;
    }
    no_normal += !normal.area;
    areas[test.kind] += shares.area && normal.area;
  }
  for (const int count : areas) EXPECT_GT(count, 1'500);
  EXPECT_GT(no_share, 1'000);
  EXPECT_GT(no_normal, 1'000);
  EXPECT_GT(subnormal_shares, 20);
  EXPECT_GT(subnormal_normals, 20);
  EXPECT_GT(subnormal_times, 1'000);
  EXPECT_GT(infinite, 1'000);
}

/// Of numbers in the middle between two floats, or next to it by their last bit, and a rest.
TEST(RayFinish, FloatsAreRoundedOnce) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 100'000; ++i) {
    const int bits = 26 + static_cast<int>(random() % 39), subnormal = static_cast<int>(random() % 27);
    const int exponent = i % 2 == 0 ? -bits : -126 - bits - subnormal + 1;
    const int drop = bits - 24 + (i % 2 == 0 ? 0 : std::max(subnormal - 1, 0) + 1);
    const uint64_t first = uint64_t{1} << (bits - 1), middle = drop > bits ? 0 : uint64_t{1} << (drop - 1);
    const uint64_t above = drop >= 64 ? 0 : random() << drop & (first - 1);
    const uint64_t value = (first | above | middle) + random() % 3 - 1;
    const bool rest = random() % 2 == 0;
    const Exact whole =
        (Exact(std::ldexp(static_cast<double>(value >> 32), 32)) + Exact(static_cast<double>(value & 0xffffffff))) *
        Exact(std::ldexp(1.0, exponent));
    const Exact exact = rest ? whole + Exact(std::ldexp(0.25, exponent)) : whole;
    ASSERT_TRUE(is_nearest(rounded_to_float(value, exponent, rest), exact)) << value << " 2^" << exponent;
  }
}

TEST(RayFinish, SharesAreFromZeroToOneAndNormalsHaveLengthOneOrZero) {
  std::mt19937 random(2);
  int areas = 0, lengths = 0, whole = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Drawn test(random);
    if (!test.ray.valid) continue;
    const RayFinish finish(test.ray, test.triangle, 1, 0);
    const double u = finish.u, v = finish.v;
    ASSERT_TRUE(u >= 0 && v >= 0 && u <= 1 && v <= 1 && u + v <= 1 + 0x1p-24) << u << " " << v;
    double sum = 0;
    for (const float component : finish.normal) {
      ASSERT_LE(std::fabs(component), 1);
      sum += static_cast<double>(component) * static_cast<double>(component);
      whole += std::fabs(component) == 1;
    }
    if (sum != 0) {
      ASSERT_NEAR(sum, 1, 0x1.2p-23);
    }
    areas += u + v > 0;
    lengths += sum > 0;
  }
  EXPECT_GT(areas, 500'000);
  EXPECT_GT(lengths, 500'000);
  EXPECT_GT(whole, 10'000);
}

/// The same triangle of any size: a normal and shares do not change with it, as long as nothing is rounded in sides.
TEST(RayFinish, SizeMakesNoDifference) {
  for (const int size : {-149, -120, 0, 30, 57}) {
    const float unit = std::ldexp(1.0f, size);
    Triangle triangle{{{-1, -1, 3}, {3, -1, 3}, {0, 1, 4}}, 0};
    for (auto& corner : triangle.corners) {
      for (float& x : corner) x *= unit;
    }
    const PreparedRay ray = prepared({0, 0, 0}, {0, 0, unit}, triangle);
    const RayFinish finish(ray, triangle, 3, size);
    EXPECT_EQ(finish.t, 3 * unit);
    EXPECT_EQ(finish.u, 0.125f);
    EXPECT_EQ(finish.v, 0.5f);
    EXPECT_EQ(finish.normal[0], 0);
    EXPECT_EQ(finish.normal[1], -0.4472136f);
    EXPECT_EQ(finish.normal[2], 0.8944272f);
  }
}

TEST(RayFinish, WithoutAnAreaThereAreZeros) {
  const Triangle line{{{1, 2, 3}, {2, 4, 6}, {3, 6, 9}}, 0}, point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, 0};
  for (const Triangle& triangle : {line, point}) {
    const RayFinish finish(prepared({0, 0, 0}, {1, 2, 3}, triangle), triangle, 1, 0);
    EXPECT_EQ(finish.u, 0);
    EXPECT_EQ(finish.v, 0);
    for (const float component : finish.normal) EXPECT_EQ(as_bits(component), 0u);
  }
  // Seen edge-on there is no share, but a normal.
  const Triangle wall{{{0, -1, 2}, {0, 1, 2}, {0, 0, 4}}, 0};
  const RayFinish finish(prepared({0, 0, 0}, {0, 0, 1}, wall), wall, 2, 0);
  EXPECT_EQ(finish.u, 0);
  EXPECT_EQ(finish.v, 0);
  EXPECT_EQ(finish.normal[0], 1);
}

/// Sizes of errors.
struct Errors {
  std::vector<double> all;
  void add(double error) { all.push_back(std::fabs(error)); }
  double at(double share) {
    if (all.empty()) return 0;
    const auto place = all.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    return *place;
  }
};

double double_of(const Exact& x) { return x.rounded(53); }

/// The results of exact arithmetic for the ray and the triangle.
struct ExactHit {
  Exact u, v, normal[3], length_squared;
  bool area;

  ExactHit(const PreparedRay& ray, const Triangle& triangle) {
    const Exact dz(ray.direction[ray.kz]), shear_x = Exact(ray.direction[ray.kx]) / dz,
                                           shear_y = Exact(ray.direction[ray.ky]) / dz;
    Exact x[3], y[3], weights[3], sides[2][3];
    for (int corner = 0; corner < 3; ++corner) {
      const auto from_origin = [&](int axis) { return Exact(triangle(corner, axis)) - Exact(ray.origin[axis]); };
      const Exact z = from_origin(ray.kz);
      x[corner] = from_origin(ray.kx) - shear_x * z;
      y[corner] = from_origin(ray.ky) - shear_y * z;
    }
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      weights[k] = x[b] * y[a] - y[b] * x[a];
    }
    const Exact sum = weights[0] + weights[1] + weights[2];
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 2; ++i) sides[i][axis] = Exact(triangle(i + 1, axis)) - Exact(triangle(0, axis));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      normal[axis] = sides[0][a] * sides[1][b] - sides[0][b] * sides[1][a];
      length_squared = length_squared + normal[axis] * normal[axis];
    }
    area = sum.sign() != 0 && length_squared.sign() != 0;
    if (!area) return;
    u = weights[1] / sum;
    v = weights[2] / sum;
  }
  /// Of a component, in units of its own last place: of squares, where the relative error is twice as large.
  double normal_error(float component, int axis) const {
    const Exact square = normal[axis] * normal[axis] / length_squared;
    const Exact here(component);
    if (square.sign() == 0) return component == 0 ? 0 : INFINITY;
    if (square < Exact(0x1p-252)) return 0;
    const double relative = double_of((here * here - square) / square) / 2;
    return relative * std::fabs(component) / std::ldexp(1.0, std::ilogb(component) - 23);
  }
};

/// As engines compute it, in double (sim/scene/traversal.cpp, triangle_test.hpp).
Vec3 normal_in_double(const Triangle& triangle) {
  Vec3d corners[3];
  for (int corner = 0; corner < 3; ++corner) {
    for (int axis = 0; axis < 3; ++axis) corners[corner][axis] = triangle(corner, axis);
  }
  return normalized(cross(corners[1] - corners[0], corners[2] - corners[0])).as<float>();
}
struct SharesInDouble {
  float u, v;
  SharesInDouble(const TriangleRay& ray, const Triangle& triangle) {
    const CornersInView view(ray, triangle);
    double weights[3];
    bool zero = false;
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const float weight = view.x[b] * view.y[a] - view.y[b] * view.x[a];
      weights[k] = weight;
      zero |= weight == 0;
    }
    for (int k = 0; zero && k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      weights[k] = NarrowFloat(53).difference(view.x[b], view.y[a], view.y[b], view.x[a]);
    }
    const double sum = weights[0] + weights[1] + weights[2];
    u = static_cast<float>(weights[1] / sum);
    v = static_cast<float>(weights[2] / sum);
  }
};

TEST(RayFinish, IsAsNearToWhatIsExactAsDouble) {
  std::mt19937 random(3);
  std::array<std::array<Errors, 4>, kKinds> errors;
  for (int i = 0; i < 200'000; ++i) {
    const Drawn test(random);
    float t = 0;
    if (!test.ray.valid || !meets_triangle(NarrowFloat(32), test.ray, test.triangle, t)) continue;
    const ExactHit exact(test.ray, test.triangle);
    if (!exact.area) continue;
    const RayFinish finish(test.ray, test.triangle, t, 0);
    const SharesInDouble shares(test.ray, test.triangle);
    const Vec3 normal = normal_in_double(test.triangle);
    auto& [share, share_in_double, component, component_in_double] = errors[test.kind];
    const auto away = [](float x, const Exact& from) { return double_of(Exact(x) - from) * 0x1p24; };
    if (std::isfinite(shares.u)) {
      share.add(away(finish.u, exact.u));
      share.add(away(finish.v, exact.v));
      share_in_double.add(away(shares.u, exact.u));
      share_in_double.add(away(shares.v, exact.v));
    }
    for (int axis = 0; axis < 3; ++axis) {
      component.add(exact.normal_error(finish.normal[axis], axis));
      component_in_double.add(exact.normal_error(normal[axis], axis));
    }
  }
  const char* const names[kKinds] = {"aimed",      "whole numbers", "edge-on", "1e9",    "around the origin",
                                     "any floats", "padded",        "slivers", "unequal"};
  for (size_t from : {0, 2}) {
    std::printf(from == 0 ? "shares, errors in 2^-24\n" : "normals, errors in the last place of a component\n");
    std::printf("%17s %7s  %-26s  engines, in double\n", "", "", "rp_ray_finish.v");
    std::printf("%17s %7s", "hits of rays", "count");
    for (int i = 0; i < 2; ++i) std::printf("  %8s %8s %8s", "median", "99%", "largest");
    std::printf("\n");
    for (size_t kind = 0; kind < kKinds; ++kind) {
      std::printf("%17s %7zu", names[kind], errors[kind][from].all.size());
      for (size_t i = from; i < from + 2; ++i) {
        Errors& each = errors[kind][i];
        std::printf("  %8.3g %8.3g %8.3g", each.at(0.5), each.at(0.99), each.at(1));
      }
      std::printf("\n");
      if (kind == AnyFloats) continue;  // sides have 40 bits where double has 53
      Errors &here = errors[kind][from], &in_double = errors[kind][from + 1];
      EXPECT_GT(here.all.size(), 2'000u) << names[kind];
      if (from == 0) {
        EXPECT_LE(here.at(0.5), in_double.at(0.5)) << names[kind];
        EXPECT_LE(here.at(0.99), 1.01 * in_double.at(0.99)) << names[kind];
      } else {
        EXPECT_LT(here.at(1), 0.53) << names[kind];
      }
    }
  }
}

struct Seen {
  std::array<int, kKinds> rays{};
  std::array<int, 40> apart{};
};

template <typename Unit>
class FinishBench : public Clocked<Unit> {
 public:
  FinishBench() : Clocked<Unit>(4) {}

  void ray(Seen& seen) {
    RayFinishPipe::Start start{};
    const Drawn test(this->random);
    if (!test.ray.valid) return;
    const Time time(this->random);
    start = {this->random() & 0xffff, test.ray, test.triangle, time.t, time.scale};
    set(start);
    ASSERT_NO_FATAL_FAILURE(cycle(&start));
    const uint32_t apart =
        RayFinishPipe::kApart + (!this->one_of(4) ? 0 : this->random() % static_cast<uint32_t>(seen.apart.size()));
    for (uint32_t i = 1; i < apart; ++i) ASSERT_NO_FATAL_FAILURE(cycle(nullptr));
    ++seen.apart[apart - RayFinishPipe::kApart];
    ++seen.rays[test.kind];
  }
  void drain() {
    for (int i = 0; i < RayFinishPipe::kStages; ++i) ASSERT_NO_FATAL_FAILURE(cycle(nullptr));
  }

 private:
  void set(const RayFinishPipe::Start& start) {
    Unit& unit = *this->u;
    unit.tag_i = static_cast<uint16_t>(start.tag);
    for (int corner = 0; corner < 3; ++corner) set_floats(&unit.corners_i[3 * corner], start.triangle.corners[corner]);
    set_floats(&unit.origin_i[0], start.ray.origin);
    unit.main_axis_i = static_cast<uint8_t>(start.ray.kz);
    unit.shear_i = uint64_t{as_bits(start.ray.shear_y)} << 32 | as_bits(start.ray.shear_x);
    unit.t_i = as_bits(start.t);
    unit.scale_i = static_cast<uint16_t>(start.scale & 0x1ff);
  }
  /// What stands at the inputs in other cycles is nothing.
  void disturb() {
    Unit& unit = *this->u;
    unit.tag_i = this->random() & 0xffff;
    for (int word = 0; word < 9; ++word) unit.corners_i[word] = this->random();
    for (int word = 0; word < 3; ++word) unit.origin_i[word] = this->random();
    unit.main_axis_i = this->random() % 3;
    unit.shear_i = uint64_t{this->random()} << 32 | this->random();
    unit.t_i = this->random();
    unit.scale_i = this->random() & 0x1ff;
  }
  void cycle(const RayFinishPipe::Start* start) {
    Unit& unit = *this->u;
    unit.valid_i = start != nullptr;
    if (start == nullptr) disturb();
    unit.eval();
    const RayFinishPipe::Result* const result = pipe_.result();
    ASSERT_EQ(unit.valid_o, result != nullptr);
    if (result != nullptr) {
      ASSERT_EQ(unit.tag_o, result->tag);
      ASSERT_EQ(unit.t_o, as_bits(result->finish.t)) << result->finish.t;
      ASSERT_EQ(unit.u_o, as_bits(result->finish.u)) << result->finish.u;
      ASSERT_EQ(unit.v_o, as_bits(result->finish.v)) << result->finish.v;
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(unit.normal_o[axis], as_bits(result->finish.normal[axis])) << result->finish.normal[axis];
      }
    }
    pipe_.clock(start);
    this->clock();
  }
  RayFinishPipe pipe_;
};

TEST(RayFinishInVerilog, AgreesWithItsClassInEveryCycle) {
  FinishBench<Vray_finish_16> bench;
  Seen seen;
  for (int ray = 0; ray < 120'000; ++ray) ASSERT_NO_FATAL_FAILURE(bench.ray(seen)) << "ray " << ray;
  ASSERT_NO_FATAL_FAILURE(bench.drain());
  for (const int count : seen.rays) EXPECT_GT(count, 4'000);
  for (const int count : seen.apart) EXPECT_GT(count, 300);
}
}  // namespace
}  // namespace raypool::bench
