#include "cli/engine_choice.hpp"

#include <gtest/gtest.h>

namespace raypool {
namespace {

EngineCosts costs_of(std::optional<double> estimate_error, std::optional<double> sample_share, double model_seconds,
                     double seconds_left) {
  return {estimate_error, sample_share, model_seconds, seconds_left, 2};
}

TEST(EngineForError, IsTheQuickestThatIsNearEnough) {
  const EngineCosts costs = costs_of(0.14, 0.1, 0, 0);
  EXPECT_EQ(engine_for_error(0.2, costs).engine, Engine::Estimate);
  EXPECT_EQ(engine_for_error(0.14, costs).engine, Engine::Estimate);
  EXPECT_EQ(engine_for_error(0.13, costs).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_error(0.13, costs).why, "an estimate's error is 14%");
}

TEST(EngineForError, IsModelWhereASampleIsNoQuicker) {
  EXPECT_EQ(engine_for_error(0.02, costs_of(0.14, 0.74, 0, 0)).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_error(0.02, costs_of(0.14, 0.75, 0, 0)).engine, Engine::Model);
  EXPECT_EQ(engine_for_error(0.02, costs_of({}, 1, 0, 0)).engine, Engine::Model);
}

TEST(EngineForError, NeedsNoEstimate) {
  EXPECT_EQ(engine_for_error(0.5, costs_of({}, 0.1, 0, 0)).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_error(0.5, costs_of({}, {}, 0, 0)).engine, Engine::Model);
}

TEST(EngineForTime, IsTheNearestThatEndsInTime) {
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.1, 8.9, 10)).engine, Engine::Model);
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.1, 9.2, 10)).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.1, 100, 10)).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.1, 300, 10)).engine, Engine::Estimate);
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.9, 12, 10)).engine, Engine::Estimate);
  EXPECT_EQ(engine_for_time(costs_of(0.14, 0.1, 300, 10)).why,
            "the smallest sample would take about 15 s, with 10 s left");
}

TEST(EngineForTime, SamplesAtLeastWhereThereIsNoEstimate) {
  EXPECT_EQ(engine_for_time(costs_of({}, 0.1, 300, 10)).engine, Engine::Sampled);
  EXPECT_EQ(engine_for_time(costs_of({}, {}, 300, 10)).engine, Engine::Model);
}

}  // namespace
}  // namespace raypool
