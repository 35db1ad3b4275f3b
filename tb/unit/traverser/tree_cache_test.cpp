// A bank of the traverser's caches in Verilog against its class, all outputs in every cycle; and both against a memory:
// every ray gets the line that it asked for, once.
#include "machine/traverser/tree_cache.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>
#include <map>
#include <vector>

#include "Vtree_cache_1_1_4_2_1_5_32.h"
#include "Vtree_cache_32_2_16_2_3_9_32.h"
#include "Vtree_cache_3_5_64_4_5_23_32.h"
#include "Vtree_cache_8_24_128_16_8_23_32.h"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"
#include "unit/traverser/full_sets.hpp"

namespace raypool::bench {
namespace {

/// LANES, SLOTS, LINES, WAYS, MSHRS, LINE_BITS.
template <typename Unit, uint32_t lanes, uint32_t slots, uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t bits>
struct Parameters {
  using Verilated = Unit;
  static constexpr uint32_t kLanes = lanes, kSlots = slots, kLineBits = bits;
  static constexpr TreeCache::Sizes kSizes{lanes, lines, ways, mshrs};
};

/// One in so many cycles (0: never): lanes look up a line, a lane leaves an offer, the memory leaves a request, a line
/// comes. `lines` from 0 on are looked up, or with `sets` as many lines of the first so many sets, shared evenly; one
/// in so many lookups is a prefetch, and one is of a line with another value in one bit.
struct Traffic {
  uint32_t lookup = 1, leave_offer = 0, leave_request = 0, fill = 1, lines = 16, prefetch = 0, sets = 0, other_bit = 0;
};

template <typename P>
class Bench {
 public:
  explicit Bench(uint32_t seed) : bench_(seed), rows_(P::kSizes.lines) {
    for (uint32_t lane = 0; lane < P::kLanes; ++lane) {
      for (uint32_t slot = 0; slot < P::kSlots; ++slot) free_[lane].push_back(slot);
    }
  }

  void clock(const Traffic& traffic) {
    if (!looks_) offer_lookup(traffic);
    const bool fill = on_way_.size() > 0 && (fill_waits_ || one_of(traffic.fill));
    const uint32_t fill_id = fill ? on_way_.front().id : 0;
    const Line data = fill ? line_data(on_way_.front().line) : Line{};
    const bool taken = looks_ && cache_.ready() && !fill;
    // A lane that has its lookup taken takes no offer.
    const bool offer_taken =
        cache_.offers() && !one_of(traffic.leave_offer) && !(taken && (lookup_.lanes >> cache_.offer_lane() & 1) != 0);
    const bool request_ready = !one_of(traffic.leave_request);
    drive(fill, fill_id, data, offer_taken, request_ready);
    ASSERT_NO_FATAL_FAILURE(compare(fill));
    ASSERT_NO_FATAL_FAILURE(take_given());

    const bool filled = fill && cache_.fill_ready();
    ASSERT_TRUE(filled || !fill || !fill_waits_) << "a line waits for more than a cycle";
    fill_waits_ = fill && !filled;
    late_fills += fill_waits_ ? 1 : 0;
    if (filled) {
      rows_[cache_.fill_row(fill_id)] = data;
      ASSERT_EQ(asked_.erase(on_way_.front().line), 1u);
      on_way_.pop_front();
    }
    const bool requested = request_ready && cache_.request_valid();
    if (requested) {
      const uint32_t line = cache_.request_line();
      ASSERT_EQ(asked_.count(line), 0u) << "line " << line << " is asked for twice";
      asked_[line] = true;
      on_way_.push_back({line, cache_.request_id()});
      most_on_way = std::max<uint64_t>(most_on_way, on_way_.size());
    }
    blocked += cache_.blocked() ? 1 : 0;
    if (taken) {
      for (uint32_t lane = 0; lane < P::kLanes; ++lane) {
        if ((lookup_.lanes >> lane & 1) == 0) continue;
        wanted_[{lane, lookup_.slots[lane]}] = lookup_.line;
      }
    }
    full_sets.before(cache_);
    cache_.clock({taken ? &lookup_ : nullptr, fill, fill_id, offer_taken, requested});
    full_sets.after(cache_);
    if (taken) looks_ = false, ++lookups;
    bench_.clock();
    ++cycle_;
  }
  /// Nothing more is asked, and every lane gets what it wants.
  void drain() {
    for (uint32_t i = 0; i < 5000 && !(cache_.idle() && !looks_ && on_way_.empty()); ++i)
      ASSERT_NO_FATAL_FAILURE(clock({0, 3, 3, 1, 1, 0}));
    EXPECT_EQ(wanted_.size(), 0u);
    EXPECT_TRUE(cache_.idle());
    EXPECT_EQ(cache_.busy(), 0u);
  }
  /// A reset in front of another tree, whatever is looked up or waits: nothing is on its way then, but for a line that
  /// comes in the cycle of the reset. What the memory has is another thing from then on.
  void restart(Traffic traffic) {
    const bool fill = bench_.one_of(2);
    for (uint32_t i = 0; fill && on_way_.empty() && i < 1000; ++i) ASSERT_NO_FATAL_FAILURE(clock(traffic));
    traffic.leave_request = 1;
    for (uint32_t i = 0; on_way_.size() > (fill ? 1 : 0); ++i) {
      ASSERT_LT(i, 5000u) << "lines do not come";
      ASSERT_NO_FATAL_FAILURE(clock(traffic));
    }
    const bool comes = !on_way_.empty();
    u_.rst_ni = 0;
    drive(comes, comes ? on_way_.front().id : 0, comes ? line_data(on_way_.front().line) : 0, bench_.one_of(2),
          bench_.one_of(2));
    bench_.clock();
    u_.rst_ni = 1;
    restarts_with_fill += comes ? 1 : 0;
    busy_at_restart += cache_.busy() != 0 ? 1 : 0;
    for (const auto& [slot, line] : wanted_) free_[slot.first].push_back(slot.second);
    for (uint32_t lane = 0; looks_ && lane < P::kLanes; ++lane)
      if ((lookup_.lanes >> lane & 1) != 0) free_[lane].push_back(lookup_.slots[lane]);
    cache_ = TreeCache(P::kSizes);
    wanted_.clear();
    asked_.clear();
    on_way_.clear();
    looks_ = fill_waits_ = false;
    tree_ += 0x10001;
  }
  const TreeCache::Work& work() const { return cache_.work(); }

