// What port_arbiter, import_arbiter and block_scheduler promise, under random traffic: nothing is lost, mixed up or
// changed while it waits, and nobody starves.
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <random>
#include <vector>

#include "Vblock_scheduler_2.h"
#include "Vblock_scheduler_4.h"
#include "Vimport_arbiter_2.h"
#include "Vimport_arbiter_4.h"
#include "Vport_arbiter_2.h"
#include "Vport_arbiter_4.h"

namespace raypool::bench {
namespace {

template <typename Unit>
class Clocked {
 public:
  explicit Clocked(uint32_t seed) : random(seed) {
    u.clk_i = 0;
    u.rst_ni = 0;
    clock();
    clock();
    u.rst_ni = 1;
  }
  ~Clocked() { u.final(); }
  void clock() {
    u.eval();
    u.clk_i = 1;
    u.eval();
    u.clk_i = 0;
  }
  bool one_of(uint32_t n) { return random() % n == 0; }

  Unit u;
  std::mt19937 random;
};

struct Port2 {
  using Unit = Vport_arbiter_2;
  static constexpr uint32_t kCount = 2;
};
struct Port4 {
  using Unit = Vport_arbiter_4;
  static constexpr uint32_t kCount = 4;
};

template <typename Model>
class PortArbiter : public testing::Test {};
using Ports = testing::Types<Port2, Port4>;
TYPED_TEST_SUITE(PortArbiter, Ports);

// A requester sends packages of 1 to 3 words, {requester, number of the word}, with gaps
// between the words of a package too.
struct Requester {
  uint32_t sent = 0;  // words
  int left = 0;       // words of its package
  int gap = 0;
  int waited = 0;  // packages of others that ended while this one asked and had nothing of its own begun
  bool begun = false;
};

TYPED_TEST(PortArbiter, KeepsPackagesTogetherInTurnAndLosesNothing) {
  constexpr uint32_t kCount = TypeParam::kCount;
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Clocked<typename TypeParam::Unit> bench(seed);
    auto& u = bench.u;
    std::array<Requester, kCount> requesters;
    std::array<uint32_t, kCount> received{};
    int owner = -1;      // of the package under way at the port
    bool waits = false;  // what was offered in the last cycle was not taken
    uint32_t offered = 0, number = 0, packages = 0;
    for (int cycle = 0; cycle < 6000; ++cycle) {
      const bool crowded = cycle > 3000;  // everybody always
      uint32_t valid = 0, last = 0;
      uint64_t data = 0;
      for (uint32_t r = 0; r < kCount; ++r) {
        Requester& requester = requesters[r];
        if (requester.left == 0 && (crowded || bench.one_of(6)))
          requester.left = 1 + static_cast<int>(bench.random() % 3);
        if (requester.gap > 0) --requester.gap;
        if (requester.left == 0 || requester.gap > 0) continue;
        valid |= 1u << r;
        last |= uint32_t{requester.left == 1} << r;
        data |= uint64_t{r << 14 | (requester.sent & 0x3fff)} << 16 * r;
      }
      u.valid_i = valid;
      u.last_i = last;
      u.data_i = data;
      // Valid does not depend on ready.
      u.ready_i = 0;
      u.eval();
      const bool shown = u.valid_o;
      ASSERT_EQ(u.ready_o, 0u);
      u.ready_i = crowded || !bench.one_of(3);
      u.eval();
      ASSERT_EQ(u.valid_o, shown);
      if (waits) {
        ASSERT_TRUE(u.valid_o) << "what waits was withdrawn";
        ASSERT_EQ(u.data_o, offered) << "what waits was changed";
        ASSERT_EQ(u.number_o, number);
      }
      if (owner < 0) {
        ASSERT_EQ(u.valid_o, valid != 0);
      }
      waits = u.valid_o && !u.ready_i;
      offered = u.data_o;
      number = u.number_o;
      if (u.valid_o) {
        ASSERT_TRUE(valid >> number & 1);
        ASSERT_EQ(offered >> 14, number);
        if (owner >= 0) {
          ASSERT_EQ(number, static_cast<uint32_t>(owner)) << "two packages are mixed";
        }
        owner = static_cast<int>(number);
        requesters[number].begun = true;
      }
      ASSERT_EQ(u.ready_o & valid, u.valid_o && u.ready_i ? 1u << number : 0u);
      if (u.valid_o && u.ready_i) {
        Requester& requester = requesters[number];
        ASSERT_EQ(offered & 0x3fff, received[number]++ & 0x3fff) << "a word is lost or doubled";
        ++requester.sent;
        if (--requester.left == 0) {
          owner = -1;
          ++packages;
          requester.begun = false;
          requester.waited = 0;
          for (uint32_t r = 0; r < kCount; ++r) {
            if (r != number && (valid >> r & 1) != 0 && !requesters[r].begun) {
              ASSERT_LT(++requesters[r].waited, static_cast<int>(kCount)) << "requester " << r << " starves";
            }
          }
        }
        if (!crowded && bench.one_of(4)) requester.gap = 1 + static_cast<int>(bench.random() % 3);
      }
      bench.clock();
    }
    EXPECT_GT(packages, 1500u);
    for (uint32_t r = 0; r < kCount; ++r) EXPECT_GT(received[r], 1000u / kCount) << r;
  }
}

struct Import2 {
  using Unit = Vimport_arbiter_2;
  static constexpr uint32_t kUnits = 2;
};
struct Import4 {
  using Unit = Vimport_arbiter_4;
  static constexpr uint32_t kUnits = 4;
};

template <typename Model>
class ImportArbiter : public testing::Test {};
using Imports = testing::Types<Import2, Import4>;
TYPED_TEST_SUITE(ImportArbiter, Imports);

TYPED_TEST(ImportArbiter, GivesEveryPackageToTheUnitThatAsked) {
  constexpr uint32_t kUnits = TypeParam::kUnits;
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Clocked<typename TypeParam::Unit> bench(seed);
    auto& u = bench.u;
    std::array<uint32_t, kUnits> kind{};  // 0: asks for nothing
    std::array<uint32_t, kUnits> asked{}, beats{};
    std::deque<uint32_t> expected;  // units, in the order of their requests
    uint32_t beat = 0;
    size_t most = 0;
    for (int cycle = 0; cycle < 6000; ++cycle) {
      const uint32_t hurry = cycle < 3000 ? 6 : 1;
      uint32_t valid = 0, kinds = 0;
      for (uint32_t r = 0; r < kUnits; ++r) {
        if (kind[r] == 0 && bench.one_of(hurry)) kind[r] = 1 + bench.random() % 2;
        valid |= uint32_t{kind[r] != 0} << r;
        kinds |= kind[r] << 2 * r;
      }
      u.unit_request_valid_i = valid;
      u.unit_request_kind_i = kinds;
      u.request_ready_i = bench.one_of(2);
      const bool arrives = !expected.empty() && !bench.one_of(4);
      u.beat_valid_i = arrives;
      u.eval();
      ASSERT_EQ(u.unit_beat_valid_o, arrives ? 1u << expected.front() : 0u) << "cycle " << cycle;
      const bool transfer = u.request_valid_o && u.request_ready_i;
      ASSERT_EQ(u.unit_request_ready_o & valid, transfer ? 1u << u.request_unit_o : 0u);
      if (arrives) {
        ++beats[expected.front()];
        if (++beat == 6) {
          beat = 0;
          expected.pop_front();
        }
      }
      if (u.request_valid_o) {
        ASSERT_EQ(u.request_kind_o, kind[u.request_unit_o]);
      }
      if (transfer) {
        expected.push_back(u.request_unit_o);
        ++asked[u.request_unit_o];
        kind[u.request_unit_o] = 0;
      }
      most = std::max(most, expected.size());
      bench.clock();
    }
    EXPECT_EQ(most, 3u);
    const uint32_t fewest = *std::min_element(asked.begin(), asked.end());
    for (uint32_t r = 0; r < kUnits; ++r) {
      EXPECT_LE(asked[r], fewest + fewest / 4) << "unit " << r << " is preferred";
      EXPECT_GE(beats[r] + 18, 6 * asked[r]);
      EXPECT_LE(beats[r], 6 * asked[r]);
    }
  }
}

