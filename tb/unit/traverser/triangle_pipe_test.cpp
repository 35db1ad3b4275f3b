// The triangle pipe: its arithmetic against rational numbers, and the Verilog against its class, all outputs in every
// cycle.
#include "machine/traverser/triangle_pipe.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cmath>
#include <random>

#include "Vfloat_products_11_31_1.h"
#include "Vfloat_quotient_11_31.h"
#include "Vfloat_quotient_6_5.h"
#include "Vtriangle_pipe_26.h"
#include "Vtriangle_pipe_32.h"
#include "scene/exact_rational.hpp"
#include "unit/common/clocked.hpp"
#include "unit/traverser/drawn_triangle.hpp"
#include "unit/traverser/triangle_signals.hpp"

namespace raypool::bench {
namespace {

/// t of the plane, each operation in rational numbers and then rounded.
double exact_plane_time(const TriangleRay& ray, const Triangle& triangle, int bits, bool& defined) {
  const auto rounded = [&](const Exact& x) { return Exact(x.rounded(bits)); };
  Exact a[3], sides[2][3], normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    a[axis] = rounded(Exact(triangle(0, axis)) - Exact(ray.origin[axis]));
    for (int i = 0; i < 2; ++i) sides[i][axis] = rounded(Exact(triangle(i + 1, axis)) - Exact(triangle(0, axis)));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    normal[axis] = rounded(rounded(sides[0][i] * sides[1][j]) - rounded(sides[0][j] * sides[1][i]));
  }
  const auto dot = [&](const Exact(&b)[3]) {
    const Exact first = rounded(rounded(normal[0] * b[0]) + rounded(normal[1] * b[1]));
    return rounded(first + rounded(normal[2] * b[2]));
  };
  const Exact direction[3] = {ray.direction[0], ray.direction[1], ray.direction[2]};
  const Exact numerator = dot(a), denominator = dot(direction);
  defined = denominator.sign() != 0;
  return defined ? (numerator / denominator).rounded(bits) : 0;
}

/// The same, without any rounding.
Exact exact_time(const TriangleRay& ray, const Triangle& triangle, bool& defined) {
  Exact a[3], sides[2][3], numerator, denominator;
  for (int axis = 0; axis < 3; ++axis) {
    a[axis] = Exact(triangle(0, axis)) - Exact(ray.origin[axis]);
    for (int i = 0; i < 2; ++i) sides[i][axis] = Exact(triangle(i + 1, axis)) - Exact(triangle(0, axis));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const Exact normal = sides[0][i] * sides[1][j] - sides[0][j] * sides[1][i];
    numerator = numerator + normal * a[axis];
    denominator = denominator + normal * Exact(ray.direction[axis]);
  }
  defined = denominator.sign() != 0;
  return defined ? numerator / denominator : Exact();
}

TEST(TrianglePipe, EveryOperationIsOneOfRationalNumbersRoundedOnce) {
  std::mt19937 random(1);
  std::array<int, kKinds> times{};
  int undefined = 0;
  for (int i = 0; i < 40000; ++i) {
    const Drawn test(random);
    if (!test.ray.valid) continue;
    for (const int bits : {26, 32}) {
      bool defined = false;
      const double expected = exact_plane_time(test.ray, test.triangle, bits, defined);
      const double t = plane_time(NarrowFloat(static_cast<uint32_t>(bits)), test.ray, test.triangle);
      ASSERT_EQ(std::isfinite(t), defined);
      if (defined) {
        ASSERT_EQ(t, expected) << bits << " bits, kind " << test.kind;
      }
      ++(defined ? times[test.kind] : undefined);
    }
  }
  for (const int count : times) EXPECT_GT(count, 2000);
  EXPECT_GT(undefined, 1000);
}

TEST(TrianglePipe, OfRaysThatAreAimedTheTimeIsMostlyTheNearestFloat) {
  std::mt19937 random(2);
  int nearest = 0, hits = 0;
  for (int i = 0; i < 100000; ++i) {
    const Drawn test(random);
    float t = 0;
    if (test.kind != Aimed || !test.ray.valid || !meets_triangle(NarrowFloat(32), test.ray, test.triangle, t)) continue;
    bool defined = false;
    const Exact exact = exact_time(test.ray, test.triangle, defined);
    if (!defined || t < 0x1p-126f) continue;
    nearest += t == exact.rounded(24);
    ++hits;
  }
  EXPECT_GT(hits, 5000);
  EXPECT_GT(nearest, hits * 98 / 100);
}

TEST(TrianglePipe, OfTwoAtTheSameTimeTheLowerNumberIsHit) {
  TrianglePipe pipe(32);
  const Triangle triangle{{{-1, -1, 3}, {1, -1, 3}, {0, 1, 3}}, 7};
  const PreparedRay ray = prepared({0, 0, 1}, {0, 0, 4}, triangle);
  const auto hit = [&](float limit, float best_t, uint32_t best_number) {
    pipe.begin(ray, triangle, 1);
    pipe.clock({}, {});
    for (int cycle = 1; cycle < pipe.stages(); ++cycle) pipe.clock({limit, -2}, {best_t, best_number});
    EXPECT_NE(pipe.result(), nullptr);
    EXPECT_EQ(pipe.result()->t, 2) << "internal: the direction's largest component is scaled to 1";
    return pipe.result()->hit;
  };
  EXPECT_TRUE(hit(INFINITY, INFINITY, 0));
  EXPECT_TRUE(hit(INFINITY, 2, 8));
  EXPECT_FALSE(hit(INFINITY, 2, 7));
  EXPECT_FALSE(hit(INFINITY, 2, 6));
  EXPECT_FALSE(hit(0.5f, INFINITY, 8));
  EXPECT_TRUE(hit(std::nextafter(0.5f, 1.0f), INFINITY, 8));
}

/// What the ray of each tag answers when a test asks.
struct Answers {
  TrianglePipe::Limit limit{1, 0};
  TrianglePipe::Best best{1, 0};

