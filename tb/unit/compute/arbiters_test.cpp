// What port_arbiter, import_arbiter and block_scheduler promise, under random traffic: nothing is lost, mixed up or
// changed while it waits, and no requester starves. In every cycle each is compared with its class, too.
#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <random>
#include <vector>

#include "Vblock_scheduler_2.h"
#include "Vblock_scheduler_3.h"
#include "Vblock_scheduler_4.h"
#include "Vimport_arbiter_2.h"
#include "Vimport_arbiter_3.h"
#include "Vimport_arbiter_4.h"
#include "Vport_arbiter_2.h"
#include "Vport_arbiter_3.h"
#include "Vport_arbiter_4.h"
#include "machine/compute/block_scheduler.hpp"
#include "machine/compute/import_arbiter.hpp"
#include "machine/compute/port_arbiter.hpp"

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
struct Port3 {
  using Unit = Vport_arbiter_3;
  static constexpr uint32_t kCount = 3;
};
struct Port4 {
  using Unit = Vport_arbiter_4;
  static constexpr uint32_t kCount = 4;
};

template <typename Model>
class PortArbiterTest : public testing::Test {};
using Ports = testing::Types<Port2, Port3, Port4>;
TYPED_TEST_SUITE(PortArbiterTest, Ports);

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

  /// One cycle. `crowded`: every port always.
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
    model_.present(valid_);
    ASSERT_EQ(model_.valid(), shown);
    if (shown) {
      ASSERT_EQ(unit_.number_o, model_.choice());
    }
    ASSERT_NO_FATAL_FAILURE(check_offer());
    ASSERT_EQ(unit_.ready_o & valid_, unit_.valid_o && unit_.ready_i ? 1u << number_ : 0u);
    model_.clock(unit_.ready_i != 0, (unit_.last_i >> number_ & 1) != 0);
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
  PortArbiter model_;
  std::array<Requester, kCount> requesters_;
  std::array<uint32_t, kCount> received_{};
  int owner_ = -1;      // of the package under way at the port
  bool waits_ = false;  // what was offered in the last cycle was not taken
  uint32_t valid_ = 0, offered_ = 0, number_ = 0, packages_ = 0;
};

TYPED_TEST(PortArbiterTest, KeepsPackagesTogetherInTurnAndLosesNothing) {
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
  static constexpr uint32_t kUnits = 2, kBeats = 5;
};
struct Import3 {
  using Unit = Vimport_arbiter_3;
  static constexpr uint32_t kUnits = 3, kBeats = 3;
};
struct Import4 {
  using Unit = Vimport_arbiter_4;
  static constexpr uint32_t kUnits = 4, kBeats = 6;
};

template <typename Model>
class ImportArbiterTest : public testing::Test {};
using Imports = testing::Types<Import2, Import3, Import4>;
TYPED_TEST_SUITE(ImportArbiterTest, Imports);

// Units that ask, and the pool that gives packages in order. Beats come even while the queue of receivers is full and
// another request waits, so that a place becomes free in the cycle in which a request would take it.
template <typename Import>
class ImportArbiterBench {
 public:
  static constexpr uint32_t kUnits = Import::kUnits, kBeats = Import::kBeats, kPlaces = 3;
  explicit ImportArbiterBench(uint32_t seed) : bench_(seed) {}

  struct Traffic {
    uint32_t ask = 1, take = 2, gap = 4;  ///< one in so many cycles: a unit asks, a request is taken, no beat comes
  };
  void clock(const Traffic& traffic) {
    show(traffic);
    const bool arrives = !expected_.empty() && !bench_.one_of(traffic.gap);
    u_.beat_valid_i = arrives;
    u_.eval();
    model_.present(valid_);
    ASSERT_NO_FATAL_FAILURE(compare(arrives));
    const bool was_full = expected_.size() == kPlaces;
    const bool transfer = u_.request_valid_o && u_.request_ready_i;
    model_.clock(u_.request_ready_i != 0, arrives);
    if (arrives) take_beat();
    full_and_leaves += was_full && valid_ != 0 && u_.request_ready_i && expected_.size() < kPlaces ? 1 : 0;
    if (transfer) take_request();
    most = std::max(most, expected_.size());
    bench_.clock();
  }
  /// In the middle of everything; requests of the units stay, packages under way are forgotten.
  void reset() {
    u_.rst_ni = 0;
    u_.beat_valid_i = 0;
    u_.unit_request_valid_i = 0;
    bench_.clock();
    u_.rst_ni = 1;
    model_ = ImportArbiter(kBeats);
    expected_.clear();
    beat_ = 0;
  }

  uint64_t full_and_leaves = 0;  ///< cycles in which the queue was full, its oldest left, and a request waited
  size_t most = 0;
  std::array<uint32_t, kUnits> asked{}, beats{};

