#include "fit/fit.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace raypool::fit {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kBase = 10'000;

/// Values of one field, the least first.
Part part_of(const std::string& field, const std::vector<int>& values) {
  return [=](const Configuration&) {
    std::vector<Cut> cuts;
    for (const int value : values) cuts.push_back({field, value, "because"});
    return cuts;
  };
}

/// A machine's cycles are kBase and what each field adds.
uint64_t cost(const Configuration& machine) {
  const std::map<uint32_t, uint64_t> lanes = {{1, 200}, {2, 50}, {32, 0}};
  const std::map<uint32_t, uint64_t> data = {{512, 80}, {1024, 30}, {8192, 0}};
  return kBase + lanes.at(machine.slow_lanes) + data.at(machine.data_cache_bytes);
}

const std::vector<Part> kTwoParts = {part_of("slow_lanes", {1, 2}), part_of("data_cache.bytes", {512, 1024})};

TEST(Fit, TheWholeKeepsToWhatWasAllowed) {
  const Fit fitted = fit(Configuration(), kBase, kTwoParts, 0.01,
                         [](const Configuration& machine, const std::string&) { return cost(machine); });
  EXPECT_EQ(fitted.most_cycles, 10'100u);
  EXPECT_EQ(fitted.fitted.slow_lanes, 2u);           // one would be 2% slower
  EXPECT_EQ(fitted.fitted.data_cache_bytes, 1024u);  // 512 alone would do, but not with the two slow lanes
  EXPECT_EQ(fitted.cycles, kBase + 80);
  ASSERT_EQ(fitted.changes.size(), 2u);
  EXPECT_EQ(fitted.changes[0].cut.field, "slow_lanes");
  EXPECT_EQ(fitted.changes[0].from, Json(32));
  EXPECT_EQ(fitted.changes[0].cycles, kBase + 50);
  EXPECT_EQ(fitted.changes[1].cycles, kBase + 30);
}

TEST(Fit, AnEarlierPartLeavesLessToALaterOne) {
  const std::vector<Part> turned = {kTwoParts[1], kTwoParts[0]};
  const Fit fitted = fit(Configuration(), kBase, turned, 0.01,
                         [](const Configuration& machine, const std::string&) { return cost(machine); });
  EXPECT_EQ(fitted.fitted.data_cache_bytes, 512u);
  EXPECT_EQ(fitted.fitted.slow_lanes, 32u);
  EXPECT_EQ(fitted.changes.size(), 1u);
}

TEST(Fit, WhatOnePartGainsNoOtherSpends) {
  const std::vector<Part> parts = {part_of("intersection_words", {16}), part_of("slow_lanes", {1, 2})};
  const Fit fitted = fit(Configuration(), kBase, parts, 0.01, [](const Configuration& machine, const std::string&) {
    return cost(machine) - (machine.intersection_words == 16 ? 500 : 0);
  });
  EXPECT_EQ(fitted.fitted.intersection_words, 16u);
  EXPECT_EQ(fitted.fitted.slow_lanes, 2u) << "one alone would be 2% slower";
  EXPECT_EQ(fitted.cycles, kBase - 450);
}

TEST(Fit, WithNothingAllowedOnlyWhatCostsNothingIsLeftOut) {
  std::vector<Part> parts = kTwoParts;
  parts.push_back(part_of("stack_depth", {2}));
  const Fit fitted = fit(Configuration(), kBase, parts, 0,
                         [](const Configuration& machine, const std::string&) { return cost(machine); });
  EXPECT_EQ(fitted.cycles, kBase);
  ASSERT_EQ(fitted.changes.size(), 1u);
  EXPECT_EQ(fitted.changes[0].cut.field, "stack_depth");
}

TEST(Fit, AMachineThatCannotDrawTheFrameIsPassedOver) {
  const Fit fitted = fit(Configuration(), kBase, {part_of("stack_depth", {2, 3, 4})}, 0,
                         [](const Configuration& machine, const std::string&) -> std::optional<uint64_t> {
                           if (machine.stack_depth < 4) return std::nullopt;
                           return kBase;
                         });
  EXPECT_EQ(fitted.fitted.stack_depth, 4u);
}

TEST(Fit, AChangeThatNeedsAnotherHasNoCyclesAlone) {
  const std::vector<Part> parts = {part_of("intersection_words", {16}), part_of("stack_depth", {2})};
  const Fit fitted = fit(Configuration(), kBase, parts, 0,
                         [](const Configuration& machine, const std::string&) -> std::optional<uint64_t> {
                           if (machine.stack_depth == 2 && machine.intersection_words == 21) return std::nullopt;
                           return kBase;
                         });
  ASSERT_EQ(fitted.changes.size(), 2u);
  EXPECT_EQ(fitted.changes[0].cycles, kBase);
  EXPECT_EQ(fitted.changes[1].cycles, std::nullopt);
}

TEST(Fit, APartSeesWhatWasLeftOutBefore) {
  std::vector<uint32_t> seen;
  const std::vector<Part> parts = {part_of("intersection_words", {16}), [&](const Configuration& machine) {
                                     seen.push_back(machine.intersection_words);
                                     return std::vector<Cut>();
                                   }};
  fit(Configuration(), kBase, parts, 0, [](const Configuration&, const std::string&) { return kBase; });
  EXPECT_EQ(seen, std::vector<uint32_t>{16});
}

TEST(Fit, NoMachineIsMeasuredTwice) {
  std::multiset<std::string> measured;
  std::vector<Part> parts = kTwoParts;
  parts.push_back(part_of("slow_lanes", {2}));
  fit(Configuration(), kBase, parts, 0.01, [&](const Configuration& machine, const std::string&) {
    measured.insert(to_json(machine));
    return cost(machine);
  });
  EXPECT_EQ(measured.count(to_json(Configuration())), 0u) << "the base's cycles are given";
  for (const std::string& machine : measured) EXPECT_EQ(measured.count(machine), 1u) << machine;
  EXPECT_GE(measured.size(), 4u);
}

TEST(Fit, AValueThatAFieldCannotHaveIsRefused) {
  EXPECT_THROW(with(Configuration(), {"data_cache.bytes", 700, ""}), InputError);
  EXPECT_EQ(with(Configuration(), {"chip.policy", "fill", ""}).chip.policy, PolicyName::Fill);
}

void expect_same_machine(const Configuration& configuration) {
  const std::string text = shortest_file(configuration);
  EXPECT_EQ(to_json(parse_configuration(text, "the file")), to_json(configuration)) << text;
}

TEST(ShortestFile, HasWhatDiffersFromTheDefaults) {
  Configuration configuration;
  configuration.name = "small";
  configuration.data_cache_bytes = 512;
  configuration.chip.traverser = TraverserName::Static;
  EXPECT_EQ(Json::parse(shortest_file(configuration)),
            Json::parse(R"({"name": "small", "data_cache": {"bytes": 512}, "chip": {"traverser": "static"}})"));
  expect_same_machine(configuration);
}

TEST(ShortestFile, HasAListInALine) {
  Configuration configuration;
  configuration.name = "lists";
  for (const Opcode opcode : {Opcode::Imul, Opcode::Sar})
    configuration.alus[AluType::Int].without |= 1u << operation_of(opcode);
  EXPECT_NE(shortest_file(configuration).find(R"("without": ["imul", "sar"])"), std::string::npos)
      << shortest_file(configuration);
  expect_same_machine(configuration);
}

TEST(ShortestFile, ShowsWhatOtherFieldsWouldChange) {
  Configuration configuration;
  configuration.name = "held";
  configuration.chip.intersection_pool_size = 1024;  // which held_limit follows, unless it is set
  expect_same_machine(configuration);
  configuration.slow_unit = SlowUnit::Newton0;  // which the depth of slw follows
  expect_same_machine(configuration);
  configuration.alus[AluType::Slw].depth = 6;  // which it may be with that slow unit only
  expect_same_machine(configuration);
  for (const char* name : {"8w8c", "best_4w4c", "4w4c_fma", "2w32c"}) expect_same_machine(load_configuration(name));
}

}  // namespace
}  // namespace raypool::fit
