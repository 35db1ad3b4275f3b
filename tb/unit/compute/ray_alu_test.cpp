// The promises of rtl/compute/rp_ray_alu.v (docs/machine/ray-alu.md), for narrow and wide warps. RayAluBench checks
// most of them in every cycle of every test.
#include <gtest/gtest.h>

#include "Vray_alu_1x1.h"
#include "Vray_alu_1x32.h"
#include "Vray_alu_1x32_wide.h"
#include "Vray_alu_2x2.h"
#include "Vray_alu_2x2_12words.h"
#include "Vray_alu_2x8_18words_wide.h"
#include "Vray_alu_2x8_wide.h"
#include "Vray_alu_32x1.h"
#include "Vray_alu_4x4.h"
#include "Vray_alu_8x8.h"
#include "Vray_alu_8x8_16words.h"
#include "unit/compute/ray_alu_bench.hpp"

namespace raypool::bench {
namespace {

template <typename U, uint32_t W, uint32_t L, bool Wide = false, uint32_t Words = 21>
struct RayModel {
  using Unit = U;
  static constexpr uint32_t kWarps = W, kLanes = L, kWords = Words;
  static constexpr bool kWide = Wide;  ///< rld and rst move all lanes a cycle
};
using Models =
    ::testing::Types<RayModel<Vray_alu_1x1, 1, 1>, RayModel<Vray_alu_2x2, 2, 2>, RayModel<Vray_alu_1x32, 1, 32>,
                     RayModel<Vray_alu_4x4, 4, 4>, RayModel<Vray_alu_8x8, 8, 8>, RayModel<Vray_alu_32x1, 32, 1>,
                     RayModel<Vray_alu_2x8_wide, 2, 8, true>, RayModel<Vray_alu_1x32_wide, 1, 32, true>,
                     RayModel<Vray_alu_2x2_12words, 2, 2, false, 12>, RayModel<Vray_alu_8x8_16words, 8, 8, false, 16>,
                     RayModel<Vray_alu_2x8_18words_wide, 2, 8, true, 18>>;
struct ModelName {
  template <typename Model>
  static std::string GetName(int) {
    return std::to_string(Model::kWarps) + "x" + std::to_string(Model::kLanes) +
           (Model::kWords < 21 ? "_" + std::to_string(Model::kWords) + "words" : "") + (Model::kWide ? "_wide" : "");
  }
};

template <typename Model>
class RayAlu : public ::testing::Test {
 public:
  using Driver = RayAluBench<Model>;

