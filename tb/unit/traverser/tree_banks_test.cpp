// A cache of the traverser in Verilog, its banks and the next lane at each, against its class, all outputs in every
// cycle; and both against a memory: every ray gets the line that it asked for, once, and none waits for ever.
#include "machine/traverser/tree_banks.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <vector>

#ifdef RAYPOOL_LARGE
#include "Vtree_banks_32_2_32_2_4_1_9_32.h"
#include "Vtree_banks_8_24_1024_16_64_8_26_32.h"
#else
#include "Vtree_banks_16_3_64_2_12_4_20_32.h"
#include "Vtree_banks_1_2_4_2_1_1_5_32.h"
#include "Vtree_banks_2_9_256_4_16_16_12_32.h"
#include "Vtree_banks_3_5_64_4_6_2_23_32.h"
#endif
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"
#include "unit/traverser/full_sets.hpp"

namespace raypool::bench {
namespace {

/// LANES, SLOTS, LINES, WAYS, MSHRS, BANKS, LINE_BITS.
template <typename Unit, uint32_t lanes, uint32_t slots, uint32_t lines, uint32_t ways, uint32_t mshrs, uint32_t banks,
          uint32_t bits>
struct Parameters {
  using Verilated = Unit;
  static constexpr uint32_t kSlots = slots, kLineBits = bits;
  static constexpr TreeBanks::Sizes kSizes{lanes, lines, ways, mshrs, banks};
};

/// One in so many cycles (0: never): a lane has another want, leaves a line for which it has waited, offers its wants
/// in another order than in the cycle before, or leaves one out; the memory leaves a request, a line comes. `lines`
/// from 0 on are wanted, or with `sets` as many lines of the first so many sets of the banks, shared evenly; one in so
/// many wants is a prefetch, and one is of a line with another value in one bit.
struct Traffic {
  uint32_t want = 1, leave = 0, turn = 0, withhold = 0, leave_request = 0, fill = 1, lines = 16, prefetch = 0, sets = 0,
           other_bit = 0;
};

template <typename P>
class Bench {
 public:
  explicit Bench(uint32_t seed) : full_sets(P::kSizes.banks, FullSets(kOfABank)), bench_(seed), rows_(P::kSizes.lines) {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      for (uint32_t slot = 0; slot < P::kSlots; ++slot) free_[lane].push_back(slot);
    }
  }

