#include "traverser/core.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "scene/scene.hpp"
#include "traverser/test_turns.hpp"
#include "traverser/test_visits.hpp"

namespace raypool::traverser {
namespace {

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

struct Outcome {
  std::vector<uint64_t> done;  ///< [ray] cycle
  uint64_t cycles = 0;
  TraverserWork work;
};

/// All rays enter as soon as they can. With `skip` only cycles are clocked in which something happens. Caches begin
/// with what is `remembered`.
Outcome trace_all(const ChipConfiguration& chip, const std::vector<VisitList>& rays, bool skip = true,
                  const std::vector<VisitList>& remembered = {}) {
  test::LonelyPort port(chip.memory_cycles_per_beat);
  Core core(chip, port);
  for (const VisitList& places : remembered) core.remember(places);
  Outcome result;
  result.done.resize(rays.size());
  std::map<uint32_t, size_t> in_flight;  // [slot]
  size_t entered = 0, left = 0;
  uint64_t promised = 0;  // no ray is done before
  for (uint64_t cycle = 1; left < rays.size();) {
    core.clock(cycle);
    if (core.valid()) {
      EXPECT_GE(cycle, promised);
      result.done[in_flight.at(core.slot())] = cycle;
      in_flight.erase(core.slot());
      ++left;
    }
    if (entered < rays.size() && core.ready()) in_flight[core.push(rays[entered])] = entered, ++entered;
    promised = core.earliest_done(cycle);
    result.cycles = cycle;
    EXPECT_GT(core.next(), cycle);
    const bool enters = entered < rays.size() && core.ready();
    cycle = skip && !enters && left < rays.size() ? core.next() : cycle + 1;
    if (cycle > 100'000'000) throw std::logic_error("no end");
  }
  result.work = core.work();
  return result;
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

ChipConfiguration any_machine(std::mt19937& random) {
  const auto roll = [&](uint32_t from, uint32_t to) {
    return from + static_cast<uint32_t>(random() % (to - from + 1));
  };
  ChipConfiguration chip;
  chip.modelled_traverser_rays = roll(1, 40);
  chip.modelled_traverser_box_pipes = roll(1, 4);
  chip.modelled_traverser_triangle_pipes = roll(1, 3);
  chip.modelled_traverser_box_latency = roll(1, 9);
  chip.modelled_traverser_triangle_latency = roll(1, 9);
  chip.modelled_traverser_setup_latency = roll(1, 4);
  chip.modelled_traverser_finish_latency = roll(1, 4);
  chip.modelled_traverser_cache_latency = roll(1, 3);
  chip.modelled_traverser_cache_banks = 1u << roll(0, 3);
  chip.modelled_traverser_stack_entries = roll(8, 12);
  chip.modelled_traverser_node_cache_bytes = chip.modelled_traverser_triangle_cache_bytes = 1024u << roll(0, 3);
  chip.modelled_traverser_node_cache_ways = chip.modelled_traverser_triangle_cache_ways = 1u << roll(0, 4);
  chip.modelled_traverser_nodes = static_cast<NodeFormat>(roll(0, 1));
  chip.modelled_traverser_node_cache_bytes *= node_bytes(chip.modelled_traverser_nodes) / 64;
  chip.modelled_traverser_node_cache_mshrs = roll(1, 4);
  chip.modelled_traverser_triangle_cache_mshrs = roll(1, 4);
  chip.modelled_traverser_memory_row_miss = roll(0, 60);
  chip.memory_latency = roll(1, 150);
  chip.memory_cycles_per_beat = roll(1, 4);
  return chip;
}

TEST(TraverserCore, MakesEveryTestOnceAndNeedsNoCycleInWhichNothingHappens) {
  std::mt19937 random(3);
  for (int shape = 0; shape < 12; ++shape) {
    const ChipConfiguration chip = any_machine(random);
    std::vector<VisitList> rays;
    uint64_t nodes = 0, leaves = 0, triangles = 0;
    for (int i = 0; i < 300; ++i) {
      rays.push_back(i % 17 == 0 ? VisitList{} : test::random_visits(random, 60, 500));
      for (const Visit& visit : rays.back()) {
        nodes += visit.triangles == 0;
        leaves += visit.triangles != 0;
        triangles += visit.triangles;
      }
    }
    const Outcome skipping = trace_all(chip, rays), stepped = trace_all(chip, rays, false);
    EXPECT_EQ(skipping.done, stepped.done);
    EXPECT_EQ(skipping.work.ray_cycles, stepped.work.ray_cycles);
    EXPECT_EQ(skipping.work.boxes.waiting, stepped.work.boxes.waiting);
    const TraverserWork& work = skipping.work;
    EXPECT_EQ(work.rays, rays.size());
    EXPECT_EQ(work.boxes.tests, nodes);
    EXPECT_EQ(work.leaves, leaves);
    EXPECT_EQ(work.triangles.tests, triangles);
    EXPECT_EQ(work.node_cache.hits + work.node_cache.misses + work.node_cache.joined, nodes);
    const uint32_t node_lines = node_bytes(chip.modelled_traverser_nodes) / 64;
    EXPECT_EQ(work.memory_lines, node_lines * work.node_cache.misses + work.triangle_cache.misses + work.stack_fills);
    EXPECT_EQ(work.memory_quadwords, 2 * work.stack_spills);
    EXPECT_EQ(work.row_hits + work.row_misses, work.memory_lines + work.stack_spills);
    EXPECT_LE(work.most_rays, chip.modelled_traverser_rays);
    EXPECT_GT(work.stack_spills, 0u);
  }
}

/// Rays through a room.
const std::vector<VisitList>& room_rays() {
  static const std::vector<VisitList> rays = [] {
    ChipConfiguration walked;
    walked.traverser = TraverserName::Modelled;
    const Tracer tracer(make_room(0.1), 0, walked);
    std::vector<VisitList> all;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 60; ++x) {
        VisitList visits;
        Hit hit;
        const auto share = [](int at) { return static_cast<float>(at) / 60 - 0.5f; };
        tracer.traversal().nearest({{8.75f, 1.92f, 5.05f}, {-5.5f + 4 * share(x), -1.15f + 4 * share(y), -2.6f}, 1e9f},
                                   hit, nullptr, &visits);
        all.push_back(visits);
      }
    }
    return all;
  }();
  return rays;
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