  static RayTask task(uint32_t warp, RayOp op, uint32_t word = 0, uint32_t mask = Driver::kAllLanes) {
    return {warp, op, word, mask, {}};
  }
  /// rst of a value that names warp, word and lane.
  static RayTask store(uint32_t warp, uint32_t word, uint32_t mask = Driver::kAllLanes) {
    RayTask result{warp, RayOp::Rst, word, mask, {}};
    for (uint32_t lane = 0; lane < Driver::kLanes; ++lane)
      result.data.push_back(warp << 16 | word << 8 | lane | 0x5a000000u);
    return result;
  }
  /// Stores words 0 .. 11 of a warp.
  static void fill(Driver& bench, uint32_t warp) {
    for (uint32_t word = 0; word < 12; ++word) bench.run(store(warp, word));
  }
};
TYPED_TEST_SUITE(RayAlu, Models, ModelName);

// What needs a second warp.
template <typename Model>
class RayAluOfSeveralWarps : public RayAlu<Model> {};
using ModelsOfSeveralWarps =
    ::testing::Types<RayModel<Vray_alu_2x2, 2, 2>, RayModel<Vray_alu_4x4, 4, 4>, RayModel<Vray_alu_8x8, 8, 8>,
                     RayModel<Vray_alu_32x1, 32, 1>, RayModel<Vray_alu_2x8_wide, 2, 8, true>>;
TYPED_TEST_SUITE(RayAluOfSeveralWarps, ModelsOfSeveralWarps, ModelName);

struct RandomLaunch {
  uint32_t kind, threads;
};

template <typename Bench>
std::vector<RandomLaunch> random_launches(Bench& bench, uint32_t count) {
  std::vector<RandomLaunch> launches;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t threads = bench.roll(50) ? Bench::kContents : 1 + bench.below(Bench::kContents);
    launches.push_back({bench.roll(85) ? 1 + bench.below(2) : 0, threads});
  }
  return launches;
}

template <typename Bench>
void make_random(Bench& bench, RayTask& task) {
  const uint32_t kind = bench.below(100);
  task.op = kind < 45 ? RayOp::Rld : kind < 80 ? RayOp::Rst : kind < 90 ? RayOp::Rout : RayOp::Rfb;
  task.word = bench.below(Bench::kWords);
  const uint32_t shape = bench.below(10);
  if (shape == 0) task.mask = 0;
  if (shape > 3) task.mask &= static_cast<uint32_t>(bench.random());
  for (uint32_t lane = 0; lane < Bench::kLanes; ++lane) task.data.push_back(static_cast<uint32_t>(bench.random()));
}

// Tasks at random for every warp over several launches, the next launch's import
// overlapping, with pools of the given speeds.
template <typename Model>
RayCounts random_run(uint32_t seed, PoolOdds odds, uint32_t task_percent, uint32_t launches) {
  using Bench = RayAluBench<Model>;
  Bench bench(seed);
  bench.odds = odds;
  const std::vector<RandomLaunch> kernels = random_launches(bench, launches);
  struct Warp {
    uint32_t kernel = 0, before = 0, after = 0;  ///< tasks left before and after rin
    bool imported = false;
  };
  std::vector<Warp> warps(Bench::kWarps);
  uint32_t started = 0;
  const auto begin = [&](Warp& warp) {
    warp = {warp.kernel, bench.roll(50) ? 0 : bench.below(4), bench.below(20), false};
  };
  for (Warp& warp : warps) begin(warp);

  // The warp's next task, if it has one.
  const auto choose = [&](uint32_t number, RayTask& task) {
    Warp& warp = warps[number];
    while (warp.kernel < launches) {
      const RandomLaunch& kernel = kernels[warp.kernel];
      const bool imports = kernel.kind != 0 && number * Bench::kLanes < kernel.threads;
      task = {number, RayOp::Rin, 0, Bench::kAllLanes, {}};
      if (warp.before == 0 && imports && !warp.imported) {
        warp.imported = true;
        return true;
      }
      if (warp.before > 0 || warp.after > 0) {
        --(warp.before > 0 ? warp.before : warp.after);
        make_random(bench, task);
        return true;
      }
      ++warp.kernel;
      begin(warp);
    }
    return false;
  };
  const auto work_left = [&] {
    for (const Warp& warp : warps)
      if (warp.kernel < launches) return true;
    return started < launches || bench.busy();
  };
  while (work_left()) {
    if (started < launches && !bench.import_active() && bench.roll(20)) {
      if (kernels[started].kind != 0) bench.start_import(kernels[started].kind, kernels[started].threads);
      ++started;
    }
    RayTask task;
    bool found = false;
    if (bench.ready() && bench.roll(task_percent)) {
      const uint32_t first = bench.below(Bench::kWarps);
      for (uint32_t i = 0; i < Bench::kWarps && !found; ++i) {
        const uint32_t warp = (first + i) % Bench::kWarps;
        found = !bench.in_flight(warp) && choose(warp, task);
      }
    }
    bench.step(found ? &task : nullptr);
  }
  bench.drain();
  return bench.counts;
}

TYPED_TEST(RayAlu, RandomTasksAndPoolsGiveWhatTheModelGives) {
  const PoolOdds all_odds[] = {{100, 100, 100, 100}, {50, 70, 60, 60},  {100, 100, 10, 10},
                               {20, 20, 100, 100},   {90, 100, 30, 90}, {100, 40, 90, 15}};
  RayCounts sum;
  uint32_t seed = 1;
  for (const PoolOdds& odds : all_odds) {
    for (const uint32_t task_percent : {100u, 100u, 30u}) {
      const RayCounts counts = random_run<TypeParam>(seed++, odds, task_percent, 60);
      sum.reads += counts.reads;
      sum.writes += counts.writes;
      sum.packages += counts.packages;
      sum.rays += counts.rays;
      sum.contributions += counts.contributions;
      sum.waited_in += counts.waited_in;
      sum.waited_out += counts.waited_out;
      sum.words_checked += counts.words_checked;
    }
  }
  EXPECT_GT(sum.reads, 2500u);
  EXPECT_GT(sum.writes, 2000u);
  EXPECT_GT(sum.packages, 500u);
  EXPECT_GT(sum.rays, 200u);
  EXPECT_GT(sum.contributions, 200u);
  EXPECT_GT(sum.waited_in, 100u);
  EXPECT_GT(sum.waited_out, 50u);
  EXPECT_GT(sum.words_checked, 10000u);
}

TYPED_TEST(RayAlu, AnUndisturbedAccessTakesItsPortCyclesAndOne) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(1);
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
    for (uint32_t word = 0; word < Bench::kWords; ++word) {
      bench.run(this->store(warp, word));
      EXPECT_EQ(bench.duration[warp], Bench::kAccessCycles);
    }
  }
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
    for (uint32_t word = 0; word < Bench::kWords; ++word) {
      bench.run(this->task(warp, RayOp::Rld, word));
      EXPECT_EQ(bench.duration[warp], Bench::kAccessCycles);
    }
  }
  EXPECT_EQ(bench.counts.words_checked, uint64_t{2} * Bench::kWords * Bench::kContents);
}