 private:
  void show(const Traffic& traffic) {
    uint32_t kinds = 0;
    valid_ = 0;
    for (uint32_t r = 0; r < kUnits; ++r) {
      if (kind_[r] == 0 && bench_.one_of(traffic.ask)) kind_[r] = 1 + bench_.random() % 2;
      valid_ |= uint32_t{kind_[r] != 0} << r;
      kinds |= kind_[r] << 2 * r;
    }
    u_.unit_request_valid_i = valid_;
    u_.unit_request_kind_i = kinds;
    u_.request_ready_i = bench_.one_of(traffic.take);
  }
  void compare(bool arrives) {
    ASSERT_EQ(u_.unit_beat_valid_o, arrives ? 1u << expected_.front() : 0u);
    ASSERT_EQ(model_.expects(), !expected_.empty());
    if (model_.expects()) {
      ASSERT_EQ(model_.receiver(), expected_.front());
    }
    ASSERT_EQ(u_.request_valid_o, model_.valid());
    ASSERT_EQ(u_.request_valid_o, valid_ != 0 && expected_.size() < kPlaces)
        << "a package may be asked for while fewer than three are to come, and not before one of three is there";
    const bool transfer = u_.request_valid_o && u_.request_ready_i;
    ASSERT_EQ(u_.unit_request_ready_o & valid_, transfer ? 1u << u_.request_unit_o : 0u);
    if (!u_.request_valid_o) return;
    ASSERT_EQ(u_.request_unit_o, model_.choice());
    ASSERT_EQ(u_.request_kind_o, kind_[u_.request_unit_o]);
  }
  void take_beat() {
    ++beats[expected_.front()];
    if (++beat_ < kBeats) return;
    beat_ = 0;
    expected_.pop_front();
  }
  void take_request() {
    const uint32_t unit = u_.request_unit_o;
    expected_.push_back(unit);
    ++asked[unit];
    kind_[unit] = 0;
  }

  Clocked<typename Import::Unit> bench_;
  typename Import::Unit& u_ = bench_.u;
  ImportArbiter model_{kBeats};
  std::array<uint32_t, kUnits> kind_{};  // 0: asks for nothing
  std::deque<uint32_t> expected_;        // units, in the order of their requests
  uint32_t valid_ = 0, beat_ = 0;
};

TYPED_TEST(ImportArbiterTest, GivesEveryPackageToTheUnitThatAsked) {
  using Bench = ImportArbiterBench<TypeParam>;
  uint64_t full_and_leaves = 0;
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench bench(seed);
    for (const typename Bench::Traffic traffic : {typename Bench::Traffic{6, 2, 4}, typename Bench::Traffic{1, 2, 4}})
      for (int cycle = 0; cycle < 3000; ++cycle) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic)) << "cycle " << cycle;
    EXPECT_EQ(bench.most, Bench::kPlaces);
    const uint32_t fewest = *std::min_element(bench.asked.begin(), bench.asked.end());
    for (uint32_t r = 0; r < Bench::kUnits; ++r) {
      EXPECT_LE(bench.asked[r], fewest + fewest / 4) << "unit " << r << " is preferred";
      EXPECT_GE(bench.beats[r] + Bench::kPlaces * Bench::kBeats, Bench::kBeats * bench.asked[r]);
      EXPECT_LE(bench.beats[r], Bench::kBeats * bench.asked[r]);
    }
    full_and_leaves += bench.full_and_leaves;
  }
  EXPECT_GT(full_and_leaves, 500u) << "no request waited while a full queue lost its oldest entry";
}

TYPED_TEST(ImportArbiterTest, AFullQueueThatLosesItsOldestTakesTheNextRequestOneCycleLater) {
  using Bench = ImportArbiterBench<TypeParam>;
  Bench bench(3);
  for (int cycle = 0; cycle < 3000; ++cycle)  // the pool takes at once and sends without gaps
    ASSERT_NO_FATAL_FAILURE(bench.clock({1, 1, 1000})) << "cycle " << cycle;
  EXPECT_GT(bench.full_and_leaves, 400u);
}

TYPED_TEST(ImportArbiterTest, ForgetsPackagesUnderWayAtAReset) {
  ImportArbiterBench<TypeParam> bench(5);
  for (int round = 0; round < 200; ++round) {
    for (int cycle = 0; cycle < 5 + round % 17; ++cycle)
      ASSERT_NO_FATAL_FAILURE(bench.clock({1, 1, 3})) << "round " << round << ", cycle " << cycle;
    bench.reset();
  }
}

TYPED_TEST(ImportArbiterTest, IgnoresBeatsThatNoUnitAskedFor) {
  constexpr int kBeats = TypeParam::kBeats;
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
    EXPECT_EQ(bench.u.unit_beat_valid_o, i < kBeats ? 2u : 0u);
    bench.clock();
  }
}

struct Blocks2 {
  using Unit = Vblock_scheduler_2;
  static constexpr uint32_t kUnits = 2;
};
struct Blocks3 {
  using Unit = Vblock_scheduler_3;
  static constexpr uint32_t kUnits = 3;
};
struct Blocks4 {
  using Unit = Vblock_scheduler_4;
  static constexpr uint32_t kUnits = 4;
};

template <typename Model>
class BlockSchedulerTest : public testing::Test {};
using Blocks = testing::Types<Blocks2, Blocks3, Blocks4>;
TYPED_TEST_SUITE(BlockSchedulerTest, Blocks);

TYPED_TEST(BlockSchedulerTest, GivesALaunchToAReadyUnitAndFreeOnesFirst) {
  Clocked<typename TypeParam::Unit> bench(1);
  BlockScheduler model;
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
    model.present(u.ready_i, u.busy_i);
    ASSERT_EQ(u.launch_ready_o, model.ready());
    model.clock(u.launch_valid_i != 0);
    if (u.ready_i) {
      ASSERT_EQ(unit, model.unit());
      ASSERT_TRUE(u.ready_i >> unit & 1);
      if (u.ready_i & ~u.busy_i) {
        ASSERT_FALSE(u.busy_i >> unit & 1) << "a unit that runs no kernel was passed over";
      }
    }
    bench.clock();
  }
}

TYPED_TEST(BlockSchedulerTest, TakesTurnsAmongEqualUnits) {
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
