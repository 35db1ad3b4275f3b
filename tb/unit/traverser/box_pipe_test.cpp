// The narrow box test: the class against exact arithmetic, which it may never miss a box of; the Verilog against the
// class, all outputs in every cycle, with stalls. Boxes and rays are made so that they nearly touch.
#include "machine/traverser/box_pipe.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <cmath>
#include <limits>
#include <random>

#include "Vbox_pipe_10.h"
#include "Vbox_pipe_12.h"
#include "Vbox_pipe_16.h"
#include "Vbox_pipe_6.h"
#include "Vbox_pipe_7.h"
#include "config/configuration.hpp"
#include "scene/exact_rational.hpp"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"

namespace raypool::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RayWords {
  float origin[3], direction[3], limit;
};

/// The value of a key, which may be beyond a float.
double value_of(uint32_t key, int bits) {
  if (key == 0) return 0;
  const uint32_t fraction = key & ((1u << (bits - 1)) - 1);
  return std::ldexp(static_cast<double>(fraction | 1u << (bits - 1)),
                    static_cast<int>(key >> (bits - 1)) - kKeyBias - (bits - 1));
}

/// Real numbers: does the segment meet box `box`, its origin moved by `shift`? `entry`: when.
bool meets(const RayWords& ray, const double (&shift)[3], const BoxNode& node, int box, Exact& entry) {
  Exact near = 0, far = 0;
  bool endless = std::isinf(ray.limit);
  if (!endless) far = Exact(ray.limit);
  for (int axis = 0; axis < 3; ++axis) {
    const Exact origin = Exact(ray.origin[axis]) + Exact(shift[axis]);
    const auto distance = [&](int side) {
      return Exact(node.origin[axis]) + Exact(std::ldexp(node.planes[side][axis][box], node.exponent[axis])) - origin;
    };
    const bool backwards = ray.direction[axis] < 0;
    const Exact first = distance(backwards ? 1 : 0), second = distance(backwards ? 0 : 1);
    if (ray.direction[axis] == 0) {
      if (Exact(0) < first || second < Exact(0)) return false;
      continue;
    }
    const Exact enters = first / Exact(ray.direction[axis]), leaves = second / Exact(ray.direction[axis]);
    if (near < enters) near = enters;
    if (endless || leaves < far) far = leaves;
    endless = false;
  }
  entry = near;
  return endless || !(far < near);
}

class Cases {
 public:
  explicit Cases(uint32_t seed) : random_(seed) {}

  /// A node, and a ray that meets a corner, an edge or a face of one of its boxes exactly, or misses it by a little;
  /// both of any size.
  void make() {
    const int scale = static_cast<int>(one_of(4) ? below(240) : below(20)) - (one_of(4) ? 126 : 10);
    node.children = static_cast<uint8_t>(one_of(8) ? below(5) : 4);
    for (int axis = 0; axis < 3; ++axis) {
      const int exponent = one_of(6) ? static_cast<int>(below(256)) - 128 : scale - 8 + static_cast<int>(below(4));
      node.exponent[axis] = static_cast<int8_t>(std::min(std::max(exponent, -128), 127));
      node.origin[axis] = any(node.exponent[axis] + static_cast<int>(below(16)));
      for (int box = 0; box < kBoxes; ++box) {
        const auto a = static_cast<uint8_t>(below(256));
        const auto b = static_cast<uint8_t>(one_of(4) ? a : one_of(4) ? 255 : below(256));
        node.planes[0][axis][box] = std::min(a, b);
        node.planes[1][axis][box] = std::max(a, b);
      }
    }
    const int box = static_cast<int>(below(kBoxes)), when = static_cast<int>(below(12)) - 6;
    if (one_of(4)) {
      from_the_grid(box, when);
      return;
    }
    // Towards a point of a box's surface, at a time that is a power of two or any.
    const float time = one_of(2) ? std::ldexp(1.0f, when) : any(when);
    for (int axis = 0; axis < 3; ++axis) {
      const double at = node.origin[axis] + std::ldexp(node.planes[below(2)][axis][box], node.exponent[axis]);
      float direction = any(node.exponent[axis] + static_cast<int>(below(14)));
      if (one_of(8)) direction = one_of(2) ? 0.0f : -0.0f;
      if (one_of(16)) direction = as_float(static_cast<uint32_t>(random_() & 0x807fffffu));  // subnormal
      if (one_of(16)) direction = as_float(static_cast<uint32_t>(random_()));
      ray.direction[axis] = direction;
      ray.origin[axis] = static_cast<float>(at - static_cast<double>(time) * direction);
      if (one_of(4)) ray.origin[axis] = as_float(as_bits(ray.origin[axis]) + below(5) - 2);
      if (one_of(16)) ray.origin[axis] = node.origin[axis];
      if (one_of(32)) ray.origin[axis] = as_float(static_cast<uint32_t>(random_()));
    }
    ray.limit = one_of(3) ? kInfinity : one_of(2) ? std::fabs(time) : std::fabs(any(when + 1));
    if (one_of(16)) ray.limit = as_float(static_cast<uint32_t>(random_()) & 0x7fffffffu);
  }
  bool one_of(uint32_t n) { return random_() % n == 0; }
  uint32_t below(uint32_t n) { return static_cast<uint32_t>(random_() % n); }
  double share() { return static_cast<double>(random_()) / 4294967296.0; }