TYPED_TEST(RayAlu, AccessesOfDifferentWarpsFollowEachOtherWithoutAGap) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(2);
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) bench.run(this->store(warp, 3));
  while (!bench.ready()) bench.step();
  const uint64_t begin = bench.cycle;
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
    const RayTask read = this->task(warp, RayOp::Rld, 3);
    while (!bench.ready()) bench.step();
    bench.step(&read);
  }
  while (bench.busy()) bench.step();
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) EXPECT_EQ(bench.duration[warp], Bench::kAccessCycles);
  EXPECT_EQ(bench.cycle - begin, Bench::kWarps * Bench::kSteps + 2);
}

TYPED_TEST(RayAlu, AStoreWritesTheMaskedLanesOnly) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(3);
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
    for (const uint32_t word : {0u, 9u, Bench::kWords - 1}) bench.run(this->store(warp, word));
  }
  for (uint32_t mask = 0; mask < 16; ++mask) {
    const uint32_t warp = mask % Bench::kWarps, wide = mask * 0x11111111u & Bench::kAllLanes,
                   word = mask % 2 == 0 ? 9 : Bench::kWords - 1;
    RayTask store = this->store(warp, word, wide);
    for (uint32_t& value : store.data) value += 0x01000000u * (mask + 1);
    bench.run(store);
    for (uint32_t other = 0; other < Bench::kWarps; ++other) {
      bench.run(this->task(other, RayOp::Rld, 0, 0));
      bench.run(this->task(other, RayOp::Rld, word, 0));
    }
  }
}

TYPED_TEST(RayAlu, EachPackageReachesItsThread) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(4);
  for (uint32_t launch = 0; launch < 4; ++launch) {
    const uint32_t threads = launch == 1 ? (Bench::kContents + 1) / 2 : Bench::kContents;
    bench.start_import(1 + launch % 2, threads);
    bench.step();
    for (uint32_t warp = 0; warp * Bench::kLanes < threads; ++warp) {
      bench.run(this->task(warp, RayOp::Rin));
      for (uint32_t word = 0; word < Bench::kWords; ++word) {
        bench.run(this->task(warp, RayOp::Rld, word));
        for (uint32_t lane = 0; lane < Bench::kLanes && warp * Bench::kLanes + lane < threads; ++lane) {
          ASSERT_EQ(bench.read_data[warp][lane], Bench::package_word(launch, warp * Bench::kLanes + lane, word));
        }
      }
    }
  }
}

