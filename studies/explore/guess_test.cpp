#include "explore/guess.hpp"

#include <gtest/gtest.h>

#include "chip/test_board.hpp"

namespace raypool::explore {
namespace {

constexpr uint32_t kSide = 64;  // pixels

struct Frame : test::RealFrame {
  Frame() : RealFrame(8, 8, kSide, kSide, 2, make_cornell()) {
    options.configuration.chip.traverser = TraverserName::Hardware;
    native.width = native.height = kSide;
    native.depth = 2;
    native.contents = options.configuration.contents();
    render_native(scene, image, tracer, native, &whole);
    counts = estimate::count_frame(options.configuration, scene, image, tracer, native, whole);
  }
  double guess(const std::vector<std::string>& set, uint32_t units = 1) {
    const Configuration machine = load_configuration("8w8c", set);
    return Guesses(counts, whole).cycles(machine, units, estimate::kernel_costs(machine));
  }

  NativeOptions native;
  NativeStatistics whole;
  estimate::FrameCounts counts;
};

TEST(Guesses, AreNearTheEstimates) {
  Frame frame;
  for (const char* lanes : {"chip.hardware_traverser.lanes=1 chip.hardware_traverser.triangle_pipes=1",
                            "chip.hardware_traverser.lanes=8"}) {
    const Configuration machine = load_configuration("8w8c", {lanes, "chip.policy=fill"});
    const double estimate = estimate::estimate_frame(machine, 1, frame.counts).cycles.value;
    const double guess = frame.guess({lanes, "chip.policy=fill"});
    EXPECT_GT(guess, 0.5 * estimate) << lanes;
    EXPECT_LT(guess, 1.3 * estimate) << lanes;
  }
}

// Each of these binds in turn, where ports are as quick as they can be.
TEST(Guesses, KnowWhatBinds) {
  Frame frame;
  const auto guess = [&](const std::string& change, uint32_t units = 4) {
    return frame.guess({"chip.ray_pool.pipelined=true chip.intersection_pool.pipelined=true chip.shading=traverser "
                        "intersection_words=16 chip.hardware_traverser.lanes=8 " +
                        change},
                       units);
  };
  const double usual = guess("");
  for (const char* change :
       {"chip.hardware_traverser.rays=8", "chip.hardware_traverser.lanes=1 chip.hardware_traverser.triangle_pipes=1",
        "chip.hardware_traverser.triangle_pipes=1", "chip.memory.latency=2000", "warps=1", "alus.flt.latency=16",
        "chip.ray_pool.cycles_per_beat=64", "chip.intersection_pool.cycles_per_beat=64"})
    EXPECT_GT(guess(change), 1.05 * usual) << change;
  const std::string far = "chip.memory.latency=2000";
  for (const char* cache : {"node", "triangle"})
    EXPECT_GT(guess(far + " chip.hardware_traverser." + cache + "_cache_bytes=4096"), 1.05 * guess(far)) << cache;
  EXPECT_NEAR(guess("warps=1", 1), 4 * guess("warps=1", 4), 1);
}

}  // namespace
}  // namespace raypool::explore