  void clock(const Traffic& traffic) {
    for (uint32_t lane = 0; lane < kLanes; ++lane) want(traffic, lane);
    uint32_t room = 0;
    for (uint32_t lane = 0; lane < kLanes; ++lane) room |= (one_of(traffic.leave) ? 0u : 1u) << lane;
    if (!fills_ && !on_way_.empty() && one_of(traffic.fill)) choose_fill();
    const uint32_t fill = fills_ ? on_way_.front().id : TreeBanks::kNone;
    const bool request_ready = !one_of(traffic.leave_request);
    drive(room, request_ready);

    const uint32_t waited = banks_.waited();
    std::array<bool, TreeBanks::kMostBanks> looks{};
    for (uint32_t bank = 0; bank < P::kSizes.banks; ++bank)
      looks[bank] = banks_.banks()[bank].ready() && !(fills_ && fill >> kMshrBits == bank);
    banks_.choose(wants(), wanting(), room, fill);
    ASSERT_NO_FATAL_FAILURE(compare(waited));
    ASSERT_NO_FATAL_FAILURE(take_given());
    for (uint32_t lane = 0; lane < kLanes; ++lane) ASSERT_NO_FATAL_FAILURE(take_wanted(lane, waited, looks));

    if (fills_) {
      ASSERT_NO_FATAL_FAILURE(take_fill());
    }
    const bool requested = request_ready && banks_.request_valid();
    if (banks_.request_valid()) {
      ASSERT_NO_FATAL_FAILURE(look_at_request(requested));
    }
    for (uint32_t bank = 0; bank < P::kSizes.banks; ++bank) full_sets[bank].before(banks_.banks()[bank]);
    banks_.clock(requested);
    for (uint32_t bank = 0; bank < P::kSizes.banks; ++bank) full_sets[bank].after(banks_.banks()[bank]);
    bench_.clock();
    ++cycle_;
  }
  /// Nothing more is wanted, and every lane gets what it wants.
  void drain() {
    const auto wants = [&] {
      for (uint32_t lane = 0; lane < kLanes; ++lane) {
        if (wants_[lane][0].valid || wants_[lane][1].valid) return true;
      }
      return false;
    };
    for (uint32_t i = 0; i < 20000 && !(banks_.idle() && on_way_.empty() && !wants()); ++i)
      ASSERT_NO_FATAL_FAILURE(clock({0, 3, 1, 0, 3, 1, 1, 0}));
    EXPECT_EQ(wanted_.size(), 0u);
    EXPECT_FALSE(wants());
    EXPECT_TRUE(banks_.idle());
  }
  /// A reset in front of another tree, whatever is wanted or waits: nothing is on its way then, but for a line that
  /// comes in the cycle of the reset. What the memory has is another thing from then on.
  void restart(Traffic traffic) {
    const bool fill = bench_.one_of(2);
    for (uint32_t i = 0; fill && on_way_.empty() && i < 1000; ++i) ASSERT_NO_FATAL_FAILURE(clock(traffic));
    traffic.leave_request = 1;
    for (uint32_t i = 0; on_way_.size() > (fill ? 1 : 0); ++i) {
      ASSERT_LT(i, 20000u) << "lines do not come";
      ASSERT_NO_FATAL_FAILURE(clock(traffic));
    }
    fills_ = !on_way_.empty();
    u_.rst_ni = 0;
    drive(static_cast<uint32_t>(bench_.random()), bench_.one_of(2));
    bench_.clock();
    u_.rst_ni = 1;
    restarts_with_fill += fills_ ? 1 : 0;
    for (const auto& [slot, line] : wanted_) free_[slot.first].push_back(slot.second);
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      for (LineWant& want : wants_[lane]) {
        if (want.valid && !want.prefetch) free_[lane].push_back(want.slot);
        want.valid = false;
      }
    }
    banks_ = TreeBanks(P::kSizes);
    wanted_.clear();
    asked_.clear();
    on_way_.clear();
    first_ = {};
    fills_ = fill_waited_ = request_waits_ = false;
    tree_ += 0x10001;
  }
  const TreeBanks::Work& work() const { return banks_.work(); }

  std::vector<FullSets> full_sets;  ///< [bank]
  uint64_t given = 0, seconds = 0, gave_way = 0, most_on_way = 0, full = 0;
  uint64_t restarts_with_fill = 0;

 private:
  using Line = uint32_t;  // data that identifies it, DATA_BITS are 32
  struct OnWay {
    uint32_t line, id;
  };
  static constexpr uint32_t kLanes = P::kSizes.lanes, kMshrs = P::kSizes.mshrs / P::kSizes.banks;
  static constexpr TreeCache::Sizes kOfABank{P::kSizes.lanes, P::kSizes.lines / P::kSizes.banks, P::kSizes.ways,
                                             kMshrs};

  static constexpr uint32_t bits_for(uint32_t count) {
    uint32_t bits = 1;
    while (1u << bits < count) ++bits;
    return bits;
  }
  static constexpr uint32_t kSlotBits = bits_for(P::kSlots), kMshrBits = bits_for(kMshrs);

  bool one_of(uint32_t n) { return n != 0 && bench_.one_of(n); }
  Line line_data(uint32_t line) const { return line * 2654435761u + tree_; }

