#include "machine/chip/kernel_policy.hpp"

#include <gtest/gtest.h>

#include <random>

#include "config/configuration.hpp"
#include "config/parameter_table.hpp"
#include "machine/chip/fill_policy.hpp"

namespace raypool {
namespace {

using Kind = Choice::Kind;

PolicySetup setup(uint32_t contents, uint32_t units, uint32_t rays, uint32_t intersections, uint32_t per_secondary) {
  PolicySetup setup;
  setup.contents = contents;
  setup.units = units;
  setup.ray_capacity = rays;
  setup.intersection_capacity = intersections;
  setup.rays_per_secondary = per_secondary;
  return setup;
}

PolicyView seen(uint32_t rays, uint32_t normal, uint32_t shadow, bool eye_possible) {
  PolicyView view;
  view.rays = rays;
  view.normal = normal;
  view.shadow = shadow;
  view.secondary_room = 1023;
  view.eye_possible = eye_possible;
  view.more_to_come = true;
  return view;
}

TEST(ThesisPolicy, ChoosesAsFigure53WithOneUnitOf64Contents) {
  const ThesisPolicy policy({64, 1, 512, 512});
  EXPECT_EQ(policy.ray_threshold(), 48u);
  EXPECT_EQ(policy.intersection_threshold(), 8u);
  // RP > 48: draw out if there are shadow intersections, else halt.
  EXPECT_EQ(policy.choose(seen(49, 100, 1, true)).kind, Kind::Shade);
  EXPECT_EQ(policy.choose(seen(49, 100, 0, true)).kind, Kind::Halt);
  // RP <= 48, ISP > 8: the kind of which there are more.
  EXPECT_EQ(policy.choose(seen(48, 9, 0, true)).kind, Kind::Secondary);
  EXPECT_EQ(policy.choose(seen(48, 5, 4, true)).kind, Kind::Secondary);
  EXPECT_EQ(policy.choose(seen(48, 5, 5, true)).kind, Kind::Shade);
  EXPECT_EQ(policy.choose(seen(0, 0, 9, true)).kind, Kind::Shade);
  // ISP <= 8: eye rays if possible, else halt.
  EXPECT_EQ(policy.choose(seen(48, 4, 4, true)).kind, Kind::Eye);
  EXPECT_EQ(policy.choose(seen(48, 4, 4, false)).kind, Kind::Halt);
}

TEST(ThesisPolicy, RunsWhatIsLeftWhenNothingElseCanCome) {
  const ThesisPolicy policy({64, 1, 512, 512});
  PolicyView view = seen(0, 3, 2, false);
  view.more_to_come = false;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  EXPECT_EQ(policy.choose(view).threads, 3u);
  view.shadow = 4;
  EXPECT_EQ(policy.choose(view).kind, Kind::Shade);
  EXPECT_EQ(policy.choose(view).threads, 4u);
}

TEST(ThesisPolicy, LaunchesAheadOnlyFullKernelsThatImport) {
  const ThesisPolicy policy({64, 1, 512, 512});
  PolicyView view = seen(0, 63, 0, true);
  view.ahead = true;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
  view.normal = 64;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  view.normal = 0;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
}

TEST(ThesisPolicy, ScalesItsThresholds) {
  const auto thresholds = [](uint32_t contents, uint32_t units) {
    const ThesisPolicy policy({contents, units, 512, 512});
    return std::make_pair(policy.ray_threshold(), policy.intersection_threshold());
  };
  EXPECT_EQ(thresholds(1, 1), std::make_pair(48u, 0u));
  EXPECT_EQ(thresholds(4, 1), std::make_pair(48u, 3u));
  EXPECT_EQ(thresholds(16, 1), std::make_pair(48u, 8u));
  EXPECT_EQ(thresholds(64, 4), std::make_pair(192u, 8u));
  EXPECT_EQ(thresholds(128, 2), std::make_pair(192u, 16u));
  EXPECT_EQ(thresholds(1024, 4), std::make_pair(384u, 128u));
  EXPECT_EQ(ThesisPolicy({128, 1, 512, 16}).intersection_threshold(), 15u);
  EXPECT_EQ(ThesisPolicy({64, 1, 512, 512, 7, 3}).ray_threshold(), 7u);
  EXPECT_EQ(ThesisPolicy({128, 2, 512, 512, 7, 3}).ray_threshold(), 28u);
  EXPECT_EQ(ThesisPolicy({128, 2, 512, 512, 7, 3}).intersection_threshold(), 6u);
}

PolicyView full_of_normal(bool ahead) {
  PolicyView view = seen(0, 64, 0, true);
  view.kernels = ahead ? 1 : 0;
  view.ahead = ahead;
  return view;
}

TEST(FillPolicy, ScalesItsLoadAndItsBacklog) {
  const auto numbers = [](uint32_t contents, uint32_t units, uint32_t capacity) {
    const FillPolicy policy(setup(contents, units, 512, capacity, 1));
    return std::make_pair(policy.load(), policy.backlog());
  };
  EXPECT_EQ(numbers(1, 1, 512), std::make_pair(1u, 64u));
  EXPECT_EQ(numbers(64, 4, 512), std::make_pair(64u, 256u));
  EXPECT_EQ(numbers(1024, 2, 512), std::make_pair(64u, 128u)) << "a batch of the traverser";
  EXPECT_EQ(numbers(64, 1, 17), std::make_pair(17u, 64u)) << "the pool never holds more";
}

TEST(FillPolicy, LaunchesFullLoadsAndTilesAheadAndNothingLess) {
  const FillPolicy policy(setup(64, 1, 512, 512, 1));
  PolicyView view = full_of_normal(true);
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  view.normal = 63;
  EXPECT_EQ(policy.choose(view).kind, Kind::Eye);
  view.eye_possible = false;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
  view.shadow = 64;
  EXPECT_EQ(policy.choose(view).kind, Kind::Shade);
  view.shadow = 63;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
  view.ahead = false;
  view.kernels = 0;
  EXPECT_EQ(policy.choose(view).threads, 63u);
}

TEST(FillPolicy, MakesNoMoreRaysThanTheirPoolWillHaveRoomFor) {
  const FillPolicy policy(setup(64, 1, 512, 512, 2));
  PolicyView view = full_of_normal(true);
  view.rays = 300;
  view.rays_to_come = 512 + 64 - 300 - 128;  // the kernel that runs leaves 128 places when it ends
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  ++view.rays_to_come;
  EXPECT_EQ(policy.choose(view).kind, Kind::Eye) << "which makes 64";
  view.rays_to_come += 64;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
}

TEST(FillPolicy, ShadesAQuarterLoadWhileTheTraverserIsBehind) {
  const FillPolicy policy(setup(64, 1, 512, 512, 1));
  PolicyView view = full_of_normal(true);
  view.shadow = 16;
  view.rays = 64;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  ++view.rays;
  EXPECT_EQ(policy.choose(view).kind, Kind::Shade);
  --view.shadow;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
}

TEST(FillPolicy, WaitsWithPartOfALoadWhileALoadIsQueuedAtThePort) {
  const FillPolicy policy(setup(64, 2, 512, 512, 1));
  PolicyView view = seen(0, 40, 0, false);
  view.kernels = 1;
  view.promised = 64;
  EXPECT_EQ(policy.choose(view).kind, Kind::Halt);
  view.promised = 63;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  view.promised = 64;
  view.kernels = 0;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
}

TEST(FillPolicy, MakesRaysForWhichThereIsNoRoomWhenNothingElseCanCome) {
  const FillPolicy policy(setup(64, 1, 1, 512, 2));
  PolicyView view = seen(0, 3, 0, false);
  view.more_to_come = false;
  EXPECT_EQ(policy.choose(view).kind, Kind::Secondary);
  EXPECT_EQ(policy.choose(view).threads, 3u);
}

class AnyNamedPolicy : public testing::TestWithParam<PolicyName> {};

TEST_P(AnyNamedPolicy, NeverProposesWhatIsImpossibleAndNeverHaltsForGood) {
  std::mt19937 random(7);
  const auto roll = [&](uint32_t below) { return static_cast<uint32_t>(random()) % below; };
  for (int i = 0; i < 200'000; ++i) {
    const uint32_t contents = 1u << roll(11);
    const uint32_t capacity = roll(2) == 0 ? 512 : 1 + roll(100), ray_capacity = roll(2) == 0 ? 512 : 1 + roll(100);
    const uint32_t limit = ray_capacity + capacity - 1;
    const auto policy = make_policy(GetParam(), setup(contents, 1u << roll(3), ray_capacity, capacity, 1 + roll(2)));
    const auto shadow = std::min(capacity, roll(3) * roll(capacity + 1));
    PolicyView view = seen(roll(2) * roll(ray_capacity + 1), roll(2) * roll(capacity + 1), shadow, roll(2) == 0);
    view.kernels = roll(2) * roll(9);
    view.promised = view.kernels > 0 ? roll(2) * roll(2 * capacity) : 0;
    view.rays_to_come = roll(2) * roll(2 * contents);
    view.more_to_come = view.rays > 0 || view.rays_to_come > 0;
    view.secondary_room = limit - std::min(limit, view.shadow + (view.more_to_come ? roll(2) * roll(512) : 0));
    view.ahead = view.kernels > 0 && roll(4) == 0;
    const Choice choice = policy->choose(view);
    EXPECT_TRUE(choice.kind != Kind::Eye || view.eye_possible);
    if (choice.kind == Kind::Secondary) {
      EXPECT_GE(choice.threads, 1u);
      EXPECT_LE(choice.threads, std::min({contents, view.normal, view.secondary_room}));
    }
    if (choice.kind == Kind::Shade) {
      EXPECT_GE(choice.threads, 1u);
      EXPECT_LE(choice.threads, std::min(contents, view.shadow));
    }
    if (choice.kind == Kind::Halt && view.kernels == 0) {
      EXPECT_LT(view.shadow, capacity);
      if (!view.more_to_come) {
        EXPECT_FALSE(view.eye_possible);
        EXPECT_EQ(view.normal + view.shadow, 0u);
      }
    }
    if (HasFailure()) FAIL() << "view " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Policy, AnyNamedPolicy, testing::Values(PolicyName::Thesis, PolicyName::Fill),
                         [](const testing::TestParamInfo<PolicyName>& name) {
                           return name.param == PolicyName::Fill ? "fill" : "thesis";
                         });

TEST(Policy, EveryNameOfTheTableHasAClass) {
  for (const Parameter& parameter : parameter::kOfChip) {
    if (path_of(parameter) != "chip.policy") continue;
    for (const int name : values_of(parameter.range))
      EXPECT_TRUE(make_policy(static_cast<PolicyName>(name), {})) << name;
    return;
  }
  FAIL() << "no row";
}

}  // namespace
}  // namespace raypool
