// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_traverser_lane.v: a lane of the traverser. Slots for rays, a box pipe, the stacks, what is kept of
// each ray and its best hit; nodes, leaves and the results of triangle tests come from outside.
//
// Outputs, read before clock(), are valid for the whole cycle and do not depend on its inputs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "machine/common/free_list.hpp"
#include "machine/common/late_queue.hpp"
#include "machine/common/ram_queue.hpp"
#include "machine/traverser/box_pipe.hpp"
#include "machine/traverser/child_order.hpp"
#include "machine/traverser/lane_hits.hpp"
#include "machine/traverser/lane_stacks.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/line_offers.hpp"
#include "machine/traverser/tree_fault.hpp"

namespace raypool {

class TraverserLane {
 public:
  struct Sizes {
    uint32_t slots = 24;
    uint32_t stack_entries = 16;  ///< of a slot
    int box_bits = 12;
  };
  struct Entered {
    uint32_t slot;
    LaneRay ray;
  };
  static constexpr uint32_t kNoSlot = UINT32_MAX;
  struct Inputs {
    const Entered* ray = nullptr;               ///< is set up
    const LeafReader::Given* node = nullptr;    ///< is given, two cycles after its lookup
    const LeafReader::Given* leaf = nullptr;    ///< likewise
    const LaneStacks::Block* filled = nullptr;  ///< what was asked for has come
    const LaneHits::Result* result = nullptr;   ///< of the triangle pipe
    uint32_t freed = kNoSlot;                   ///< slot
    uint8_t node_taken = 0;                     ///< bit i: node_wants()[i]
    uint8_t leaf_taken = 0;                     ///< bit i: leaf_wants()[i]
    bool leaf_waited = false;                   ///< a line of a leaf is taken for which a ray has waited
    bool slot_taken = false;                    ///< for a ray; only if slot_valid()
    bool request_taken = false;                 ///< only if request_valid()
    bool test_taken = false;                    ///< by the triangle pipe; only if there is one
    bool done_taken = false;                    ///< only if done_valid()
    bool stop = false;                          ///< no more nodes are tested
  };
  static constexpr uint32_t kNode = BoxPipe::kStages + 1;  ///< cycles from a box test to when its result is a node's
  static constexpr uint32_t kNoReference = UINT32_MAX;
  static constexpr uint32_t kLeaf = 1u << 31;  ///< of a reference: it is a leaf's

  /// Signals and events of the lanes: sets of lanes, a bit each, so that the code that clocks them goes through those
  /// few of which something comes, kind by kind. The bits of outputs are valid for the whole cycle.
  struct Sets {
    uint64_t cycle = 0;
    uint32_t test = 0, request = 0, done = 0, slot = 0, fault = 0, nodes = 0, leaves = 0, leaf_room = 0;  ///< outputs
    /// Which have something to offer, end, begin, read, or stacks that go on, without inputs.
    uint32_t offers = 0, ends = 0, stacks = 0, begins = 0, reads = 0;
    uint32_t given = 0;                   ///< a node in the cycle before
    uint32_t leaf_ends = 0;               ///< a leaf's last result came in the cycle before
    uint32_t faulty = 0;                  ///< that node is malformed
    uint32_t stacked = 0, not_ready = 0;  ///< stacks that went on in the cycle, and those in which no ray may begin
    static constexpr uint32_t kCycles = 16;
    std::array<uint32_t, kCycles> offers_at{}, reads_at{}, given_at{};  ///< [cycle] in turn

    uint32_t& offers_in(uint32_t cycles) { return offers_at[(cycle + cycles) % kCycles]; }
    uint32_t& reads_in(uint32_t cycles) { return reads_at[(cycle + cycles) % kCycles]; }
    /// Lanes that began the test of their boxes so many cycles ago.
    uint32_t given_ago(uint32_t cycles) const { return given_at[(cycle - cycles) % kCycles]; }
    /// Those that go on by themselves, each kind in its turn.
    uint32_t to_offer() { return offers | std::exchange(offers_in(0), 0); }
    uint32_t to_read() { return reads | std::exchange(reads_in(0), 0); }
    uint32_t to_stack() const { return stacks | given_ago(kNode) | leaf_ends; }
  };