  // A want stays with its slot until it is taken; what the lane offers of its two wants it may change in any cycle.
  void want(const Traffic& traffic, uint32_t lane) {
    for (LineWant& want : wants_[lane]) {
      const bool prefetch = one_of(traffic.prefetch);
      if (want.valid || !one_of(traffic.want) || (!prefetch && free_[lane].empty())) continue;
      want = {true, prefetch, 0, any_line(traffic) & ((1u << P::kLineBits) - 1)};
      if (prefetch) continue;
      want.slot = static_cast<uint8_t>(free_[lane].front());
      free_[lane].pop_front();
    }
    if (one_of(traffic.turn)) std::swap(wants_[lane][0], wants_[lane][1]);
    offered_[lane] = wants_[lane];
    if (one_of(traffic.withhold)) offered_[lane][bench_.random() % 2].valid = false;
  }

  TreeBanks::AllWants wants() const {
    TreeBanks::AllWants wants{};
    for (uint32_t lane = 0; lane < kLanes; ++lane) wants[lane] = &offered_[lane];
    return wants;
  }
  // Lanes that want nothing may be among them.
  uint32_t wanting() {
    auto lanes = static_cast<uint32_t>(bench_.random());
    for (uint32_t lane = 0; lane < kLanes; ++lane)
      lanes |= (offered_[lane][0].valid || offered_[lane][1].valid ? 1u : 0u) << lane;
    return lanes & static_cast<uint32_t>((uint64_t{1} << kLanes) - 1);
  }

  uint32_t any_line(const Traffic& traffic) {
    uint32_t line = static_cast<uint32_t>(bench_.random()) % traffic.lines;
    constexpr uint32_t kSets = P::kSizes.lines / P::kSizes.ways;  // of all banks
    if (traffic.sets != 0) line = line % traffic.sets % kSets + line / traffic.sets * kSets;
    if (one_of(traffic.other_bit)) line ^= 1u << bench_.random() % P::kLineBits;
    return line;
  }

  // Of the lines on their way any may come next; then it waits until it is taken.
  void choose_fill() {
    std::swap(on_way_.front(), on_way_[bench_.random() % std::min<size_t>(on_way_.size(), 3)]);
    fills_ = true;
  }