TYPED_TEST(RayAlu, TheNextImportWaitsForTheSliceOnly) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(5);
  bench.start_import(1, Bench::kContents);
  bench.step();
  while (bench.import_active()) bench.step();
  bench.start_import(2, Bench::kContents);
  for (int i = 0; i < 100; ++i) bench.step();
  EXPECT_EQ(bench.counts.packages, Bench::kContents);  // all input slices are full
  for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
    bench.run(this->task(warp, RayOp::Rin));
    EXPECT_EQ(bench.duration[warp], Bench::kSwapCycles);
    for (uint32_t i = 0; i < Bench::kBeats * Bench::kLanes + 20; ++i) bench.step();
    EXPECT_EQ(bench.counts.packages, Bench::kContents + (warp + 1) * Bench::kLanes);
  }
  EXPECT_FALSE(bench.import_active());
}

TYPED_TEST(RayAlu, AFastPoolIsKeptBusyByTheImport) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(6);
  bench.start_import(1, Bench::kContents);
  const uint64_t begin = bench.cycle;
  bench.step();
  while (bench.import_active()) bench.step();
  EXPECT_EQ(bench.cycle - begin, Bench::kBeats * Bench::kContents + 3);  // start, valid, taken, then a beat every cycle
}

TYPED_TEST(RayAlu, AnImportOfKindNoneImportsNothing) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(7);
  bench.start_import(0, Bench::kContents);
  for (int i = 0; i < 50; ++i) bench.step();
  EXPECT_EQ(bench.counts.packages, 0u);
}

TYPED_TEST(RayAlu, AFastPortGetsABeatEveryCycle) {
  using Bench = RayAluBench<TypeParam>;
  for (const RayOp op : {RayOp::Rout, RayOp::Rfb}) {
    Bench bench(8);
    for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) this->fill(bench, warp);
    for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
      const RayTask out = this->task(warp, op);
      while (!bench.ready()) bench.step();
      bench.step(&out);
    }
    bench.drain();
    ASSERT_EQ(bench.beat_cycles.size(), Bench::kContents * (op == RayOp::Rout ? 3 : 1));
    EXPECT_EQ(bench.beat_cycles.back() - bench.beat_cycles.front() + 1, bench.beat_cycles.size());
  }
}

TYPED_TEST(RayAlu, TheFirstBeatIsOfferedFourCyclesAfterDone) {
  using Bench = RayAluBench<TypeParam>;
  for (const RayOp op : {RayOp::Rout, RayOp::Rfb}) {
    Bench bench(13);
    this->fill(bench, 0);
    bench.run(this->task(0, op));
    const uint64_t done = bench.cycle - 1;
    bench.drain();
    EXPECT_EQ(bench.beat_cycles.front() - done, 4u);
  }
}

TYPED_TEST(RayAlu, AnOutputMayBeFilledWhileTheOneBeforeLeaves) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(9);
  bench.odds.rays = bench.odds.frame = 0;
  this->fill(bench, 0);
  bench.run(this->task(0, RayOp::Rout));
  EXPECT_EQ(bench.duration[0], Bench::kSwapCycles);
  // The lower words first: a second rout must not touch what the port has not taken yet.
  this->fill(bench, 0);
  const RayTask second = this->task(0, RayOp::Rfb);
  bench.step(&second);
  for (int i = 0; i < 200; ++i) bench.step();
  EXPECT_EQ(bench.in_flight(0), Bench::kLanes > 1);  // a single ray fits the beats that wait
  bench.odds.rays = bench.odds.frame = 100;
  bench.drain();
  EXPECT_EQ(bench.counts.rays, Bench::kLanes);
  EXPECT_EQ(bench.counts.contributions, Bench::kLanes);
}

TYPED_TEST(RayAlu, AnEmptyMaskExportsNothingAndFreesAtOnce) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(10);
  bench.odds.rays = bench.odds.frame = 0;
  for (const RayOp op : {RayOp::Rout, RayOp::Rfb, RayOp::Rout}) {
    bench.run(this->task(0, op, 0, 0));
    EXPECT_EQ(bench.duration[0], Bench::kSwapCycles);
  }
  bench.drain();
  EXPECT_TRUE(bench.beat_cycles.empty());
}