  /// `sets`: of all lanes among which it has this number; null: it is alone.
  explicit TraverserLane(const Sizes& sizes, Sets* sets = nullptr, uint32_t number = 0)
      : own_sets_(sets != nullptr ? nullptr : std::make_unique<Sets>()),
        sets_(sets != nullptr ? sets : own_sets_.get()),
        bit_(1u << number),
        box_bits_(sizes.box_bits),
        free_(sizes.slots),
        numbers_(sizes.slots),
        visits_(sizes.slots),
        rays_(sizes.slots, LaneRay{false, false, no_ray(sizes.box_bits), {}, {}}),
        begins_(sizes.slots),
        nodes_{LateQueue<LineWant>(sizes.slots), LateQueue<LineWant>(sizes.slots)},
        stacks_({sizes.slots, sizes.stack_entries}),
        leaves_(sizes.slots),
        ends_(sizes.slots),
        hits_(rays_) {
    sets_->slot |= bit_;
    sets_->leaf_room |= bit_;
  }
  TraverserLane(const TraverserLane&) = delete;
  TraverserLane& operator=(const TraverserLane&) = delete;

  /// A reference, kNoReference of an empty tree, and the number of nodes. While no ray is in it.
  void set_tree(uint32_t root, uint32_t nodes) {
    root_ = root;
    count_ = nodes;
  }

  bool slot_valid() const { return free_.valid(); }
  uint32_t slot() const { return free_.number(); }  ///< means something while slot_valid()

  /// Lines that it wants in this cycle, if it wants any; they stay where they are.
  bool wants_node() const { return node_offers_.any() && !stacks_.fill_waits(); }
  bool wants_leaf() const { return leaves_.wants_any(); }
  const LineWants& node_wants() const { return node_offers_.wants(); }
  const LineWants& leaf_wants() const { return leaves_.wants(); }
  bool leaf_room() const { return leaves_.room(); }

  /// A node that no tree has, or to which a ray comes too late: valid for a cycle, and then perhaps others.
  TreeFault fault() const {
    TreeFault fault = fault_;
    fault.valid = (sets_->fault & bit_) != 0;
    return fault;
  }

  bool request_valid() const { return stacks_.request_valid(); }
  const LaneStacks::Request& request() const { return stacks_.request(); }  ///< means something while request_valid()

  bool test_valid() const { return leaves_.test_valid(); }
  std::optional<LeafReader::Test> test() const { return leaves_.test(); }
  const LaneRay& ray(uint32_t slot) const { return rays_[slot]; }
  const LaneHits& hits() const { return hits_; }

  bool done_valid() const { return done_.has_value(); }
  uint32_t done_slot() const { return *done_; }  ///< only while done_valid()

  /// The end of a cycle of a lane that is alone.
  void clock(const Inputs& inputs) {
    Sets& sets = *sets_;
    if ((sets.to_offer() != 0) | (inputs.node_taken != 0)) offer(inputs.node_taken);
    if ((sets.ends != 0) | inputs.done_taken) end(inputs.done_taken);
    sets.stacked = sets.not_ready = 0;
    if ((sets.to_stack() != 0) | inputs.request_taken | (inputs.filled != nullptr))
      stack(inputs.request_taken, inputs.filled);
    if ((sets.begins & ~sets.not_ready) != 0) begin();
    const LeafReader::Inputs leaves{inputs.leaf_taken, inputs.leaf_waited, inputs.leaf, inputs.test_taken};
    if ((sets.to_read() != 0) | leaves.any()) read(leaves);
    const uint32_t ended = sets.leaf_ends;
    if ((ended != 0) | (inputs.result != nullptr)) take_result(inputs.result);
    end_tests(sets, inputs.node != nullptr && !inputs.stop ? bit_ : 0);
    if (sets.faulty != 0) show_fault();
    if (sets.given != 0) test(*inputs.node);
    if (inputs.ray != nullptr) enter(*inputs.ray);
    if (inputs.slot_taken) take_slot();
    if (inputs.freed != kNoSlot) free_slot(inputs.freed);
    ++sets.cycle;
  }

  // ---- What happens at the end of a cycle, of each kind in this order, where something of it happens

