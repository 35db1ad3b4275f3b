// A lane and its triangle pipe in Verilog and as classes, side by side, between caches and a memory that answer when
// they like: all outputs in every cycle, and of every ray what it visits and hits.
#pragma once

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "machine/traverser/traverser_lane.hpp"
#include "machine/traverser/triangle_pipe.hpp"
#include "unit/common/clocked.hpp"
#include "unit/common/signal_bits.hpp"
#include "unit/traverser/lane_trees.hpp"
#include "unit/traverser/triangle_signals.hpp"

namespace raypool::bench {

/// One in so many cycles (0: never): a ray begins, its set-up takes a cycle more, the memory leaves a request, brings a
/// block, the triangle pipe leaves a test, a ray that is done is left; of lookups, one in so many is left, and is not
/// in the cache: its line comes with one in so many cycles; one in so many slots that are free stays so for a cycle.
struct LaneTraffic {
  uint32_t begin = 1, set_up = 2, leave_request = 4, fill = 2, leave_test = 0, leave_done = 4, leave_lookup = 8,
           miss = 4, line = 8, free = 2;
};

struct LaneSeen {
  uint64_t cycles = 0, rays = 0, hits = 0, shadows = 0, blocked = 0, visits = 0, misses = 0, offers = 0;
  uint64_t told_now = 0, told_before = 0;  ///< best hits that are a result of the same cycle, or of the one before
  uint64_t ahead = 0, kept = 0, spilled = 0, fetched = 0, dropped = 0;
  uint32_t most_rays = 0, deepest = 0;
};

/// Unit: lane_units with these parameters.
template <typename Unit, uint32_t slots, uint32_t entries, uint32_t bits, uint32_t triangle_bits>
struct LaneParameters {
  using Verilated = Unit;
  static constexpr uint32_t kSlots = slots, kEntries = entries, kBits = bits, kTriangleBits = triangle_bits;
  static constexpr uint32_t kKey = bits + 9, kEntry = kKey + 32;
  static constexpr uint32_t slot_bits() {
    uint32_t count = 1;
    while ((1u << count) < slots) ++count;
    return count;
  }
};

/// A cache as its lane sees it.
class LaneCache {
 public:
  struct Turn {
    uint8_t taken = 0;  // bit i: want i
    bool waited = false;
  };

  /// What is given in this cycle, or null.
  const LeafReader::Given* given() const { return line_[0] ? &*line_[0] : nullptr; }

  /// Which want it takes, if any. A lane to which it offers a line asks for none.
  template <typename Random>
  Turn turn(const LineWants& wants, bool room, const std::vector<TreeLine>& lines, const LaneTraffic& traffic,
            Random&& one_of, LaneSeen& seen) {
    Turn turn;
    for (Waiter& waiter : waiters_) waiter.come = waiter.come || one_of(traffic.line);
    const auto come = std::find_if(waiters_.begin(), waiters_.end(), [](const Waiter& waiter) { return waiter.come; });
    if (come != waiters_.end()) {
      if (!room) return turn;
      turn.waited = true;
      ++seen.offers;
      line_[2] = LeafReader::Given{come->want.slot, &lines.at(come->want.line)};
      waiters_.erase(come);
      return turn;
    }
    for (uint32_t i = 0; i < wants.size() && turn.taken == 0; ++i)
      if (wants[i].valid && !one_of(traffic.leave_lookup)) turn.taken = static_cast<uint8_t>(1u << i);
    if (turn.taken == 0 || wants[turn.taken >> 1].prefetch) return turn;
    const LineWant& want = wants[turn.taken >> 1];
    if (one_of(traffic.miss)) {
      ++seen.misses;
      waiters_.push_back({want, false});
    } else {
      line_[2] = LeafReader::Given{want.slot, &lines.at(want.line)};
    }
    return turn;
  }
  void clock() {
    line_[0] = line_[1];
    line_[1] = line_[2];
    line_[2].reset();
  }

 private:
  struct Waiter {
    LineWant want;
    bool come;
  };
  std::vector<Waiter> waiters_;
  std::array<std::optional<LeafReader::Given>, 3> line_;  // given now, and in the next two cycles
};

template <typename P>
class LaneBench {
 public:
  struct Asked {
    LaneRay ray;
    Walk walk;
  };

  explicit LaneBench(uint32_t seed) : bench_(seed), tracing_(P::kSlots) {}