TYPED_TEST(ImportArbiter, IgnoresBeatsThatNobodyAskedFor) {
  Clocked<typename TypeParam::Unit> bench(1);
  bench.u.beat_valid_i = 1;
  for (int i = 0; i < 10; ++i) {
    bench.u.eval();
    EXPECT_EQ(bench.u.unit_beat_valid_o, 0u);
    bench.clock();
  }
  bench.u.beat_valid_i = 0;
  bench.u.unit_request_valid_i = 2;
  bench.u.request_ready_i = 1;
  bench.clock();
  bench.u.unit_request_valid_i = 0;
  bench.u.beat_valid_i = 1;
  for (int i = 0; i < 10; ++i) {
    bench.u.eval();
    EXPECT_EQ(bench.u.unit_beat_valid_o, i < 6 ? 2u : 0u);
    bench.clock();
  }
}

struct Blocks2 {
  using Unit = Vblock_scheduler_2;
  static constexpr uint32_t kUnits = 2;
};
struct Blocks4 {
  using Unit = Vblock_scheduler_4;
  static constexpr uint32_t kUnits = 4;
};

template <typename Model>
class BlockScheduler : public testing::Test {};
using Blocks = testing::Types<Blocks2, Blocks4>;
TYPED_TEST_SUITE(BlockScheduler, Blocks);

