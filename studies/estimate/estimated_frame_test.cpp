#include "estimate/estimated_frame.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "chip/test_board.hpp"
#include "chip/tree_image.hpp"
#include "estimate/launch_flow.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"

namespace raypool::estimate {
namespace {

constexpr uint32_t kSide = 64;  // pixels

struct Frame : test::RealFrame {
  Frame(uint32_t warps, uint32_t lanes, TraverserName traverser, uint32_t how_many = 1)
      : RealFrame(warps, lanes, kSide, kSide, 2, make_cornell()), units(how_many) {
    options.configuration.chip.traverser = traverser;
    if (traverser == TraverserName::Hardware) {
      tree = make_tree_image(scene, tracer.traversal().bvh(), options.configuration.chip, image.material_base);
      options.tree = &*tree;
    }
    native.width = native.height = kSide;
    native.depth = 2;
    native.contents = options.configuration.contents();
  }
  double simulated() {
    const auto chip =
        make_chip_model(options.configuration, make_model(options.configuration, image.memory, units).device);
    return static_cast<double>(run_board(options, *chip).cycles);
  }
  Estimates estimated() {
    NativeStatistics whole;
    render_native(scene, image, tracer, native, &whole);
    return estimate_frame(options.configuration, units,
                          count_frame(options.configuration, scene, image, tracer, native, whole));
  }

  uint32_t units;
  NativeOptions native;
  std::optional<TreeImage> tree;
};

// An interval holds in 19 of 20 frames; these are among them.
TEST(EstimatedFrame, HasTheCyclesOfTheModelInItsInterval) {
  for (const TraverserName traverser : {TraverserName::Static, TraverserName::Hardware}) {
    for (const uint32_t lanes : {4u, 8u}) {
      Frame frame(lanes, lanes, traverser);
      const double cycles = frame.simulated();
      const Interval estimate = frame.estimated().cycles;
      EXPECT_TRUE(estimate.contains(cycles)) << lanes << " lanes, traverser " << static_cast<int>(traverser) << ": "
                                             << estimate.value << " beside " << cycles;
    }
  }
}

TEST(EstimatedFrame, FindsTheFasterMachine) {
  const double one = Frame(4, 4, TraverserName::Static).estimated().cycles.value;
  EXPECT_LT(Frame(8, 8, TraverserName::Static).estimated().cycles.value, one);
  EXPECT_LT(Frame(4, 4, TraverserName::Static, 2).estimated().cycles.value, 0.7 * one);
}

TEST(EstimatedFrame, IsTheSameInEachRun) {
  Frame frame(4, 4, TraverserName::Hardware);
  const Estimates first = frame.estimated(), second = frame.estimated();
  EXPECT_EQ(first.cycles.value, second.cycles.value);
  EXPECT_EQ(first.memory_port.value, second.memory_port.value);
}

TEST(EstimatedFrame, KnowsThePixelsOutsideThePicture) {
  Frame frame(8, 8, TraverserName::Static);
  frame.native.width = frame.native.height = 20;  // tiles of 8x8
  NativeStatistics whole;
  render_native(frame.scene, frame.image, frame.tracer, frame.native, &whole);
  const Estimates estimates = estimate_frame(
      frame.options.configuration, 1,
      count_frame(frame.options.configuration, frame.scene, frame.image, frame.tracer, frame.native, whole));
  EXPECT_NEAR(estimates.mrays_per_s.value * estimates.cycles.value / 1e3, static_cast<double>(whole.rays()), 1);
}

/// A frame of tiles that are alike.
Workload alike(uint32_t tiles, double hits) {
  Workload work;
  TileWork tile;
  tile.pixels = tile.threads = 64;
  tile.eye_hits = hits;
  tile.rays = 64 * (1 + hits);
  work.tiles.assign(tiles, tile);
  return work;
}

KernelTable costs_on(const Configuration& configuration) {
  KernelTable costs;
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  for (size_t i = 0; i < kRayKernels; ++i) costs[i] = costs_of(program, kRayKernelNames[i], configuration);
  return costs;
}

TEST(LaunchFlow, CountsTheRaysOfTheFrame) {
  Configuration configuration;
  configuration.chip.traverser = TraverserName::Static;
  const KernelTable kernels = costs_on(configuration);
  EXPECT_EQ(flow_of(configuration, 1, alike(16, 0), kernels).rays, 16 * 64);
  const Flow flow = flow_of(configuration, 1, alike(16, 1), kernels);
  EXPECT_EQ(flow.rays, 2 * 16 * 64);
  EXPECT_EQ(flow.warps[RayKernel::CastEye], 16 * 8);
  EXPECT_GE(flow.warps[RayKernel::CastSecondaryDirect], 16 * 8);
}

TEST(LaunchFlow, IsNoFasterThanItsPorts) {
  Configuration configuration;
  configuration.chip.traverser = TraverserName::Static;
  configuration.chip.ray_pool_overhead = 64;  // cycles a ray
  const Flow flow = flow_of(configuration, 4, alike(16, 1), costs_on(configuration));
  EXPECT_GE(flow.cycles, 67 * flow.rays);
  EXPECT_EQ(flow.ray_port, 67 * flow.rays);
}

TEST(LaunchFlow, IsNoFasterThanAnAlu) {
  Configuration configuration;
  configuration.chip.traverser = TraverserName::Static;
  configuration.alus[AluType::Flt].latency = 16;  // cycles a task
  const KernelTable kernels = costs_on(configuration);
  const Flow flow = flow_of(configuration, 1, alike(16, 1), kernels);
  double busy = 0;
  for (size_t i = 0; i < kRayKernels; ++i)
    for (const Segment& segment : kernels[i].segments) busy += flow.warps[i] * segment.busy[AluType::Flt];
  EXPECT_GE(flow.cycles, busy);
}

TEST(LaunchFlow, IsNoFasterThanThePipesOfTheTraverser) {
  Configuration configuration;
  configuration.chip.hardware_traverser_lanes = configuration.chip.hardware_traverser_triangle_pipes = 1;
  Workload work = alike(16, 1);
  for (TileWork& tile : work.tiles) tile.nodes = 200;
  const Flow flow = flow_of(configuration, 4, work, costs_on(configuration));
  EXPECT_GE(flow.cycles, 0.9 * 200 * flow.rays) << "ways of rays differ, so that the sum may be a little less";
}

}  // namespace
}  // namespace raypool::estimate
