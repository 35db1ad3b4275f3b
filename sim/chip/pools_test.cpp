#include <gtest/gtest.h>

#include "chip/intersection_pool.hpp"
#include "chip/ray_pool.hpp"
#include "chip/simulation.hpp"
#include "chip/test_driver.hpp"

namespace raypool::chip {
namespace {

/// Both pools, and units that the test plays. Each unit casts pixels of a 64x64 image, its own columns.
struct Bench {
  Simulation simulation;
  ChipClock clock{"clock"};
  PixelLedger ledger;
  RayPool rays;
  IntersectionPool intersections;
  std::vector<uint32_t> next, beat;  // [unit] ray it exports, beat of it

  explicit Bench(int units, int capacity = 512, int depth = 5)
      : ledger(units, 64, 64),
        rays("ray_pool", clock, ledger, units, capacity, depth),
        intersections("intersection_pool", clock, ledger, units, capacity),
        next(static_cast<size_t>(units)),
        beat(static_cast<size_t>(units)) {
    for (int unit = 0; unit < units; ++unit) {
      std::vector<uint32_t> pixels;
      for (uint32_t i = 0; i < 1024; ++i) pixels.push_back(pixel(unit, i));
      ledger.eye_launched(unit, std::move(pixels));
    }
  }
  static uint32_t pixel(int unit, uint32_t i) { return (static_cast<uint32_t>(unit) * 16 + i % 16) | (i / 16 % 64) << 16; }
  static Ray eye_ray(int unit, uint32_t i) {
    Ray ray{};
    ray[word::kPixel] = pixel(unit, i);
    ray[word::kFlags] = 1;
    return ray;
  }
  void run(std::function<bool(uint64_t)> cycle) {
    test::Driver driver("driver", clock, std::move(cycle));
    simulation.run();
    clock.rethrow();
  }
  /// The unit offers its next beat in this cycle. True if a ray was completed.
  bool offer(int unit) {
    if (!rays.ready(unit)) {
      rays.want(unit);
      return false;
    }
    const auto u = static_cast<size_t>(unit);
    const Ray ray = eye_ray(unit, next[u]);
    Beat data;
    for (size_t i = 0; i < 4; ++i) data[i] = ray[beat[u] * 4 + i];
    const bool last = ++beat[u] == 3;
    rays.take(unit, data, last);
    if (last) {
      beat[u] = 0;
      ++next[u];
    }
    return last;
  }
};

TEST(RayPool, TakesARayInFiveCycles) {
  Bench bench(1);
  std::vector<uint64_t> completed;
  bench.run([&](uint64_t cycle) {
    if (cycle >= 10 && bench.offer(0)) completed.push_back(cycle);
    return completed.size() < 20;
  });
  for (size_t i = 0; i < completed.size(); ++i) EXPECT_EQ(completed[i], 10 + 4 + 5 * i);
  EXPECT_EQ(bench.rays.size(), 20u);
  EXPECT_EQ(bench.rays.busy_cycles(), 100u);
  for (uint32_t i = 0; i < 20; ++i) EXPECT_EQ(bench.rays.rays()[i].ray, Bench::eye_ray(0, i));
}

TEST(RayPool, SharesItsPortAmongTheUnits) {
  Bench bench(4);
  std::vector<int> order;
  bench.run([&](uint64_t cycle) {
    for (int unit = 0; unit < 4; ++unit) {
      if (bench.offer(unit)) {
        order.push_back(unit);
        EXPECT_EQ(cycle, 1 + 4 + 5 * (order.size() - 1));
      }
    }
    return order.size() < 40;
  });
  for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], static_cast<int>(i % 4));
}

TEST(RayPool, TakesNothingWhileFull) {
  Bench bench(2, 8);
  int completed = 0;
  uint64_t resumed = 0;
  bench.run([&](uint64_t cycle) {
    for (int unit = 0; unit < 2; ++unit) {
      const bool full_before = bench.rays.full();
      if (bench.offer(unit) && ++completed == 9) resumed = cycle;
      // The ray that fills the pool holds nobody up in its own cycle, whichever unit is asked first.
      EXPECT_FALSE(!full_before && bench.rays.held_up(1 - unit));
    }
    if (cycle == 100) {
      EXPECT_EQ(bench.rays.size(), 8u);
      EXPECT_TRUE(bench.rays.held_up(0));
      EXPECT_TRUE(bench.rays.held_up(1));
      bench.rays.rays().erase(bench.rays.rays().begin());
      bench.rays.removed(0);
    }
    return cycle < 200;
  });
  EXPECT_EQ(completed, 9);
  EXPECT_EQ(resumed, 104u);
  EXPECT_EQ(bench.rays.fill().peak(), 8u);
}

