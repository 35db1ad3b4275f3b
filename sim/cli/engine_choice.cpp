#include "cli/engine_choice.hpp"

#include <fmt/format.h>

namespace raypool {
namespace {

constexpr double kMargin = 1.1;          // of times, which are extrapolated
constexpr double kLargestSample = 0.75;  // of the frame; the whole of it is exact, and takes hardly longer

constexpr const char* kSeveralFrames = "frames that add up are neither sampled nor estimated";

std::string text_of(double seconds) {
  return seconds < 10 ? fmt::format("{:.1f} s", seconds) : fmt::format("{:.0f} s", seconds);
}

bool can_sample(const EngineCosts& costs) { return *costs.sample_share < kLargestSample; }

}  // namespace

EngineChoice engine_for_error(double error, const EngineCosts& costs) {
  if (costs.estimate_error && *costs.estimate_error <= error)
    return {Engine::Estimate, fmt::format("its error with this traverser is {:.0f}%", 100 * *costs.estimate_error)};
  if (!costs.sample_share) return {Engine::Model, kSeveralFrames};
  if (!can_sample(costs)) return {Engine::Model, "a sample of so small a frame would be nearly all of it"};
  return {Engine::Sampled, costs.estimate_error
                               ? fmt::format("an estimate's error is {:.0f}%", 100 * *costs.estimate_error)
                               : "shader sets are not estimated"};
}

EngineChoice engine_for_time(const EngineCosts& costs) {
  if (!costs.sample_share) return {Engine::Model, kSeveralFrames};
  const double model = kMargin * costs.model_seconds;
  const std::string left = text_of(costs.seconds_left) + " left";
  if (model <= costs.seconds_left)
    return {Engine::Model, fmt::format("the whole frame takes about {}, with {}", text_of(costs.model_seconds), left)};
  const std::string too_long =
      fmt::format("the whole frame would take about {}, with {}", text_of(costs.model_seconds), left);
  if (!can_sample(costs)) return {costs.estimate_error ? Engine::Estimate : Engine::Model, too_long};
  const double sample = *costs.sample_share * costs.model_seconds / costs.cores;
  if (kMargin * sample <= costs.seconds_left || !costs.estimate_error) return {Engine::Sampled, too_long};
  return {Engine::Estimate, fmt::format("the smallest sample would take about {}, with {}", text_of(sample), left)};
}

}  // namespace raypool