  /// The next node is offered; one that is taken is looked up.
  void offer(uint32_t taken) {
    const uint64_t cycle = sets_->cycle;
    const LineWant* next = nullptr;
    if (node_offers_.ready()) {
      const uint32_t first = node_turn_ ^ static_cast<uint32_t>(!nodes_[node_turn_].valid(cycle));
      if (nodes_[first].valid(cycle)) {
        next = &nodes_[first].data();
        nodes_[first].pop();
        node_turn_ = 1 - first;
      }
    }
    if (taken != 0) {
      const LineWant& asked = node_offers_.wants()[taken >> 1];
      numbers_[asked.slot] = asked.line;
    }
    node_offers_.clock(next, taken);
    set(sets_->nodes, node_offers_.any() & !fill_waits());
    set(sets_->offers, node_offers_.ready() & (nodes_[0].valid(cycle + 1) | nodes_[1].valid(cycle + 1)));
  }
  /// A ray that is done is taken, or the next one is offered.
  void end(bool taken) {
    if (taken) done_.reset();
    if (!done_ && ends_.valid()) {
      done_ = ends_.data();
      ends_.pop();
    }
    set(sets_->done, done_.has_value());
    set(sets_->ends, !done_ & ends_.valid());
  }
  void stack(bool request_taken, const LaneStacks::Block* filled) {
    LaneStacks::Inputs inputs;
    std::optional<LaneStacks::LeafResult> leaf;
    inputs.node = node();
    if (hits_.leaf_valid()) leaf = hits_.leaf(box_bits_);
    inputs.leaf = leaf ? &*leaf : nullptr;
    inputs.request_taken = request_taken;
    inputs.filled = filled;
    const LaneStacks::Outcome& outcome = stacks_.clock(inputs);
    if (outcome.node_goes_on) go(0, inputs.node->slot, inputs.node->nearest);
    if (outcome.next) go(1, outcome.slot, outcome.reference);
    if (outcome.done) push_end(outcome.slot);
    sets_->stacked |= bit_;
    set(sets_->not_ready, !outcome.ray_ready);
    set(sets_->stacks, !stacks_.sleeps());
    set(sets_->request, stacks_.request_valid());
    set(sets_->nodes, node_offers_.any() & !fill_waits());
  }
  /// Where no ray is not_ready.
  void begin() {
    const uint32_t slot = begins_.data();
    begins_.pop();
    set(sets_->begins, begins_.valid());
    stacks_.begin(slot);
    if (rays_[slot].meets && root_ != kNoReference) {
      go(1, slot, root_);
    } else {
      push_end(slot);
    }
  }
  void read(const LeafReader::Inputs& inputs) {
    leaves_.work(sets_->cycle, inputs);
    // What has been looked up is given, or missed; and what is behind a line that has been given is wanted.
    sets_->reads_in(2) |= (0u - static_cast<uint32_t>((inputs.taken != 0) | (inputs.given != nullptr))) & bit_;
    set(sets_->reads, leaves_.goes_on(sets_->cycle + 1));
    set(sets_->test, leaves_.test_valid());
    set(sets_->leaves, leaves_.wants_any());
    set(sets_->leaf_room, leaves_.room());
  }
  /// Of a triangle, or null: of those that ended a leaf in the cycle before.
  void take_result(const LaneHits::Result* result) {
    hits_.clock(result);
    set(sets_->leaf_ends, hits_.leaf_valid());
  }
  /// Of all lanes: those that are given a node in this cycle.
  static void end_tests(Sets& sets, uint32_t given) {
    sets.given = sets.given_at[(sets.cycle + 1) % Sets::kCycles] = given;
    sets.fault = sets.faulty;
  }
  /// Of one of the set faulty.
  void show_fault() {
    fault_ = next_fault_;
    sets_->faulty &= ~bit_;
  }
  /// Of the node that is given: its test begins in the next cycle, and what comes of it is known now.
  void test(const LeafReader::Given& given) {
    ++node_tests_;
    given_slot_ = given.slot;
    const uint32_t* const references = given.line->data() + sizeof(BoxNode) / sizeof(uint32_t);
    BoxNode node;
    std::memcpy(&node, given.line->data(), sizeof node);
    look_at_node(node, references);
    node.children &= 7;
    Tested& tested = tested_[(sets_->cycle + 1) % tested_.size()];
    tested.node.slot = given.slot;
    tested.node.limit = hits_.limit_key(given.slot);
    tested.boxes = test_boxes(rays_[given.slot].box, node, tested.node.limit);
    order_children(tested.boxes, references, tested.node);
  }
  void enter(const Entered& entered) {
    rays_[entered.slot] = entered.ray;
    visits_[entered.slot] = 0;
    hits_.enter(entered.slot);
    begins_.push(entered.slot);
    sets_->begins |= bit_;
  }
  void take_slot() {
    free_.take();
    set(sets_->slot, slot_valid());
  }
  void free_slot(uint32_t slot) {
    free_.free(slot);
    sets_->slot |= bit_;
  }

  // ---- For reports of a lockstep