  /// Traces the rays; all are done in time. `tree` must outlive the call.
  void trace(const LaneTree& tree, const std::vector<Asked>& rays, const LaneTraffic& traffic) {
    begin(tree, rays);
    uint64_t lines = 100;
    for (const Asked& asked : rays) lines += 1 + asked.walk.lines.size();
    // A visit takes 60 cycles or so by itself, and some 60 more where nothing is there at once.
    const uint64_t end = seen.cycles + 400 * lines;
    while (done_ < rays.size()) {
      ASSERT_LT(seen.cycles, end) << "a ray waits for ever";
      ASSERT_NO_FATAL_FAILURE(cycle(traffic));
    }
    for (const Asked& asked : rays) seen.deepest = std::max(seen.deepest, asked.walk.deepest);
    seen.ahead = lane_.leaves().looked_ahead();
    seen.kept = lane_.leaves().waited_for_kept();
    seen.spilled = lane_.stack_work().spilled;
    seen.fetched = lane_.stack_work().fetched;
    seen.dropped = lane_.stack_work().dropped;
  }

  /// Traces them for so many cycles and is stopped: it comes to rest, with rays in it. The bench is of no use behind
  /// it.
  void trace_and_stop(const LaneTree& tree, const std::vector<Asked>& rays, const LaneTraffic& traffic,
                      uint32_t cycles) {
    begin(tree, rays);
    for (uint32_t i = 0; i < cycles; ++i) ASSERT_NO_FATAL_FAILURE(cycle(traffic));
    stopped_ = true;
    for (uint32_t i = 0; i < 600; ++i) ASSERT_NO_FATAL_FAILURE(cycle({}));
    for (const LineWants& wants : {wants_nodes(), lane_.leaf_wants()})
      ASSERT_FALSE(wants[0].valid || wants[1].valid) << "it goes on";
  }

  LaneSeen seen;

 private:
  void begin(const LaneTree& tree, const std::vector<Asked>& rays) {
    tree_ = &tree;
    lane_.set_tree(tree.root, static_cast<uint32_t>(tree.nodes.size()));
    u_.root_i = tree.root;
    u_.nodes_i = static_cast<uint32_t>(tree.nodes.size());
    rays_ = &rays;
    begun_ = done_ = 0;
  }
  struct Tracing {
    const Asked* asked = nullptr;
    size_t lines = 0;  // looked up
  };
  struct SetUp {
    uint32_t slot;
    const Asked* asked;
  };

  LineWants wants_nodes() const { return lane_.wants_node() ? lane_.node_wants() : LineWants{}; }
  bool one_of(uint32_t n) { return n != 0 && bench_.one_of(n); }

  void cycle(const LaneTraffic& traffic) {
    ASSERT_NO_FATAL_FAILURE(compare());
    TraverserLane::Inputs inputs;
    const auto random = [this](uint32_t n) { return one_of(n); };

    inputs.stop = stopped_;
    u_.stop_i = stopped_;
    inputs.slot_taken = !stopped_ && lane_.slot_valid() && begun_ < rays_->size() && one_of(traffic.begin);
    TraverserLane::Entered entered{0, no_ray()};
    if (!set_up_.empty() && !one_of(traffic.set_up)) {
      entered = {set_up_.front().slot, set_up_.front().asked->ray};
      set_up_.pop_front();
      inputs.ray = &entered;
    }
    if (inputs.slot_taken) {
      const Asked& asked = (*rays_)[begun_++];
      set_up_.push_back({lane_.slot(), &asked});
      tracing_[lane_.slot()] = {&asked, 0};
      seen.most_rays = std::max(seen.most_rays, static_cast<uint32_t>(begun_ - done_));
    }

    const LineWants node_wants = wants_nodes(), leaf_wants = lane_.leaf_wants();
    const LaneCache::Turn node = nodes_.turn(node_wants, true, tree_->nodes, traffic, random, seen);
    const LaneCache::Turn leaf = leaves_.turn(leaf_wants, lane_.leaf_room(), tree_->triangles, traffic, random, seen);
    inputs.node_taken = node.taken;
    inputs.leaf_taken = leaf.taken;
    inputs.leaf_waited = leaf.waited;
    inputs.node = nodes_.given();
    inputs.leaf = leaves_.given();
    ASSERT_NO_FATAL_FAILURE(visits(node_wants, node, 0));
    ASSERT_NO_FATAL_FAILURE(visits(leaf_wants, leaf, Walk::kLeafLine));

    inputs.request_taken = lane_.request_valid() && !one_of(traffic.leave_request);
    const bool fills = wanted_ && one_of(traffic.fill);
    const LaneStacks::Block block = fills ? memory_.at(*wanted_) : LaneStacks::Block{};
    if (fills) {
      inputs.filled = &block;
      wanted_.reset();
    }
    const std::optional<LeafReader::Test> test = lane_.test();
    const bool test_ready = !one_of(traffic.leave_test);
    inputs.test_taken = test && test_ready;
    inputs.done_taken = lane_.done_valid() && !one_of(traffic.leave_done);
    if (!left_.empty() && one_of(traffic.free)) {
      inputs.freed = left_.front();
      left_.pop_front();
    }
    drive(inputs, test_ready);
    if (inputs.request_taken) take_request();
    if (inputs.done_taken) {
      ASSERT_NO_FATAL_FAILURE(take_done());
    }

    clock_pipe(inputs, test);
    nodes_.clock();
    leaves_.clock();
    bench_.clock();
    ++seen.cycles;
  }

