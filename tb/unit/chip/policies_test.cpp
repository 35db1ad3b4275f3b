// What the controller decides with, in Verilog, against its classes: both policies, and the rules that nothing may
// break. What a policy sees is drawn around the places where its decision changes.
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <random>
#include <type_traits>
#include <vector>

#include "Vfill_policy_1024_4_512_512_64.h"
#include "Vfill_policy_128_2_40_16_600.h"
#include "Vfill_policy_1_1_1_1_1.h"
#include "Vfill_policy_4_2_7_5_3.h"
#include "Vfill_policy_64_1_512_512_64.h"
#include "Vfill_policy_64_4_512_512_128.h"
#include "Vlaunch_rules_1_1_1_1_1_1_0.h"
#include "Vlaunch_rules_4_2_7_5_3_0_0.h"
#include "Vlaunch_rules_64_1_512_512_512_1_1.h"
#include "Vlaunch_rules_64_4_512_512_100_0_0.h"
#include "Vthesis_policy_1024_4_512_512_48_8.h"
#include "Vthesis_policy_128_2_40_16_48_8.h"
#include "Vthesis_policy_1_1_1_1_48_8.h"
#include "Vthesis_policy_4_2_7_5_48_8.h"
#include "Vthesis_policy_64_1_512_512_48_8.h"
#include "Vthesis_policy_64_4_512_512_7_3.h"
#include "machine/chip/fill_policy.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/launch_rules.hpp"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// Its numbers are those of the class.
template <typename Unit_, uint32_t kContents, uint32_t kUnits, uint32_t kRays, uint32_t kIntersections,
          uint32_t kRayThreshold, uint32_t kIntersectionThreshold>
struct Thesis {
  using Unit = Unit_;
  using Policy = ThesisPolicy;
  static PolicySetup setup() {
    PolicySetup setup;
    setup.contents = kContents;
    setup.units = kUnits;
    setup.ray_capacity = kRays;
    setup.intersection_capacity = kIntersections;
    setup.ray_threshold = kRayThreshold;
    setup.intersection_threshold = kIntersectionThreshold;
    return setup;
  }
};

template <typename Unit_, uint32_t kContents, uint32_t kUnits, uint32_t kRays, uint32_t kIntersections, uint32_t kBatch>
struct Fill {
  using Unit = Unit_;
  using Policy = FillPolicy;
  static PolicySetup setup() {
    PolicySetup setup = Thesis<Unit, kContents, kUnits, kRays, kIntersections, 48, 8>::setup();
    setup.batch = kBatch;
    return setup;
  }
};

/// Views that a controller could see, and some that it could not.
class Views {
 public:
  Views(const PolicySetup& setup, uint32_t seed) : setup_(setup), random_(seed) {
    // Where decisions change.
    for (const uint32_t edge :
         {0u, setup.contents, setup.contents * 2, setup.batch, setup.batch * setup.units, setup.ray_capacity,
          setup.ray_capacity * 3 / 4, setup.intersection_capacity, setup.ray_threshold, setup.intersection_threshold,
          (setup.batch + 3) / 4, setup.ray_threshold * setup.units * std::max(1u, setup.contents / 64),
          setup.intersection_threshold * std::max(1u, setup.contents / 64)})
      for (const uint32_t near : {edge, edge + 1, edge + 2, edge - std::min(edge, 1u), edge - std::min(edge, 2u)})
        edges_.push_back(near);
  }

  PolicyView next() {
    PolicyView view;
    view.rays = count(setup_.ray_capacity);
    view.normal = count(setup_.intersection_capacity);
    view.shadow = below(4) == 0 ? view.normal - std::min(view.normal, below(2)) : count(setup_.intersection_capacity);
    view.secondary_room = below(3) == 0 ? view.normal + below(2) : count(2048);
    view.rays_to_come = count(4 * setup_.contents);
    view.promised = count(setup_.intersection_capacity);
    view.kernels = below(2) * below(2 * setup_.units + 1);
    view.eye_possible = below(2) == 0;
    view.more_to_come = below(2) == 0;
    view.ahead = below(3) == 0;
    return view;
  }
  uint32_t below(uint32_t limit) { return static_cast<uint32_t>(random_()) % limit; }

 private:
  uint32_t count(uint32_t most) {
    const uint32_t edge = edges_[below(static_cast<uint32_t>(edges_.size()))];
    return below(2) == 0 ? std::min(edge, most) : below(most + 1);
  }

  PolicySetup setup_;
  std::mt19937 random_;
  std::vector<uint32_t> edges_;
};

template <typename P>
class PolicyTest : public testing::Test {};
using Policies = testing::Types<
    Thesis<Vthesis_policy_1_1_1_1_48_8, 1, 1, 1, 1, 48, 8>, Thesis<Vthesis_policy_4_2_7_5_48_8, 4, 2, 7, 5, 48, 8>,
    Thesis<Vthesis_policy_64_1_512_512_48_8, 64, 1, 512, 512, 48, 8>,
    Thesis<Vthesis_policy_64_4_512_512_7_3, 64, 4, 512, 512, 7, 3>,
    Thesis<Vthesis_policy_128_2_40_16_48_8, 128, 2, 40, 16, 48, 8>,
    Thesis<Vthesis_policy_1024_4_512_512_48_8, 1024, 4, 512, 512, 48, 8>, Fill<Vfill_policy_1_1_1_1_1, 1, 1, 1, 1, 1>,
    Fill<Vfill_policy_4_2_7_5_3, 4, 2, 7, 5, 3>, Fill<Vfill_policy_64_1_512_512_64, 64, 1, 512, 512, 64>,
    Fill<Vfill_policy_64_4_512_512_128, 64, 4, 512, 512, 128>, Fill<Vfill_policy_128_2_40_16_600, 128, 2, 40, 16, 600>,
    Fill<Vfill_policy_1024_4_512_512_64, 1024, 4, 512, 512, 64>>;
