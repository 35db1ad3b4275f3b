// The memory ALU with its data cache, in several sizes. mem_alu_bench.hpp checks every cycle; here are the situations.
#include "Vmem_alu_16x4.h"
#include "Vmem_alu_1x1.h"
#include "Vmem_alu_1x32.h"
#include "Vmem_alu_32x2.h"
#include "Vmem_alu_4x4.h"
#include "Vmem_alu_8x8.h"
#include "Vmem_alu_8x8_small.h"
#include "unit/compute/mem_alu_bench.hpp"

namespace raypool::bench {
namespace {

template <typename U, int kW, int kL, uint32_t kB, int kM, bool kI = false>
struct Model {
  using Unit = U;
  static constexpr int kWarps = kW, kLanes = kL, kMshrs = kM;
  static constexpr uint32_t kBytes = kB;
  static constexpr bool kSharing = kI;
};
using Model1x1 = Model<Vmem_alu_1x1, 1, 1, 512, 1>;
using Model4x4 = Model<Vmem_alu_4x4, 4, 4, 1024, 2>;
using Model8x8 = Model<Vmem_alu_8x8, 8, 8, 8192, 4>;
using Model8x8_small = Model<Vmem_alu_8x8_small, 8, 8, 512, 1, true>;
using Model1x32 = Model<Vmem_alu_1x32, 1, 32, 1024, 4>;
using Model16x4 = Model<Vmem_alu_16x4, 16, 4, 512, 16, true>;
using Model32x2 = Model<Vmem_alu_32x2, 32, 2, 512, 3>;
using Models = ::testing::Types<Model1x1, Model4x4, Model8x8, Model8x8_small, Model1x32, Model16x4, Model32x2>;

template <typename M>
class MemAlu : public ::testing::Test {
 public:
  using Bench = MemAluBench<M>;
  static constexpr uint32_t kWay = M::kBytes / 2;  ///< bytes between lines of one set

  /// Cycles of a task with n quadwords that hit.
  static uint64_t hit_cycles(uint64_t quads) { return 2 + std::max<uint64_t>(quads, 1); }

  /// Brings the lines of a task into the cache; false if they do not fit at one time.
  static bool warm(Bench& bench, const MemTask& task) {
    MemTask load = task;
    load.store = false;
    bench.run(load);
    const size_t reads = bench.memory.reads();
    bench.run(load);
    return bench.memory.reads() == reads;
  }

