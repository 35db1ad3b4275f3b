#include "traverser/core.hpp"

#include <gtest/gtest.h>

#include "traverser/test_machines.hpp"

namespace raypool::traverser {
namespace {

using test::Outcome;
using test::room_rays;
using test::trace_all;

ChipConfiguration quick() {
  ChipConfiguration chip;
  chip.modelled_traverser_setup_latency = 5;
  chip.modelled_traverser_box_latency = 7;
  chip.modelled_traverser_triangle_latency = 11;
  chip.modelled_traverser_finish_latency = 3;
  chip.modelled_traverser_cache_latency = 2;
  chip.memory_latency = 100;
  chip.modelled_traverser_memory_row_miss = 0;
  return chip;
}

const Visit kNode{0, 0, 0, 0};

TEST(TraverserCore, ARayWithoutVisitsIsPreparedAndFinished) {
  EXPECT_EQ(trace_all(quick(), {{}}).done, std::vector<uint64_t>{1 + 5 + 3});
}

TEST(TraverserCore, ANodeIsLookedUpTestedAndLeft) {
  // Prepared in 1 .. 6, missed in 7, the line comes in 107, the result in 114.
  EXPECT_EQ(trace_all(quick(), {{kNode}}).done, std::vector<uint64_t>{114 + 3});
  // Another ray, 300 cycles later, finds the line in the cache.
  std::vector<VisitList> rays(300);
  rays.front() = {kNode};
  rays.push_back({kNode});
  EXPECT_EQ(trace_all(quick(), rays).done.back(), 301 + 5 + 1 + 2 + 7 + 3u);
}

TEST(TraverserCore, ALeafsLinesComeOneAfterTheOtherAndAllItsTrianglesAreTested) {
  // Triangles 1, 2 and 3 are bytes 44 .. 175: lines 0, 1 and 2. The first line completes none of them.
  const VisitList leaf{{0, 0, 1, 0}, {1, 3, 0, 0}};
  std::vector<VisitList> rays(800);
  rays.front() = leaf;
  rays.push_back(leaf);
  const Outcome result = trace_all(quick(), rays);
  const uint64_t node_done = 801 + 5 + 1 + 2 + 7;
  EXPECT_EQ(result.done.back(), node_done + 1 + 3 * 2 + 2 + 11 + 3);
  EXPECT_EQ(result.work.triangles.tests, 6u);
  EXPECT_EQ(result.work.triangle_cache.misses, 3u);
  EXPECT_EQ(result.work.triangle_cache.hits, 3u);
  EXPECT_EQ(result.work.leaves, 2u);
}

TEST(TraverserCore, WhenALineOfALeafMissesThoseBehindItAreRequestedToo) {
  // Lines 0, 1 and 2 come 8 cycles apart, 100 after the first was requested; the last gives the last triangle's test.
  ChipConfiguration chip = quick();
  chip.memory_cycles_per_beat = 2;
  chip.modelled_traverser_triangle_pipes = 1;
  const uint64_t requested = 1 + 5 + 1, last = requested + 100 + 2 * 8, tests = 1 + 11;
  const uint64_t done = trace_all(chip, {{{1, 3, 0, 0}}}).done[0];
  EXPECT_GE(done, last + tests + 3 - 1);
  EXPECT_LE(done, last + tests + 3 + 3) << "three latencies one after the other would be 200 more";
  // Without registers for them they come one after the other.
  chip.modelled_traverser_triangle_cache_mshrs = 1;
  EXPECT_GT(trace_all(chip, {{{1, 3, 0, 0}}}).done[0], requested + 3 * 100);
}

TEST(TraverserCore, EntriesThatLieTooFarTakeACycleEach) {
  const auto done = [](uint16_t discarded) {
    const VisitList visits{{0, 0, 4, 0}, {0, 0, 4, 0}, {0, 0, 0, discarded}};
    return trace_all(quick(), {visits}).done[0];
  };
  EXPECT_EQ(done(1), done(0));  // going on takes a cycle in any case
  EXPECT_EQ(done(6), done(1) + 5);
}

TEST(TraverserCore, MakesEveryTestOnceAndNeedsNoCycleInWhichNothingHappens) {
  test::expect_every_test_once(TraverserName::Modelled);
}

double cycles_of(const ChipConfiguration& chip) { return static_cast<double>(trace_all(chip, room_rays()).cycles); }

/// A machine in which nothing but what the test takes away is scarce.
ChipConfiguration ample() {
  ChipConfiguration chip;
  chip.modelled_traverser_rays = 512;
  chip.modelled_traverser_box_pipes = chip.modelled_traverser_triangle_pipes = 16;
  chip.modelled_traverser_cache_banks = 32;
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 1 << 24;
  chip.modelled_traverser_node_cache_mshrs = chip.modelled_traverser_triangle_cache_mshrs = 64;
  chip.memory_cycles_per_beat = 1;
  return chip;
}

TEST(TraverserCore, TwiceTheBoxPipesAreTwiceAsFastWhereTheyBind) {
  ChipConfiguration chip = ample();
  chip.modelled_traverser_box_pipes = 1;
  const Outcome one = trace_all(chip, room_rays());
  EXPECT_GT(static_cast<double>(one.work.boxes.tests), 0.9 * static_cast<double>(one.cycles));
  chip.modelled_traverser_box_pipes = 2;
  EXPECT_NEAR(static_cast<double>(one.cycles) / cycles_of(chip), 2, 0.15);
}

TEST(TraverserCore, TwiceTheTrianglePipesHelpWhereTheyBind) {
  ChipConfiguration chip = ample();
  chip.modelled_traverser_triangle_pipes = 1;
  const double one = cycles_of(chip);
  chip.modelled_traverser_triangle_pipes = 2;
  EXPECT_GT(one / cycles_of(chip), 1.2);
}

TEST(TraverserCore, ATenthOfTheBandwidthIsTenTimesAsSlowWhereItBinds) {
  ChipConfiguration chip = ample();
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 4096;
  chip.modelled_traverser_memory_row_miss = 0;
  chip.memory_cycles_per_beat = 3;
  const Outcome fast = trace_all(chip, room_rays());
  EXPECT_GT(static_cast<double>(fast.work.memory_lines * 4 * 3), 0.9 * static_cast<double>(fast.cycles));
  chip.memory_cycles_per_beat = 30;
  EXPECT_NEAR(cycles_of(chip) / static_cast<double>(fast.cycles), 10, 1.0);
}

TEST(TraverserCore, HalfTheCacheReadsMoreAndIsSlowerWhereTheMemoryBinds) {
  ChipConfiguration chip = ample();
  chip.memory_cycles_per_beat = 4;
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 8192;
  const Outcome whole = trace_all(chip, room_rays());
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 4096;
  const Outcome half = trace_all(chip, room_rays());
  const double bytes = static_cast<double>(half.work.bytes()) / static_cast<double>(whole.work.bytes());
  EXPECT_GT(bytes, 1.1);
  EXPECT_NEAR(static_cast<double>(half.cycles) / static_cast<double>(whole.cycles), bytes, 0.1 * bytes);
}

TEST(TraverserCore, WhatItRemembersIsNotRead) {
  ASSERT_GT(trace_all(ample(), room_rays()).work.node_cache.misses, 100u);
  const TraverserWork work = trace_all(ample(), room_rays(), true, room_rays()).work;
  EXPECT_EQ(work.node_cache.misses + work.triangle_cache.misses, 0u);
  EXPECT_GT(work.triangle_cache.hits, 100u);
}

TEST(TraverserCore, AnExactNodeIsOneLookupAndTakesTwoLinesOfItsCache) {
  ChipConfiguration chip = quick();
  chip.modelled_traverser_nodes = NodeFormat::Exact;
  chip.memory_cycles_per_beat = 2;
  // As ANodeIsLookedUpTestedAndLeft, but the second line comes 8 cycles later.
  std::vector<VisitList> rays(300);
  rays.front() = {kNode};
  rays.push_back({kNode});
  const Outcome one = trace_all(chip, rays);
  EXPECT_EQ(one.done.front(), 114 + 8 + 3u);
  EXPECT_EQ(one.done.back(), 301 + 5 + 1 + 2 + 7 + 3u);
  EXPECT_EQ(one.work.bytes(), 128u);

  // 16 nodes, one after the other and again: they fit in 1 KB if they are compressed, and in 2 KB if not.
  const auto misses = [&](NodeFormat nodes, uint32_t bytes) {
    chip.modelled_traverser_nodes = nodes;
    chip.modelled_traverser_node_cache_bytes = bytes;
    VisitList visits;
    for (uint32_t i = 0; i < 32; ++i) visits.push_back({i % 16, 0, 1, 0});
    return trace_all(chip, {visits}).work.node_cache.misses;
  };
  EXPECT_EQ(misses(NodeFormat::Compressed, 1024), 16u);
  EXPECT_EQ(misses(NodeFormat::Exact, 1024), 32u);
  EXPECT_EQ(misses(NodeFormat::Exact, 2048), 16u);
}

TEST(TraverserCore, MoreRaysInFlightHideTheLatencyWhereNothingElseBinds) {
  ChipConfiguration chip = ample();
  chip.modelled_traverser_rays = 4;
  const double four = cycles_of(chip);
  chip.modelled_traverser_rays = 8;
  EXPECT_NEAR(four / cycles_of(chip), 2, 0.2);
}

}  // namespace
}  // namespace raypool::traverser