TYPED_TEST_SUITE(PolicyTest, Policies);

TYPED_TEST(PolicyTest, ChoosesWhatItsClassChooses) {
  constexpr bool kFill = std::is_same_v<typename TypeParam::Policy, FillPolicy>;
  constexpr int kViews = 400'000;
  PolicySetup setup = TypeParam::setup();
  Views views(setup, 11);
  typename TypeParam::Unit unit;
  uint32_t seen[4] = {};
  for (int i = 0; i < kViews; ++i) {
    const PolicyView view = views.next();
    setup.rays_per_secondary = 1 + views.below(2);
    const Choice choice = typename TypeParam::Policy(setup).choose(view);
    unit.rays_i = view.rays;
    unit.normal_i = view.normal;
    unit.shadow_i = view.shadow;
    unit.secondary_room_i = view.secondary_room;
    unit.eye_possible_i = view.eye_possible;
    unit.more_to_come_i = view.more_to_come;
    unit.ahead_i = view.ahead;
    if constexpr (kFill) {
      unit.rays_to_come_i = view.rays_to_come;
      unit.promised_i = view.promised;
      unit.kernels_i = view.kernels;
      unit.two_rays_i = setup.rays_per_secondary == 2;
    }
    unit.clk_i = 0;
    unit.eval();
    unit.clk_i = 1;
    unit.eval();
    ASSERT_EQ(unit.kind_o, static_cast<uint32_t>(choice.kind)) << "view " << i;
    ASSERT_EQ(unit.threads_o, choice.threads) << "view " << i;
    ++seen[unit.kind_o];
  }
  for (const uint32_t count : seen) EXPECT_GT(count, kViews / 2000u);
}

template <typename Unit_, uint32_t kContents, uint32_t kUnits, uint32_t kRays, uint32_t kIntersections, uint32_t kHeld,
          bool kRemedy, bool kTraverserShades>
struct Rules {
  using Unit = Unit_;
  static constexpr uint32_t kThreads = kContents, kOfUnits = kUnits, kLimit = kHeld;
  static ChipConfiguration chip() {
    ChipConfiguration chip;
    chip.ray_pool_size = kRays;
    chip.intersection_pool_size = kIntersections;
    chip.held_limit = kHeld;
    chip.window_remedy = kRemedy;
    chip.shading = kTraverserShades ? Shading::Traverser : Shading::Kernel;
    return chip;
  }
};

template <typename R>
class LaunchRulesTest : public testing::Test {};
using AllRules = testing::Types<Rules<Vlaunch_rules_1_1_1_1_1_1_0, 1, 1, 1, 1, 1, true, false>,
                                Rules<Vlaunch_rules_4_2_7_5_3_0_0, 4, 2, 7, 5, 3, false, false>,
                                Rules<Vlaunch_rules_64_1_512_512_512_1_1, 64, 1, 512, 512, 512, true, true>,
                                Rules<Vlaunch_rules_64_4_512_512_100_0_0, 64, 4, 512, 512, 100, false, false>>;
TYPED_TEST_SUITE(LaunchRulesTest, AllRules);

TYPED_TEST(LaunchRulesTest, AllowWhatTheirClassAllows) {
  const ChipConfiguration chip = TypeParam::chip();
  LaunchRules rules(chip, TypeParam::kThreads, TypeParam::kOfUnits);
  Clocked<typename TypeParam::Unit> bench(3);
  auto& unit = *bench.u;
  const auto around = [&](uint32_t most) { return static_cast<uint32_t>(bench.random()) % (most + 2); };
  const uint32_t limit = chip.intersection_pool_size + chip.ray_pool_size;
  uint32_t allowed = 0, refused = 0, no_room = 0, room = 0;
  for (int i = 0; i < 200'000; ++i) {
    const uint32_t held = bench.one_of(4) ? 0 : around(TypeParam::kLimit);
    unit.tile_left_i = !bench.one_of(8);
    unit.tile_pixels_i = 1 + around(std::min(TypeParam::kThreads, TypeParam::kLimit));
    unit.held_i = held;
    unit.cast_held_i = held;
    unit.shadow_rays_i = around(chip.ray_pool_size);
    unit.shadow_i = around(chip.intersection_pool_size);
    unit.shadow_to_come_i =
        bench.one_of(2) ? around(limit) : limit - std::min(limit, unit.shadow_rays_i + unit.shadow_i);
    unit.cast_i = 0;
    unit.eval();
    const bool may_cast = unit.tile_left_i && rules.may_cast(unit.tile_pixels_i, held);
    ASSERT_EQ(unit.eye_possible_o, may_cast) << "step " << i;
    ASSERT_EQ(unit.secondary_room_o, rules.secondary_room(unit.shadow_rays_i, unit.shadow_to_come_i, unit.shadow_i))
        << "step " << i;
    (may_cast ? allowed : refused) += 1;
    (unit.secondary_room_o == 0 ? no_room : room) += 1;
    unit.cast_i = may_cast && bench.one_of(2);
    if (unit.cast_i) rules.cast(held);
    bench.clock();
  }
  EXPECT_GT(allowed, 1000u);
  EXPECT_GT(refused, 1000u);
  EXPECT_GT(room, 1000u);
  if (chip.shading == Shading::Kernel) {
    EXPECT_GT(no_room, 1000u);
  }
}

}  // namespace
}  // namespace raypool::bench