  // What means nothing is noise.
  void drive(uint32_t room, bool request_ready) {
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      for (uint32_t i = 0; i < 2; ++i) {
        const LineWant& want = offered_[lane][i];
        const uint32_t at = 2 * lane + i;
        const auto noise = static_cast<uint32_t>(bench_.random());
        set_bits(u_.want_valid_i, at, 1, want.valid);
        set_bits(u_.want_prefetch_i, at, 1, want.valid ? want.prefetch : noise >> 31);
        // Invalid wants of a line that others want must not be taken for it.
        const uint32_t line = want.valid ? want.line : (noise & 1) != 0 ? offered_[noise % kLanes][i].line : noise;
        set_bits(u_.want_line_i, at * P::kLineBits, P::kLineBits, line);
        set_bits(u_.want_slot_i, at * kSlotBits, kSlotBits, want.valid && !want.prefetch ? want.slot : noise >> 9);
      }
    }
    u_.waited_ready_i = room;
    u_.request_ready_i = request_ready;
    u_.fill_valid_i = fills_;
    fill_id_ = fills_
                   ? on_way_.front().id
                   : bench_.random() % P::kSizes.banks << kMshrBits | static_cast<uint32_t>(bench_.random()) % kMshrs;
    u_.fill_id_i = fill_id_;
    u_.fill_data_i = fills_ ? line_data(on_way_.front().line) : static_cast<uint32_t>(bench_.random());
    u_.eval();
  }

  void compare(uint32_t waited) {
    ASSERT_EQ(u_.waited_valid_o, waited) << "cycle " << cycle_;
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
      ASSERT_EQ(get_bits(u_.taken_o, 2 * lane, 2), banks_.taken(lane)) << "cycle " << cycle_ << ", lane " << lane;
    }
    ASSERT_EQ(u_.given_valid_o, banks_.given_lanes()) << "cycle " << cycle_;
    ASSERT_EQ(u_.request_valid_o, banks_.request_valid()) << "cycle " << cycle_;
    if (banks_.request_valid()) {
      ASSERT_EQ(u_.request_id_o, banks_.request_id()) << "cycle " << cycle_;
      ASSERT_EQ(u_.request_line_o, banks_.request_line()) << "cycle " << cycle_;
    }
    ASSERT_EQ(u_.fill_ready_o, banks_.fill_ready(fill_id_)) << "cycle " << cycle_;
  }

  void take_given() {
    for (uint32_t bits = banks_.given_lanes(); bits != 0; bits &= bits - 1) {
      const uint32_t lane = lowest(bits);
      const TreeBanks::Given& now = banks_.given(lane);
      ASSERT_EQ(get_bits(u_.given_slot_o, lane * kSlotBits, kSlotBits), now.slot) << "cycle " << cycle_;
      const auto wanted = wanted_.find({lane, now.slot});
      ASSERT_NE(wanted, wanted_.end()) << "a ray gets a line that it has not asked for";
      ASSERT_EQ(get_bits(u_.given_data_o, lane * 32, 32), line_data(wanted->second)) << "cycle " << cycle_;
      ASSERT_EQ(rows_[now.row], line_data(wanted->second)) << "cycle " << cycle_;
      free_[lane].push_back(now.slot);
      wanted_.erase(wanted);
      ++given;
    }
  }

  // What stays a lane's first want is taken when its bank has been ready so often that all lanes were chosen.
  void take_wanted(uint32_t lane, uint32_t waited, const std::array<bool, TreeBanks::kMostBanks>& looks) {
    const LineWant& first = offered_[lane][0];
    const uint32_t taken = banks_.taken(lane);
    if (!first.valid || (waited >> lane & 1) != 0 || taken == 1 || first.line != first_[lane].line) first_[lane] = {};
    if (first.valid && (waited >> lane & 1) == 0 && taken != 1) {
      first_[lane].line = first.line;
      first_[lane].passed += looks[first.line % P::kSizes.banks] ? 1 : 0;
      ASSERT_LT(first_[lane].passed, kLanes) << "lane " << lane << " waits for its bank in cycle " << cycle_;
    }
    if (taken == 0) return;
    ASSERT_EQ(waited >> lane & 1, 0u) << "cycle " << cycle_;
    ASSERT_TRUE(offered_[lane][taken >> 1].valid) << "cycle " << cycle_;
    seconds += taken >> 1;
    LineWant& want = wants_[lane][taken >> 1];
    if (!want.prefetch) wanted_[{lane, want.slot}] = want.line;
    want.valid = false;
  }

  void take_fill() {
    const bool filled = banks_.fill_ready(fill_id_);
    ASSERT_TRUE(filled || !fill_waited_) << "a line waits for more than a cycle";
    fill_waited_ = !filled;
    if (!filled) return;
    rows_[banks_.fill_row(fill_id_)] = line_data(on_way_.front().line);
    ASSERT_EQ(asked_.erase(on_way_.front().line), 1u);
    on_way_.pop_front();
    fills_ = false;
  }

  void look_at_request(bool taken) {
    const OnWay request{banks_.request_line(), banks_.request_id()};
    gave_way += request_waits_ && request.id != request_.id ? 1 : 0;
    request_waits_ = !taken;
    request_ = request;
    if (!taken) return;
    ASSERT_EQ(request.line % P::kSizes.banks, request.id >> kMshrBits) << "cycle " << cycle_;
    ASSERT_EQ(asked_.count(request.line), 0u) << "line " << request.line << " is asked for twice";
    asked_[request.line] = true;
    on_way_.push_back(request);
    most_on_way = std::max<uint64_t>(most_on_way, on_way_.size());
  }

  Clocked<typename P::Verilated> bench_;
  typename P::Verilated& u_ = *bench_.u;
  TreeBanks banks_{P::kSizes};
  uint64_t cycle_ = 0;
  uint32_t tree_ = 12345;                                         // that the memory has
  std::map<uint32_t, std::deque<uint32_t>> free_;                 // [lane] slots that wait for nothing
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> wanted_;      // [lane, slot] line
  std::array<LineWants, TreeBanks::kMostLanes> wants_, offered_;  // that each lane has, and what it offers of them
  struct First {
    uint32_t line = UINT32_MAX, passed = 0;  // how often its bank chose another
  };
  std::array<First, TreeBanks::kMostLanes> first_;
  std::deque<OnWay> on_way_;  // the first of which comes, if one does
  std::map<uint32_t, bool> asked_;
  bool fills_ = false, fill_waited_ = false, request_waits_ = false;
  OnWay request_{};
  uint32_t fill_id_ = 0;
  std::vector<Line> rows_;
};

