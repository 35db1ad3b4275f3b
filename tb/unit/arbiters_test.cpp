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

// Requesters in front of an arbiter, and what has to come out behind it.
template <typename Port>
class PortArbiterBench {
 public:
  static constexpr uint32_t kCount = Port::kCount;
  explicit PortArbiterBench(uint32_t seed) : bench_(seed) {}

  /// One cycle. `crowded`: everybody always.
  void clock(bool crowded) {
    show(crowded);
    // Valid does not depend on ready.
    unit_.ready_i = 0;
    unit_.eval();
    const bool shown = unit_.valid_o;
    ASSERT_EQ(unit_.ready_o, 0u);
    unit_.ready_i = crowded || !bench_.one_of(3);
    unit_.eval();
    ASSERT_EQ(unit_.valid_o, shown);
    ASSERT_NO_FATAL_FAILURE(check_offer());
    ASSERT_EQ(unit_.ready_o & valid_, unit_.valid_o && unit_.ready_i ? 1u << number_ : 0u);
    if (unit_.valid_o && unit_.ready_i) {
      ASSERT_NO_FATAL_FAILURE(take(crowded));
    }
    bench_.clock();
  }
  uint32_t packages() const { return packages_; }
  uint32_t received(uint32_t requester) const { return received_[requester]; }

 private:
  void show(bool crowded) {
    uint32_t last = 0;
    uint64_t data = 0;
    valid_ = 0;
    for (uint32_t r = 0; r < kCount; ++r) {
      Requester& requester = requesters_[r];
      if (requester.left == 0 && (crowded || bench_.one_of(6))) {
        requester.left = 1 + static_cast<int>(bench_.random() % 3);
      }
      if (requester.gap > 0) --requester.gap;
      if (requester.left == 0 || requester.gap > 0) continue;
      valid_ |= 1u << r;
      last |= uint32_t{requester.left == 1} << r;
      data |= uint64_t{r << 14 | (requester.sent & 0x3fff)} << 16 * r;
    }
    unit_.valid_i = valid_;
    unit_.last_i = last;
    unit_.data_i = data;
  }
  void check_offer() {
    if (waits_) {
      ASSERT_TRUE(unit_.valid_o) << "what waits was withdrawn";
      ASSERT_EQ(unit_.data_o, offered_) << "what waits was changed";
      ASSERT_EQ(unit_.number_o, number_);
    }
    if (owner_ < 0) {
      ASSERT_EQ(unit_.valid_o, valid_ != 0);
    }
    waits_ = unit_.valid_o && !unit_.ready_i;
    offered_ = unit_.data_o;
    number_ = unit_.number_o;
    if (!unit_.valid_o) return;
    ASSERT_TRUE(valid_ >> number_ & 1);
    ASSERT_EQ(offered_ >> 14, number_);
    if (owner_ >= 0) {
      ASSERT_EQ(number_, static_cast<uint32_t>(owner_)) << "two packages are mixed";
    }
    owner_ = static_cast<int>(number_);
    requesters_[number_].begun = true;
  }
  void take(bool crowded) {
    Requester& requester = requesters_[number_];
    ASSERT_EQ(offered_ & 0x3fff, received_[number_]++ & 0x3fff) << "a word is lost or doubled";
    ++requester.sent;
    if (--requester.left == 0) {
      owner_ = -1;
      ++packages_;
      requester.begun = false;
      requester.waited = 0;
      ASSERT_NO_FATAL_FAILURE(others_wait());
    }
    if (!crowded && bench_.one_of(4)) requester.gap = 1 + static_cast<int>(bench_.random() % 3);
  }
  void others_wait() {
    for (uint32_t r = 0; r < kCount; ++r) {
      if (r != number_ && (valid_ >> r & 1) != 0 && !requesters_[r].begun) {
        ASSERT_LT(++requesters_[r].waited, static_cast<int>(kCount)) << "requester " << r << " starves";
      }
    }
  }

  Clocked<typename Port::Unit> bench_;
  typename Port::Unit& unit_ = bench_.u;
  std::array<Requester, kCount> requesters_;
  std::array<uint32_t, kCount> received_{};
  int owner_ = -1;      // of the package under way at the port
  bool waits_ = false;  // what was offered in the last cycle was not taken
  uint32_t valid_ = 0, offered_ = 0, number_ = 0, packages_ = 0;
};

TYPED_TEST(PortArbiter, KeepsPackagesTogetherInTurnAndLosesNothing) {
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    PortArbiterBench<TypeParam> bench(seed);
    for (int cycle = 0; cycle < 6000; ++cycle) ASSERT_NO_FATAL_FAILURE(bench.clock(cycle > 3000));
    EXPECT_GT(bench.packages(), 1500u);
    for (uint32_t r = 0; r < TypeParam::kCount; ++r) EXPECT_GT(bench.received(r), 1000u / TypeParam::kCount) << r;
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