  struct Mix {
    uint32_t sets, lines;
    int store_percent, issue_percent;
    MemoryBehaviour memory;
    bool upper = false;  ///< upper address bits are set, too
  };
  /// What the bench has counted.
  struct Seen {
    uint64_t freed_while_chosen = 0, freed_wasted = 0;
  };
  static Seen run_random(uint32_t seed, int tasks, const Mix& mix) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Bench bench(seed);
    bench.memory.behaviour = mix.memory;
    const uint64_t bound =
        1000 + static_cast<uint64_t>(M::kWarps) * M::kLanes *
                   static_cast<uint64_t>(mix.memory.latency + mix.memory.jitter + mix.memory.gap + 40) * 100 /
                   static_cast<uint64_t>(mix.memory.beat_percent);
    for (int given = 0; given < tasks;) {
      const auto warp = static_cast<uint32_t>(bench.random() % M::kWarps);
      if (bench.ready() && !bench.flights[warp] && static_cast<int>(bench.random() % 100) < mix.issue_percent) {
        const MemTask task = bench.any_task(warp, mix.sets, mix.lines, mix.store_percent, mix.upper);
        bench.step(&task);
        ++given;
      } else {
        bench.step();
      }
      for (const auto& flight : bench.flights)
        if (flight && bench.cycle - flight->start >= bound)
          throw std::runtime_error("starved or hung, cycle " + std::to_string(bench.cycle));
    }
    bench.drain();
    EXPECT_EQ(bench.hits + bench.misses, bench.expected_loads);
    EXPECT_EQ(bench.stores, bench.expected_stores);
    EXPECT_EQ(bench.writes_at_port, bench.expected_stores);
    EXPECT_EQ(bench.faults, 0u);
    return {bench.freed_while_chosen, bench.freed_wasted};
  }
};
TYPED_TEST_SUITE(MemAlu, Models);

// What needs three miss-status holding registers: two have both ways of a set, and a third one is freed.
template <typename M>
class MemAluOfThreeMisses : public MemAlu<M> {};
using ModelsOfThreeMisses = ::testing::Types<Model8x8, Model16x4, Model32x2>;
TYPED_TEST_SUITE(MemAluOfThreeMisses, ModelsOfThreeMisses);

// What needs a second warp.
template <typename M>
class MemAluOfSeveralWarps : public MemAlu<M> {};
using ModelsOfSeveralWarps = ::testing::Types<Model4x4, Model8x8, Model8x8_small, Model16x4, Model32x2>;
TYPED_TEST_SUITE(MemAluOfSeveralWarps, ModelsOfSeveralWarps);

template <typename M>
class MemAluThatInvalidates : public MemAlu<M> {
 public:
  using Bench = typename MemAlu<M>::Bench;
};
using ModelsThatInvalidate = ::testing::Types<Model8x8_small, Model16x4>;
TYPED_TEST_SUITE(MemAluThatInvalidates, ModelsThatInvalidate);

TYPED_TEST(MemAlu, EmptyMaskCompletesInThreeCycles) {
  typename TestFixture::Bench bench;
  for (bool store : {false, true}) {
    MemTask task = bench.strided(0, store, 3, 5);  // misaligned, which no lane sees
    task.mask = 0;
    EXPECT_EQ(bench.run(task).cycles, 3u);
  }
  EXPECT_EQ(bench.memory.reads() + bench.writes_at_port + bench.faults + bench.hits + bench.misses, 0u);
}

TYPED_TEST(MemAlu, OneQuadwordACycle) {
  typename TestFixture::Bench bench;
  int measured = 0;
  for (uint32_t stride : {0u, 4u, 8u, 16u, 20u, 64u}) {
    for (bool store : {false, true}) {
      const MemTask task = bench.strided(0, store, 16, stride);
      if (!this->warm(bench, task)) continue;
      EXPECT_EQ(bench.run(task).cycles, this->hit_cycles(bench.quads_of(task).size()))
          << "stride " << stride << " store " << store;
      ++measured;
    }
  }
  EXPECT_GE(measured, 6);
}

TYPED_TEST(MemAlu, TasksOfSeveralWarpsKeepThePipelineFull) {
  constexpr int kWarps = TypeParam::kWarps;
  typename TestFixture::Bench bench;
  for (bool store : {false, true}) {
    const MemTask sample = bench.strided(0, store, 0, 4);
    ASSERT_TRUE(this->warm(bench, sample));
    const size_t quads = bench.quads_of(sample).size();
    if (kWarps < 4 * static_cast<int>(quads)) continue;  // too few warps to hide the depth
    const uint64_t begin = bench.cycle;
    constexpr int kTasks = 64;
    for (int given = 0, warp = 0; given < kTasks; ++given, warp = (warp + 1) % kWarps) {
      while (!bench.ready() || bench.flights[warp]) bench.step();
      const MemTask task = bench.strided(static_cast<uint32_t>(warp), store, 0, 4);
      bench.step(&task);
    }
    while (bench.busy()) bench.step();
    // The last one is done in its cycle 2 + n. Tasks that must queue may leave one idle cycle for every two.
    EXPECT_GE(bench.cycle - begin, kTasks * quads + 3) << "store " << store;
    EXPECT_LE(bench.cycle - begin, kTasks * quads + 3 + (quads > 1 ? kTasks / 2 : 0)) << "store " << store;
    bench.drain();
  }
}

TYPED_TEST(MemAlu, StoresOfScatteredLanesLeaveEveryCycle) {
  typename TestFixture::Bench bench;
  const MemTask task = bench.strided(0, true, 0, 64);  // nothing cached
  EXPECT_EQ(bench.run(task).cycles, this->hit_cycles(TypeParam::kLanes));
  EXPECT_EQ(bench.memory.reads(), 0u) << "a store must not allocate";
}

TYPED_TEST(MemAluOfSeveralWarps, HitsGoOnUnderMissesOfOtherWarps) {
  typename TestFixture::Bench bench;
  const MemTask near = bench.strided(1, false, 0, 4);
  ASSERT_TRUE(this->warm(bench, near));
  bench.memory.behaviour.silent = true;
  const MemTask far = bench.strided(0, false, 2048 + 64, 64);
  bench.give(far);
  for (int i = 0; i < 3 * TypeParam::kLanes + 10; ++i) bench.step();
  ASSERT_GT(bench.memory.pending(), 0u);
  bench.give(near);
  for (int i = 0; i < 50 && bench.flights[1]; ++i) bench.step();
  ASSERT_FALSE(bench.flights[1]);
  EXPECT_EQ(bench.results[1].cycles, this->hit_cycles(bench.quads_of(near).size()));
  EXPECT_TRUE(bench.flights[0]);
  bench.memory.behaviour.silent = false;
  bench.drain();
}

TYPED_TEST(MemAlu, OneFetchServesAllWarpsAndLanesOfALine) {
  typename TestFixture::Bench bench;
  bench.memory.behaviour.latency = 200;
  uint64_t quads = 0;
  for (uint32_t warp = 0; warp < TypeParam::kWarps; ++warp) {
    MemTask task = bench.strided(warp, false, 0, 4);
    for (auto& address : task.address) address %= 64;
    quads += bench.quads_of(task).size();
    bench.give(task);
  }
  bench.drain();
  EXPECT_EQ(bench.memory.reads(), 1u);
  EXPECT_EQ(bench.hits, 0u);
  EXPECT_EQ(bench.misses, quads);
}

TYPED_TEST(MemAlu, MissesOfAWarpAreFetchedTogether) {
  typename TestFixture::Bench bench;
  bench.memory.behaviour.silent = true;
  bench.give(bench.strided(0, false, 0, 64));
  for (int i = 0; i < 100; ++i) bench.step();
  EXPECT_EQ(bench.memory.pending(), static_cast<size_t>(std::min(TypeParam::kLanes, TypeParam::kMshrs)));
  bench.memory.behaviour.silent = false;
  bench.drain();
}

TYPED_TEST(MemAlu, ReplacesTheLeastRecentlyUsedLine) {
  typename TestFixture::Bench bench(7);
  // A reference of one access at a time: two lines a set, the most recently used first.
  std::map<uint32_t, std::deque<uint32_t>> sets;
  for (int i = 0; i < 600; ++i) {
    const auto set = static_cast<uint32_t>(bench.random() % 4);
    const uint32_t address = set * 64 + static_cast<uint32_t>(bench.random() % 4) * this->kWay;
    const bool store = bench.random() % 4 == 0;
    auto& lines = sets[set];
    const auto place = std::find(lines.begin(), lines.end(), address);
    const bool cached = place != lines.end();
    if (cached) lines.erase(place);
    if (cached || !store) lines.push_front(address);
    if (lines.size() > 2) lines.pop_back();
    const size_t reads = bench.memory.reads();
    bench.run(bench.strided(0, store, address, 0));
    ASSERT_EQ(bench.memory.reads() - reads, !cached && !store ? 1u : 0u) << "access " << i;
  }
}

TYPED_TEST(MemAlu, StoreUpdatesACachedLine) {
  typename TestFixture::Bench bench;
  bench.run(bench.strided(0, false, 32, 0));
  const size_t reads = bench.memory.reads();
  const MemTask store = bench.strided(0, true, 32, 0);
  bench.run(store);
  EXPECT_EQ(bench.run(bench.strided(0, false, 32, 0)).data[0], store.data.back());
  EXPECT_EQ(bench.memory.reads(), reads);
  EXPECT_EQ(bench.memory.word(32), store.data.back()) << "the highest lane wins";
}

TYPED_TEST(MemAluOfSeveralWarps, StoreWaitsForThePendingFetchOfItsLine) {
  typename TestFixture::Bench bench;
  bench.memory.behaviour.silent = true;
  bench.give(bench.strided(0, false, 0, 0));
  bench.give(bench.strided(1, true, 4, 0));
  for (int i = 0; i < 100; ++i) bench.step();
  EXPECT_TRUE(bench.flights[1]);
  EXPECT_EQ(bench.stores, 0u);
  bench.memory.behaviour.silent = false;
  bench.drain();
  EXPECT_EQ(bench.stores, 1u);
}

TYPED_TEST(MemAlu, IllegalAddressesOfActiveLanesFault) {
  constexpr int kLanes = TypeParam::kLanes;
  for (bool store : {false, true}) {
    for (int lane : {0, kLanes - 1}) {
      for (int kind = 0; kind < 4; ++kind) {
        typename TestFixture::Bench bench;
        const uint32_t limit = 512;
        bench.set_limit(limit);
        const auto warp = static_cast<uint32_t>(TypeParam::kWarps - 1);
        MemTask task = bench.strided(warp, store, 0, 4);
        const uint32_t illegal[] = {17, limit, 0xfffffffcu, limit + 2};
        task.address[lane] = illegal[kind];
        task.immediate = 0xfffff000u;
        bench.give(task);
        for (int i = 0; i < 30; ++i) bench.step();
        EXPECT_EQ(bench.faults, 1u);
        EXPECT_EQ(bench.fault_code, kind == 0 || kind == 3 ? 5u : 6u);
        EXPECT_EQ(bench.fault_warp, warp);
        EXPECT_EQ(bench.memory.reads() + bench.stores, 0u) << "accessed before the fault";
        EXPECT_TRUE(bench.idle());

        task.mask &= ~(1u << lane);  // now no lane asks for it
        bench.give(task);
        bench.drain();
        EXPECT_EQ(bench.faults, 1u);
        task.address[lane] = limit - 4;  // the last word
        task.mask |= 1u << lane;
        bench.run(task);
        EXPECT_EQ(bench.faults, 1u);
      }
    }
  }
}

TYPED_TEST(MemAlu, InvalidateForgetsEverything) {
  typename TestFixture::Bench bench;
  for (int i = 0; i < 3; ++i) {
    const MemTask load = bench.strided(0, false, 64 * static_cast<uint32_t>(i), 4);
    bench.run(load);
    bench.poke(load.address[0], 0xabcd0000u + static_cast<uint32_t>(i));
    bench.invalidate = true;
    bench.step();
    EXPECT_EQ(bench.run(load).data[0], 0xabcd0000u + static_cast<uint32_t>(i));
  }
}

TYPED_TEST(MemAluThatInvalidates, LoadBehindAnInvalReadsTheMemory) {
  typename TestFixture::Bench bench;
  const MemTask load = bench.strided(0, false, 0, 4), other = bench.strided(0, false, 64, 4);
  MemTask inval = load;
  inval.inval = true;
  for (uint32_t i = 0; i < 3; ++i) {
    bench.run(load);
    bench.run(other);
    bench.poke(load.address[0], 0xabcd0000u + i);
    EXPECT_EQ(bench.run(inval).cycles, this->hit_cycles(TestFixture::Bench::quads_of(inval).size()));
    const size_t reads = bench.memory.reads();
    EXPECT_EQ(bench.run(load).data[0], 0xabcd0000u + i);
    bench.run(other);
    EXPECT_EQ(bench.memory.reads(), reads + 1) << "the other line was forgotten too";
  }
  EXPECT_EQ(bench.writes_at_port, 0u);
}

// The way of a line that was removed is filled first, so that the other line of the set stays.
TYPED_TEST(MemAluThatInvalidates, RemovedLineIsReplacedFirst) {
  typename TestFixture::Bench bench;
  const MemTask first = bench.strided(0, false, 0, 0), second = bench.strided(0, false, this->kWay, 0);
  for (const MemTask& removed : {first, second}) {
    const MemTask& stays = removed.address == first.address ? second : first;
    bench.run(stays);
    bench.run(removed);
    MemTask inval = removed;
    inval.inval = true;
    bench.run(inval);
    bench.run(bench.strided(0, false, 2 * this->kWay, 0));
    const size_t reads = bench.memory.reads();
    bench.run(stays);
    EXPECT_EQ(bench.memory.reads(), reads);
  }
}

// Each warp has a line of its own, in sets where all others thrash. Another unit stores there, then the warp reads it.
TYPED_TEST(MemAluThatInvalidates, WarpsSeeWhatAnotherUnitStores) {
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    typename TestFixture::Bench bench(seed, TypeParam::kBytes * 32);
    bench.memory.behaviour.latency = 1 + static_cast<int>(seed);
    bench.memory.behaviour.jitter = seed % 2 == 0 ? 20 : 0;
    const auto own = [&](uint32_t warp) {
      return bench.strided(warp, false, (16 + warp) * this->kWay + 64 * (warp % 2), 4);
    };
    std::vector<bool> forgotten(TypeParam::kWarps);
    for (int given = 0; given < 3000;) {
      const auto warp = static_cast<uint32_t>(bench.random() % TypeParam::kWarps);
      if (!bench.ready() || bench.flights[warp]) {
        bench.step();
        continue;
      }
      MemTask task = own(warp);
      if (forgotten[warp]) {
        forgotten[warp] = false;  // and this load must find the new words
      } else if (bench.random() % 2 == 0) {
        for (const uint32_t address : task.address) bench.poke(address, static_cast<uint32_t>(bench.random()));
        task.inval = forgotten[warp] = true;
      } else {
        task = bench.any_task(warp, 2, 3, 30);
      }
      bench.step(&task);
      ++given;
    }
    bench.drain();
  }
}

