// rtl/chip/rp_chip.v in lockstep with its model while it draws frames with the real kernels, amid random surroundings:
// all ports of all blocks in every cycle, on machines that differ in their corner cases.
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <string>

#include "lockstep/lockstep_chip.hpp"
#include "lockstep/rtl_loader.hpp"
#include "rtl/chip_frames.hpp"

namespace raypool {
namespace {

using namespace test;

/// Of everything one.
Machine smallest() {
  Machine machine;
  Configuration& c = machine.configuration;
  c.name = "chip_1w1c";
  c.chip.traverser = TraverserName::Static;
  c.warps = c.lanes = 1;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 1;
  c.chip.ray_pool_size = c.chip.intersection_pool_size = c.chip.held_limit = 1;
  c.chip.ray_pool_overhead = c.chip.intersection_pool_overhead = 1;
  c.chip.memory_queue = 1;
  c.chip.memory_latency = 6;
  c.chip.memory_cycles_per_beat = 1;
  c.chip.hardware_traverser_node_cache_mshrs = c.chip.hardware_traverser_triangle_cache_mshrs = 1;
  return machine;
}

/// Two units, all that a chip may have: the policy fill, culling, a traverser that shades, pipelined pools, records.
Machine full() {
  Machine machine;
  machine.units = 2;
  Configuration& c = machine.configuration;
  c.name = "chip_2w2c_full";
  c.chip.traverser = TraverserName::Static;
  c.warps = c.lanes = 2;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 2;
  c.kernel_overlap = true;
  c.intersection_words = 18;
  c.chip.policy = PolicyName::Fill;
  c.chip.culling = true;
  c.chip.shading = Shading::Traverser;
  c.chip.static_traverser_batch = 3;
  c.chip.tile_order = TileOrder::Hilbert;
  c.chip.ray_pool_size = 5;
  c.chip.ray_pool_pipelined = c.chip.intersection_pool_pipelined = true;
  c.chip.intersection_pool_size = c.chip.held_limit = 8;
  c.chip.memory_latency = 20;
  return machine;
}

/// Four units, and slow ports.
Machine slow() {
  Machine machine;
  machine.units = 4;
  Configuration& c = machine.configuration;
  c.name = "chip_1w1c_slow";
  c.chip.traverser = TraverserName::Static;
  c.warps = c.lanes = 1;
  c.instruction_cache_bytes = c.data_cache_bytes = 512;
  c.data_cache_mshrs = 2;
  c.chip.launch_ahead = c.chip.window_remedy = false;
  c.chip.thresholds_rays = 40;
  c.chip.ray_pool_size = 4;
  c.chip.ray_pool_overhead = 3;
  c.chip.ray_pool_cycles_per_beat = 2;
  c.chip.intersection_pool_size = c.chip.held_limit = 6;
  c.chip.intersection_pool_overhead = 4;
  c.chip.intersection_pool_cycles_per_beat = 2;
  c.chip.memory_latency = 40;
  c.chip.memory_cycles_per_beat = 3;
  c.chip.memory_queue = 3;
  c.chip.hardware_traverser_node_cache_mshrs = 2;
  c.chip.hardware_traverser_triangle_cache_mshrs = 1;
  return machine;
}

class ChipLockstep : public testing::TestWithParam<Machine (*)()> {};

TEST_P(ChipLockstep, DrawsFramesWithoutADifference) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const std::string library = chip_library(machine);
  Reached reached;
  ChipLockstepCounts counts;
  const Traffic all[] = {{0, 0, 0, 1000, 1, 1, 1},
                         {3, 2, 40, 1000, 200, 30, 1},
                         {2, 5, 9, 3, 20, 60, 1},
                         {9, 0, 0, 1000, 900, 5, 2000, 500}};
  // One pixel at a time takes long.
  const uint32_t size = c.chip.held_limit > 1 ? 2 : 1;
  const Picture pictures[] = {{5 * size, 3 * size, 1, true},
                              {7 * size, 3 * size, 3, true},
                              {1, 9 * size, 4, false},
                              {4 * size, 4 * size, 2, true}};
  uint32_t seed = 0;
  // One device for all frames: nothing of one may be left in the next.
  Frame first(machine, pictures[0]);
  const std::unique_ptr<LockstepChip> chip =
      make_lockstep_chip(c, load_rtl_chip(library, c, machine.units), first.image.memory, c.name);
  for (const Picture& picture : pictures) {
    for (const Traffic& traffic : all) {
      SCOPED_TRACE(testing::Message() << "seed " << ++seed << ", " << picture.width << " x " << picture.height);
      try {
        Frame frame(machine, picture);
        ASSERT_NO_FATAL_FAILURE(draw(*chip, machine, frame, traffic, seed, reached));
      } catch (const LockstepDifference& difference) {
        FAIL() << difference.what();
      }
    }
  }
  counts = chip->lockstep_counts();
  std::cout << c.name << ", " << machine.units << " units: " << to_string(counts) << "\n";
  EXPECT_EQ(counts.differences, 0u);
  EXPECT_GE(counts.counters, reached.frames);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastEye)], 50u);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastSecondary)], 50u);
  EXPECT_GT(reached.launches[to_underlying(RayKernel::CastSecondaryDirect)], 10u);
  EXPECT_EQ(reached.launches[to_underlying(RayKernel::Shade)] > 20, c.chip.shading == Shading::Kernel);
  EXPECT_EQ(reached.own > 20, c.chip.shading == Shading::Traverser);
  EXPECT_EQ(reached.black > 0, c.chip.culling);
  EXPECT_GT(counts.memory_writes, 1000u);
  EXPECT_GT(reached.deep, 20u);
  EXPECT_GT(reached.held_up, 20u);
  if (c.chip.intersection_pool_size == 1) {
    EXPECT_GT(reached.full, 20u);  // a larger one seldom is
  }
  if (machine.units > 2) {  // units that shade together
    EXPECT_GT(reached.frame_waited, 20u);
  }
  EXPECT_GT(reached.tree_lines, 20u);
  EXPECT_EQ(reached.overlapped > 0, c.chip.launch_ahead);
  for (int unit = 0; unit < machine.units; ++unit) EXPECT_GT(reached.of_unit[unit], 50u) << unit;
}