  BoxNode node{};
  RayWords ray{};

 private:
  /// A ray from the grid's origin exactly through a corner of the box, where it is or where it ends.
  void from_the_grid(int box, int when) {
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = node.origin[axis];
      ray.direction[axis] =
          std::ldexp(static_cast<float>(node.planes[below(2)][axis][box]), node.exponent[axis] - when);
      if (std::isinf(ray.direction[axis])) ray.direction[axis] = 0;
    }
    ray.limit = one_of(2) ? kInfinity : std::ldexp(1.0f, when);
  }
  /// Of about 2^exponent, of either sign, with few bits or many; finite.
  float any(int exponent) {
    const auto bits = static_cast<uint32_t>(random_());
    const uint32_t significand = one_of(3) ? (bits & 0x700000u) : (bits & 0x7fffffu);
    const double value = std::ldexp(1 + significand * 0x1p-23, std::min(std::max(exponent, -149), 126));
    return static_cast<float>((bits >> 31) != 0 ? -value : value);
  }
  std::mt19937 random_;
};

BoxRay set_up(const RayWords& ray, int bits) { return BoxRay(ray.origin, ray.direction, ray.limit, bits); }

class Narrow : public testing::TestWithParam<int> {};

TEST_P(Narrow, MeetsWhatExactArithmeticMeets) {
  const int bits = GetParam();
  Cases cases(static_cast<uint32_t>(bits));
  uint32_t met = 0, more = 0, none = 0, padded = 0, still = 0;
  for (int i = 0; i < 60000; ++i) {
    cases.make();
    BoxRay ray = set_up(cases.ray, bits);
    if (!ray.valid) continue;
    double shift[3] = {0, 0, 0};
    if (cases.one_of(2)) {
      for (int axis = 0; axis < 3; ++axis) {
        const int padding = cases.node.exponent[axis] + static_cast<int>(cases.below(20)) - 10;
        ray.axes[axis].padding = padding;
        shift[axis] = std::ldexp(cases.one_of(2) ? (1 - 0x1p-30) : cases.share(), padding);
        if (cases.one_of(2)) shift[axis] = -shift[axis];
      }
      ++padded;
    }
    const BoxResult result = test_boxes(ray, cases.node, ray.limit);
    ASSERT_EQ(result.met >> cases.node.children, 0u);
    for (int box = 0; box < cases.node.children; ++box) {
      Exact entry;
      const bool exact = meets(cases.ray, shift, cases.node, box, entry), found = (result.met >> box & 1) != 0;
      ASSERT_TRUE(found || !exact) << "test " << i << ", box " << box;
      if (exact) {
        ASSERT_FALSE(entry < Exact(value_of(result.entry[box], bits))) << "test " << i << ", box " << box;
      }
      met += exact;
      more += found && !exact;
      none += !found;
    }
    for (const BoxRay::Axis& axis : ray.axes) still += axis.still;
  }
  EXPECT_GT(met, 10000u);
  EXPECT_GT(more, 100u);
  EXPECT_GT(none, 10000u);
  EXPECT_GT(padded, 10000u);
  EXPECT_GT(still, 1000u);
}