TYPED_TEST(MemAlu, RandomTasksOfAllWarps) {
  MemoryBehaviour fast;
  fast.latency = 1;
  MemoryBehaviour slow;
  slow.latency = 30;
  slow.jitter = 40;
  slow.ready_percent = 40;
  slow.beat_percent = 60;
  slow.out_of_order = true;
  MemoryBehaviour stuck = fast;
  stuck.ready_percent = 10;
  const int tasks = TypeParam::kLanes > 8 ? 400 : 2000;
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    this->run_random(seed, tasks, {1, 4, 30, 100, fast});  // one set, all thrash
    this->run_random(seed + 10, tasks, {4, 3, 30, 100, slow});
    this->run_random(seed + 20, tasks, {2, 2, 10, 50, slow});    // mostly hits
    this->run_random(seed + 30, tasks, {4, 4, 60, 100, stuck});  // stores against a slow port
    this->run_random(seed + 40, tasks, {4, 8, 5, 100, fast});    // mostly misses
    this->run_random(seed + 50, tasks, {2, 2, 30, 100, slow, true});
    this->run_random(seed + 60, tasks, {1, 2, 30, 100, fast, true});
  }
}

// Lines of one set or a few, of which there are more than ways and registers, and which come back one at a time.
TYPED_TEST(MemAluOfThreeMisses, RegistersAreFreedWhileLosersWaitForAWayOfTheirSet) {
  uint64_t chosen = 0, wasted = 0;
  const int tasks = 12000 / TypeParam::kLanes;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    for (const uint32_t sets : {1u, 2u, 3u}) {
      for (const int gap : {1, 12, 40}) {
        MemoryBehaviour memory;
        memory.latency = 3;
        memory.gap = gap;
        const auto seen = this->run_random(100 * seed + sets, tasks, {sets, 6, 5, 100, memory, seed % 2 == 0});
        chosen += seen.freed_while_chosen;
        wasted += seen.freed_wasted;
      }
    }
  }
  EXPECT_GT(chosen, 100u) << "no register was freed in the cycle in which the privileged loser was chosen";
  EXPECT_GT(wasted, 10u) << "then no other registers had both ways of the loser's set";
}

