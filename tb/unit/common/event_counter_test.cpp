// rtl/common/rp_event_counter.v against a sum: so narrow that it wraps many times in a run, as one of 48 bits never
// does in a simulation.
#include <gtest/gtest.h>
#include <verilated.h>

#include "Vevent_counter_13_12_6_0.h"
#include "Vevent_counter_4_2_2_0.h"
#include "Vevent_counter_6_3_2_0.h"
#include "Vevent_counter_7_3_1_1.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

template <typename Unit_, uint32_t kBits_, uint32_t kEventBits_, bool kLate_>
struct Counter {
  using Unit = Unit_;
  static constexpr uint32_t kBits = kBits_, kEventBits = kEventBits_;
  static constexpr bool kLate = kLate_;
};

template <typename C>
class EventCounter : public testing::Test {
 protected:
  /// Counts random events, one in `pace` cycles on average. Each cycle is checked; returns the sum.
  uint64_t count(Clocked<typename C::Unit>& bench, uint32_t cycles, uint32_t pace) {
    auto& u = *bench.u;
    uint64_t sum = 0;
    for (uint32_t cycle = 0; cycle < cycles; ++cycle) {
      const uint32_t events = bench.one_of(pace) ? static_cast<uint32_t>(bench.random()) & kMostEvents : 0;
      u.event_i = events;
      u.eval();
      const uint64_t before = sum;
      sum += events;
      const uint64_t shown = (uint64_t{u.value_o} + u.pending_o) & kMask;
      EXPECT_EQ(shown, (C::kLate ? before : sum) & kMask) << "cycle " << cycle;
      if (testing::Test::HasFailure()) return sum;
      bench.clock();
    }
    return sum;
  }

 private:
  static constexpr uint64_t kMask = (uint64_t{1} << C::kBits) - 1;
  static constexpr uint32_t kMostEvents = (1u << C::kEventBits) - 1;
};
using Counters =
    testing::Types<Counter<Vevent_counter_4_2_2_0, 4, 2, false>, Counter<Vevent_counter_6_3_2_0, 6, 2, false>,
                   Counter<Vevent_counter_7_3_1_1, 7, 1, true>, Counter<Vevent_counter_13_12_6_0, 13, 6, false>>;
TYPED_TEST_SUITE(EventCounter, Counters);

TYPED_TEST(EventCounter, WrapsAtItsEnd) {
  for (const uint32_t pace : {1u, 2u, 9u}) {
    Clocked<typename TypeParam::Unit> bench(pace);
    const uint64_t sum = this->count(bench, 60000, pace);
    EXPECT_GT(sum >> TypeParam::kBits, 10u) << "it has hardly wrapped";
  }
}

TYPED_TEST(EventCounter, CountsFromZeroAfterAReset) {
  Clocked<typename TypeParam::Unit> bench(1);
  for (uint32_t run = 0; run < 50 && !this->HasFailure(); ++run) {
    this->count(bench, 1 + static_cast<uint32_t>(bench.random()) % 300, 1);
    bench.u->event_i = 1;
    bench.u->rst_ni = 0;
    bench.clock();
    bench.u->rst_ni = 1;
  }
}

}  // namespace
}  // namespace raypool::bench