  // The triangle pipe's class and then the lane's: what a test is given takes the results of the same cycle into
  // account.
  void clock_pipe(TraverserLane::Inputs& inputs, const std::optional<LeafReader::Test>& test) {
    LaneHits::Result result;
    if (pipe_.result() != nullptr) {
      const TriangleResult& from = *pipe_.result();
      result = {TestTag::of(from.tag, P::slot_bits()), from.number, from.hit, from.t};
      inputs.result = &result;
    }
    TrianglePipe::Limit limit{1, 0};
    TrianglePipe::Best best{1, 0};
    if (pipe_.told_limit() != nullptr) limit = lane_.ray(slot_of(*pipe_.told_limit())).limit;
    if (pipe_.told_best() != nullptr) {
      const uint32_t slot = slot_of(*pipe_.told_best());
      best = lane_.hits().told(slot, inputs.result);
      const bool now = result.hit && result.tag.slot == slot;
      seen.told_now += now;
      seen.told_before += !now && hit_before_ == slot;
    }
    hit_before_ = result.hit ? result.tag.slot : P::kSlots;
    if (inputs.test_taken) {
      pipe_.begin(lane_.ray(test->slot).triangle, test->triangle,
                  TestTag{test->slot, test->last, test->place}.word(P::slot_bits()));
    }
    pipe_.clock(limit, best);
    lane_.clock(inputs);
  }
  static uint32_t slot_of(const TriangleResult& result) { return TestTag::of(result.tag, P::slot_bits()).slot; }
  static LaneRay no_ray() { return {false, false, BoxRay({0, 0, 0}, {0, 0, 0}, 0, int{P::kBits}), {}, {1, 0}}; }

  void visits(const LineWants& wants, const LaneCache::Turn& turn, uint32_t kind) {
    if (turn.taken == 0 || wants[turn.taken >> 1].prefetch) return;
    const LineWant& want = wants[turn.taken >> 1];
    Tracing& ray = tracing_[want.slot];
    ASSERT_NE(ray.asked, nullptr) << "cycle " << seen.cycles;
    ASSERT_LT(ray.lines, ray.asked->walk.lines.size()) << "cycle " << seen.cycles;
    ASSERT_EQ(want.line | kind, ray.asked->walk.lines[ray.lines]) << "cycle " << seen.cycles;
    ++ray.lines;
    ++seen.visits;
  }

  void take_done() {
    Tracing& ray = tracing_[u_.done_slot_o];
    ASSERT_NE(ray.asked, nullptr) << "cycle " << seen.cycles;
    const Walk& walk = ray.asked->walk;
    EXPECT_EQ(ray.lines, walk.lines.size());
    ASSERT_EQ(u_.done_hit_o, walk.hit.hit) << "cycle " << seen.cycles;
    if (walk.hit.hit) {
      ASSERT_EQ(u_.done_t_o, as_bits(walk.hit.t)) << "cycle " << seen.cycles;
      ASSERT_EQ(u_.done_number_o, walk.hit.number) << "cycle " << seen.cycles;
      ASSERT_EQ(u_.done_place_o, walk.hit.place) << "cycle " << seen.cycles;
    }
    seen.hits += walk.hit.hit;
    seen.shadows += ray.asked->ray.shadow;
    seen.blocked += ray.asked->ray.shadow && walk.hit.hit;
    ++seen.rays;
    ++done_;
    left_.push_back(u_.done_slot_o);
    ray.asked = nullptr;
  }

  void take_request() {
    const LaneStacks::Request& request = lane_.request();
    const std::pair<uint32_t, uint32_t> block{request.slot, request.block};
    if (!request.write) {
      wanted_ = block;
      return;
    }
    for (uint32_t i = 0; i < LaneStacks::kBlock; ++i) memory_[block][i] = requested(i);
  }
  LaneStacks::Entry requested(uint32_t place) const {
    const uint32_t first = place * P::kEntry;
    return {get_bits(u_.request_entries_o, first + 32, P::kKey), get_bits(u_.request_entries_o, first, 32)};
  }