  FullSets full_sets{P::kSizes};
  uint64_t lookups = 0, given = 0, shared = 0, late_fills = 0, blocked = 0, most_on_way = 0;
  uint64_t restarts_with_fill = 0, busy_at_restart = 0;

 private:
  using Line = uint32_t;  // data that identifies it, DATA_BITS are 32
  struct OnWay {
    uint32_t line, id;
  };

  bool one_of(uint32_t n) { return n != 0 && bench_.one_of(n); }
  Line line_data(uint32_t line) const { return line * 2654435761u + tree_; }

  void offer_lookup(const Traffic& traffic) {
    if (!one_of(traffic.lookup)) return;
    lookup_ = {};
    lookup_.line = any_line(traffic) & ((1u << P::kLineBits) - 1);
    looks_ = true;
    if (one_of(traffic.prefetch)) return;
    for (uint32_t lane = 0; lane < P::kLanes; ++lane) {
      if (free_[lane].empty() || (P::kLanes > 1 && bench_.random() % 3 != 0)) continue;
      lookup_.lanes |= 1u << lane;
      lookup_.slots[lane] = static_cast<uint8_t>(free_[lane].front());
      free_[lane].pop_front();
    }
    looks_ = lookup_.lanes != 0;
  }

  uint32_t any_line(const Traffic& traffic) {
    uint32_t line = static_cast<uint32_t>(bench_.random()) % traffic.lines;
    constexpr uint32_t kSets = P::kSizes.lines / P::kSizes.ways;
    if (traffic.sets != 0) line = line % traffic.sets % kSets + line / traffic.sets * kSets;
    if (one_of(traffic.other_bit)) line ^= 1u << bench_.random() % P::kLineBits;
    return line;
  }

  static constexpr uint32_t slot_bits() {
    uint32_t bits = 1;
    while (1u << bits < P::kSlots) ++bits;
    return bits;
  }

