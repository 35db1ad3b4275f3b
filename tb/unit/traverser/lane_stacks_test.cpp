// The stacks of a lane of the traverser in Verilog against their class, all outputs in every cycle; and both against
// stacks that are never full: every ray goes on with the entry that it must, or is done.
#include "machine/traverser/lane_stacks.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <map>
#include <vector>

#include "Vlane_stacks_1_8_3_12_7.h"
#include "Vlane_stacks_24_16_32_32_7.h"
#include "Vlane_stacks_33_64_2_9_2.h"
#include "Vlane_stacks_3_9_21_20_3.h"
#include "Vlane_stacks_5_8_6_10_4.h"
#include "Vlane_stacks_8_12_8_8_7.h"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"

namespace raypool::bench {
namespace {

/// SLOTS, ENTRIES, KEY_BITS, REFERENCE_BITS, BLOCK_BITS.
template <typename Unit, uint32_t slots, uint32_t entries, uint32_t key, uint32_t reference, uint32_t block>
struct Parameters {
  using Verilated = Unit;
  static constexpr uint32_t kSlots = slots, kEntries = entries, kKey = key, kReference = reference;
  static constexpr uint32_t kEntry = key + reference, kMostBlocks = (1u << block) - 1;
  /// That fit, wherever they are: a stack spills when it has more than entries - 3 in the RAM.
  static constexpr uint32_t kMostEntries = 4 * kMostBlocks + entries - 3;
};

/// One in so many cycles (0: never): a ray begins, a node or a leaf has a result, the memory leaves a request, a block
/// comes. One in so many nodes meets no child, one in so many leaves ends its ray. `limits`: one in so many limits lies
/// behind every entry, the others anywhere.
struct Traffic {
  uint32_t begin = 1, node = 1, leaf = 1, leave_request = 0, fill = 1, no_child = 4, over = 0, limits = 2;
};

template <typename P>
class Bench {
 public:
  explicit Bench(uint32_t seed) : bench_(seed), rays_(P::kSlots) {}

  void clock(const Traffic& traffic) {
    ASSERT_NO_FATAL_FAILURE(look_at_registers());
    const uint32_t begins = choose(Ray::State::None, traffic.begin);
    // The slot of a result is given a cycle ahead.
    node_slot_ = node_ahead_;
    leaf_slot_ = leaf_ahead_;
    node_ahead_ = choose(Ray::State::Visits, traffic.node);
    leaf_ahead_ = choose(Ray::State::Visits, traffic.leaf);
    if (leaf_ahead_ == node_ahead_) leaf_ahead_ = kNoSlot;
    if (node_slot_ != kNoSlot) roll_node(traffic);
    if (leaf_slot_ != kNoSlot) leaf_ = {leaf_slot_, limit(traffic), one_of(traffic.over)};
    fills_ = asked_ && one_of(traffic.fill);
    const bool request_ready = !one_of(traffic.leave_request);
    drive(begins, request_ready);

    LaneStacks::Inputs inputs;
    inputs.node = node_slot_ != kNoSlot ? &node_ : nullptr;
    inputs.leaf = leaf_slot_ != kNoSlot ? &leaf_ : nullptr;
    inputs.request_taken = request_ready && stacks_.request_valid();
    inputs.filled = fills_ ? &memory_.at(asked_block_) : nullptr;
    if (inputs.request_taken) {
      ASSERT_NO_FATAL_FAILURE(take_request());
    }
    take_results();
    const LaneStacks::Outcome outcome = stacks_.clock(inputs);
    ASSERT_NO_FATAL_FAILURE(compare(outcome));
    ASSERT_NO_FATAL_FAILURE(take_outcome(outcome));
    if (begins != kNoSlot && outcome.ray_ready) {
      stacks_.begin(begins);
      rays_[begins].state = Ray::State::Visits;
      rays_[begins].stack.clear();
      ++begun;
    }
    waited_ = stacks_.fill_waits() ? waited_ + 1 : 0;
    most_waiting = std::max<uint64_t>(most_waiting, std::count_if(rays_.begin(), rays_.end(), [](const Ray& ray) {
                                        return ray.state == Ray::State::Waits;
                                      }));
    bench_.clock();
    ++cycle_;
  }
  /// No ray begins, and all are done in time.
  void drain() {
    const auto done = [](const Ray& ray) { return ray.state == Ray::State::None; };
    for (uint32_t i = 0; i < 40000 && !std::all_of(rays_.begin(), rays_.end(), done); ++i)
      ASSERT_NO_FATAL_FAILURE(clock({0, 3, 1, 3, 5, 1, 60, 2}));
    EXPECT_TRUE(std::all_of(rays_.begin(), rays_.end(), done)) << "a ray waits for ever";
    EXPECT_FALSE(asked_);
  }
  const LaneStacks::Work& work() const { return stacks_.work(); }

