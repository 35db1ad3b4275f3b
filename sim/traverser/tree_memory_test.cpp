#include "traverser/tree_memory.hpp"

#include <gtest/gtest.h>

#include "traverser/test_turns.hpp"

namespace raypool::traverser {
namespace {

struct Nobody : LookupListener {
  void looked_up(uint32_t /*slot*/, uint64_t /*due*/) override {}
};

/// The memory between fetch units whose every lookup misses.
struct Bench {
  explicit Bench(const ChipConfiguration& chip) : port(2), memory(chip, port), nodes(setup()), triangles(setup()) {}
  static FetchUnit::Setup setup() { return {4, 1, 32, 1 << 14, 1, 64}; }

  static void want(FetchUnit& fetch, uint32_t line) { fetch.push(0, {0, line, 1, 0}); }
  /// The cycles in which lines come, in their order, and what they are.
  std::vector<std::pair<uint64_t, uint32_t>> run() {
    std::vector<std::pair<uint64_t, uint32_t>> came;
    for (uint64_t cycle = 1; cycle < 2000; ++cycle) {
      while (memory.valid(cycle)) came.emplace_back(cycle, memory.take().which);
      nodes.clock(cycle, nobody);
      triangles.clock(cycle, nobody);
      memory.clock(cycle, nodes, triangles, stacks, nobody);
    }
    return came;
  }

  test::LonelyPort port;
  TreeMemory memory;
  FetchUnit nodes, triangles;
  RayStacks stacks{1, 8};
  Nobody nobody;
};

ChipConfiguration chip_of(uint32_t banks) {
  ChipConfiguration chip;
  chip.memory_latency = 100;
  chip.modelled_traverser_memory_banks = banks;
  chip.modelled_traverser_memory_row_bytes = 128;  // two lines
  chip.modelled_traverser_memory_row_miss = 50;
  return chip;
}

using Came = std::vector<std::pair<uint64_t, uint32_t>>;

TEST(TreeMemory, ALineOfTheOpenRowComesAfterTheLatencyAnotherLater) {
  Bench bench(chip_of(4));
  Bench::want(bench.nodes, 0);
  Bench::want(bench.nodes, 1);  // of the row of 0
  // The second has its turn 8 cycles later, before the row is open, and comes 8 cycles after the first.
  EXPECT_EQ(bench.run(), (Came{{151, 0}, {159, 1}}));
  TraverserWork work;
  bench.memory.add_to(work);
  EXPECT_EQ(work.row_hits, 1u);
  EXPECT_EQ(work.row_misses, 1u);
  EXPECT_EQ(work.memory_lines, 2u);
  EXPECT_EQ(bench.port.beats(), 8u);
}

TEST(TreeMemory, AnExactNodeIsTwoLinesThatComeTogether) {
  ChipConfiguration chip = chip_of(4);
  chip.modelled_traverser_nodes = NodeFormat::Exact;
  Bench bench(chip);
  Bench::want(bench.nodes, 0);
  Bench::want(bench.nodes, 1);
  Bench::want(bench.triangles, 4);
  // Each has a bank of its own. A line keeps the port for 8 cycles, so the triangles' comes 8 behind the first node's,
  // whose turn was before, and the two of the second node 8 and 16 behind that.
  EXPECT_EQ(bench.run(), (Came{{159, 0}, {167, 4}, {183, 1}}));
  TraverserWork work;
  bench.memory.add_to(work);
  EXPECT_EQ(work.row_hits, 2u);
  EXPECT_EQ(work.row_misses, 3u);
  EXPECT_EQ(work.memory_lines, 5u);
  EXPECT_EQ(bench.port.beats(), 5 * 4u);
}

TEST(TreeMemory, RowsOfOneBankAreOpenedOneAfterTheOther) {
  const auto last = [](uint32_t banks) {
    Bench bench(chip_of(banks));
    for (uint32_t row = 0; row < 4; ++row) Bench::want(bench.nodes, 2 * row);
    return bench.run().back().first;
  };
  EXPECT_EQ(last(1), 1 + 4 * 50 + 100u);
  EXPECT_EQ(last(4), 1 + 3 * 8 + 50 + 100u);
}

TEST(TreeMemory, WhoAsksHasATurnInRotation) {
  Bench bench(chip_of(1));
  for (uint32_t line = 0; line < 3; ++line) {
    Bench::want(bench.nodes, line);
    Bench::want(bench.triangles, 100 + line);
  }
  bench.stacks.push(0, 12);
  std::vector<uint32_t> order;
  for (const auto& [cycle, which] : bench.run()) order.push_back(which);
  EXPECT_EQ(order, (std::vector<uint32_t>{0, 100, 1, 101, 2, 102}));
  EXPECT_EQ(bench.port.beats(), 6 * 4 + 2u) << "six lines, and 32 bytes of a stack";
}

}  // namespace
}  // namespace raypool::traverser
