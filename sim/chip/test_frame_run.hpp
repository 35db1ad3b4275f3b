// For tests: a run of the scripted world (test_scripted_unit.hpp) on a chip.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "chip/board.hpp"
#include "chip/test_scripted_unit.hpp"
#include "machine/compute/multiprocessor.hpp"

namespace raypool::test {

struct FrameRun {
  World world;
  ChipOptions options;
  Memory memory{4096};
  WorldFrame frame;
  std::vector<ScriptedUnit*> units;     ///< of the device
  std::unique_ptr<ComputeUnit> device;  ///< until it is drawn on

  FrameRun(uint32_t warps, uint32_t lanes, uint32_t unit_count, uint32_t width, uint32_t height, uint32_t depth,
           int pace = 60, uint32_t seed = 1) {
    world.seed = seed;
    for (uint32_t i = 0; i < memory.size(); i += 4) memory.store(i, i * 2654435761u);
    options.configuration.warps = warps;
    options.configuration.lanes = lanes;
    options.configuration.chip.traverser = TraverserName::Static;
    options.width = width;
    options.height = height;
    options.depth = depth;
    std::vector<std::unique_ptr<ComputeUnit>> made;
    for (uint32_t i = 0; i < unit_count; ++i) {
      auto unit = std::make_unique<ScriptedUnit>(world, warps * lanes, pace, seed + i, memory);
      units.push_back(unit.get());
      made.push_back(std::move(unit));
    }
    device = make_multiprocessor(std::move(made));
    options.entries = test::kScriptedEntries;
    options.memory = &memory;
    options.watchdog_cycles = 20'000;
  }

  ChipResult go() {
    for (ScriptedUnit* unit : units) unit->set_world(world);
    WorldTracer tracer(world);
    options.tracer = &tracer;
    options.frame = &frame;
    return run_board(options, *make_chip_around(options, std::move(device)));
  }

  /// Every ray and contribution of the world, once.
  void expect_conserved(const ChipResult& result) const {
    const Expected expected(world, options.width, options.height, options.depth);
    EXPECT_EQ(result.ray_counts.eye.traced, expected.eye);
    EXPECT_EQ(result.ray_counts.reflection.traced, expected.secondary);
    EXPECT_EQ(result.ray_counts.shadow.traced, expected.shadow);
    EXPECT_EQ(result.ray_counts.missed(), expected.missed);
    EXPECT_EQ(result.ray_counts.blocked(), expected.blocked);
    const ChipConfiguration& chip = options.configuration.chip;
    EXPECT_EQ(result.dropped_depth, chip.culling ? expected.deepest : expected.beyond);
    EXPECT_EQ(result.contributions, expected.contributions.size());
    EXPECT_EQ(frame.contributions, expected.contributions);
    EXPECT_LE(result.rays_pool.peak, result.rays_pool.capacity);
    EXPECT_LE(result.normal_pool.peak, result.normal_pool.capacity);
    EXPECT_LE(result.shadow_pool.peak, result.shadow_pool.capacity);
    EXPECT_LE(result.direct_pool.peak, result.direct_pool.capacity);
  }
};

}  // namespace raypool::test