  uint64_t begun = 0, went_on = 0, emptied = 0, over_with_entries = 0, most_waiting = 0;
  uint32_t most_blocks = 0;

 private:
  static constexpr uint32_t kNoSlot = UINT32_MAX;

  struct Ray {
    enum class State : uint8_t { None, Visits, Waits };
    State state = State::None;
    std::vector<LaneStacks::Entry> stack;
    bool done = false;       ///< is what comes of its visit; else it goes on with:
    uint32_t reference = 0;  ///<
  };

  bool one_of(uint32_t n) { return n != 0 && bench_.one_of(n); }
  static constexpr uint32_t mask(uint32_t bits) { return UINT32_MAX >> (32 - bits); }
  uint32_t any(uint32_t bits) { return static_cast<uint32_t>(bench_.random()) & mask(bits); }
  LaneStacks::Entry any_entry() { return {any(P::kKey), any(P::kReference)}; }
  uint32_t limit(const Traffic& traffic) { return one_of(traffic.limits) ? mask(P::kKey) : any(P::kKey); }

  // A slot in this state, without those that have a result.
  uint32_t choose(typename Ray::State state, uint32_t one_in) {
    if (!one_of(one_in)) return kNoSlot;
    const uint32_t first = bench_.random() % P::kSlots;
    for (uint32_t i = 0; i < P::kSlots; ++i) {
      const uint32_t slot = (first + i) % P::kSlots;
      if (rays_[slot].state == state && slot != node_slot_ && slot != leaf_slot_) return slot;
    }
    return kNoSlot;
  }

  // While a block waits, nodes have results for the time of a pipe only. Stacks are as deep as the memory lets them be.
  void roll_node(const Traffic& traffic) {
    const Ray& ray = rays_[node_slot_];
    node_ = {node_slot_, one_of(traffic.no_child) ? 0 : 1 + any(2), any(P::kReference), {}, limit(traffic)};
    for (LaneStacks::Entry& other : node_.others) other = any_entry();
    if (waited_ > 8 || ray.stack.size() + 3 > P::kMostEntries) node_.children = 0;
  }

  void set_entry(uint32_t place, const LaneStacks::Entry& entry, bool fill) {
    const uint32_t first = place * P::kEntry;
    if (fill) {
      set_bits(u_.fill_entries_i, first, P::kReference, entry.reference);
      set_bits(u_.fill_entries_i, first + P::kReference, P::kKey, entry.key);
    } else {
      set_bits(u_.node_others_i, first, P::kReference, entry.reference);
      set_bits(u_.node_others_i, first + P::kReference, P::kKey, entry.key);
    }
  }

  // What means nothing is noise.
  void drive(uint32_t begins, bool request_ready) {
    const auto slot = [&](uint32_t of) { return of != kNoSlot ? of : any(8) % P::kSlots; };
    const bool node = node_slot_ != kNoSlot, leaf = leaf_slot_ != kNoSlot;
    u_.ray_valid_i = begins != kNoSlot;
    u_.ray_slot_i = slot(begins);
    u_.node_valid_i = node;
    u_.node_slot_i = slot(node_ahead_);
    u_.node_children_i = node ? node_.children : any(3);
    u_.node_nearest_i = node && node_.children > 0 ? node_.nearest : any(P::kReference);
    u_.node_limit_i = node && node_.children == 0 ? node_.limit : any(P::kKey);
    for (uint32_t i = 0; i < LaneStacks::kLeast; ++i)
      set_entry(i, node && i + 1 < node_.children ? node_.others[i] : any_entry(), false);
    u_.leaf_valid_i = leaf;
    u_.leaf_slot_i = slot(leaf_ahead_);
    u_.leaf_limit_i = leaf ? leaf_.limit : any(P::kKey);
    u_.leaf_over_i = leaf ? leaf_.over : any(1);
    u_.request_ready_i = request_ready;
    u_.fill_valid_i = fills_;
    for (uint32_t i = 0; i < LaneStacks::kBlock; ++i)
      set_entry(i, fills_ ? memory_.at(asked_block_)[i] : any_entry(), true);
    u_.eval();
  }

  LaneStacks::Entry requested(uint32_t place) const {
    const uint32_t first = place * P::kEntry;
    return {get_bits(u_.request_entries_o, first + P::kReference, P::kKey),
            get_bits(u_.request_entries_o, first, P::kReference)};
  }

