#include "chip/memory_port.hpp"

#include <gtest/gtest.h>

#include "chip/fixed_latency_memory.hpp"
#include "chip/simulation.hpp"
#include "chip/test_driver.hpp"

namespace raypool::chip {
namespace {

struct Bench {
  Simulation simulation;
  ChipClock clock{"clock"};
  Memory memory{65536};
  MemoryPort port;
  FixedLatencyMemory target;

  explicit Bench(const ChipConfiguration& chip = {})
      : port("memory_port", chip), target("memory", memory, chip.memory_latency) {
    port.clock(clock.now);
    port.socket.bind(target.socket);
    for (uint32_t i = 0; i < memory.size(); i += 4) memory.store(i, i * 2654435761u);
  }
  bool ready() const { return port.room_from() <= clock.cycle(); }
  /// True if a beat arrives in this cycle.
  bool response(MemoryResponse& response) {
    if (port.response_due() > clock.cycle()) return false;
    port.response(response);
    return true;
  }
  void run(std::function<bool(uint64_t)> cycle) { test::drive(simulation, clock, std::move(cycle)); }
};

MemoryRequest read_of(uint32_t address, uint8_t id = 0) { return {false, address, {}, 0, id}; }

TEST(MemoryPort, GivesALineInFourBeatsThatEndAfter120Cycles) {
  Bench bench;
  std::vector<uint64_t> beats;
  bench.run([&](uint64_t cycle) {
    if (cycle == 10) bench.port.request(read_of(128, 5));
    MemoryResponse response;
    if (bench.response(response)) {
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

TEST(MemoryPort, TakesLatencyBeatsAndQueueAsTheChipSays) {
  ChipConfiguration chip;
  chip.memory_latency = 40;
  chip.memory_cycles_per_beat = 3;
  chip.memory_queue = 2;
  Bench bench(chip);
  std::vector<uint64_t> beats;
  bench.run([&](uint64_t cycle) {
    if (cycle == 10) {
      bench.port.request(read_of(128));
      EXPECT_TRUE(bench.ready());
      bench.port.request(read_of(192));
      EXPECT_FALSE(bench.ready());
    }
    EXPECT_TRUE(cycle != 11 || bench.ready()) << "the first is served in cycle 10";
    MemoryResponse response;
    if (bench.response(response)) beats.push_back(cycle - 10);
    return cycle < 100;
  });
  EXPECT_EQ(beats, (std::vector<uint64_t>{31, 34, 37, 40, 43, 46, 49, 52}));
  EXPECT_EQ(bench.port.busy_cycles(), 24u);
}

TEST(MemoryPort, MovesEightGigabytesASecond) {
  Bench bench;
  uint64_t first = 0, last = 0;
  int beats = 0, asked = 0;
  bench.run([&](uint64_t cycle) {
    if (asked < 100 && bench.ready()) bench.port.request(read_of(64u * static_cast<uint32_t>(asked++)));
    MemoryResponse response;
    if (bench.response(response)) {
      if (beats++ == 0) first = cycle;
      last = cycle;
    }
    return cycle < 2000;
  });
  EXPECT_EQ(beats, 400);
  EXPECT_EQ(last - first + 2, 100u * 64 / 8);
}

TEST(MemoryPort, TakesTwoCyclesForAWrite) {
  Bench bench;
  uint64_t beat = 0;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (int i = 0; i < 3; ++i) bench.port.request({true, 0, {1, 2, 3, 4}, 15, 0});
      bench.port.request(read_of(64));
    }
    MemoryResponse response;
    if (bench.response(response) && response.beat == 3) beat = cycle;
    return cycle < 200;
  });
  EXPECT_EQ(beat, 1u + 3 * 2 + 120);
  EXPECT_EQ(bench.port.writes(), 3u);
}

TEST(MemoryPort, LetsAReadSeeEveryEarlierWriteAndNoLaterOne) {
  Bench bench;
  const uint32_t before = bench.memory.load(68);
  Beat seen{};
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.port.request({true, 64, {11, 12, 13, 14}, 0b1101, 0});
      bench.port.request(read_of(64));
      bench.port.request({true, 64, {21, 22, 23, 24}, 15, 0});
    }
    MemoryResponse response;
    if (bench.response(response) && response.beat == 0) seen = response.data;
    return cycle < 200;
  });
  EXPECT_EQ(seen, (Beat{11, before, 13, 14}));
  EXPECT_EQ(bench.memory.load(64), 21u);
}

TEST(MemoryPort, HoldsEightWaitingRequests) {
  Bench bench;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      for (int i = 0; i < 8; ++i) {
        EXPECT_TRUE(bench.ready());
        bench.port.request(read_of(0));
      }
      EXPECT_FALSE(bench.ready());
    }
    // One is served in cycle 1, the next in cycle 9.
    if (cycle == 2) {
      EXPECT_TRUE(bench.ready());
      bench.port.request(read_of(0));
    }
    EXPECT_EQ(bench.ready(), cycle < 1 || cycle >= 10) << cycle;
    return cycle < 12;
  });
}

TEST(MemoryPort, KnowsOfEachUnitWhetherSomethingIsUnderWay) {
  Bench bench;
  bench.run([&](uint64_t cycle) {
    if (cycle == 1) {
      bench.port.request(read_of(0, 3));
      bench.port.request({true, 64, {1, 2, 3, 4}, 15, 2 << 5});
      bench.port.request(read_of(128, 1 | 3 << 5));
    }
    MemoryResponse response;
    const bool came = bench.response(response);
    if (came) {
      EXPECT_EQ(response.id, cycle > 121 ? 1 | 3 << 5 : 3) << cycle;
    }
    // Served in cycles 1, 9 and 11.
    EXPECT_EQ(bench.port.quiet(0), cycle < 1 || cycle >= 121) << cycle;
    EXPECT_TRUE(bench.port.quiet(1));
    EXPECT_EQ(bench.port.quiet(2), cycle < 1 || cycle >= 10) << cycle;
    EXPECT_EQ(bench.port.quiet(3), cycle < 1 || cycle >= 131) << cycle;
    return cycle < 200;
  });
}

}  // namespace
}  // namespace raypool::chip