// Each bit of an address, in the bank that is accessed, in what waits for it and at the port.
TYPED_TEST(MemAlu, DistinguishesLinesByEveryBitOfTheirAddress) {
  for (uint32_t bit = lowest(this->kWay); bit < 32; ++bit) {
    for (const bool other_first : {false, true}) {  // so that the pair goes into either way
      typename TestFixture::Bench bench;
      if (other_first) bench.run(bench.strided(0, false, 32 | 1u << (bit == 31 ? 30 : 31), 0));
      for (const uint32_t address : {32u, 32u | 1u << bit, 32u}) {
        bench.run(bench.strided(0, false, address, 0));
        bench.run(bench.strided(0, true, address, 0));
        bench.run(bench.strided(0, false, address, 0));
      }
    }
  }
}

TYPED_TEST(MemAlu, EveryBitOfAnAddressCountsAtTheLimit) {
  for (uint32_t bit = 9; bit < 32; ++bit) {
    typename TestFixture::Bench bench;
    bench.set_limit(1u << bit);
    MemTask task = bench.strided(0, false, 0, 0);
    task.address.back() = 1u << bit;
    bench.give(task);
    for (int i = 0; i < 30; ++i) bench.step();
    EXPECT_EQ(bench.faults, 1u) << "bit " << bit;
    EXPECT_EQ(bench.fault_code, 6u) << "bit " << bit;
    task.address.back() = (1u << bit) - 4;
    bench.run(task);
    EXPECT_EQ(bench.faults, 1u) << "bit " << bit;
  }
}

TYPED_TEST(MemAlu, NoWarpStarvesAmongThrashingOnes) {
  typename TestFixture::Bench bench(3);
  bench.memory.behaviour.latency = 5;
  std::vector<int> done(TypeParam::kWarps, 0);
  for (int i = 0; i < 20000; ++i) {
    const auto warp = static_cast<uint32_t>(bench.random() % TypeParam::kWarps);
    if (bench.ready() && !bench.flights[warp]) {
      MemTask task = bench.strided(warp, false, warp * this->kWay, 0);
      for (int lane = 0; lane < TypeParam::kLanes; ++lane)
        task.address[lane] = (warp * 8 + static_cast<uint32_t>(bench.random() % 8)) * this->kWay % bench.memory.bytes();
      bench.step(&task);
      ++done[warp];
    } else {
      bench.step();
    }
  }
  const auto [least, most] = std::minmax_element(done.begin(), done.end());
  EXPECT_GE(*least * 3, *most * 2) << "one set, equal demands: warps must get equal shares";
  bench.drain();
  this->RecordProperty("longest_cycles", static_cast<int>(bench.longest));
}

}  // namespace
}  // namespace raypool::bench