  // What means nothing is noise, or what it was.
  void drive(const TraverserLane::Inputs& inputs, bool test_ready) {
    u_.slot_ready_i = inputs.slot_taken;
    u_.ray_valid_i = inputs.ray != nullptr;
    u_.ray_slot_i = inputs.ray != nullptr ? inputs.ray->slot : bench_.random() % P::kSlots;
    if (inputs.ray != nullptr) set_ray(inputs.ray->ray);
    u_.node_taken_i = inputs.node_taken;
    u_.leaf_taken_i = inputs.leaf_taken;
    u_.leaf_waited_i = inputs.leaf_waited;
    u_.node_given_i = inputs.node != nullptr;
    u_.node_given_slot_i = inputs.node != nullptr ? inputs.node->slot : bench_.random() % P::kSlots;
    if (inputs.node != nullptr) copy_line(*inputs.node, &u_.node_given_data_i[0]);
    u_.leaf_given_i = inputs.leaf != nullptr;
    u_.leaf_given_slot_i = inputs.leaf != nullptr ? inputs.leaf->slot : bench_.random() % P::kSlots;
    if (inputs.leaf != nullptr) copy_line(*inputs.leaf, &u_.leaf_given_data_i[0]);
    u_.request_ready_i = inputs.request_taken;
    u_.fill_valid_i = inputs.filled != nullptr;
    for (uint32_t i = 0; inputs.filled != nullptr && i < LaneStacks::kBlock; ++i) {
      set_bits(u_.fill_entries_i, i * P::kEntry, 32, (*inputs.filled)[i].reference);
      set_bits(u_.fill_entries_i, i * P::kEntry + 32, P::kKey, (*inputs.filled)[i].key);
    }
    u_.test_ready_i = test_ready;
    u_.done_ready_i = inputs.done_taken;
    u_.free_valid_i = inputs.freed != TraverserLane::kNoSlot;
    u_.free_slot_i = u_.free_valid_i != 0 ? inputs.freed : bench_.random() % P::kSlots;
  }
  void set_ray(const LaneRay& ray) {
    u_.ray_meets_i = ray.meets;
    u_.ray_shadow_i = ray.shadow;
    if (!ray.meets) return;
    u_.backwards_i = u_.still_i = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const BoxRay::Axis& box = ray.box.axes[axis];
      set_bits(u_.backwards_i, axis, 1, box.backwards);
      set_bits(u_.still_i, axis, 1, box.still);
      set_bits(u_.reciprocal_i, axis * P::kBits, P::kBits, box.reciprocal);
      set_bits(u_.exponent_i, axis * 10, 10, static_cast<uint32_t>(box.exponent));
      set_bits(u_.padding_i, axis * 10, 10, static_cast<uint32_t>(box.padding));
    }
    u_.limit_key_i = ray.box.limit;
    set_triangle_ray(u_, ray.triangle);
    u_.limit_i = as_bits(ray.limit.limit);
    u_.scale_i = static_cast<uint32_t>(ray.limit.scale) & 0x1ff;
  }

  static void copy_line(const LeafReader::Given& given, uint32_t* to) {
    std::copy(given.line->begin(), given.line->end(), to);
  }

  template <typename Lines, typename Slots>
  void compare_wants(const LineWants& wants, uint32_t valid, uint32_t prefetch, const Lines& lines, const Slots& of) {
    for (uint32_t i = 0; i < wants.size(); ++i) {
      ASSERT_EQ(valid >> i & 1, wants[i].valid) << "cycle " << seen.cycles;
      if (!wants[i].valid) continue;
      ASSERT_EQ(get_bits(lines, i * kLineBits, kLineBits), wants[i].line) << "cycle " << seen.cycles;
      ASSERT_EQ(prefetch >> i & 1, wants[i].prefetch) << "cycle " << seen.cycles;
      if (wants[i].prefetch) continue;
      ASSERT_EQ(get_bits(of, i * P::slot_bits(), P::slot_bits()), wants[i].slot) << "cycle " << seen.cycles;
    }
  }

