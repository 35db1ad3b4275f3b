#include "explore/machines.hpp"

#include <gtest/gtest.h>

#include <set>

#include "config/limits.hpp"

namespace raypool::explore {
namespace {

size_t differences(const Machine& a, const Machine& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.features.size(); ++i) count += a.features[i] != b.features[i];
  return count;
}

TEST(MachineSpace, HasAllCombinationsOfAFewAxes) {
  MachineSpace space("4w4c", {}, {{"warps", {"4", "8"}}, {"units", {"1", "2", "4"}}});
  EXPECT_EQ(space.combinations(), 6u);
  space.add_all();
  ASSERT_EQ(space.machines().size(), 6u);
  const Machine& last = space.machines().back();
  EXPECT_EQ(last.configuration.warps, 8u);
  EXPECT_EQ(last.units, 4u);
  EXPECT_EQ(last.changes, "warps=8");
  EXPECT_EQ(space.machines().front().changes, "");  // as the base has it
  EXPECT_EQ(last.features, (Features{1, 4}));
}

TEST(MachineSpace, DrawsTheSameForTheSameSeedAndNoneTwice) {
  MachineSpace one("best_8w8c", {}, usual_axes()), again("best_8w8c", {}, usual_axes()),
      other("best_8w8c", {}, usual_axes());
  one.add_random(50, 7);
  again.add_random(50, 7);
  other.add_random(50, 8);
  ASSERT_EQ(one.machines().size(), 50u);
  std::set<Features> features;
  size_t same = 0;
  for (size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(one.machines()[i].features, again.machines()[i].features);
    same += one.machines()[i].features == other.machines()[i].features;
    features.insert(one.machines()[i].features);
  }
  EXPECT_EQ(features.size(), 50u);
  EXPECT_LT(same, 5u);
}

TEST(MachineSpace, NeighboursDifferInOneAxis) {
  MachineSpace space("4w4c", {}, {{"warps", {"2", "4", "8"}}, {"lanes", {"4", "8"}}, {"units", {"1", "2"}}});
  space.add_random(1, 1);
  EXPECT_EQ(space.add_neighbours({0}, 100), 4u);  // two of warps, one of lanes, one of units
  for (size_t i = 1; i < space.machines().size(); ++i)
    EXPECT_EQ(differences(space.machines()[0], space.machines()[i]), 1u);
  EXPECT_EQ(space.add_neighbours({0}, 100), 0u);
  EXPECT_EQ(space.add_neighbours({1}, 6), 1u);  // no more than these
}

TEST(MachineSpace, LeavesOutWhatIsOfNoMachine) {
  MachineSpace space("4w4c", {}, {{"warps", {"4", "5"}}});
  space.add_all();
  EXPECT_EQ(space.machines().size(), 1u);
  EXPECT_EQ(space.left_out(), 1u);
  EXPECT_NE(space.wrong().find("warps"), std::string::npos) << space.wrong();
}

std::string refusal(const std::vector<Axis>& axes) {
  try {
    MachineSpace("4w4c", {}, axes).add_all();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MachineSpace, RefusesAFieldThatThereIsNot) {
  EXPECT_NE(refusal({{"warp", {"4"}}}).find("warps"), std::string::npos) << refusal({{"warp", {"4"}}});
}

TEST(Axes, AreReplacedByTheirField) {
  std::vector<Axis> axes = {{"warps", {"4"}}, {"lanes", {"4"}}};
  set_axis(axes, "lanes=8,16");
  set_axis(axes, "triples=true");
  ASSERT_EQ(axes.size(), 3u);
  EXPECT_EQ(axes[1].values, (std::vector<std::string>{"8", "16"}));
  EXPECT_EQ(axes[2].field, "triples");
  for (const char* wrong : {"warps", "=4", "warps=", "units=3"})
    EXPECT_THROW(set_axis(axes, wrong), InputError) << wrong;
}

// A value that no machine can have would shrink the study without a word.
TEST(Axes, UsualValuesAreOfMachines) {
  MachineSpace drawn("best_8w8c", {}, usual_axes());
  drawn.add_random(300, 1);
  std::set<uint32_t> features;
  for (const Machine& machine : drawn.machines()) features.insert(machine.features.begin(), machine.features.end());
  size_t values = 0;
  for (const Axis& axis : usual_axes()) values += axis.values.size();
  EXPECT_EQ(features.size(), values);
  for (const Axis& axis : usual_axes()) {
    MachineSpace space("best_8w8c", {}, {axis});
    space.add_all();
    size_t usual = 0;
    for (const Machine& machine : space.machines()) usual += machine.changes.empty();
    EXPECT_EQ(usual, axis.field == "units" ? 3u : 1u) << axis.field << ": the base's own value is none of them";
  }
}

}  // namespace
}  // namespace raypool::explore
