// The set-up of a ray: the class against rational numbers, against what engines prepare, and the Verilog against the
// class, all outputs in every cycle.
#include "machine/traverser/ray_setup.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <array>

#include "Vray_setup_12.h"
#include "Vray_setup_16.h"
#include "Vray_setup_6.h"
#include "scene/exact_rational.hpp"
#include "scene/narrow_boxes.hpp"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"
#include "unit/traverser/hard_words.hpp"

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

/// What docs/machine/box-test.md asks of the padding ("No hit is lost", 4), in rational numbers, and how much more
/// there is.
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

/// A component of the triangle pipe's direction: sign, 11 bits of exponent, 23 of fraction.
uint64_t direction_word(double x) {
  uint64_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits >> 29;
}

template <typename Unit>
void expect_shown(const Unit& u, const RaySetup& setup) {
  const auto bits = static_cast<uint32_t>(setup.box.bits);
  const auto word = [](const auto& signal, int axis) { return get_bits(signal, 32 * static_cast<uint32_t>(axis), 32); };
  const TriangleRay& triangle = setup.triangle;
  ASSERT_EQ(u.limit_o, as_bits(setup.limit));
  ASSERT_EQ(u.scale_o, static_cast<uint32_t>(setup.scale) & 0x1ff);
  ASSERT_EQ(u.key_o, setup.box.limit);
  ASSERT_EQ(u.main_axis_o, triangle.kz);
  ASSERT_EQ(word(u.shear_o, 0), as_bits(triangle.shear_x));
  ASSERT_EQ(word(u.shear_o, 1), as_bits(triangle.shear_y));
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    const auto at = static_cast<uint32_t>(axis);
    const BoxRay::Axis& box = setup.box.axes[axis];
    ASSERT_EQ(word(u.origin_o, axis), as_bits(triangle.origin[axis]));
    ASSERT_EQ(get_bits(u.backwards_o, at, 1), box.backwards ? 1u : 0u);
    ASSERT_EQ(get_bits(u.still_o, at, 1), box.still ? 1u : 0u);
    ASSERT_EQ(get_bits(u.reciprocal_o, bits * at, bits), box.reciprocal);
    ASSERT_EQ(get_bits(u.exponent_o, 10 * at, 10), static_cast<uint32_t>(box.exponent) & 0x3ff);
    ASSERT_EQ(get_bits(u.padding_o, 10 * at, 10), static_cast<uint32_t>(box.padding) & 0x3ff);
    ASSERT_EQ(word(u.padded_lower_o, axis), as_bits(triangle.padded[0][axis]));
    ASSERT_EQ(word(u.padded_upper_o, axis), as_bits(triangle.padded[1][axis]));
    ASSERT_EQ(word(u.inverse_o, axis), as_bits(triangle.inverse[axis]));
    const uint64_t direction = direction_word(triangle.direction[axis]);
    ASSERT_EQ(get_bits(u.direction_o, 35 * at, 32), static_cast<uint32_t>(direction));
    ASSERT_EQ(get_bits(u.direction_o, 35 * at + 32, 3), static_cast<uint32_t>(direction >> 32));
  }
}

constexpr uint32_t kSpacings = 40;

struct Shown {
  std::array<int, HardWords::kKinds> rays{};
  int nothing = 0;                     // rays that hit nothing
  std::array<int, kSpacings> apart{};  // by so many cycles more than they must be
  std::array<int, 3> main_axes{};
};

/// Rays of one scene at a time, since its box stands still: the pipe is empty when the next one comes.
template <typename Unit>
class SetupBench : public Clocked<Unit> {
 public:
  explicit SetupBench(int bits) : Clocked<Unit>(static_cast<uint32_t>(bits)), bits_(bits), words_(this->random()) {}

  void scene(int rays, Shown& shown) {
    words_.draw();
    const RootBox root = words_.root;
    set_words(this->u->lower_i, root.lower);
    set_words(this->u->upper_i, root.upper);
    for (int ray = 0; ray < rays; ++ray) {
      ASSERT_NO_FATAL_FAILURE(begin(root, ray == 0, shown));
      ASSERT_NO_FATAL_FAILURE(cycle(true, shown));
      const uint32_t apart = RaySetupPipe::kApart + (this->one_of(2) ? 0 : this->random() % kSpacings);
      for (uint32_t i = 1; i < apart; ++i) ASSERT_NO_FATAL_FAILURE(cycle(false, shown));
      ++shown.apart[apart - RaySetupPipe::kApart];
    }
    for (int i = 0; i < RaySetupPipe::kStages; ++i) ASSERT_NO_FATAL_FAILURE(cycle(false, shown));
  }