  void compare() {
    ASSERT_FALSE(lane_.fault().valid) << "cycle " << seen.cycles << ": malformed tree";
    ASSERT_FALSE(u_.fault_valid_o) << "cycle " << seen.cycles << ": malformed tree";
    ASSERT_EQ(u_.slot_valid_o, lane_.slot_valid()) << "cycle " << seen.cycles;
    if (lane_.slot_valid()) {
      ASSERT_EQ(u_.slot_o, lane_.slot()) << "cycle " << seen.cycles;
    }
    ASSERT_NO_FATAL_FAILURE(compare_wants(wants_nodes(), u_.node_want_o, 0, u_.node_want_line_o, u_.node_want_slot_o));
    ASSERT_NO_FATAL_FAILURE(compare_wants(lane_.leaf_wants(), u_.leaf_want_o, u_.leaf_want_prefetch_o,
                                          u_.leaf_want_line_o, u_.leaf_want_slot_o));
    ASSERT_EQ(u_.leaf_room_o, lane_.leaf_room()) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.request_valid_o, lane_.request_valid()) << "cycle " << seen.cycles;
    if (lane_.request_valid()) {
      ASSERT_NO_FATAL_FAILURE(compare_request());
    }
    const std::optional<LeafReader::Test> test = lane_.test();
    ASSERT_EQ(u_.test_valid_o, test.has_value()) << "cycle " << seen.cycles;
    if (test) {
      ASSERT_NO_FATAL_FAILURE(compare_test(*test));
    }
    ASSERT_EQ(u_.result_valid_o, pipe_.result() != nullptr) << "cycle " << seen.cycles;
    if (pipe_.result() != nullptr) {
      ASSERT_EQ(u_.result_hit_o, pipe_.result()->hit) << "cycle " << seen.cycles;
      if (pipe_.result()->hit) {
        ASSERT_EQ(u_.result_t_o, as_bits(pipe_.result()->t)) << "cycle " << seen.cycles;
      }
    }
    ASSERT_EQ(u_.done_valid_o, lane_.done_valid()) << "cycle " << seen.cycles;
    if (lane_.done_valid()) {
      ASSERT_NO_FATAL_FAILURE(compare_done());
    }
  }
  void compare_request() {
    const LaneStacks::Request& request = lane_.request();
    ASSERT_EQ(u_.request_write_o, request.write) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.request_slot_o, request.slot) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.request_block_o, request.block) << "cycle " << seen.cycles;
    for (uint32_t i = 0; request.write && i < LaneStacks::kBlock; ++i) {
      ASSERT_EQ(requested(i).key, request.entries[i].key) << "cycle " << seen.cycles;
      ASSERT_EQ(requested(i).reference, request.entries[i].reference) << "cycle " << seen.cycles;
    }
  }
  void compare_test(const LeafReader::Test& test) {
    const uint64_t tag = TestTag{test.slot, test.last, test.place}.word(P::slot_bits());
    if constexpr (std::is_integral_v<std::decay_t<decltype(u_.test_tag_o)>>) {
      ASSERT_EQ(u_.test_tag_o, tag) << "cycle " << seen.cycles;
    }
    for (int i = 0; i < 9; ++i)
      ASSERT_EQ(u_.test_corners_o[i], as_bits(test.triangle(i / 3, i % 3))) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.test_number_o, test.triangle.number) << "cycle " << seen.cycles;
  }
  void compare_done() {
    ASSERT_EQ(u_.done_slot_o, lane_.done_slot()) << "cycle " << seen.cycles;
    const LaneHits::Hit& hit = lane_.hits().best(lane_.done_slot());
    ASSERT_EQ(u_.done_hit_o, hit.hit) << "cycle " << seen.cycles;
    if (!hit.hit) return;
    ASSERT_EQ(u_.done_t_o, as_bits(hit.t)) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.done_number_o, hit.number) << "cycle " << seen.cycles;
    ASSERT_EQ(u_.done_place_o, hit.place) << "cycle " << seen.cycles;
  }

  static constexpr uint32_t kLineBits = 26;

  Clocked<typename P::Verilated> bench_;
  typename P::Verilated& u_ = *bench_.u;
  TraverserLane lane_{{P::kSlots, P::kEntries, int{P::kBits}}};
  TrianglePipe pipe_{P::kTriangleBits};
  const LaneTree* tree_ = nullptr;
  const std::vector<Asked>* rays_ = nullptr;
  size_t begun_ = 0, done_ = 0;
  std::deque<SetUp> set_up_;
  bool stopped_ = false;
  std::vector<Tracing> tracing_;  // [slot]
  std::deque<uint32_t> left_;     // slots
  LaneCache nodes_, leaves_;
  std::map<std::pair<uint32_t, uint32_t>, LaneStacks::Block> memory_;  // [slot, block]
  std::optional<std::pair<uint32_t, uint32_t>> wanted_;
  uint32_t hit_before_ = P::kSlots;
};

}  // namespace raypool::bench
