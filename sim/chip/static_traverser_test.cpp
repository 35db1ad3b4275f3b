#include "chip/static_traverser.hpp"

#include <gtest/gtest.h>

#include "chip/frame_port.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/simulation.hpp"
#include "chip/test_driver.hpp"

namespace raypool::chip {
namespace {

struct HalfTracer : RayTracer {
  /// Rays of odd pixels leave nothing.
  bool trace(const Ray& ray, Intersection& intersection) override {
    ++traced;
    std::copy(ray.begin(), ray.end(), intersection.begin());
    return (ray[word::kPixel] & 1) == 0;
  }
  int traced = 0;
};

struct Counted : FrameSink {
  void add(const FrameContribution& contribution) override { pixels.push_back(contribution.pixel); }
  std::vector<uint32_t> pixels;
};

/// Stands for the controller: counts how often it is told that rays have moved.
struct Moves : DecisionIf {
  void changed() override { ++seen; }
  int seen = 0;
};

ChipConfiguration chip_of(int intersections) {
  ChipConfiguration chip;
  chip.intersection_pool_size = intersections;
  return chip;
}

/// Rays come from nowhere: no kernel has made them.
struct RaysOfNobody : PixelLedger {
  using PixelLedger::PixelLedger;
  void ray_exported(uint32_t /*unit*/, const Ray& /*ray*/, bool /*kept*/) override {}
};

/// A traverser between pools that the test fills.
struct Bench {
  Simulation simulation;
  ChipClock clock{"clock"};
  RaysOfNobody ledger;
  RayPool rays;
  IntersectionPool intersections;
  HalfTracer tracer;
  Counted picture;
  FramePort frame;
  Moves moves;
  StaticTraverser traverser;

  explicit Bench(uint32_t units, int capacity = 512) : Bench(units, chip_of(capacity)) {}
  Bench(uint32_t units, const ChipConfiguration& chip)
      : ledger("pixel_ledger", units, 512, 1),
        rays("ray_pool", {}, 5),
        intersections("intersection_pool", chip),
        frame("frame_port", picture),
        traverser("traverser", {tracer, chip, units, 5, true, true}) {
    rays.clock(clock.now);
    rays.ledger(ledger.records);
    rays.arrivals(traverser.arrivals);
    intersections.clock(clock.now);
    intersections.ledger(ledger.records);
    frame.clock(clock.now);
    frame.ledger(ledger.records);
    traverser.clock(clock.now);
    traverser.rays(rays.traverser);
    traverser.intersections(intersections.traverser);
    traverser.frame(frame.traverser);
    traverser.ledger(ledger.records);
    traverser.controller(moves);
  }

  /// Puts `count` rays into the pool; with kShadowFlag shadow rays.
  void fill(int count, uint32_t flags = 1) {
    std::vector<uint32_t> pixels;
    for (int i = 0; i < count; ++i) pixels.push_back(static_cast<uint32_t>(i));
    ledger.eye_launched(0, pixels);  // so that the pixels are held
    for (const uint32_t pixel : pixels) {
      rays.take(0, {}, false);
      rays.take(0, {0, 0, 0, pixel}, false);
      rays.take(0, {0, 0, 0, flags}, true);
    }
  }
  void run(std::function<bool(uint64_t)> cycle) { test::drive(simulation, clock, std::move(cycle)); }
};

TEST(StaticTraverser, Turns64RaysIntoIntersectionsAtTheEndOfAKernel) {
  Bench bench(1);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) bench.fill(200);
    if (cycle == 1) bench.traverser.shader_stalls(false);
    if (cycle == 5) bench.traverser.kernel_ended(0);
    EXPECT_EQ(bench.rays.size(), cycle <= 5 ? 200u : 136u);
    if (cycle == 6) {
      EXPECT_EQ(bench.rays.size(), 136u);
      EXPECT_EQ(bench.intersections.size(ImportKind::Normal), 32u);  // the other half missed
    }
    return cycle < 5000;
  });
  EXPECT_EQ(bench.traverser.counts().batches, 1u);
  EXPECT_EQ(bench.traverser.counts().rays.missed(), 32u);
  EXPECT_EQ(bench.traverser.counts().rays.eye.traced, 64u);
  EXPECT_EQ(bench.ledger.held(), 168u);
}

TEST(StaticTraverser, TakesBatchAndStallAsTheChipSays) {
  ChipConfiguration chip;
  chip.static_traverser_batch = 10;
  chip.static_traverser_stall_cycles = 300;
  Bench bench(2, chip);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.fill(100);
      bench.traverser.shader_stalls(false);
    }
    if (cycle == 5) bench.traverser.kernel_ended(0);
    if (cycle == 50) bench.traverser.shader_stalls(true);
    EXPECT_EQ(bench.rays.size(), cycle <= 5 ? 100u : cycle <= 350 ? 90u : 70u) << cycle;
    return cycle < 500;
  });
}