  // What means nothing is noise.
  void drive(bool fill, uint32_t fill_id, Line data, bool offer_taken, bool request_ready) {
    const auto noise = static_cast<uint32_t>(bench_.random());
    u_.valid_i = looks_;
    u_.line_i = (looks_ ? lookup_.line : noise) & ((1u << P::kLineBits) - 1);
    u_.lanes_i = looks_ ? lookup_.lanes : noise & static_cast<uint32_t>((uint64_t{1} << P::kLanes) - 1);
    for (uint32_t lane = 0; lane < P::kLanes; ++lane)
      set_bits(u_.slots_i, lane * slot_bits(), slot_bits(),
               looks_ && (lookup_.lanes >> lane & 1) != 0 ? lookup_.slots[lane] : noise >> lane % 16);
    u_.offer_ready_i = cache_.offers() ? offer_taken : noise >> 9 & 1;
    u_.request_ready_i = request_ready;
    u_.fill_valid_i = fill;
    u_.fill_id_i = fill ? fill_id : 0;
    u_.fill_data_i = fill ? data : noise;
    u_.eval();
  }

  void compare(bool fill) {
    ASSERT_EQ(u_.ready_o, cache_.ready() && !fill) << "cycle " << cycle_;
    ASSERT_EQ(u_.offer_valid_o, cache_.offers()) << "cycle " << cycle_;
    if (cache_.offers()) {
      ASSERT_EQ(u_.offer_lane_o, 1u << cache_.offer_lane()) << "cycle " << cycle_;
      ASSERT_EQ(u_.offer_slot_o, cache_.offer_slot()) << "cycle " << cycle_;
    }
    ASSERT_EQ(u_.request_valid_o, cache_.request_valid()) << "cycle " << cycle_;
    if (cache_.request_valid()) {
      ASSERT_EQ(u_.request_id_o, cache_.request_id()) << "cycle " << cycle_;
      ASSERT_EQ(u_.request_line_o, cache_.request_line()) << "cycle " << cycle_;
    }
    ASSERT_EQ(u_.fill_ready_o, cache_.fill_ready()) << "cycle " << cycle_;
    const TreeCache::Given& given_now = cache_.given();
    ASSERT_EQ(u_.given_lanes_o, given_now.lanes) << "cycle " << cycle_;
    for (uint32_t lane = 0; lane < P::kLanes; ++lane) {
      if ((given_now.lanes >> lane & 1) == 0) continue;
      ASSERT_EQ(get_bits(u_.given_slots_o, lane * slot_bits(), slot_bits()), given_now.slots[lane]);
    }
  }

  void take_given() {
    const TreeCache::Given& now = cache_.given();
    if (now.lanes == 0) return;
    shared += (now.lanes & (now.lanes - 1)) != 0 ? 1 : 0;
    for (uint32_t lane = 0; lane < P::kLanes; ++lane) {
      if ((now.lanes >> lane & 1) == 0) continue;
      const auto wanted = wanted_.find({lane, now.slots[lane]});
      ASSERT_NE(wanted, wanted_.end()) << "a ray gets a line that it has not asked for";
      ASSERT_EQ(u_.given_data_o, line_data(wanted->second)) << "cycle " << cycle_ << ", line " << wanted->second;
      free_[lane].push_back(now.slots[lane]);
      wanted_.erase(wanted);
      ++given;
    }
  }