  Answers() = default;
  Answers(std::mt19937& random, const NarrowFloat& narrow, const Drawn& test) {
    limit.scale = random() % 4 != 0 ? std::ilogb(test.ray.t_scale) : static_cast<int>(random() % 277) - 127;
    float t = 0;
    const bool met = meets_triangle(narrow, test.ray, test.triangle, t) && std::isfinite(t);
    if (met && random() % 16 == 0) limit.scale = std::max(-127, -149 - std::ilogb(t) + static_cast<int>(random() % 25));
    const float ray_t = met ? static_cast<float>(std::ldexp(static_cast<double>(t), limit.scale)) : 1;
    const auto around = [&](float x) {
      const uint32_t moved = as_bits(x) + random() % 3 - 1;
      return moved <= 0x7f800000 ? as_float(moved) : x;
    };
    limit.limit = random() % 2 == 0 ? INFINITY : random() % 4 == 0 ? 1 : around(ray_t);
    if (!(limit.limit > 0)) limit.limit = 0x1p-149f;
    best.t = random() % 2 == 0 ? INFINITY : random() % 8 == 0 ? 0 : around(t);
    if (!(best.t >= 0)) best.t = 0;
    best.number = random() % 3 == 0 ? test.triangle.number + random() % 3 - 1 : random();
  }
};

struct Seen {
  uint64_t results = 0, late_misses = 0, ties = 0;
  std::array<uint64_t, kKinds> hits{};
};

template <typename Unit>
class PipeBench : public Clocked<Unit> {
 public:
  explicit PipeBench(uint32_t bits) : Clocked<Unit>(bits), narrow_(bits), pipe_(bits) {}

  void cycle(Seen& seen) {
    Unit& unit = *this->u;
    const Drawn test(this->random);
    unit.valid_i = test.ray.valid && !this->one_of(8);
    const auto tag = static_cast<uint8_t>(cycle_++);
    if (test.ray.valid) set_test(test, tag);
    set_answers();
    unit.eval();
    ASSERT_NO_FATAL_FAILURE(compare(seen)) << "cycle " << cycle_;
    const TriangleResult *limited = pipe_.told_limit(), *compared = pipe_.told_best();
    const bool met = compared != nullptr && compared->hit;
    if (met) {
      const Answers& told = answers_[compared->tag];
      seen.ties += compared->t == told.best.t && compared->number != told.best.number;
    }
    const Answers none;
    if (unit.valid_i) pipe_.begin(test.ray, test.triangle, tag);
    pipe_.clock(limited != nullptr ? answers_[limited->tag].limit : none.limit,
                compared != nullptr ? answers_[compared->tag].best : none.best);
    seen.late_misses += met && !pipe_.result()->hit;
    this->clock();
  }