TEST(StaticTraverser, Turns64RaysAUnitIntoIntersectionsAfter1000CyclesOfStall) {
  for (const uint32_t units : {1, 2, 4}) {
    Bench bench(units);
    std::vector<std::pair<uint64_t, uint32_t>> steps;  // cycle in which it is first seen, rays left
    bench.run([&](uint64_t cycle) {
      const uint32_t before = bench.rays.size();
      if (cycle == 1) {
        bench.fill(500);
        bench.traverser.shader_stalls(false);
      }
      if (cycle == 50) {
        bench.traverser.shader_stalls(true);
      }
      if (cycle > 1 && (steps.empty() ? 500 : steps.back().second) != before) steps.push_back({cycle, before});
      return cycle < 2100;
    });
    const auto batch = static_cast<uint32_t>(64 * units);
    ASSERT_EQ(steps.size(), 2u) << units;
    EXPECT_EQ(steps[0], (std::pair<uint64_t, uint32_t>(1051, 500 - batch)));
    EXPECT_EQ(steps[1], (std::pair<uint64_t, uint32_t>(2051, units == 4 ? 0 : 500 - 2 * batch)));
  }
}

TEST(StaticTraverser, DoesNothingWhileTheShaderWorks) {
  Bench bench(2);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.fill(100);
      bench.traverser.shader_stalls(false);
    }
    if (cycle == 20) bench.traverser.shader_stalls(true);
    if (cycle == 1019) bench.traverser.shader_stalls(false);  // 999 cycles are not enough
    return cycle < 4000;
  });
  EXPECT_EQ(bench.rays.size(), 100u);
}

TEST(StaticTraverser, KeepsRaysWithoutRoomAndTracesThemOnce) {
  Bench bench(1, 10);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) bench.fill(64, 1 | kShadowFlag);
    if (cycle == 2) bench.traverser.kernel_ended(0);
    if (cycle == 3) {
      EXPECT_EQ(bench.intersections.size(ImportKind::Shadow), 10u);
      EXPECT_EQ(bench.rays.size(), 22u);  // 32 are free, 10 of them found room
      bench.fill(20);                     // normal rays pass those that wait
      bench.traverser.kernel_ended(0);
    }
    return cycle < 10;
  });
  EXPECT_EQ(bench.intersections.size(ImportKind::Normal), 10u);
  EXPECT_EQ(bench.rays.size(), 22u);
  EXPECT_EQ(bench.tracer.traced, 84);
  EXPECT_EQ(bench.traverser.counts().rays.blocked(), 32u);
}

TEST(StaticTraverser, IsDueAtTheEndOfAStallThatMovesARayAndOfNoOther) {
  Bench bench(1, 10);
  const auto due = [&] { return bench.traverser.work_done().due; };
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.traverser.shader_stalls(false);
      bench.fill(64);
      EXPECT_EQ(due(), kNever) << "the shader works";
    }
    if (cycle == 10) {
      bench.traverser.shader_stalls(true);
      EXPECT_EQ(due(), 1010u);
    }
    if (cycle == 1011) {
      EXPECT_EQ(
          bench.traverser.describe(),
          "traverser: 0 rays wait to be traced, until a kernel ends or the shader has stalled for 1000 cycles; 22 "
          "traced ones wait for room in the intersection pool");
      EXPECT_EQ(due(), kNever) << "no ray that is there can move";
      bench.ledger.launched(0, RayKernel::CastSecondary, 1);
      bench.intersections.request(0, ImportKind::Normal);
    }
    if (cycle == 1012) {
      bench.intersections.request(0, ImportKind::Normal);
      EXPECT_EQ(due(), 2010u) << "there is room for one";
    }
    return cycle < 1013;
  });
}

TEST(StaticTraverser, AddsOneShadowRayACycleToThePictureAUnitsContributionFirst) {
  ChipConfiguration chip;
  chip.shading = Shading::Traverser;
  Bench bench(2, chip);
  bench.ledger.launched(1, RayKernel::Shade, 1);
  bench.ledger.imported(1, 400);
  std::vector<uint32_t> left;  // rays in the pool at the beginning of cycles 3, 4, ...
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) bench.fill(8, 1 | kShadowFlag);  // 4 reach the light
    if (cycle == 2) bench.traverser.kernel_ended(0);
    if (cycle == 3) bench.frame.take(1, {400, {}});
    if (cycle > 2) left.push_back(bench.rays.size());
    return cycle < 8;
  });
  EXPECT_EQ(left, (std::vector<uint32_t>{3, 3, 2, 1, 0, 0}));
  EXPECT_EQ(bench.picture.pixels, (std::vector<uint32_t>{0, 400, 2, 4, 6}));
  EXPECT_EQ(bench.intersections.size(ImportKind::Shadow), 0u);
  EXPECT_EQ(bench.ledger.held(), 0u);
  EXPECT_EQ(bench.traverser.counts().delivered, 4u);
}

}  // namespace
}  // namespace raypool::chip