  Clocked<typename P::Verilated> bench_;
  typename P::Verilated& u_ = *bench_.u;
  TreeCache cache_{P::kSizes};
  uint64_t cycle_ = 0;
  uint32_t tree_ = 12345;                                     // that the memory has
  std::map<uint32_t, std::deque<uint32_t>> free_;             // [lane] slots that wait for nothing
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> wanted_;  // [lane, slot] line
  TreeCache::Lookup lookup_;                                  // that is offered
  bool looks_ = false;
  std::deque<OnWay> on_way_;
  std::map<uint32_t, bool> asked_;
  bool fill_waits_ = false;
  std::vector<Line> rows_;
};

template <typename P>
class TreeCacheTest : public testing::Test {};
using All = testing::Types<Parameters<Vtree_cache_1_1_4_2_1_5_32, 1, 1, 4, 2, 1, 5>,
                           Parameters<Vtree_cache_3_5_64_4_5_23_32, 3, 5, 64, 4, 5, 23>,
                           Parameters<Vtree_cache_8_24_128_16_8_23_32, 8, 24, 128, 16, 8, 23>,
                           Parameters<Vtree_cache_32_2_16_2_3_9_32, 32, 2, 16, 2, 3, 9>>;
TYPED_TEST_SUITE(TreeCacheTest, All);

TYPED_TEST(TreeCacheTest, AgreesWithItsClassInEveryCycle) {
  uint64_t late = 0, blocked = 0, shared = 0, joined = 0, most = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    constexpr uint32_t kLines = TypeParam::kSizes.lines;
    for (const Traffic& traffic :
         {Traffic{1, 0, 0, 1, kLines, 0}, Traffic{1, 0, 0, 1, 2 * kLines, 5}, Traffic{1, 3, 2, 4, 3 * kLines, 3},
          Traffic{1, 0, 0, 40, 1 << 20, 0}, Traffic{2, 1, 5, 2, 20, 9}, Traffic{5, 2, 2, 5, 5, 2},
          Traffic{1, 0, 0, 100, 4 * kLines, 4}, Traffic{2, 0, 0, 20, 2 * kLines, 3}, Traffic{1, 1, 0, 1, kLines + 3, 0},
          Traffic{1, 1, 2, 2, kLines, 7, 0, 2}}) {
      for (uint32_t i = 0; i < 4000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
      ASSERT_NO_FATAL_FAILURE(bench.drain());
    }
    late += bench.late_fills;
    blocked += bench.blocked;
    shared += bench.shared;
    joined += bench.work().joined;
    most = std::max(most, bench.most_on_way);
  }
  EXPECT_GT(late, 20u);
  EXPECT_GT(blocked, 1000u);
  EXPECT_EQ(most, TypeParam::kSizes.mshrs);
  if (TypeParam::kLanes > 1) {
    EXPECT_GT(shared, 1000u);
    EXPECT_GT(joined, 1000u);
  }
}

TYPED_TEST(TreeCacheTest, HasNoLineOfTheTreeBeforeBehindAReset) {
  constexpr uint32_t kLines = TypeParam::kSizes.lines;
  uint64_t with_fill = 0, busy = 0, given = 0;
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    for (uint32_t tree = 0; tree < 120; ++tree) {
      const Traffic all[] = {{1, 0, 0, 1, 2 * kLines, 3}, {1, 3, 2, 4, kLines, 2}, {1, 2, 0, 9, 4 * kLines, 0}};
      const Traffic& traffic = all[tree % 3];
      for (uint32_t i = 0; i < 100 + 2 * kLines; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
      ASSERT_NO_FATAL_FAILURE(bench.restart(traffic));
    }
    with_fill += bench.restarts_with_fill;
    busy += bench.busy_at_restart;
    given += bench.given;
  }
  EXPECT_GT(with_fill, 50u);
  EXPECT_GT(busy, 100u);
  EXPECT_GT(given, 1000u);
}

// Of these a bank has more registers than ways.
template <typename P>
class TreeCacheOfMoreMisses : public testing::Test {};
using MoreMisses = testing::Types<Parameters<Vtree_cache_3_5_64_4_5_23_32, 3, 5, 64, 4, 5, 23>,
                                  Parameters<Vtree_cache_32_2_16_2_3_9_32, 32, 2, 16, 2, 3, 9>>;
TYPED_TEST_SUITE(TreeCacheOfMoreMisses, MoreMisses);

// Lines of one set, or of two and three, that come back one at a time.
TYPED_TEST(TreeCacheOfMoreMisses, MissesOfOneSetWaitForAWayThoughARegisterIsFree) {
  constexpr TreeCache::Sizes kSizes = TypeParam::kSizes;
  uint64_t waits = 0, others = 0, own = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    constexpr uint32_t kLines = 4 * kSizes.ways;
    for (const uint32_t prefetch : {0u, 4u}) {
      for (const Traffic& traffic :
           {Traffic{1, 0, 0, 4, kLines, prefetch, 1}, Traffic{1, 2, 0, 12, kLines, prefetch, 2},
            Traffic{1, 0, 3, 12, kLines, prefetch, 3}, Traffic{1, 0, 0, 90, kLines, prefetch, 2},
            Traffic{2, 3, 0, 40, kLines / 2 + 1, prefetch, 2}, Traffic{1, 0, 0, 7, kLines, prefetch, 2, 5}}) {
        for (uint32_t i = 0; i < 4000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
        ASSERT_NO_FATAL_FAILURE(bench.drain());
      }
    }
    waits += bench.full_sets.waits;
    others += bench.full_sets.others_freed;
    own += bench.full_sets.own_freed;
  }
  EXPECT_GT(waits, 50u) << "no lookup waits for a way while a register is free";
  EXPECT_GT(others, 20u) << "no other register is freed meanwhile";
  EXPECT_GT(own, 50u) << "no way of the set is given back";
}

}  // namespace
}  // namespace raypool::bench