 private:
  void set_test(const Drawn& test, uint8_t tag) {
    Unit& unit = *this->u;
    unit.tag_i = tag;
    for (int corner = 0; corner < 3; ++corner) set_floats(&unit.corners_i[3 * corner], test.triangle.corners[corner]);
    unit.number_i = test.triangle.number;
    set_triangle_ray(unit, test.ray);
    if (!unit.valid_i) return;
    answers_[tag] = Answers(this->random, narrow_, test);
    kinds_[tag] = test.kind;
  }
  void set_answers() {
    Unit& unit = *this->u;
    const TriangleResult *limited = pipe_.told_limit(), *compared = pipe_.told_best();
    unit.limit_i = limited != nullptr ? as_bits(answers_[limited->tag].limit.limit) : this->random();
    unit.scale_i = limited != nullptr ? answers_[limited->tag].limit.scale & 0x1ff : this->random() & 0x1ff;
    unit.best_t_i = compared != nullptr ? as_bits(answers_[compared->tag].best.t) : this->random();
    unit.best_number_i = compared != nullptr ? answers_[compared->tag].best.number : this->random();
  }
  void compare(Seen& seen) const {
    const Unit& unit = *this->u;
    const TriangleResult *limited = pipe_.asks_limit(), *compared = pipe_.asks_best(), *result = pipe_.result();
    ASSERT_EQ(unit.asks_limit_o, limited != nullptr);
    ASSERT_EQ(unit.asks_best_o, compared != nullptr);
    ASSERT_EQ(unit.valid_o, result != nullptr);
    if (limited != nullptr) {
      ASSERT_EQ(unit.limit_tag_o, limited->tag);
    }
    if (compared != nullptr) {
      ASSERT_EQ(unit.best_tag_o, compared->tag);
    }
    if (result == nullptr) return;
    ASSERT_EQ(unit.tag_o, result->tag);
    ASSERT_EQ(unit.number_o, result->number);
    ASSERT_EQ(unit.hit_o, result->hit) << "kind " << kinds_[result->tag] << ", t " << result->t;
    if (result->hit) {
      ASSERT_EQ(unit.t_o, as_bits(result->t)) << "kind " << kinds_[result->tag] << ": " << result->t;
    }
    ++seen.results;
    seen.hits[kinds_[result->tag]] += result->hit;
  }

