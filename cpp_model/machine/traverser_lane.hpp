// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser_lane.v: a lane of the traverser. Slots for rays, a box pipe, the stacks, what is kept of each ray and
// its best hit; nodes, leaves and the results of triangle tests come from outside.
//
// What is said before clock() holds in a whole cycle, and depends on no input of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "machine/box_pipe.hpp"
#include "machine/child_order.hpp"
#include "machine/free_list.hpp"
#include "machine/lane_hits.hpp"
#include "machine/lane_stacks.hpp"
#include "machine/late_queue.hpp"
#include "machine/leaf_reader.hpp"
#include "machine/line_offers.hpp"
#include "machine/pipe_items.hpp"
#include "machine/ram_queue.hpp"
#include "machine/tree_fault.hpp"

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
  static constexpr uint32_t kNoReference = UINT32_MAX;
  static constexpr uint32_t kLeaf = 1u << 31;  ///< of a reference: it is a leaf's

  explicit TraverserLane(const Sizes& sizes)
      : box_bits_(sizes.box_bits),
        free_(sizes.slots),
        numbers_(sizes.slots),
        visits_(sizes.slots),
        rays_(sizes.slots, LaneRay{false, false, no_ray(sizes.box_bits), {}, {}}),
        begins_(sizes.slots),
        nodes_{LateQueue<LineWant>(sizes.slots), LateQueue<LineWant>(sizes.slots)},
        stacks_({sizes.slots, sizes.stack_entries}),
        leaves_(sizes.slots),
        ends_(sizes.slots),
        hits_(rays_) {}
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
  const TreeFault& fault() const { return fault_; }

  bool request_valid() const { return stacks_.request_valid(); }
  const LaneStacks::Request& request() const { return stacks_.request(); }  ///< means something while request_valid()

  bool test_valid() const { return leaves_.test_valid(); }
  std::optional<LeafReader::Test> test() const { return leaves_.test(); }
  const LaneRay& ray(uint32_t slot) const { return rays_[slot]; }
  const LaneHits& hits() const { return hits_; }

  bool done_valid() const { return done_.has_value(); }
  uint32_t done_slot() const { return *done_; }  ///< only while done_valid()

  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    offer_nodes(inputs.node_taken);
    const LaneStacks::NodeResult* const node = tests_.at(kNode);
    const LaneStacks::Outcome& outcome = clock_stacks(inputs, node);
    if (inputs.done_taken) done_.reset();
    if (!done_ && ends_.valid()) {
      done_ = ends_.data();
      ends_.pop();
    }

    if (outcome.node_goes_on) go(0, node->slot, node->nearest);
    if (outcome.next) go(1, outcome.slot, outcome.reference);
    if (outcome.done) ends_.push(outcome.slot);
    if (outcome.ray_ready && begins_.valid()) begin();
    LeafReader::Inputs leaves;
    leaves.taken = inputs.leaf_taken;
    leaves.waited = inputs.leaf_waited;
    leaves.given = inputs.leaf;
    leaves.triangle_taken = inputs.test_taken;
    leaves_.clock(leaves);

    fault_.valid = false;
    if (is_given_) {
      ++node_tests_;
      look_at_node();
      test_boxes();
    } else {
      boxes_.clock(true, rays_[0].box, nullptr, 0);
    }
    tests_.clock();
    is_given_ = inputs.node != nullptr && !inputs.stop;
    if (is_given_) {
      given_slot_ = inputs.node->slot;
      given_line_ = *inputs.node->line;
    }
    hits_.clock(inputs.result);
    if (inputs.ray != nullptr) enter(*inputs.ray);
    if (inputs.slot_taken) free_.take();
    if (inputs.freed != kNoSlot) free_.free(inputs.freed);
    ++cycle_;
  }

  // ---- For reports of a lockstep

  const BoxPipe& boxes() const { return boxes_; }
  /// Of boxes that had their result in the cycle before, or null.
  const LaneStacks::NodeResult* node() const { return tests_.at(kNode); }
  const LaneStacks::Outcome& stacks_outcome() const { return stacks_.outcome(); }  ///< of the cycle that has ended
  std::optional<LaneStacks::LeafResult> leaf_result() const { return hits_.leaf(box_bits_); }
  /// Of which a slot is given a line in this cycle, whose boxes are tested in it.
  std::optional<uint32_t> given_slot() const { return is_given_ ? std::optional(given_slot_) : std::nullopt; }
  bool fill_waits() const { return stacks_.fill_waits(); }
  bool begin_valid() const { return begins_.valid(); }
  uint32_t begin_slot() const { return begins_.data(); }  ///< only while begin_valid()

  // ---- For measurements

  uint64_t node_tests() const { return node_tests_; }
  const LaneStacks::Work& stack_work() const { return stacks_.work(); }
  const LeafReader& leaves() const { return leaves_; }

 private:
  static constexpr uint32_t kNode = BoxPipe::kStages + 1;  // cycles from a box test to when its result is a node's

  static BoxRay no_ray(int bits) { return BoxRay({0, 0, 0}, {0, 0, 0}, 0, bits); }

  // The next one is offered; one that is taken is looked up.
  void offer_nodes(uint32_t taken) {
    const LineWant* next = nullptr;
    if (queued_nodes_ != 0 && node_offers_.ready()) {
      const uint32_t first = nodes_[node_turn_].valid(cycle_) ? node_turn_ : 1 - node_turn_;
      if (nodes_[first].valid(cycle_)) {
        next = &nodes_[first].data();
        nodes_[first].pop();
        --queued_nodes_;
        node_turn_ = 1 - first;
      }
    }
    if (taken != 0) {
      const LineWant& asked = node_offers_.wants()[taken >> 1];
      numbers_[asked.slot] = asked.line;
    }
    if (next != nullptr || taken != 0) node_offers_.clock(next, taken);
  }

  const LaneStacks::Outcome& clock_stacks(const Inputs& inputs, const LaneStacks::NodeResult* node) {
    LaneStacks::Inputs stacks;
    std::optional<LaneStacks::LeafResult> leaf;
    stacks.node = node;
    if (hits_.leaf_valid()) leaf = hits_.leaf(box_bits_);
    stacks.leaf = leaf ? &*leaf : nullptr;
    stacks.request_taken = inputs.request_taken;
    stacks.filled = inputs.filled;
    return stacks_.clock(stacks);
  }

  // The node whose test begins. A way back to a node has a step to a number that is not above the one before it; ways
  // that meet again, and stacks that come back wrong, lead to more visits than there are nodes.
  void look_at_node() {
    BoxNode node;
    std::memcpy(&node, given_line_.data(), sizeof node);
    fault_.line = numbers_[given_slot_];
    const bool late = visits_[given_slot_]++ == count_;
    bool backward = false;
    for (uint32_t i = 0; i < std::min<uint32_t>(node.children, kBoxes); ++i) {
      const uint32_t reference = given_line_[sizeof node / sizeof(uint32_t) + i];
      const bool too_high = reference > LeafReader::kLastLine;
      backward = backward || ((reference & kLeaf) == 0 && (too_high || reference <= fault_.line));
    }
    if (node.children == 0 || node.children > kBoxes)
      fault_.code = TreeFaultCode::Children;
    else if (backward)
      fault_.code = TreeFaultCode::Order;
    else if (late)
      fault_.code = TreeFaultCode::Visits;
    else
      return;
    fault_.valid = true;
  }

  void go(uint32_t source, uint32_t slot, uint32_t reference) {
    if ((reference & kLeaf) == 0) {
      nodes_[source].push(cycle_, {true, false, static_cast<uint8_t>(slot), reference & LeafReader::kLastLine});
      ++queued_nodes_;
    } else {
      leaves_.start(source, slot, reference);
    }
  }
  void begin() {
    const uint32_t slot = begins_.data();
    begins_.pop();
    stacks_.begin(slot);
    if (rays_[slot].meets && root_ != kNoReference) {
      go(1, slot, root_);
    } else {
      ends_.push(slot);
    }
  }

  // Of the node that has been given.
  void test_boxes() {
    BoxNode node;
    std::memcpy(&node, given_line_.data(), sizeof node);
    node.children &= 7;
    LaneStacks::NodeResult& result = tests_.begin();
    result.slot = given_slot_;
    result.limit = hits_.limit_key(given_slot_);
    boxes_.clock(true, rays_[given_slot_].box, &node, result.limit);
    order_children(*boxes_.begun(), given_line_.data() + sizeof node / sizeof(uint32_t), result);
  }
  void enter(const Entered& entered) {
    rays_[entered.slot] = entered.ray;
    visits_[entered.slot] = 0;
    hits_.enter(entered.slot);
    begins_.push(entered.slot);
  }

  int box_bits_;
  uint32_t root_ = kNoReference, count_ = 0;
  FreeList free_;
  std::vector<uint32_t> numbers_, visits_;  // [slot] of the node that was looked up; of nodes that have come
  TreeFault fault_;
  std::vector<LaneRay> rays_;  // [slot]
  RamQueue<uint32_t> begins_;  // slots whose ray has come

  uint64_t cycle_ = 0;
  std::array<LateQueue<LineWant>, 2> nodes_;  // that are wanted: from box results; from the stack, and roots
  uint32_t queued_nodes_ = 0;                 // in them
  uint32_t node_turn_ = 0;                    // whose head comes next
  LineOffers node_offers_;
  bool is_given_ = false;  // in the cycle before, for this slot this line
  uint32_t given_slot_ = 0;
  TreeLine given_line_{};
  BoxPipe boxes_;
  PipeItems<LaneStacks::NodeResult, kNode> tests_;  // of boxes, and what the stacks will make of them

  LaneStacks stacks_;
  LeafReader leaves_;
  RamQueue<uint32_t> ends_;       // slots whose ray is done
  std::optional<uint32_t> done_;  // that is offered
  LaneHits hits_;
  uint64_t node_tests_ = 0;
};

}  // namespace raypool