  /// Scenes so far out and so small that a place more or less decides their padding, with a ray from within each.
  void scenes_at_a_step(Shown& shown) {
    words_.draw();
    const size_t axis = this->random() % 3;
    const uint32_t first = (this->random() % 2) << 31 | (100 + this->random() % 80) << 23;
    const uint32_t more = this->random() % 4, origin = this->random() % 4;
    for (size_t i = 0; i < 3; ++i) words_.ray.origin[i] = words_.root.lower[i] = words_.root.upper[i] = 0;
    for (float& component : words_.ray.direction) component = std::isfinite(component) ? component + 1 : 1;
    const auto padding_at = [&](uint32_t fraction) {
      const float near = as_float(first + fraction), far = as_float(first + fraction + more);
      words_.root.lower[axis] = std::min(near, far);
      words_.root.upper[axis] = std::max(near, far);
      words_.ray.origin[axis] = as_float(first + fraction + origin);
      return RaySetup(words_.ray, words_.root, bits_).box.axes[axis].padding;
    };
    uint32_t low = 8, high = 0x7ffff0;
    const int padding = padding_at(low);
    while (high - low > 1) {
      const uint32_t middle = low + (high - low) / 2;
      (padding_at(middle) == padding ? low : high) = middle;
    }
    for (uint32_t fraction = low - 3; fraction <= high + 3; ++fraction) {
      padding_at(fraction);
      set_words(this->u->lower_i, words_.root.lower);
      set_words(this->u->upper_i, words_.root.upper);
      ASSERT_NO_FATAL_FAILURE(begin(words_.root, true, shown));
      ASSERT_NO_FATAL_FAILURE(cycle(true, shown));
      for (int i = 0; i < RaySetupPipe::kStages; ++i) ASSERT_NO_FATAL_FAILURE(cycle(false, shown));
    }
  }

 private:
  template <typename Signal>
  static void set_words(Signal& signal, const float (&floats)[3]) {
    for (uint32_t axis = 0; axis < 3; ++axis) set_bits(signal, 32 * axis, 32, as_bits(floats[axis]));
  }
  void begin(const RootBox& root, bool first, Shown& shown) {
    if (!first) words_.draw_for(root);
    Unit& unit = *this->u;
    set_words(unit.origin_i, words_.ray.origin);
    set_words(unit.direction_i, words_.ray.direction);
    unit.limit_i = as_bits(words_.ray.limit);
    next_ = {static_cast<uint32_t>(this->random() & 0xff), RaySetup(words_.ray, root, bits_)};
    unit.tag_i = next_.tag;
    if (!next_.setup.valid) return;
    ++shown.rays[words_.kind];
    ++shown.main_axes[static_cast<size_t>(next_.setup.triangle.kz)];
  }
  void cycle(bool comes, Shown& shown) {
    Unit& unit = *this->u;
    unit.valid_i = comes;
    // What stands at the inputs in other cycles is nothing.
    if (!comes) unit.tag_i = this->random() & 0xff;
    if (!comes) unit.limit_i = this->random();
    if (!comes) set_bits(unit.origin_i, 32 * (this->random() % 3), 32, this->random());
    if (!comes) set_bits(unit.direction_i, 32 * (this->random() % 3), 32, this->random());
    unit.eval();
    ASSERT_EQ(unit.valid_o, pipe_.result() != nullptr);
    if (pipe_.result() != nullptr) {
      ASSERT_EQ(unit.tag_o, pipe_.result()->tag);
      ASSERT_EQ(unit.hits_o, pipe_.result()->setup.valid);
      if (unit.hits_o) {
        ASSERT_NO_FATAL_FAILURE(expect_shown(unit, pipe_.result()->setup));
      }
      shown.nothing += !unit.hits_o;
    }
    pipe_.clock(comes ? &next_ : nullptr);
    this->clock();
  }

  int bits_;
  HardWords words_;
  RaySetupPipe pipe_;
  RaySetupPipe::Result next_{0, {{}, {}, 0}};
};

template <typename Unit>
void compare_setup(int bits) {
  SetupBench<Unit> bench(bits);
  Shown shown;
  for (int scene = 0; scene < 8000; ++scene) {
    ASSERT_NO_FATAL_FAILURE(bench.scene(10, shown)) << "scene " << scene;
  }
  for (const int count : shown.rays) EXPECT_GT(count, 2'000);
  for (const int count : shown.main_axes) EXPECT_GT(count, 10'000);
  EXPECT_GT(shown.nothing, 5'000);
  for (const int count : shown.apart) EXPECT_GT(count, 500);
}

TEST(RaySetupInVerilog, AgreesWithItsClassInEveryCycleWith6Bits) { compare_setup<Vray_setup_6>(6); }
TEST(RaySetupInVerilog, AgreesWithItsClassInEveryCycleWith12Bits) { compare_setup<Vray_setup_12>(12); }
TEST(RaySetupInVerilog, AgreesWithItsClassInEveryCycleWith16Bits) { compare_setup<Vray_setup_16>(16); }

// What a last place of a coordinate, or of what boxes are widened by, changes.
TEST(RaySetupInVerilog, PadsAsItsClassWhereALastPlaceDecides) {
  SetupBench<Vray_setup_12> bench(12);
  Shown shown;
  for (int scene = 0; scene < 400; ++scene) {
    ASSERT_NO_FATAL_FAILURE(bench.scenes_at_a_step(shown)) << "scene " << scene;
  }
  EXPECT_LT(shown.nothing, 400);
}

}  // namespace
}  // namespace raypool::bench