// Of each frame the next one finds what it has left: counts that go on, places that are free in another order.
TEST_P(ChipLockstep, DrawsFrameAfterFrameWithoutAReset) {
  const Machine machine = GetParam()();
  const Configuration& c = machine.configuration;
  const uint32_t size = c.chip.held_limit > 1 ? 2 : 1;
  const Picture pictures[] = {{3 * size, 2 * size, 2, true},
                              {2 * size, 5 * size, 3, true},
                              {1, 3 * size, 1, false},
                              {4 * size, 3 * size, 4, true}};
  const Traffic all[] = {{0, 0, 0, 1000, 1, 1, 1}, {3, 2, 40, 1000, 200, 30, 1}, {2, 5, 9, 3, 20, 60, 1}};
  Reached reached;
  Frame frame(machine, pictures[0]);
  const std::unique_ptr<LockstepChip> chip =
      make_lockstep_chip(c, load_rtl_chip(chip_library(machine), c, machine.units), frame.image.memory, c.name);
  uint32_t seed = 0;
  for (const Traffic& traffic : all) {
    for (const Picture& picture : pictures) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << picture.width << " x " << picture.height);
      frame.show(Frame(machine, picture));
      try {
        ASSERT_NO_FATAL_FAILURE(draw(*chip, machine, frame, traffic, seed, reached,
                                     seed == 0 ? FrameBegin::Reset : FrameBegin::Next, seed % 3 != 2));
      } catch (const LockstepDifference& difference) {
        FAIL() << difference.what();
      }
      ++seed;
    }
  }
  EXPECT_EQ(reached.frames, seed);
  EXPECT_EQ(chip->lockstep_counts().differences, 0u);
  EXPECT_GT(chip->lockstep_counts().counters, 0u);
}

INSTANTIATE_TEST_SUITE_P(Machines, ChipLockstep, testing::Values(smallest, full, slow),
                         [](const auto& machine) { return machine.param().configuration.name; });

TEST(ChipLibrary, IsRefusedForAnotherChip) {
  Machine machine = smallest();
  const std::string library = chip_library(machine);
  machine.configuration.chip.ray_pool_size = 2;
  try {
    make_chip(ChipKind::Rtl, machine.configuration, Memory(), 1, library);
    FAIL() << "it was loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("needs RAY_POOL_SIZE=2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raypool