  /// Of boxes that have their result in this cycle, or null.
  const BoxResult* boxes() const {
    return tested(BoxPipe::kStages) ? &tested_[(sets_->cycle - BoxPipe::kStages) % tested_.size()].boxes : nullptr;
  }
  /// Of boxes that had their result in the cycle before, or null.
  const LaneStacks::NodeResult* node() const {
    return tested(kNode) ? &tested_[(sets_->cycle - kNode) % tested_.size()].node : nullptr;
  }
  /// Of the cycle that has ended.
  LaneStacks::Outcome stacks_outcome() const {
    return (sets_->stacked & bit_) != 0 ? stacks_.outcome() : LaneStacks::Outcome{};
  }
  std::optional<LaneStacks::LeafResult> leaf_result() const { return hits_.leaf(box_bits_); }
  /// The slot that is given a line in this cycle; the test of its boxes begins in it.
  std::optional<uint32_t> given_slot() const {
    return (sets_->given & bit_) != 0 ? std::optional(given_slot_) : std::nullopt;
  }
  bool fill_waits() const { return stacks_.fill_waits(); }
  bool begin_valid() const { return begins_.valid(); }
  uint32_t begin_slot() const { return begins_.data(); }  ///< only while begin_valid()

  // ---- For measurements

  uint64_t node_tests() const { return node_tests_ - ((sets_->given & bit_) != 0 ? 1 : 0); }
  const LaneStacks::Work& stack_work() const { return stacks_.work(); }
  const LeafReader& leaves() const { return leaves_; }

 private:
  static BoxRay no_ray(int bits) { return BoxRay({0, 0, 0}, {0, 0, 0}, 0, bits); }

  struct Tested {
    BoxResult boxes;
    LaneStacks::NodeResult node;  // what the stacks will make of it
  };

  void set(uint32_t& of, bool valid) const { of ^= ((0u - uint32_t{valid}) ^ of) & bit_; }
  bool tested(uint32_t ago) const { return (sets_->given_ago(ago) & bit_) != 0; }

  // The node that begins its test. A way back to a node has a step to a number that is not above the one before it;
  // ways that meet again, and stacks that come back wrong, lead to more visits than there are nodes.
  void look_at_node(const BoxNode& node, const uint32_t* references) {
    const uint32_t line = numbers_[given_slot_];
    const bool late = visits_[given_slot_]++ == count_;
    bool backward = false;
    for (uint32_t i = 0; i < kBoxes; ++i) {
      const bool too_high = references[i] > LeafReader::kLastLine, is_node = (references[i] & kLeaf) == 0;
      backward |= (i < node.children) & is_node & (too_high | (references[i] <= line));
    }
    const bool children = node.children - 1u >= uint32_t{kBoxes};
    if (!(children | backward | late)) return;
    next_fault_.code = children ? TreeFaultCode::Children : backward ? TreeFaultCode::Order : TreeFaultCode::Visits;
    next_fault_.line = line;
    sets_->faulty |= bit_;
  }

  void go(uint32_t source, uint32_t slot, uint32_t reference) {
    const uint64_t cycle = sets_->cycle;
    if ((reference & kLeaf) == 0) {
      nodes_[source].push(cycle, {true, false, static_cast<uint8_t>(slot), reference & LeafReader::kLastLine});
      sets_->offers_in(2) |= bit_;
    } else {
      leaves_.start(cycle, source, slot, reference);
      sets_->reads_in(2) |= bit_;
    }
  }
  void push_end(uint32_t slot) {
    ends_.push(slot);
    set(sets_->ends, !done_);
  }

  std::unique_ptr<Sets> own_sets_;
  Sets* sets_;
  uint32_t bit_;  // its own
  int box_bits_;
  uint32_t root_ = kNoReference, count_ = 0;
  FreeList free_;
  std::vector<uint32_t> numbers_, visits_;  // [slot] of the node that was looked up; of nodes that have come
  TreeFault fault_, next_fault_;
  std::vector<LaneRay> rays_;  // [slot]
  RamQueue<uint32_t> begins_;  // slots that have their ray

  std::array<LateQueue<LineWant>, 2> nodes_;  // that are wanted: from box results; from the stack, and roots
  uint32_t node_turn_ = 0;                    // the queue that comes next
  LineOffers node_offers_;
  uint32_t given_slot_ = 0;                   // the slot that was given a node last
  std::array<Tested, Sets::kCycles> tested_;  // [cycle] in turn
  static_assert(kNode + 1 < Sets::kCycles);

  LaneStacks stacks_;
  LeafReader leaves_;
  RamQueue<uint32_t> ends_;       // slots with a finished ray
  std::optional<uint32_t> done_;  // that is offered
  LaneHits hits_;
  uint64_t node_tests_ = 0;
};

}  // namespace raypool
