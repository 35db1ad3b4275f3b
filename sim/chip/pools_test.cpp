#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bits.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/simulation.hpp"
#include "chip/test_driver.hpp"

namespace raypool::chip {
namespace {

ChipConfiguration chip_of(int capacity) {
  ChipConfiguration chip;
  chip.ray_pool_size = chip.intersection_pool_size = capacity;
  return chip;
}

/// Both pools, and units that the test plays. Each unit casts pixels of a 64x64 image, its own columns.
struct Bench {
  Simulation simulation;
  ChipClock clock{"clock"};
  PixelLedger ledger;
  RayPool rays;
  IntersectionPool intersections;
  std::vector<uint32_t> next, beat;  // [unit] ray it exports, beat of it

  explicit Bench(uint32_t units, uint32_t capacity = 512, uint32_t depth = 5)
      : Bench(units, chip_of(capacity), depth) {}
  Bench(uint32_t units, const ChipConfiguration& chip, uint32_t depth)
      : ledger("pixel_ledger", units, 64, 64),
        rays("ray_pool", chip, depth),
        intersections("intersection_pool", chip),
        next(units),
        beat(units) {
    rays.clock(clock.now);
    rays.ledger(ledger.records);
    intersections.clock(clock.now);
    intersections.ledger(ledger.records);
    for (uint32_t unit = 0; unit < units; ++unit) {
      std::vector<uint32_t> pixels;
      for (uint32_t i = 0; i < 1024; ++i) pixels.push_back(pixel(unit, i));
      ledger.eye_launched(unit, std::move(pixels));
    }
  }
  static uint32_t pixel(uint32_t unit, uint32_t i) { return (unit * 16 + i % 16) | (i / 16 % 64) << 16; }
  static Ray eye_ray(uint32_t unit, uint32_t i) {
    Ray ray{};
    ray[word::kPixel] = pixel(unit, i);
    ray[word::kFlags] = 1;
    return ray;
  }
  const Ray& ray(size_t i) { return std::next(rays.rays().begin(), static_cast<std::ptrdiff_t>(i))->ray; }
  void run(std::function<bool(uint64_t)> cycle) { test::drive(simulation, clock, std::move(cycle)); }
  /// True if a beat of a ray is taken in this cycle.
  bool ready() const { return rays.beats_from() <= clock.cycle(); }
  /// True if a beat of an intersection arrives in this cycle.
  bool beat_of_intersection(Beat& data) {
    if (intersections.beat_due() > clock.cycle()) return false;
    intersections.beat(data);
    return true;
  }
  /// The device offers the unit's next beat in this cycle. True if a ray was completed.
  bool offer(uint32_t unit) {
    if (!ready()) {
      rays.want();
      return false;
    }
    const auto u = unit;
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
  for (uint32_t i = 0; i < 20; ++i) EXPECT_EQ(bench.ray(i), Bench::eye_ray(0, i));
}

TEST(RayPool, TakesOverheadAndBeatsAsLongAsTheChipSays) {
  for (const auto& [overhead, per_beat] : {std::pair{1, 1}, {2, 2}, {5, 3}}) {
    ChipConfiguration chip;
    chip.ray_pool_overhead = overhead;
    chip.ray_pool_cycles_per_beat = per_beat;
    Bench bench(1, chip, 5);
    const uint64_t service = overhead + 3 * per_beat;
    std::vector<uint64_t> completed;
    bench.run([&](uint64_t cycle) {
      if (cycle >= 10 && bench.offer(0)) completed.push_back(cycle);
      return completed.size() < 20;
    });
    for (size_t i = 0; i < completed.size(); ++i)
      EXPECT_EQ(completed[i], 10 + service * (i + 1) - per_beat) << overhead << per_beat;
    EXPECT_EQ(bench.rays.busy_cycles(), 20 * service);
    for (uint32_t i = 0; i < 20; ++i) EXPECT_EQ(bench.ray(i), Bench::eye_ray(0, i));
  }
}

TEST(RayPool, HidesTheOverheadBehindTheBeatsOfTheRayBeforeWhenPipelined) {
  for (const auto& [overhead, per_beat] : {std::pair{2, 1}, {1, 1}, {3, 1}, {5, 1}, {4, 2}}) {
    ChipConfiguration chip;
    chip.ray_pool_overhead = overhead;
    chip.ray_pool_cycles_per_beat = per_beat;
    chip.ray_pool_pipelined = true;
    Bench bench(1, chip, 5);
    const uint64_t service = std::max(overhead, 3 * per_beat);
    std::vector<uint64_t> completed;
    bench.run([&](uint64_t cycle) {
      const bool pause = completed.size() == 10 && cycle < 500;  // the eleventh comes to an idle port
      if (cycle >= 10 && !pause && bench.offer(0)) completed.push_back(cycle);
      return completed.size() < 20;
    });
    for (size_t i = 0; i < completed.size(); ++i) {
      const uint64_t begin = i < 10 ? 10 + overhead + service * i : 500 + service * (i - 10);
      EXPECT_EQ(completed[i], begin + 2 * per_beat) << overhead << per_beat << ", ray " << i;
    }
    EXPECT_EQ(bench.rays.busy_cycles(), overhead + 20 * service);
    for (uint32_t i = 0; i < 20; ++i) EXPECT_EQ(bench.ray(i), Bench::eye_ray(0, i));
  }
}

TEST(RayPool, FindsNoPlaceAheadWhileFull) {
  ChipConfiguration chip = chip_of(2);
  chip.ray_pool_pipelined = true;
  Bench bench(1, chip, 5);
  std::vector<uint64_t> completed;
  bench.run([&](uint64_t cycle) {
    if (bench.offer(0)) completed.push_back(cycle);
    if (cycle == 100) {
      EXPECT_TRUE(bench.rays.held_up());
      bench.rays.remove(bench.rays.rays().begin());
    }
    return cycle < 200;
  });
  EXPECT_EQ(completed, (std::vector<uint64_t>{1 + 4, 1 + 7, 104}));
}

TEST(RayPool, TakesARayOfAnyUnitInFiveCycles) {
  Bench bench(4);
  int completed = 0;
  bench.run([&](uint64_t cycle) {
    if (bench.offer(completed % 4)) {
      EXPECT_EQ(cycle, 1u + 4 + 5 * static_cast<uint32_t>(completed++));
    }
    return completed < 40;
  });
  ASSERT_EQ(bench.rays.size(), 40u);
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(bench.ray(i), Bench::eye_ray(i % 4, static_cast<uint32_t>(i / 4)));
  }
}

TEST(RayPool, TakesNothingWhileFull) {
  Bench bench(1, 8);
  int completed = 0;
  uint64_t resumed = 0;
  bench.run([&](uint64_t cycle) {
    if (bench.offer(0) && ++completed == 9) resumed = cycle;
    // The ray that fills the pool holds nobody up in its own cycle.
    if (completed < 8 || cycle == 1 + 4 + 5 * 7) {
      EXPECT_FALSE(bench.rays.held_up()) << cycle;
    }
    if (cycle == 100) {
      EXPECT_EQ(bench.rays.size(), 8u);
      EXPECT_TRUE(bench.rays.held_up());
      bench.rays.remove(bench.rays.rays().begin());
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
      if (!bench.ready()) {
        bench.rays.want();
      } else {
        Beat data;
        for (size_t i = 0; i < 4; ++i) data[i] = made[ray][number * 4 + i];
        const bool last = ++number == 3;
        const uint32_t before = bench.rays.size();
        bench.rays.take(0, data, last);
        EXPECT_EQ(bench.rays.size() - before, last && ray != 1 ? 1 : 0);
        if (last) number = 0, ++ray;
      }
    }
    return cycle < 50;
  });
  EXPECT_EQ(bench.rays.taken(), 4u);
  EXPECT_EQ(bench.rays.dropped_depth(), 1u);
  ASSERT_EQ(bench.rays.size(), 3u);
  EXPECT_EQ(bench.rays.shadow_rays(), 2u);
  EXPECT_EQ(bench.ray(1), made[2]);
}

// One after the other at an idle port: how many of them stay.
uint32_t kept_of(bool culling, const std::vector<std::array<float, 3>>& weights) {
  ChipConfiguration chip;
  chip.culling = culling;
  Bench bench(1, chip, 5);
  uint32_t ray = 0, number = 0;
  bench.run([&](uint64_t cycle) {
    if (ray == weights.size()) return false;
    if (!bench.ready()) {
      bench.rays.want();
      return cycle < 200;
    }
    Ray made = Bench::eye_ray(0, ray);
    for (size_t i = 0; i < 3; ++i) made[word::kColor + i] = as_bits(weights[ray][i]);
    Beat data;
    std::copy_n(&made[number * 4], 4, data.begin());
    bench.rays.take(0, data, number == 2);
    if (++number == 3) number = 0, ++ray;
    return cycle < 200;
  });
  EXPECT_EQ(bench.rays.taken(), weights.size());
  EXPECT_EQ(bench.rays.dropped_depth(), 0u);
  EXPECT_EQ(bench.ledger.rays_to_come(), 1024 - weights.size());  // whether they stay or not
  return bench.rays.size();
}

TEST(RayPool, DropsRaysWithoutWeightAndNoneWithTheLeastWeight) {
  const float least = std::numeric_limits<float>::denorm_min();
  const std::vector<std::array<float, 3>> black = {{0, 0, 0}, {0, -0.0f, 0}};
  const std::vector<std::array<float, 3>> others = {
      {least, 0, 0}, {0, 1, 0}, {0, 0, least}, {NAN, 0, 0}, {-least, 0, 0}};
  EXPECT_EQ(kept_of(true, black), 0u);
  EXPECT_EQ(kept_of(false, black), 2u);
  EXPECT_EQ(kept_of(true, others), 5u);
}

TEST(RayPool, RefusesARayOfAWrongNumberOfBeats) {
  Bench bench(1);
  EXPECT_THROW(bench.run([&](uint64_t) {
    if (!bench.ready()) {
      bench.rays.want();
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
    if (bench.beat_of_intersection(data)) {
      beats.push_back(cycle);
      words.insert(words.end(), data.begin(), data.end());
    }
    if (cycle >= 10 && taken.size() < 3) {
      if (bench.intersections.request(0, ImportKind::Shadow)) taken.push_back(cycle);
    }
    return cycle < 60;
  });
  EXPECT_EQ(taken, (std::vector<uint64_t>{11, 19, 27}));
  ASSERT_EQ(beats.size(), 18u);
  for (size_t i = 0; i < beats.size(); ++i) EXPECT_EQ(beats[i], 12 + i / 6 * 8 + i % 6);
  for (uint32_t p = 0; p < 3; ++p) {
    for (uint32_t i = 0; i < 24; ++i)
      EXPECT_EQ(words[p * 24 + i], i < kIntersectionWords ? numbered(p)[i] : 0) << p << " " << i;
  }
  EXPECT_EQ(bench.intersections.busy_cycles(), 24u);
}

TEST(IntersectionPool, TakesOverheadAndBeatsAsLongAsTheChipSays) {
  for (const auto& [overhead, per_beat] : {std::pair{1, 1}, {2, 2}, {5, 3}}) {
    ChipConfiguration chip;
    chip.intersection_pool_overhead = overhead;
    chip.intersection_pool_cycles_per_beat = per_beat;
    Bench bench(1, chip, 5);
    bench.ledger.launched(0, RayKernel::Shade, 3);
    const uint64_t service = overhead + 6 * per_beat, wait = std::max(1ul, overhead - 1ul);
    std::vector<uint64_t> taken, beats;
    std::vector<uint32_t> words;
    bench.run([&](uint64_t cycle) {
      for (uint32_t i = 0; cycle == 1 && i < 3; ++i) bench.intersections.put(ImportKind::Shadow, numbered(i));
      Beat data;
      if (bench.beat_of_intersection(data)) {
        beats.push_back(cycle);
        words.insert(words.end(), data.begin(), data.end());
      }
      if (cycle >= 10 && taken.size() < 3 && bench.intersections.request(0, ImportKind::Shadow)) taken.push_back(cycle);
      return cycle < 200;
    });
    EXPECT_EQ(taken, (std::vector<uint64_t>{10 + wait, 10 + wait + service, 10 + wait + 2 * service}));
    ASSERT_EQ(beats.size(), 18u);
    for (size_t i = 0; i < beats.size(); ++i)
      EXPECT_EQ(beats[i], taken[i / 6] + 1 + i % 6 * per_beat) << overhead << per_beat;
    for (uint32_t i = 0; i < 72; ++i)
      EXPECT_EQ(words[i], i % 24 < kIntersectionWords ? numbered(i / 24)[i % 24] : 0) << i;
    EXPECT_EQ(bench.intersections.busy_cycles(), 3 * service);
  }
}

TEST(IntersectionPool, HidesTheOverheadBehindTheBeatsBeforeWhenPipelined) {
  // A unit has two requests on their way at most, and sees a cycle later that one has come; several have more.
  for (const auto& [overhead, per_beat] : {std::pair{2, 1}, {1, 1}, {6, 1}, {9, 1}, {2, 2}, {13, 2}}) {
    for (const uint32_t most : {2u, 8u}) {
      ChipConfiguration chip;
      chip.intersection_pool_overhead = overhead;
      chip.intersection_pool_cycles_per_beat = per_beat;
      chip.intersection_pool_pipelined = true;
      Bench bench(1, chip, 5);
      constexpr uint32_t kPackages = 12;
      bench.ledger.launched(0, RayKernel::Shade, kPackages);
      const uint64_t service = std::max(overhead, 6 * per_beat), wait = std::max(1ul, overhead - 1ul);
      uint32_t taken = 0;
      std::vector<uint64_t> beats;
      std::vector<uint32_t> words;
      bench.run([&](uint64_t cycle) {
        for (uint32_t i = 0; cycle == 1 && i < kPackages; ++i) bench.intersections.put(ImportKind::Shadow, numbered(i));
        const auto come = static_cast<uint32_t>(beats.size() / 6);
        EXPECT_LE(taken - come, 2u) << "a register for the package that moves, and one for the next";
        const bool asks = cycle >= 10 && taken < kPackages && taken - come < most;
        if (asks && bench.intersections.request(0, ImportKind::Shadow)) ++taken;
        Beat data;
        if (bench.beat_of_intersection(data)) {
          beats.push_back(cycle);
          words.insert(words.end(), data.begin(), data.end());
        }
        return beats.size() < kPackages * 6;
      });
      for (size_t i = 0; i < beats.size(); ++i)
        EXPECT_EQ(beats[i], 11 + wait + i / 6 * service + i % 6 * per_beat) << overhead << per_beat << most << " " << i;
      for (uint32_t i = 0; i < words.size(); ++i)
        EXPECT_EQ(words[i], i % 24 < kIntersectionWords ? numbered(i / 24)[i % 24] : 0) << i;
      EXPECT_EQ(bench.intersections.busy_cycles(), kPackages * service);
    }
  }
}

TEST(IntersectionPool, GivesTheCompactRecordOfAPackage) {
  RecordLayout layout;
  layout.words = 14;
  layout.place.fill(RecordLayout::kAbsent);
  layout.place[word::kPixel] = word::kPixel;
  layout.place[word::kMaterial] = 13;
  layout.place[word::kDistance] = word::kLimit;
  Simulation simulation;
  ChipClock clock("clock");
  PixelLedger ledger("pixel_ledger", 1, 64, 64);
  IntersectionPool pool("intersection_pool", {}, layout);
  pool.clock(clock.now);
  pool.ledger(ledger.records);
  ledger.launched(0, RayKernel::CastSecondary, 2);
  std::vector<uint64_t> beats;
  std::vector<uint32_t> words;
  test::drive(simulation, clock, [&](uint64_t cycle) {
    for (uint32_t i = 1; cycle == 1 && i <= 2; ++i) pool.put(ImportKind::Normal, numbered(i));
    if (cycle >= 10 && pool.taken() < 2) pool.request(0, ImportKind::Normal);
    if (pool.beat_due() <= cycle) {
      Beat data;
      pool.beat(data);
      beats.push_back(cycle);
      words.insert(words.end(), data.begin(), data.end());
    }
    return cycle < 60;
  });
  EXPECT_EQ(beats, (std::vector<uint64_t>{12, 13, 14, 15, 18, 19, 20, 21}));
  ASSERT_EQ(words.size(), 32u);
  for (uint32_t i = 0; i < 32; ++i) {
    const uint32_t package = 100 * (1 + i / 16), word = i % 16;
    EXPECT_EQ(words[i], word == word::kLimit ? package + word::kDistance : word == 13 ? package + word::kMaterial : 0);
  }
  EXPECT_EQ(pool.busy_cycles(), 12u);
}

TEST(IntersectionPool, KeepsTheKindsApart) {
  Bench bench(4);
  const std::array<ImportKind, 4> kinds = {ImportKind::Normal, ImportKind::Shadow, ImportKind::Normal,
                                           ImportKind::Shadow};
  for (uint32_t unit = 0; unit < 4; ++unit) bench.ledger.launched(unit, RayKernel::Shade, 1000);
  uint32_t taken = 0, came = 0;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (uint32_t i = 0; i < 40; ++i)
        bench.intersections.put(i < 20 ? ImportKind::Normal : ImportKind::Shadow, numbered(i));
    }
    Beat data;
    if (bench.beat_of_intersection(data) && data[1] % 100 == 1) {
      EXPECT_EQ(data[1] / 100 < 20, kinds[came++ % 4] == ImportKind::Normal);
    }
    if (taken == 40) return came < 40;
    if (bench.intersections.request(taken % 4, kinds[taken % 4])) {
      EXPECT_EQ(cycle, 2 + 8 * uint64_t{taken++});
    }
    return true;
  });
  EXPECT_EQ(came, 40u);
  EXPECT_EQ(bench.intersections.size(ImportKind::Normal) + bench.intersections.size(ImportKind::Shadow), 0u);
}

TEST(IntersectionPool, LetsARequestWaitUntilItsKindComes) {
  Bench bench(1);
  bench.ledger.launched(0, RayKernel::Shade, 1);
  uint64_t taken = 0;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) bench.intersections.put(ImportKind::Shadow, numbered(0));
    if (cycle == 50) bench.intersections.put(ImportKind::Normal, numbered(1));
    if (taken == 0 && bench.intersections.request(0, ImportKind::Normal)) taken = cycle;
    return cycle < 100;
  });
  EXPECT_EQ(taken, 51u);
  EXPECT_EQ(bench.intersections.size(ImportKind::Shadow), 1u);
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