// What is subtracted may end below the last bit that is kept: then the distance is less than its other bits. It matters
// where all else is exact: a reciprocal that is m but for little, and an origin that is off by all that it may be.
TEST_P(Narrow, OfADifferenceNothingIsRoundedUp) {
  const int bits = GetParam(), places = bits + 3;
  const uint32_t power = 1u << (bits - 1);
  const auto rest = [bits](uint32_t m) { return (uint64_t{1} << (bits + 23)) % m; };
  uint32_t m = power + 1;
  for (uint32_t each = power + 1; each < 2 * power; ++each) m = rest(each) < rest(m) ? each : m;
  const auto direction = static_cast<float>((uint64_t{1} << (bits + 23)) / m);
  Cases cases(static_cast<uint32_t>(bits));
  for (int i = 0; i < 60000; ++i) {
    const uint32_t n = (1u << (places - 1)) + cases.below(1u << (places - 1));
    BoxNode node{{std::ldexp(static_cast<float>(n), 24 - places), 0, 0}, {0, 0, 0}, 1, {}};
    for (auto& upper : node.planes[1]) upper[0] = 255;
    const RayWords words = {{0.25f - 0x1p-20f, 0, 0}, {direction, 0, 0}, kInfinity};
    BoxRay ray = set_up(words, bits);
    ASSERT_EQ(ray.axes[0].reciprocal, m);
    ray.axes[0].padding = 24 - places;
    const double shift[3] = {std::ldexp(1 - 0x1p-30, 24 - places), 0, 0};
    Exact entry;
    ASSERT_TRUE(meets(words, shift, node, 0, entry));
    const BoxResult result = test_boxes(ray, node, ray.limit);
    ASSERT_EQ(result.met, 1u);
    ASSERT_FALSE(entry < Exact(value_of(result.entry[0], bits))) << "n " << n;
  }
}

// Rays through the middle of things: how many boxes too many there are.
TEST_P(Narrow, MeetsFewBoxesMore) {
  const int bits = GetParam();
  Cases cases(77);
  uint32_t met = 0, more = 0, late = 0, off = 0;
  for (int i = 0; i < 20000; ++i) {
    cases.make();
    for (int axis = 0; axis < 3; ++axis) {
      cases.node.origin[axis] = static_cast<float>(cases.share());
      cases.node.exponent[axis] = -8;
      cases.ray.origin[axis] = static_cast<float>(4 * cases.share() - 2);
      const double towards = cases.node.origin[axis] + cases.share();
      cases.ray.direction[axis] = static_cast<float>(towards - cases.ray.origin[axis]);
      if (cases.one_of(8)) {
        cases.ray.direction[axis] = 0;
        cases.ray.origin[axis] = static_cast<float>(towards);
      }
    }
    cases.ray.limit = cases.one_of(2) ? kInfinity : static_cast<float>(cases.share() + 0.25);
    const BoxRay ray = set_up(cases.ray, bits);
    if (!ray.valid) continue;
    const BoxResult result = test_boxes(ray, cases.node, ray.limit);
    for (int box = 0; box < cases.node.children; ++box) {
      Exact entry;
      const bool exact = meets(cases.ray, {0, 0, 0}, cases.node, box, entry);
      met += exact;
      more += (result.met >> box & 1) != 0 && !exact;
      if (!exact) continue;
      // Rays from afar: the key is the time, but for some units of its last bit.
      const double key = value_of(result.entry[box], bits);
      if (Exact(0.5) < entry) {
        ++late;
        off += entry < Exact(key * (1 + 16.0 / (1 << bits))) ? 0 : 1;
      }
    }
  }
  ASSERT_GT(met, 2000u);
  ASSERT_GT(late, 1000u);
  EXPECT_LT(off, late / 20) << "of " << late;
  RecordProperty("met", static_cast<int>(met));
  RecordProperty("more", static_cast<int>(more));
  // In a box's extent a key errs by some 2^-bits of the time to it.
  EXPECT_LT(more, met * (40.0 / (1 << bits)) + 4) << "of " << met;
}

INSTANTIATE_TEST_SUITE_P(Bits, Narrow, testing::Range(kLeastBoxBits, kMostBoxBits + 1));

TEST(BoxRay, RaysThatHitNothingAreInvalid) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), tiny = std::numeric_limits<float>::denorm_min();
  const RayWords good = {{0, 0, 0}, {1, 0, 0}, kInfinity};
  EXPECT_TRUE(set_up(good, 8).valid);
  for (const float bad : {nan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      RayWords ray = good;
      ray.origin[axis] = bad;
      EXPECT_FALSE(set_up(ray, 8).valid);
      ray = good;
      ray.direction[axis] = bad;
      EXPECT_FALSE(set_up(ray, 8).valid);
    }
  }
  for (const float bad : {nan, 0.0f, -0.0f, -1.0f, -kInfinity}) {
    RayWords ray = good;
    ray.limit = bad;
    EXPECT_FALSE(set_up(ray, 8).valid);
  }
  EXPECT_FALSE(set_up({{0, 0, 0}, {0, -0.0f, 0}, 1}, 8).valid);
  EXPECT_TRUE(set_up({{tiny, -tiny, 0}, {0, -tiny, 0}, tiny}, 8).valid);
}

template <typename Unit_, int kBits>
struct Pipe {
  using Unit = Unit_;
  static constexpr int kWidth = kBits;
};

