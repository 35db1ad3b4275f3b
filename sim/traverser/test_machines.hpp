// For tests: machines of a traverser, and rays for them.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <vector>

#include "scene/scene.hpp"
#include "traverser/core.hpp"
#include "traverser/lanes.hpp"
#include "traverser/test_turns.hpp"
#include "traverser/test_visits.hpp"

namespace raypool::test {

struct Outcome {
  std::vector<uint64_t> done;  ///< [ray] cycle
  uint64_t cycles = 0;
  TraverserWork work;
};

/// All rays enter as soon as they can. With `skip` only cycles are clocked in which something happens. Caches begin
/// with what is `remembered`.
inline Outcome trace_all(const ChipConfiguration& chip, const std::vector<VisitList>& rays, bool skip = true,
                         const std::vector<VisitList>& remembered = {}) {
  test::LonelyPort port(chip.memory_cycles_per_beat);
  std::unique_ptr<traverser::Machine> machine;
  if (chip.traverser == TraverserName::Lanes) {
    machine = std::make_unique<traverser::Lanes>(chip, port);
  } else {
    machine = std::make_unique<traverser::Core>(chip, port);
  }
  traverser::Machine& core = *machine;
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

inline ChipConfiguration any_machine(std::mt19937& random) {
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

/// Of machines of all shapes: no test is lost or made twice, and cycles that are left out change nothing.
inline void expect_every_test_once(TraverserName traverser) {
  std::mt19937 random(3);
  for (int shape = 0; shape < 12; ++shape) {
    ChipConfiguration chip = any_machine(random);
    chip.traverser = traverser;
    std::vector<VisitList> rays;
    uint64_t nodes = 0, leaves = 0, triangles = 0;
    for (int i = 0; i < 300; ++i) {
      rays.push_back(i % 17 == 0 ? VisitList{} : random_visits(random, 60, 500));
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
inline const std::vector<VisitList>& room_rays() {
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

}  // namespace raypool::test
