// What the machines of `make cosim` promise, and what is reported of a machine that lacks something.
#include "cosim/machines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "cosim/coverage.hpp"

namespace raypool {
namespace {

using Names = std::vector<std::string>;

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(CosimMachines, TogetherHaveEveryFeature) {
  const std::vector<Machine> machines = cosim_machines();
  EXPECT_EQ(features_lacking(machines), Names{});
  EXPECT_GE(machines.size(), 2u);
  EXPECT_LE(machines.size(), 4u);
}

// What is done where a feature is missing has faults of its own.
TEST(CosimMachines, OneOfThemLacksEachOptionalFeature) {
  const std::vector<Machine> machines = cosim_machines();
  for (const MachineFeature& feature : machine_features()) {
    // All of them are small, and their warps take turns.
    if (feature.name == "several warps" || feature.name.substr(0, 6) == "small ") continue;
    EXPECT_FALSE(std::all_of(machines.begin(), machines.end(), feature.has)) << feature.name;
  }
}

TEST(CosimMachines, NarrowSignificandsMeetEachWayOfSubnormals) {
  std::set<Subnormals> ways;
  for (const Machine& machine : cosim_machines())
    if (machine.configuration.significand < 24) ways.insert(machine.configuration.subnormals);
  EXPECT_EQ(ways.size(), 3u);
}

TEST(CosimMachines, OneThatIsNamedLacksWhatTheOthersHave) {
  const Names lacking = features_lacking({{load_configuration("8w8c"), 1}});
  const Names had = {"several units", "triples", "few registers", "narrow significands with subnormals flush",
                     "several instances of brh"};
  for (const std::string& feature : had) EXPECT_TRUE(has(lacking, feature)) << feature;
  EXPECT_FALSE(has(lacking, "several lanes"));
  const Machine other{load_configuration("8w8c", {"triples=true", "registers=12", "alus.brh.count=2",
                                                  "arithmetic.significand=20", "arithmetic.subnormals=flush"}),
                      2};
  for (const std::string& feature : had) EXPECT_FALSE(has(features_lacking({other}), feature)) << feature;
  EXPECT_TRUE(has(features_lacking({other}), "kernel overlap"));
  EXPECT_TRUE(has(features_lacking({other}), "narrow significands with subnormals ieee"));
}

TEST(CosimMachines, ValuesThatNoneHasAreNamed) {
  EXPECT_TRUE(has(values_lacking({{load_configuration("8w8c"), 1}}), "units 2, 4"));
  EXPECT_EQ(values_lacking(covering_machines(kSmallThreads)), Names{});
}

// An item counts once, whichever machine has seen it; a group of one machine alone has no figure for the other.
TEST(CoverageOfSeveral, CountsAnItemOfTwoMachinesOnce) {
  const Coverage one(load_configuration("2w2c")), other(load_configuration("2w2c", {"triples=true"}));
  const std::string text = to_string({{"one", 1, &one}, {"other", 2, &other}});
  EXPECT_TRUE(std::regex_search(text, std::regex("PC stack entries +0/8 +0/8 +0/8\n"))) << text;
  EXPECT_TRUE(std::regex_search(text, std::regex("\n  triples +- +0/3 +0/3\n"))) << text;
  EXPECT_NE(text.find("NOT covered on any machine:"), std::string::npos);
}

}  // namespace
}  // namespace raypool