template <typename P>
class BoxPipeTest : public testing::Test {};
using Pipes = testing::Types<Pipe<Vbox_pipe_6, 6>, Pipe<Vbox_pipe_7, 7>, Pipe<Vbox_pipe_10, 10>, Pipe<Vbox_pipe_12, 12>,
                             Pipe<Vbox_pipe_16, 16>>;
TYPED_TEST_SUITE(BoxPipeTest, Pipes);

template <typename Unit>
void offer(Unit& u, const BoxRay& ray, const BoxNode& node, uint32_t limit) {
  const auto bits = static_cast<uint32_t>(ray.bits);
  u.children_i = node.children;
  u.limit_i = limit;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const BoxRay::Axis& a = ray.axes[axis];
    set_bits(u.grid_i, 32 * axis, 32, as_bits(node.origin[axis]));
    set_bits(u.step_i, 8 * axis, 8, static_cast<uint32_t>(node.exponent[axis]));
    for (uint32_t box = 0; box < kBoxes; ++box) {
      set_bits(u.lower_i, 32 * axis + 8 * box, 8, node.planes[0][axis][box]);
      set_bits(u.upper_i, 32 * axis + 8 * box, 8, node.planes[1][axis][box]);
    }
    set_bits(u.origin_i, 32 * axis, 32, as_bits(a.origin));
    set_bits(u.backwards_i, axis, 1, a.backwards);
    set_bits(u.still_i, axis, 1, a.still);
    set_bits(u.reciprocal_i, bits * axis, bits, a.reciprocal);
    set_bits(u.exponent_i, 10 * axis, 10, static_cast<uint32_t>(a.exponent));
    set_bits(u.padding_i, 10 * axis, 10, static_cast<uint32_t>(a.padding));
  }
}

TYPED_TEST(BoxPipeTest, IsItsClassInEveryCycle) {
  constexpr int kBits = TypeParam::kWidth;
  constexpr uint32_t kKeyBits = kBits + 9;
  Clocked<typename TypeParam::Unit> bench(5 + kBits);
  auto& u = *bench.u;
  Cases cases(90 + kBits);
  BoxPipe pipe;
  uint32_t results = 0, met = 0, stalls = 0, nearer = 0;
  bool waits = false;
  BoxRay ray = set_up({{0, 0, 0}, {1, 1, 1}, 1}, kBits);
  uint32_t limit = 0;
  for (uint32_t cycle = 0; cycle < 60000; ++cycle) {
    // Gusts, and a consumer that is sometimes slow.
    const bool gust = (cycle >> 8 & 1) != 0;
    if (!waits) {
      u.valid_i = gust || bench.one_of(3);
      cases.make();
      BoxRay next = set_up(cases.ray, kBits);
      u.valid_i = u.valid_i && next.valid;
      if (u.valid_i) {
        ray = next;
        if (bench.one_of(2)) {
          for (int axis = 0; axis < 3; ++axis) {
            // It may also be coarser than all of the distance.
            const int coarser = static_cast<int>(cases.one_of(4) ? cases.below(140) : cases.below(20));
            ray.axes[axis].padding = cases.node.exponent[axis] + coarser - 10;
          }
        }
        limit = bench.one_of(4) ? ray.key(std::ldexp(1.0f, static_cast<int>(cases.below(20)) - 10)) : ray.limit;
        nearer += limit < ray.limit;
        offer(u, ray, cases.node, limit);
      }
    }
    u.ready_i = (cycle >> 10 & 1) != 0 || !bench.one_of(3);
    u.eval();
    ASSERT_EQ(u.valid_o, pipe.valid()) << "cycle " << cycle;
    ASSERT_EQ(u.ready_o, pipe.ready(u.ready_i)) << "cycle " << cycle;
    if (pipe.valid()) {
      ASSERT_EQ(u.met_o, pipe.result().met) << "cycle " << cycle;
      for (uint32_t box = 0; box < kBoxes; ++box) {
        ASSERT_EQ(get_bits(u.entry_o, box * kKeyBits, kKeyBits), pipe.result().entry[box])
            << "cycle " << cycle << ", box " << box;
      }
      stalls += !u.ready_i;
      results += u.ready_i;
      met += u.ready_i && u.met_o != 0;
    }
    waits = u.valid_i && !u.ready_o;
    pipe.clock(u.ready_i, ray, u.valid_i ? &cases.node : nullptr, limit);
    bench.clock();
  }
  EXPECT_GT(results, 20000u);
  EXPECT_GT(met, 5000u);
  EXPECT_GT(stalls, 1000u);
  EXPECT_GT(nearer, 1000u);
}

}  // namespace
}  // namespace raypool::bench