template <typename P>
class TreeBanksTest : public testing::Test {};
#ifdef RAYPOOL_LARGE  // tree_banks_large_test, of make test-long
using All = testing::Types<Parameters<Vtree_banks_8_24_1024_16_64_8_26_32, 8, 24, 1024, 16, 64, 8, 26>,
                           Parameters<Vtree_banks_32_2_32_2_4_1_9_32, 32, 2, 32, 2, 4, 1, 9>>;
#else
using All = testing::Types<Parameters<Vtree_banks_1_2_4_2_1_1_5_32, 1, 2, 4, 2, 1, 1, 5>,
                           Parameters<Vtree_banks_3_5_64_4_6_2_23_32, 3, 5, 64, 4, 6, 2, 23>,
                           Parameters<Vtree_banks_16_3_64_2_12_4_20_32, 16, 3, 64, 2, 12, 4, 20>,
                           Parameters<Vtree_banks_2_9_256_4_16_16_12_32, 2, 9, 256, 4, 16, 16, 12>>;
#endif
TYPED_TEST_SUITE(TreeBanksTest, All);

TYPED_TEST(TreeBanksTest, AgreesWithItsClassInEveryCycle) {
  constexpr TreeBanks::Sizes kSizes = TypeParam::kSizes;
  TreeBanks::Work seen;
  uint64_t given = 0, seconds = 0, gave_way = 0, most = 0;
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    constexpr uint32_t kLines = kSizes.lines;
    for (const Traffic& traffic :
         {Traffic{1, 0, 1, 0, 0, 1, kLines, 0}, Traffic{1, 0, 0, 0, 0, 1, 2 * kLines, 5},
          Traffic{1, 2, 2, 3, 2, 4, 3 * kLines, 3}, Traffic{1, 0, 1, 9, 0, 40, 1 << 20, 0},
          Traffic{3, 1, 1, 5, 5, 2, 20, 9}, Traffic{9, 2, 3, 0, 2, 5, 5, 2}, Traffic{1, 0, 2, 0, 0, 60, 4 * kLines, 4},
          Traffic{2, 0, 1, 0, 9, 9, 2 * kLines, 3}, Traffic{1, 3, 1, 0, 0, 1, kLines + 3, 0},
          Traffic{1, 4, 0, 0, 3, 2, 3, 4}, Traffic{1, 2, 1, 0, 2, 3, kLines, 7, 0, 2}}) {
      for (uint32_t i = 0; i < 3000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
      ASSERT_NO_FATAL_FAILURE(bench.drain());
    }
    given += bench.given;
    seconds += bench.seconds;
    gave_way += bench.gave_way;
    most = std::max(most, bench.most_on_way);
    seen.both_chosen += bench.work().both_chosen;
    seen.shared += bench.work().shared;
    seen.offered_twice += bench.work().offered_twice;
    seen.left += bench.work().left;
    seen.late_fills += bench.work().late_fills;
  }
  EXPECT_GT(given, 1000u);
  EXPECT_GT(seconds, 100u);
  EXPECT_GT(seen.left, 100u) << "a lane leaves a line for which it has waited";
  EXPECT_GT(seen.late_fills, 100u) << "a line waits";
  EXPECT_EQ(most, kSizes.mshrs);
  if (kSizes.lanes > 1) {
    EXPECT_GT(seen.shared, 1000u) << "lanes look a line up together";
  }
  if (kSizes.banks == 1) return;
  EXPECT_GT(seen.both_chosen, 1000u) << "two banks have chosen wants of a lane";
  EXPECT_GT(seen.offered_twice, 100u) << "two banks have lines for a lane that has waited";
  EXPECT_GT(gave_way, 50u) << "a request waits, and another bank's takes its place";
}

