#include "traverser/lanes.hpp"

#include <gtest/gtest.h>

#include "traverser/test_machines.hpp"

namespace raypool::traverser {
namespace {

using test::room_rays;
using test::trace_all;

const Visit kNode{0, 0, 0, 0};

ChipConfiguration quick() {
  ChipConfiguration chip;
  chip.traverser = TraverserName::Lanes;
  chip.modelled_traverser_setup_latency = 5;
  chip.modelled_traverser_box_latency = 7;
  chip.modelled_traverser_triangle_latency = 11;
  chip.modelled_traverser_finish_latency = 3;
  chip.memory_latency = 100;
  chip.modelled_traverser_memory_row_miss = 0;
  return chip;
}

TEST(Lanes, MakesEveryTestOnceAndNeedsNoCycleInWhichNothingHappens) {
  test::expect_every_test_once(TraverserName::Lanes);
}

TEST(Lanes, ARayTakesItsCycles) {
  // Prepared in 1 .. 6, done in 7, finished in 7 .. 10.
  EXPECT_EQ(trace_all(quick(), {{}}).done, std::vector<uint64_t>{1 + 5 + 1 + 3});
  // Looked up in 7, missed in 8, requested in 9, there in 109; chosen in 110, offered in 111, given in 113, tested by
  // 120, done in 121.
  EXPECT_EQ(trace_all(quick(), {{kNode}}).done, std::vector<uint64_t>{121 + 3});
  // Another ray finds the line in the cache: looked up in the cycle behind its preparation, given two later.
  std::vector<VisitList> rays(300);
  rays.front() = {kNode};
  rays.push_back({kNode});
  const uint64_t entered = 1 + 3 * 300;
  EXPECT_EQ(trace_all(quick(), rays).done.back(), entered + 5 + 1 + 2 + 7 + 1 + 3);
}

TEST(Lanes, EntriesThatLieTooFarTakeACycleEach) {
  const auto done = [](uint16_t discarded) {
    const VisitList visits{{0, 0, 4, 0}, {0, 0, 4, 0}, {0, 0, 0, discarded}};
    return trace_all(quick(), {visits}).done[0];
  };
  EXPECT_EQ(done(6), done(1) + 5);
}

TEST(Lanes, WhatItRemembersIsNotRead) {
  ChipConfiguration chip = quick();
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 1 << 22;
  ASSERT_GT(trace_all(chip, room_rays()).work.node_cache.misses, 100u);
  const TraverserWork work = trace_all(chip, room_rays(), true, room_rays()).work;
  EXPECT_EQ(work.node_cache.misses + work.triangle_cache.misses, 0u);
  EXPECT_GT(work.triangle_cache.hits, 100u);
}

TEST(Lanes, WhenALineOfALeafMissesThoseBehindItAreRequestedToo) {
  const VisitList leaf{{1, 3, 0, 0}};  // three lines
  ChipConfiguration chip = quick();
  EXPECT_LT(trace_all(chip, {leaf}).done[0], 2 * 100u);
  chip.modelled_traverser_triangle_cache_mshrs = chip.modelled_traverser_cache_banks = 1;
  EXPECT_GT(trace_all(chip, {leaf}).done[0], 3 * 100u) << "without registers they come one after the other";
}

}  // namespace
}  // namespace raypool::traverser