TYPED_TEST(BlockScheduler, GivesALaunchToAReadyUnitAndFreeOnesFirst) {
  Clocked<typename TypeParam::Unit> bench(1);
  auto& u = bench.u;
  for (int i = 0; i < 5000; ++i) {
    u.ready_i = bench.random() % (1u << TypeParam::kUnits);
    u.busy_i = bench.random() % (1u << TypeParam::kUnits);
    u.launch_valid_i = 0;
    u.eval();
    const uint32_t unit = u.launch_unit_o;
    ASSERT_EQ(u.launch_ready_o, u.ready_i != 0);
    ASSERT_EQ(u.valid_o, 0u);
    u.launch_valid_i = bench.one_of(2);
    u.eval();
    ASSERT_EQ(u.launch_ready_o, u.ready_i != 0) << "ready depends on valid";
    ASSERT_EQ(u.launch_unit_o, unit) << "the unit depends on valid";
    ASSERT_EQ(u.valid_o, u.launch_valid_i && u.ready_i ? 1u << unit : 0u);
    if (u.ready_i) {
      ASSERT_TRUE(u.ready_i >> unit & 1);
      if (u.ready_i & ~u.busy_i) {
        ASSERT_FALSE(u.busy_i >> unit & 1) << "a unit that runs no kernel was passed over";
      }
    }
    bench.clock();
  }
}

TYPED_TEST(BlockScheduler, TakesTurnsAmongEqualUnits) {
  for (const bool busy : {false, true}) {
    Clocked<typename TypeParam::Unit> bench(1);
    auto& u = bench.u;
    u.ready_i = (1u << TypeParam::kUnits) - 1;
    u.busy_i = busy ? u.ready_i : 0;
    std::vector<uint32_t> order;
    for (int i = 0; i < 100; ++i) {
      u.launch_valid_i = bench.one_of(2);
      u.eval();
      if (u.launch_valid_i) order.push_back(u.launch_unit_o);
      bench.clock();
    }
    for (size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i % TypeParam::kUnits);
  }
}

}  // namespace
}  // namespace raypool::bench