TYPED_TEST(TreeBanksTest, HaveNoLineOfTheTreeBeforeBehindAReset) {
  constexpr uint32_t kLines = TypeParam::kSizes.lines;
  uint64_t with_fill = 0, given = 0;
  Bench<TypeParam> bench(7);
  for (uint32_t tree = 0; tree < 300; ++tree) {
    const Traffic all[] = {
        {1, 0, 1, 0, 0, 1, kLines, 3}, {1, 3, 1, 5, 2, 4, kLines / 2, 2}, {1, 2, 1, 0, 0, 9, kLines}};
    const Traffic& traffic = all[tree % 3];
    for (uint32_t i = 0; i < std::max(kLines, 60u); ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
    ASSERT_NO_FATAL_FAILURE(bench.restart(traffic));
  }
  with_fill += bench.restarts_with_fill;
  given += bench.given;
  EXPECT_GT(with_fill, 20u);
  EXPECT_GT(given, 300u);
}

// Of these a bank has more registers than ways.
template <typename P>
class TreeBanksOfMoreMisses : public testing::Test {};
#ifdef RAYPOOL_LARGE
using MoreMisses = testing::Types<Parameters<Vtree_banks_32_2_32_2_4_1_9_32, 32, 2, 32, 2, 4, 1, 9>>;
#else
using MoreMisses = testing::Types<Parameters<Vtree_banks_16_3_64_2_12_4_20_32, 16, 3, 64, 2, 12, 4, 20>>;
#endif
TYPED_TEST_SUITE(TreeBanksOfMoreMisses, MoreMisses);

// Lines of one set, or of one in each bank and more, that come back one at a time.
TYPED_TEST(TreeBanksOfMoreMisses, MissesOfOneSetWaitForAWayThoughARegisterIsFree) {
  constexpr TreeBanks::Sizes kSizes = TypeParam::kSizes;
  uint64_t waits = 0, others = 0, own = 0;
  for (uint32_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    constexpr uint32_t kLines = 4 * kSizes.ways, kBanks = kSizes.banks;
    for (const uint32_t prefetch : {0u, 4u}) {
      for (const Traffic& traffic : {Traffic{1, 0, 1, 0, 0, 4, kLines, prefetch, 1},
                                     Traffic{1, 2, 1, 3, 0, 12, 2 * kBanks * kLines, prefetch, 2 * kBanks},
                                     Traffic{1, 0, 0, 0, 3, 12, 3 * kLines, prefetch, kBanks + 1},
                                     Traffic{1, 0, 1, 0, 0, 90, 2 * kLines, prefetch, kBanks + 1},
                                     Traffic{1, 0, 0, 0, 0, 7, kBanks * kLines, prefetch, 1 + kBanks, 5}}) {
        for (uint32_t i = 0; i < 3000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
        ASSERT_NO_FATAL_FAILURE(bench.drain());
      }
    }
    for (const FullSets& bank : bench.full_sets) {
      waits += bank.waits;
      others += bank.others_freed;
      own += bank.own_freed;
    }
  }
  EXPECT_GT(waits, 50u) << "no lookup waits for a way while a register is free";
  EXPECT_GT(others, 20u) << "no other register is freed meanwhile";
  EXPECT_GT(own, 50u) << "no way of the set is given back";
}

}  // namespace
}  // namespace raypool::bench