// What a controller that sees a kernel's end may rely on: the kernel's warps have seen the done of their exports.
TYPED_TEST(RayAlu, PackagesAreCountedAsTheyAreAskedForAndBeforeTheirDone) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(14);
  uint32_t asked = 0;
  for (const RayOp op : {RayOp::Rout, RayOp::Rfb}) {
    for (const uint32_t mask : {Bench::kAllLanes, 1u, 0u, 1u << (Bench::kLanes - 1)}) {
      for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
        const RayTask out = this->task(warp, op, 0, mask);
        while (!bench.ready()) bench.step();
        bench.step(&out);
        asked += static_cast<uint32_t>(__builtin_popcount(mask));
        EXPECT_EQ(bench.exports(), asked);
        EXPECT_TRUE(bench.in_flight(warp));
        while (bench.in_flight(warp)) bench.step();
      }
    }
  }
  bench.drain();
  EXPECT_EQ(bench.counts.rays + bench.counts.contributions, asked);
}

TYPED_TEST(RayAlu, TheCountOfExportsWrapsAfter65535) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(15);
  uint64_t asked = 0;
  while (asked < 66000) {
    for (uint32_t warp = 0; warp < Bench::kWarps; ++warp) {
      const RayTask out = this->task(warp, RayOp::Rfb);
      while (!bench.ready() || bench.in_flight(warp)) bench.step();
      bench.step(&out);
      asked += Bench::kLanes;
    }
  }
  bench.drain();
  EXPECT_EQ(bench.counts.contributions, asked);
  EXPECT_EQ(bench.exports(), asked - 65536);
}

TYPED_TEST(RayAluOfSeveralWarps, AWarpThatWaitsDoesNotBlockOthers) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(11);
  bench.odds.rays = 0;
  const uint32_t last = Bench::kWarps - 1;
  const RayTask in = this->task(0, RayOp::Rin);
  while (!bench.ready()) bench.step();
  bench.step(&in);
  for (int i = 0; i < 2; ++i) {
    for (uint32_t word = 0; word < Bench::kWords; ++word) bench.run(this->store(last, word));
    for (uint32_t word = 0; word < Bench::kWords; ++word) {
      bench.run(this->task(last, RayOp::Rld, word));
      EXPECT_EQ(bench.duration[last], Bench::kAccessCycles);
    }
    if (i == 0) bench.run(this->task(last, RayOp::Rout));
  }
  EXPECT_TRUE(bench.in_flight(0));
  bench.odds.rays = 100;
  bench.start_import(2, 1);
  bench.drain();
  EXPECT_FALSE(bench.in_flight(0));
}

TYPED_TEST(RayAlu, AWordThatAnIntersectionHasNotIsAFaultAndNothingElse) {
  using Bench = RayAluBench<TypeParam>;
  Bench bench(12);
  const uint32_t warp = Bench::kWarps - 1;
  for (uint32_t word = 0; word < Bench::kWords; ++word) bench.run(this->store(warp, word));
  uint64_t faults = 0;
  for (uint32_t word = Bench::kWords; word < 32; ++word) {
    for (const RayOp op : {RayOp::Rst, RayOp::Rld}) {
      RayTask bad = this->store(warp, word);
      bad.op = op;
      while (!bench.ready()) bench.step();
      bench.step(&bad);
      for (int i = 0; i < 20; ++i) bench.step();
      EXPECT_TRUE(bench.in_flight(warp));  // dropped, never done
      EXPECT_EQ(bench.faults, ++faults);
      EXPECT_EQ(bench.fault_warp, warp);
      bench.forget(warp);
    }
  }
  for (uint32_t word = 0; word < Bench::kWords; ++word) bench.run(this->task(warp, RayOp::Rld, word));
}

}  // namespace
}  // namespace raypool::bench
