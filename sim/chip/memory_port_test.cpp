#include "chip/memory_port.hpp"

#include <gtest/gtest.h>

#include "chip/simulation.hpp"
#include "chip/test_driver.hpp"

namespace raypool::chip {
namespace {

struct Bench {
  Simulation simulation;
  ChipClock clock{"clock"};
  Memory memory{65536};
  MemoryPort port;

  explicit Bench(int units) : port("memory_port", clock, memory, units) {
    for (uint32_t i = 0; i < memory.size(); i += 4) memory.store(i, i * 2654435761u);
  }
  void run(std::function<bool(uint64_t)> cycle) {
    test::Driver driver("driver", clock, std::move(cycle));
    simulation.run();
    clock.rethrow();
  }
};

MemoryRequest read_of(uint32_t address, uint8_t id = 0) { return {false, address, {}, 0, id}; }

TEST(MemoryPort, GivesALineInFourBeatsThatEndAfter120Cycles) {
  Bench bench(1);
  std::vector<uint64_t> beats;
  bench.run([&](uint64_t cycle) {
    if (cycle == 10) bench.port.request(0, read_of(128, 5));
    MemoryResponse response;
    if (bench.port.response(0, response)) {
      EXPECT_EQ(response.id, 5);
      EXPECT_EQ(response.beat, beats.size());
      for (uint32_t i = 0; i < 4; ++i) EXPECT_EQ(response.data[i], bench.memory.load(128 + response.beat * 16 + i * 4));
      beats.push_back(cycle - 10);
    }
    return cycle < 300;
  });
  EXPECT_EQ(beats, (std::vector<uint64_t>{114, 116, 118, 120}));
  EXPECT_EQ(bench.port.reads(), 1u);
  EXPECT_EQ(bench.port.busy_cycles(), 8u);
  EXPECT_TRUE(bench.port.quiet(0));
}

TEST(MemoryPort, MovesEightGigabytesASecond) {
  for (const int units : {1, 4}) {
    Bench bench(units);
    uint64_t first = 0, last = 0;
    int beats = 0, asked = 0;
    bench.run([&](uint64_t cycle) {
      for (int unit = 0; unit < units; ++unit) {
        if (asked < 100 && bench.port.ready(unit)) {
          bench.port.request(unit, read_of(64u * static_cast<uint32_t>(asked++)));
        }
        MemoryResponse response;
        if (bench.port.response(unit, response)) {
          if (beats++ == 0) first = cycle;
          last = cycle;
        }
      }
      return cycle < 2000;
    });
    EXPECT_EQ(beats, 400);
    EXPECT_EQ(last - first + 2, 100u * 64 / 8) << units << " units";
  }
}

TEST(MemoryPort, TakesTwoCyclesForAWrite) {
  Bench bench(1);
  uint64_t beat = 0;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (int i = 0; i < 3; ++i) bench.port.request(0, {true, 0, {1, 2, 3, 4}, 15, 0});
      bench.port.request(0, read_of(64));
    }
    MemoryResponse response;
    if (bench.port.response(0, response) && response.beat == 3) beat = cycle;
    return cycle < 200;
  });
  EXPECT_EQ(beat, 1u + 3 * 2 + 120);
  EXPECT_EQ(bench.port.writes(), 3u);
}

TEST(MemoryPort, LetsAReadSeeEveryEarlierWriteAndNoLaterOne) {
  Bench bench(1);
  const uint32_t before = bench.memory.load(68);
  Beat seen{};
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.port.request(0, {true, 64, {11, 12, 13, 14}, 0b1101, 0});
      bench.port.request(0, read_of(64));
      bench.port.request(0, {true, 64, {21, 22, 23, 24}, 15, 0});
    }
    MemoryResponse response;
    if (bench.port.response(0, response) && response.beat == 0) seen = response.data;
    return cycle < 200;
  });
  EXPECT_EQ(seen, (Beat{11, before, 13, 14}));
  EXPECT_EQ(bench.memory.load(64), 21u);
}

TEST(MemoryPort, HoldsEightWaitingRequestsOfAUnit) {
  Bench bench(2);
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (size_t i = 0; i < kMemoryQueue; ++i) {
        EXPECT_TRUE(bench.port.ready(0));
        bench.port.request(0, read_of(0));
      }
      EXPECT_FALSE(bench.port.ready(0));
      EXPECT_TRUE(bench.port.ready(1));
    }
    // One is served in cycle 1, the next in cycle 9.
    if (cycle == 2) {
      EXPECT_TRUE(bench.port.ready(0));
      bench.port.request(0, read_of(0));
    }
    EXPECT_EQ(bench.port.ready(0), cycle < 1 || cycle >= 10) << cycle;
    return cycle < 12;
  });
}

TEST(MemoryPort, ServesUnitsInTurn) {
  Bench bench(4);
  std::array<int, 4> lines{};
  bench.run([&](uint64_t cycle) {
    for (int unit = 0; unit < 4; ++unit) {
      // Unit 0 asks as much as it can, the others one line at a time.
      if (unit == 0 ? bench.port.ready(0) : bench.port.quiet(unit)) bench.port.request(unit, read_of(0));
      MemoryResponse response;
      if (bench.port.response(unit, response) && response.beat == 3) ++lines[static_cast<size_t>(unit)];
    }
    return cycle < 4000;
  });
  for (int unit = 1; unit < 4; ++unit) EXPECT_GE(lines[static_cast<size_t>(unit)], 4000 / (120 + 4 * 8)) << unit;
}

}  // namespace
}  // namespace raypool::chip