  NarrowFloat narrow_;
  TrianglePipe pipe_;
  uint32_t cycle_ = 0;
  std::array<Answers, 256> answers_;
  std::array<Kind, 256> kinds_{};
};

template <typename Unit>
void compare_pipe(uint32_t bits) {
  PipeBench<Unit> bench(bits);
  Seen seen;
  for (int cycle = 0; cycle < 300'000; ++cycle) ASSERT_NO_FATAL_FAILURE(bench.cycle(seen));
  EXPECT_GT(seen.results, 200'000u);
  for (const uint64_t count : seen.hits) EXPECT_GT(count, 500u);
  EXPECT_GT(seen.late_misses, 5'000u);
  EXPECT_GT(seen.ties, 1'000u);
}

TEST(TrianglePipeInVerilog, AgreesWithItsClassInEveryCycleWith32Bits) { compare_pipe<Vtriangle_pipe_32>(32); }
TEST(TrianglePipeInVerilog, AgreesWithItsClassInEveryCycleWith26Bits) { compare_pipe<Vtriangle_pipe_26>(26); }

/// A quotient of significands of so many bits, by integers: rounded to nearest even, its exponent in `places`.
uint64_t whole_quotient(uint64_t a, uint64_t b, int bits, int& places) {
  places = a < b ? -1 : 0;
  const unsigned __int128 numerator = static_cast<unsigned __int128>(a) << (bits - 1 - places);
  const auto quotient = static_cast<uint64_t>(numerator / b);
  const uint64_t rest = 2 * static_cast<uint64_t>(numerator % b);
  EXPECT_NE(rest, b) << "a tie";
  return quotient + (rest > b ? 1 : 0);
}

template <typename Unit>
void compare_quotients(int exponent_bits, int bits, uint64_t count) {
  Unit u;
  std::mt19937_64 random(5);
  const uint64_t ones = (uint64_t{1} << (bits - 1)) - 1, exponents = (uint64_t{1} << exponent_bits) - 1;
  const int latency = 2 + bits / 2;
  std::vector<uint64_t> expected(latency);
  for (uint64_t i = 0; i < count; ++i) {
    uint64_t fraction[2], exponent[2], sign[2];
    for (int k = 0; k < 2; ++k) {
      fraction[k] = bits < 10 ? i >> (k * (bits - 1)) & ones : random() & ones;
      if (bits >= 10 && random() % 3 == 0) fraction[k] = random() % 2 == 0 ? ones - random() % 4 : random() % 4;
      exponent[k] = random() % 9 == 0 ? 0 : exponents / 2 - exponents / 8 + random() % (exponents / 4);
      if (exponent[k] == 0) fraction[k] = 0;
      sign[k] = random() & 1;
    }
    const auto word = [&](uint64_t s, uint64_t e, uint64_t f) { return (s << exponent_bits | e) << (bits - 1) | f; };
    u.a_i = word(sign[0], exponent[0], fraction[0]);
    u.b_i = word(sign[1], exponent[1], fraction[1]);
    u.clk_i = 0;
    u.eval();
    if (i >= static_cast<uint64_t>(latency)) {
      ASSERT_EQ(u.quotient_o, expected[i % latency]) << "the operands of " << latency << " cycles before, cycle " << i;
    }
    const uint64_t s = sign[0] ^ sign[1];
    int places = 0;
    uint64_t result = 0;
    if (exponent[1] == 0) {
      result = word(s, exponents, exponent[0] == 0 ? (ones + 1) / 2 : 0);
    } else if (exponent[0] == 0) {
      result = word(s, 0, 0);
    } else {
      const uint64_t significand = whole_quotient(ones + 1 + fraction[0], ones + 1 + fraction[1], bits, places);
      ASSERT_EQ(significand >> (bits - 1), 1u);
      result = word(s, exponent[0] - exponent[1] + exponents / 2 + static_cast<uint64_t>(places), significand & ones);
    }
    expected[i % latency] = result;
    u.clk_i = 1;
    u.eval();
  }
  u.final();
}

TEST(FloatQuotient, IsThatOfIntegersRoundedOnce) {
  compare_quotients<Vfloat_quotient_6_5>(6, 6, uint64_t{1} << 16);
  compare_quotients<Vfloat_quotient_11_31>(11, 32, 1'000'000);
}

/// As double has it, without the bits that it has more.
uint64_t narrow_word(double x) { return number(x) >> 21; }

TEST(FloatProducts, WithSeventeenDigitsAreThoseOfTheClass) {
  Vfloat_products_11_31_1 u;
  std::mt19937_64 random(6);
  const NarrowFloat narrow(32);
  std::array<double, 3> expected{};
  for (uint64_t i = 0; i < 1'000'000; ++i) {
    const auto any = [&] {
      const uint64_t fraction = random() >> (random() % 3 == 0 ? 44 : 33), ones = random() % 4 == 0 ? 0x7fffff00 : 0;
      return std::ldexp(static_cast<double>((uint64_t{1} << 31) + (fraction | ones)),
                        static_cast<int>(random() % 300)) *
             (random() % 2 == 0 ? 1 : -1) * (random() % 16 == 0 ? 0 : 1);
    };
    const double a = any(), b = any();
    u.a_i = narrow_word(a);
    u.b_i = narrow_word(b);
    u.clk_i = 0;
    u.eval();
    if (i >= 3) {
      ASSERT_EQ(u.product_o, narrow_word(expected[i % 3])) << i;
    }
    expected[i % 3] = narrow.multiply(a, b);
    u.clk_i = 1;
    u.eval();
  }
  u.final();
}

}  // namespace
}  // namespace raypool::bench
