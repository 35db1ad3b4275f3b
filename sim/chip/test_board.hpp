// For tests: frames on a board, on the model of the chip.
#pragma once

#include <cstdint>
#include <memory>

#include "chip/board.hpp"
#include "chip/test_real_frame.hpp"
#include "chip/tree_image.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"

namespace raypool::test {

/// A machine, and what of its chip is not as it is by default.
struct BoardCase {
  const char* name;
  uint32_t warps, lanes, units, width, height, depth;
  uint32_t intersection_words = kIntersectionWords;
  void (*change)(ChipConfiguration&) = [](ChipConfiguration&) {};
};

struct BoardRun {
  explicit BoardRun(const BoardCase& c)
      : run(c.warps, c.lanes, c.width, c.height, c.depth, make_cornell(), false, c.intersection_words) {
    ChipConfiguration& chip = run.options.configuration.chip;
    c.change(chip);
    device = make_chip_model(run.options.configuration,
                             make_model(run.options.configuration, run.image.memory, c.units).device);
  }
  ChipResult draw() { return run_board(run.options, *device); }

  RealFrame run;
  std::unique_ptr<ChipDevice> device;
};

inline void expect_the_same(const ChipResult& a, const ChipResult& b) {
  EXPECT_EQ(a.cycles, b.cycles);
  EXPECT_EQ(a.busy_cycles, b.busy_cycles);
  EXPECT_EQ(a.instructions, b.instructions);
  EXPECT_EQ(a.rays(), b.rays());
  EXPECT_EQ(a.contributions, b.contributions);
  EXPECT_EQ(a.resource_utilisation, b.resource_utilisation);
  EXPECT_EQ(a.rays_pool.mean, b.rays_pool.mean);
  EXPECT_EQ(a.normal_pool.mean, b.normal_pool.mean);
  EXPECT_EQ(a.shadow_pool.mean, b.shadow_pool.mean);
  EXPECT_EQ(a.ray_port_utilisation, b.ray_port_utilisation);
  EXPECT_EQ(a.memory_port_utilisation, b.memory_port_utilisation);
  EXPECT_EQ(a.memory_reads, b.memory_reads);
  EXPECT_EQ(a.traverser_stall_batches, b.traverser_stall_batches);
  for (size_t i = 0; i < a.alus.size(); ++i) EXPECT_EQ(a.alus[i].waiting, b.alus[i].waiting) << i;
}

// With a traverser inside.
inline void inside(ChipConfiguration& chip) {
  chip.traverser = TraverserName::Hardware;
  chip.hardware_traverser_lanes = 2;
  chip.hardware_traverser_rays = 8;
  chip.hardware_traverser_triangle_pipes = 1;
  chip.hardware_traverser_stack_entries = 8;
  chip.hardware_traverser_cache_banks = 1;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 1024;
  chip.hardware_traverser_node_cache_ways = chip.hardware_traverser_triangle_cache_ways = 2;
  chip.hardware_traverser_node_cache_mshrs = chip.hardware_traverser_triangle_cache_mshrs = 2;
}

struct TreeBoard : BoardRun {
  TreeBoard()
      : BoardRun({"", 4, 4, 1, 16, 12, 3, kIntersectionWords, inside}),
        tree(make_tree_image(run.scene, run.tracer.traversal().bvh(), run.options.configuration.chip,
                             run.image.material_base)) {
    run.options.tree = &tree;
  }
  // Word of a node in the tree's memory.
  void change(uint32_t node, uint32_t word, uint32_t value) { tree.memory.store(64 * node + 4 * word, value); }
  uint32_t word(uint32_t node, uint32_t word) const { return tree.memory.load(64 * node + 4 * word); }

  TreeImage tree;
};

}  // namespace raypool::test