  // These do not depend on what comes in this cycle: it has not yet been driven.
  void look_at_registers() {
    u_.eval();
    ASSERT_EQ(u_.request_valid_o, stacks_.request_valid()) << "cycle " << cycle_;
    if (stacks_.request_valid()) {
      const LaneStacks::Request& request = stacks_.request();
      ASSERT_EQ(u_.request_write_o, request.write) << "cycle " << cycle_;
      ASSERT_EQ(u_.request_slot_o, request.slot) << "cycle " << cycle_;
      ASSERT_EQ(u_.request_block_o, request.block) << "cycle " << cycle_;
      for (uint32_t i = 0; request.write && i < LaneStacks::kBlock; ++i) {
        ASSERT_EQ(requested(i).key, request.entries[i].key) << "cycle " << cycle_;
        ASSERT_EQ(requested(i).reference, request.entries[i].reference) << "cycle " << cycle_;
      }
    }
    ASSERT_EQ(u_.fill_waits_o, stacks_.fill_waits()) << "cycle " << cycle_;
    next_valid_ = u_.next_valid_o;
    next_slot_ = u_.next_slot_o;
    next_reference_ = u_.next_reference_o;
  }

  void compare(const LaneStacks::Outcome& outcome) {
    ASSERT_EQ(u_.node_goes_on_o, outcome.node_goes_on) << "cycle " << cycle_;
    ASSERT_EQ(u_.ray_ready_o, outcome.ray_ready) << "cycle " << cycle_;
    ASSERT_EQ(u_.next_valid_o, outcome.next) << "cycle " << cycle_;
    ASSERT_EQ(next_valid_, outcome.next) << "cycle " << cycle_;
    if (outcome.next) {
      ASSERT_EQ(u_.next_slot_o, outcome.slot) << "cycle " << cycle_;
      ASSERT_EQ(u_.next_reference_o, outcome.reference) << "cycle " << cycle_;
      ASSERT_EQ(next_slot_, outcome.slot) << "cycle " << cycle_;
      ASSERT_EQ(next_reference_, outcome.reference) << "cycle " << cycle_;
    }
    ASSERT_EQ(u_.done_valid_o, outcome.done) << "cycle " << cycle_;
    if (outcome.done) {
      ASSERT_EQ(u_.done_slot_o, outcome.slot) << "cycle " << cycle_;
    }
  }

  // The memory keeps what the Verilog writes, and brings what it asks for, one block after the other.
  void take_request() {
    const std::pair<uint32_t, uint32_t> block{u_.request_slot_o, u_.request_block_o};
    if (u_.request_write_o == 0) {
      ASSERT_FALSE(asked_) << "cycle " << cycle_;
      ASSERT_EQ(memory_.count(block), 1u) << "cycle " << cycle_;
      asked_ = true;
      asked_block_ = block;
      return;
    }
    for (uint32_t i = 0; i < LaneStacks::kBlock; ++i) memory_[block][i] = requested(i);
    most_blocks = std::max(most_blocks, block.second + 1);
  }

  // What must come of the cycle's visits.
  void take_results() {
    if (fills_) asked_ = false;
    if (node_slot_ != kNoSlot) {
      Ray& ray = rays_[node_slot_];
      for (uint32_t i = 0; i + 1 < node_.children; ++i) ray.stack.push_back(node_.others[i]);
      ray.done = false;
      ray.reference = node_.nearest;
      if (node_.children == 0) take_entry(ray, node_.limit);
      ray.state = Ray::State::Waits;
    }
    if (leaf_slot_ != kNoSlot) {
      Ray& ray = rays_[leaf_slot_];
      ray.done = leaf_.over;
      if (!leaf_.over) take_entry(ray, leaf_.limit);
      over_with_entries += leaf_.over && !ray.stack.empty() ? 1 : 0;
      ray.state = Ray::State::Waits;
    }
  }
  void take_entry(Ray& ray, uint32_t limit) {
    const bool some = !ray.stack.empty();
    while (!ray.stack.empty() && ray.stack.back().key > limit) ray.stack.pop_back();
    ray.done = ray.stack.empty();
    emptied += some && ray.done ? 1 : 0;
    if (ray.done) return;
    ray.reference = ray.stack.back().reference;
    ray.stack.pop_back();
  }

  void take_outcome(const LaneStacks::Outcome& outcome) {
    if (outcome.node_goes_on) {
      ASSERT_NO_FATAL_FAILURE(answer(node_slot_, false, node_.nearest));
    }
    if (outcome.next) {
      ASSERT_NO_FATAL_FAILURE(answer(outcome.slot, false, outcome.reference));
    }
    if (outcome.done) {
      ASSERT_NO_FATAL_FAILURE(answer(outcome.slot, true, 0));
    }
  }
  void answer(uint32_t slot, bool done, uint32_t reference) {
    Ray& ray = rays_[slot];
    ASSERT_EQ(ray.state, Ray::State::Waits) << "cycle " << cycle_ << ": a ray that waits for nothing";
    ASSERT_EQ(done, ray.done) << "cycle " << cycle_;
    if (!done) {
      ASSERT_EQ(reference, ray.reference) << "cycle " << cycle_;
      ++went_on;
    }
    ray.state = done ? Ray::State::None : Ray::State::Visits;
  }

