#include <gtest/gtest.h>

#include <algorithm>

#include "chip/test_frame_run.hpp"

namespace raypool {
namespace {

using test::FrameRun;

struct Shape {
  uint32_t warps, lanes, units;
};

std::string shape_name(const testing::TestParamInfo<Shape>& shape) {
  return std::to_string(shape.param.warps) + "w" + std::to_string(shape.param.lanes) + "c" +
         std::to_string(shape.param.units) + "u";
}

class EveryShape : public testing::TestWithParam<Shape> {};

TEST_P(EveryShape, DrawsEveryImageWithoutLosingARay) {
  const Shape shape = GetParam();
  const std::array<std::array<int, 3>, 6> images = {
      {{1, 1, 1}, {1, 1, 5}, {7, 13, 1}, {31, 17, 4}, {61, 53, 2}, {97, 3, 5}}};
  for (const auto& [width, height, depth] : images) {
    SCOPED_TRACE(testing::Message() << width << "x" << height << " depth " << depth);
    FrameRun run(shape.warps, shape.lanes, shape.units, width, height, depth);
    run.expect_conserved(run.go());
  }
}

TEST_P(EveryShape, SurvivesFullPools) {
  // Nothing misses, everything is mirrored and lit: the most rays that can be alive. Small pools,
  // so that they are full all the time.
  const Shape shape = GetParam();
  for (const int packages : {512, 33}) {
    for (const int rays : {512, 64, 1}) {
      SCOPED_TRACE(testing::Message() << packages << " intersections, " << rays << " rays");
      FrameRun run(shape.warps, shape.lanes, shape.units, rays == 1 ? 11 : 31, 23, 6, 30);
      run.world.misses = run.world.blocked = 0;
      run.world.shadows = run.world.mirrors = 16;
      run.options.configuration.chip.intersection_pool_size = run.options.configuration.chip.held_limit = packages;
      run.options.configuration.chip.ray_pool_size = rays;
      run.expect_conserved(run.go());
    }
  }
}

TEST_P(EveryShape, SurvivesFullPoolsWhenTheTraverserShades) {
  const Shape shape = GetParam();
  for (const int packages : {512, 33}) {
    for (const int rays : {512, 64, 1}) {
      SCOPED_TRACE(testing::Message() << packages << " intersections, " << rays << " rays");
      FrameRun run(shape.warps, shape.lanes, shape.units, rays == 1 ? 11 : 31, 23, 6, 30);
      run.world.misses = 0;
      run.world.shadows = run.world.mirrors = 16;
      ChipConfiguration& chip = run.options.configuration.chip;
      chip.intersection_pool_size = chip.held_limit = packages;
      chip.ray_pool_size = rays;
      chip.shading = Shading::Traverser;
      const ChipResult result = run.go();
      run.expect_conserved(result);
      EXPECT_EQ(result.kernels[RayKernel::Shade].launches, 0u);
      EXPECT_EQ(result.shadow_pool.peak, 0u);
    }
  }
}

// Threads make fewer rays than the controller has kept places for, or some that the ray pool drops; hits go apart.
TEST_P(EveryShape, SurvivesFullPoolsWhenRaysAreLeftOut) {
  const Shape shape = GetParam();
  for (const bool black : {false, true}) {
    for (const int rays : {512, 64, 1}) {
      SCOPED_TRACE(testing::Message() << rays << " rays" << (black ? ", black ones" : ""));
      FrameRun run(shape.warps, shape.lanes, shape.units, rays == 1 ? 11 : 31, 23, 6, 30);
      run.world = {1, 0, 0, 9, rays == 64 ? 16 : 13, black};
      ChipConfiguration& chip = run.options.configuration.chip;
      chip.culling = true;
      chip.intersection_pool_size = chip.held_limit = rays == 512 ? 512 : 33;
      chip.ray_pool_size = rays;
      chip.policy = black ? PolicyName::Fill : PolicyName::Thesis;
      chip.shading = rays == 64 ? Shading::Traverser : Shading::Kernel;
      const ChipResult result = run.go();
      run.expect_conserved(result);
      const RayCounts& counts = result.ray_counts;
      const uint64_t hits = counts.eye.traced + counts.reflection.traced;
      EXPECT_EQ(counts.shadow.left_out, hits - counts.shadow.traced);
      EXPECT_EQ(counts.reflection.left_out, hits - result.dropped_depth - counts.reflection.traced);
      EXPECT_GT(counts.shadow.left_out, 0u);
      EXPECT_EQ(counts.reflection.left_out == 0, rays == 64);
      EXPECT_GT(result.kernels[RayKernel::CastSecondaryDirect].threads, 0u);
    }
  }
}

TEST_P(EveryShape, DrawsWithoutTheRemedyAndWithoutLaunchingAhead) {
  const Shape shape = GetParam();
  for (const bool remedy : {false, true}) {
    FrameRun run(shape.warps, shape.lanes, shape.units, 29, 23, 3);
    run.options.configuration.chip.window_remedy = remedy;
    run.options.configuration.chip.launch_ahead = false;
    run.expect_conserved(run.go());
  }
}

INSTANTIATE_TEST_SUITE_P(Chip, EveryShape,
                         testing::Values(Shape{1, 1, 1}, Shape{1, 1, 2}, Shape{1, 1, 4}, Shape{4, 4, 1}, Shape{4, 4, 2},
                                         Shape{4, 4, 4}, Shape{1, 2, 4}, Shape{8, 8, 1}, Shape{8, 8, 2}, Shape{8, 8, 4},
                                         Shape{16, 32, 2}, Shape{32, 32, 1}, Shape{32, 32, 2}, Shape{32, 32, 4}),
                         shape_name);
TEST_P(EveryShape, DrawsWithAnyPortsThresholdsAndBatches) {
  const Shape shape = GetParam();
  for (const auto& [overhead, per_beat] : {std::pair{1, 1}, {1, 2}, {7, 3}}) {
    for (const int threshold : {0, 1, 1000}) {
      SCOPED_TRACE(testing::Message() << overhead << " cycles, " << per_beat << " a beat, thresholds " << threshold);
      FrameRun run(shape.warps, shape.lanes, shape.units, 19, 11, 4);
      ChipConfiguration& chip = run.options.configuration.chip;
      chip.ray_pool_overhead = chip.intersection_pool_overhead = overhead;
      chip.ray_pool_cycles_per_beat = chip.intersection_pool_cycles_per_beat = per_beat;
      chip.ray_pool_pipelined = chip.intersection_pool_pipelined = threshold == 1;
      chip.memory_cycles_per_beat = per_beat;
      chip.thresholds_rays = chip.thresholds_intersections = threshold;
      chip.static_traverser_batch = 1 + std::min(threshold, 100);
      chip.static_traverser_stall_cycles = 10;
      run.expect_conserved(run.go());
    }
  }
}

TEST(Chip, SurvivesPoolsSmallerThanAKernel) {
  for (const uint32_t units : {1, 2, 4}) {
    for (const int rays : {512, 64, 5}) {
      for (const int packages : {16, 17, 30}) {
        for (const int width : {16, 27}) {
          SCOPED_TRACE(testing::Message()
                       << units << " units, " << rays << " rays, " << packages << " intersections, width " << width);
          FrameRun run(8, 16, units, width, 9, 9, 30);
          run.world.misses = run.world.blocked = 0;
          run.world.shadows = run.world.mirrors = 16;
          run.options.configuration.chip.intersection_pool_size = run.options.configuration.chip.held_limit = packages;
          run.options.configuration.chip.ray_pool_size = rays;
          run.expect_conserved(run.go());
        }
      }
    }
  }
}

TEST(Chip, DrawsWhateverTheRandomDelays) {
  for (uint32_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    FrameRun run(seed % 3 == 0 ? 2 : 8, seed % 2 == 0 ? 4 : 8, 1 << seed % 3, 37, 29, 1 + static_cast<int>(seed % 5),
                 1 << seed % 9, seed);
    run.world.shadows = 8 + static_cast<int>(seed % 9);
    run.world.mirrors = 16 - static_cast<int>(seed % 7);
    run.expect_conserved(run.go());
  }
}

TEST(Chip, GivesTheSameResultTwice) {
  const auto cycles = [] {
    FrameRun run(8, 8, 4, 61, 53, 3);
    return run.go().cycles;
  };
  EXPECT_EQ(cycles(), cycles());
}

TEST(Chip, TakesRaysFromTheWindowWithTheRemedy) {
  const auto cycles = [](bool remedy) {
    FrameRun run(8, 8, 1, 64, 64, 1, 200);
    run.options.configuration.chip.window_remedy = remedy;
    return run.go().cycles;
  };
  EXPECT_LT(cycles(true), cycles(false));
}

TEST(Chip, CountsKernelsAndThreads) {
  FrameRun run(8, 8, 1, 24, 16, 1);
  run.world.misses = run.world.blocked = 0;
  run.world.shadows = 16;
  const ChipResult result = run.go();
  const auto& kernels = result.kernels;
  EXPECT_EQ(kernels[RayKernel::CastEye].launches, 6u);
  EXPECT_EQ(kernels[RayKernel::CastEye].threads, 384u);
  EXPECT_EQ(kernels[RayKernel::CastSecondary].launches, 0u);
  EXPECT_EQ(kernels[RayKernel::CastSecondaryDirect].threads, 384u);
  EXPECT_EQ(kernels[RayKernel::Shade].threads, 384u);
  uint64_t cycles = 0;
  for (const auto& kernel : kernels) cycles += kernel.cycles;
  EXPECT_GE(cycles, result.busy_cycles);
  EXPECT_LE(cycles, result.cycles);
  EXPECT_GT(result.time_utilisation, 0.1);
  EXPECT_LE(result.time_utilisation, 1);
  EXPECT_GT(result.resource_utilisation, 0.1);
  EXPECT_LE(result.resource_utilisation, 1);
}

TEST(Chip, SpeedIsWhatWasTracedOverTime) {
  for (const int depth : {1, 3}) {
    FrameRun run(8, 8, 1, 24, 16, depth);  // a world in which some eye rays miss, and some hits cast no shadow ray
    const ChipResult result = run.go();
    const double per_ray = 1000 / static_cast<double>(result.cycles);
    ASSERT_NE(result.rays(), 24u * 16 * 2);
    EXPECT_DOUBLE_EQ(result.mrays_per_s, static_cast<double>(result.rays()) * per_ray);
    EXPECT_DOUBLE_EQ(result.thesis_mrays_per_s, depth == 1 ? 24 * 16 * 2 * per_ray : result.mrays_per_s);
    EXPECT_DOUBLE_EQ(result.frames_per_s, 1e9 / static_cast<double>(result.cycles));
  }
}

TEST(Chip, CastsNoReflectionsWhereThereAreNone) {
  FrameRun deep(8, 8, 2, 24, 16, 3), flat(8, 8, 2, 24, 16, 1);
  deep.options.reflections = false;
  const ChipResult result = deep.go();
  EXPECT_EQ(result.ray_counts.reflection.traced, 0u);
  EXPECT_EQ(result.cycles, flat.go().cycles);
  EXPECT_EQ(result.thesis_mrays_per_s, result.mrays_per_s) << "the thesis counts pixels at depth 1 only";
}

TEST(Chip, PutsThousandPixelTilesInBandsThatThePoolsHold) {
  FrameRun run(32, 32, 1, 64, 64, 1);
  const ChipResult result = run.go();
  EXPECT_EQ(result.kernels[0].launches, 8u);
  EXPECT_EQ(result.kernels[0].threads, 4096u);
}

TEST(Chip, CallsProgressUpToTheEnd) {
  FrameRun run(8, 8, 1, 64, 64, 1, 200);
  std::vector<ChipProgress> calls;
  run.options.progress = [&](const ChipProgress& progress) { calls.push_back(progress); };
  const ChipResult result = run.go();
  ASSERT_GE(calls.size(), 2u);
  for (size_t i = 1; i < calls.size(); ++i) EXPECT_GE(calls[i].pixels_done, calls[i - 1].pixels_done);
  EXPECT_EQ(calls.back().pixels_done, 1);
  EXPECT_EQ(calls.back().cycles, result.cycles);
  EXPECT_EQ(calls.back().rays, result.rays());
}

TEST(Chip, StopsOnAFaultAndReportsWhere) {
  FrameRun run(8, 8, 2, 64, 64, 1);
  run.units[1]->fault_at_start = Fault{FaultCode::Misaligned, 3, 17};
  try {
    run.go();
    FAIL() << "no fault";
  } catch (const ChipFault& fault) {
    EXPECT_EQ(fault.unit, 1);
    EXPECT_STREQ(fault.what(),
                 "compute unit 1 stopped with fault 5 (address that is not a multiple of 4) in warp 3 at PC 17");
  }
}

TEST(Chip, EndsWithItsStateWhenNothingMoves) {
  FrameRun run(8, 8, 1, 64, 64, 1);
  run.units[0]->hang = true;
  try {
    run.go();
    FAIL() << "no error";
  } catch (const ChipStalled& stalled) {
    EXPECT_NE(std::string(stalled.what()).find("locked up"), std::string::npos) << stalled.what();
    EXPECT_NE(std::string(stalled.what()).find("ray pool 0 of 512"), std::string::npos) << stalled.what();
    EXPECT_NE(std::string(stalled.what()).find("unit 0 runs a kernel"), std::string::npos) << stalled.what();
  }
}

TEST(Chip, GivesUpAtTheCycleLimit) {
  FrameRun run(8, 8, 1, 64, 64, 1);
  run.options.limits.cycles = 1000;
  EXPECT_THROW(run.go(), ChipStalled);
}

TEST(Chip, GivesUpWhenACounterMayWrap) {
  const auto error_of = [](uint32_t bits) -> std::string {
    FrameRun run(8, 8, 1, 64, 64, 1);
    run.options.configuration.counter_bits = bits;
    try {
      run.go();
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(error_of(48), "");
  EXPECT_EQ(error_of(32), "");
  EXPECT_NE(error_of(16).find("1023 cycles have passed"), std::string::npos) << error_of(16);
  EXPECT_NE(error_of(16).find("--set counter_bits=48"), std::string::npos) << error_of(16);
}

TEST(Chip, LetsErrorsOfTheTracerThrough) {
  struct Broken : RayTracer {
    bool trace(const Ray&, Intersection&) override { throw std::out_of_range("tracer"); }
  } broken;
  FrameRun run(8, 8, 1, 64, 64, 1);
  run.options.frame = &run.frame;
  run.options.tracer = &broken;
  EXPECT_THROW(run_board(run.options, *make_chip_around(run.options, std::move(run.device))), std::out_of_range);
}

TEST(Chip, RefusesOptionsOutOfRange) {
  const auto refuses = [](const std::function<void(FrameRun&)>& change, const char* what) {
    FrameRun run(8, 8, 1, 8, 8, 1);
    change(run);
    EXPECT_THROW(run.go(), InputError) << what;
  };
  refuses([](FrameRun& run) { run.options.width = 0; }, "width");
  refuses([](FrameRun& run) { run.options.height = 65536; }, "height");
  refuses([](FrameRun& run) { run.options.depth = 0; }, "depth");
  refuses([](FrameRun& run) { run.options.depth = 255; }, "depth");
  refuses([](FrameRun& run) { run.options.configuration.chip.held_limit = 7; }, "held limit below a tile's width");
  refuses([](FrameRun& run) { run.options.configuration.chip.held_limit = 513; }, "held limit above the pool");
  refuses([](FrameRun& run) { run.options.configuration.pc_bits = 8, run.options.program_length = 256; }, "program");
}

}  // namespace
}  // namespace raypool