TEST(RayPool, DropsNormalRaysBeyondTheDepthLimitAndNoShadowRays) {
  Bench bench(1, 512, 2);
  bench.ledger.kernel_ended(0);
  bench.ledger.launched(0, RayKernel::CastSecondary, 4);
  for (int i = 0; i < 4; ++i) bench.ledger.imported(0, 5);
  std::vector<Ray> made;
  for (const uint32_t flags : {2u, 3u, 2u | kShadowFlag, 3u | kShadowFlag}) {
    Ray ray{};
    ray[word::kPixel] = 5;
    ray[word::kFlags] = flags;
    made.push_back(ray);
  }
  uint32_t ray = 0, number = 0;
  bench.run([&](uint64_t cycle) {
    if (ray < made.size()) {
      if (!bench.rays.ready(0)) {
        bench.rays.want(0);
      } else {
        Beat data;
        for (size_t i = 0; i < 4; ++i) data[i] = made[ray][number * 4 + i];
        const bool last = ++number == 3;
        EXPECT_EQ(bench.rays.take(0, data, last), last && ray != 1);
        if (last) number = 0, ++ray;
      }
    }
    return cycle < 50;
  });
  EXPECT_EQ(bench.rays.taken(), 4u);
  EXPECT_EQ(bench.rays.dropped_depth(), 1u);
  ASSERT_EQ(bench.rays.size(), 3u);
  EXPECT_EQ(bench.rays.shadow_rays(), 2u);
  EXPECT_EQ(bench.rays.rays()[1].ray, made[2]);
}

TEST(RayPool, RefusesARayOfAWrongNumberOfBeats) {
  Bench bench(1);
  EXPECT_THROW(bench.run([&](uint64_t) {
    if (!bench.rays.ready(0)) {
      bench.rays.want(0);
    } else {
      bench.rays.take(0, Beat{}, true);
    }
    return true;
  }),
               std::runtime_error);
}

Intersection numbered(uint32_t number) {
  Intersection package{};
  for (uint32_t i = 0; i < kIntersectionWords; ++i) package[i] = number * 100 + i;
  package[word::kPixel] = 0;
  return package;
}

TEST(IntersectionPool, GivesAPackageInEightCycles) {
  Bench bench(1);
  bench.ledger.launched(0, RayKernel::Shade, 3);
  std::vector<uint64_t> taken, beats;
  std::vector<uint32_t> words;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (uint32_t i = 0; i < 3; ++i) bench.intersections.put(ImportKind::Shadow, numbered(i));
      bench.intersections.reserve(ImportKind::Shadow, 3);
      EXPECT_EQ(bench.intersections.available(ImportKind::Shadow), 0u);
    }
    Beat data;
    if (bench.intersections.beat(0, data)) {
      beats.push_back(cycle);
      words.insert(words.end(), data.begin(), data.end());
    }
    if (cycle >= 10 && taken.size() < 3) {
      if (bench.intersections.ready(0)) {
        taken.push_back(cycle);
      } else {
        bench.intersections.want(0, ImportKind::Shadow);
      }
    }
    return cycle < 60;
  });
  EXPECT_EQ(taken, (std::vector<uint64_t>{11, 19, 27}));
  ASSERT_EQ(beats.size(), 18u);
  for (size_t i = 0; i < beats.size(); ++i) EXPECT_EQ(beats[i], 12 + i / 6 * 8 + i % 6);
  for (uint32_t p = 0; p < 3; ++p) {
    for (uint32_t i = 0; i < 24; ++i) EXPECT_EQ(words[p * 24 + i], i < kIntersectionWords ? numbered(p)[i] : 0) << p << " " << i;
  }
  EXPECT_EQ(bench.intersections.busy_cycles(), 24u);
}

TEST(IntersectionPool, SharesItsPortAndKeepsTheKindsApart) {
  Bench bench(4);
  std::vector<int> order;
  std::vector<ImportKind> kinds = {ImportKind::Normal, ImportKind::Shadow, ImportKind::Normal, ImportKind::Shadow};
  for (int unit = 0; unit < 4; ++unit) bench.ledger.launched(unit, RayKernel::Shade, 1000);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (uint32_t i = 0; i < 40; ++i) bench.intersections.put(i < 20 ? ImportKind::Normal : ImportKind::Shadow, numbered(i));
    }
    for (int unit = 0; unit < 4; ++unit) {
      Beat data;
      if (bench.intersections.beat(unit, data) && data[1] % 100 == 1) {
        EXPECT_EQ(data[1] / 100 < 20, kinds[static_cast<size_t>(unit)] == ImportKind::Normal);
      }
      if (bench.intersections.ready(unit)) {
        order.push_back(unit);
        EXPECT_EQ(cycle, 2 + 8 * (order.size() - 1));
      } else {
        bench.intersections.want(unit, kinds[static_cast<size_t>(unit)]);
      }
    }
    return order.size() < 40;
  });
  for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], static_cast<int>(i % 4));
  EXPECT_EQ(bench.intersections.size(ImportKind::Normal) + bench.intersections.size(ImportKind::Shadow), 0u);
}

TEST(IntersectionPool, LetsAUnitWithoutPackagesWaitAndServesTheOthers) {
  Bench bench(2);
  int given = 0;
  bench.ledger.launched(1, RayKernel::Shade, 8);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (uint32_t i = 0; i < 8; ++i) bench.intersections.put(ImportKind::Shadow, numbered(i));
    }
    EXPECT_FALSE(bench.intersections.ready(0));
    bench.intersections.want(0, ImportKind::Normal);
    if (bench.intersections.ready(1)) {
      ++given;
    } else {
      bench.intersections.want(1, ImportKind::Shadow);
    }
    return cycle < 100;
  });
  EXPECT_EQ(given, 8);
}

TEST(LevelStatistics, WeighsLevelsByTime) {
  LevelStatistics level;
  level.set(10, 4);
  level.set(20, 8);
  level.set(30, 0);
  EXPECT_EQ(level.peak(), 8u);
  EXPECT_DOUBLE_EQ(level.mean(60), (10 * 4 + 10 * 8) / 60.0);
}

}  // namespace
}  // namespace raypool::chip