  Clocked<typename P::Verilated> bench_;
  typename P::Verilated& u_ = *bench_.u;
  LaneStacks stacks_{{P::kSlots, P::kEntries}};
  uint64_t cycle_ = 0;
  std::vector<Ray> rays_;
  uint32_t node_slot_ = kNoSlot, leaf_slot_ = kNoSlot;    // slots with results in this cycle
  uint32_t node_ahead_ = kNoSlot, leaf_ahead_ = kNoSlot;  // and in the next one
  LaneStacks::NodeResult node_;
  LaneStacks::LeafResult leaf_;
  std::map<std::pair<uint32_t, uint32_t>, LaneStacks::Block> memory_;  // [slot, block]
  std::pair<uint32_t, uint32_t> asked_block_;
  bool asked_ = false, fills_ = false;
  uint32_t waited_ = 0;  // cycles that a block has waited
  bool next_valid_ = false;
  uint32_t next_slot_ = 0, next_reference_ = 0;
};

template <typename P>
class LaneStacksTest : public testing::Test {};
using All = testing::Types<
    Parameters<Vlane_stacks_1_8_3_12_7, 1, 8, 3, 12, 7>, Parameters<Vlane_stacks_3_9_21_20_3, 3, 9, 21, 20, 3>,
    Parameters<Vlane_stacks_5_8_6_10_4, 5, 8, 6, 10, 4>, Parameters<Vlane_stacks_8_12_8_8_7, 8, 12, 8, 8, 7>,
    Parameters<Vlane_stacks_24_16_32_32_7, 24, 16, 32, 32, 7>, Parameters<Vlane_stacks_33_64_2_9_2, 33, 64, 2, 9, 2>>;
TYPED_TEST_SUITE(LaneStacksTest, All);

TYPED_TEST(LaneStacksTest, AgreesWithItsClassInEveryCycle) {
  LaneStacks::Work seen;
  uint64_t waiting = 0, emptied = 0, over = 0;
  uint32_t blocks = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench<TypeParam> bench(seed);
    for (const Traffic& traffic :
         {Traffic{1, 1, 1, 0, 1, 4, 0, 2}, Traffic{1, 1, 9, 0, 20, 30, 0, 1}, Traffic{1, 1, 2, 3, 5, 3, 4, 1},
          Traffic{1, 1, 3, 2, 40, 5, 30, 1}, Traffic{1, 1, 0, 0, 1, 99, 0, 1}, Traffic{9, 3, 1, 0, 3, 2, 40, 5},
          Traffic{1, 1, 4, 9, 2, 9, 0, 30}, Traffic{5, 3, 3, 1, 8, 3, 9, 2}, Traffic{1, 1, 0, 2, 1, 0, 0, 1},
          Traffic{1, 1, 1, 2, 3, 6, 0, 3}, Traffic{3, 2, 1, 0, 1, 2, 3, 4}}) {
      for (uint32_t i = 0; i < 4000; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
      ASSERT_NO_FATAL_FAILURE(bench.drain());
    }
    EXPECT_GT(bench.begun, 10 * TypeParam::kSlots);
    seen.spilled += bench.work().spilled;
    seen.fetched += bench.work().fetched;
    seen.dropped += bench.work().dropped;
    seen.late_fills += bench.work().late_fills;
    seen.late_retries += bench.work().late_retries;
    seen.late_spills += bench.work().late_spills;
    for (uint32_t i = 0; i < 2; ++i) seen.popped[i] += bench.work().popped[i];
    waiting = std::max(waiting, bench.most_waiting);
    emptied += bench.emptied;
    over += bench.over_with_entries;
    blocks = std::max(blocks, bench.most_blocks);
  }
  EXPECT_GT(seen.spilled, 500u);
  EXPECT_GT(seen.fetched, 500u);
  EXPECT_GT(seen.dropped, 5000u);
  EXPECT_GT(seen.popped[0], 2000u);
  EXPECT_GT(seen.popped[1], 2000u);
  EXPECT_GT(emptied, 200u);
  EXPECT_GT(over, 200u);
  EXPECT_EQ(waiting, TypeParam::kSlots);
  EXPECT_GE(blocks, 3u);
  if (TypeParam::kSlots == 1) return;
  EXPECT_GT(seen.late_spills, 20u) << "a stack spills while a request waits";
  EXPECT_GT(seen.late_retries, 20u) << "a block has come while another ray's entries are taken off";
  if (TypeParam::kEntries == 64) return;
  EXPECT_GT(seen.late_fills, 20u) << "a block comes while children are put on a stack";
}

}  // namespace
}  // namespace raypool::bench
