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
#include "machine/leaf_reader.hpp"
#include "machine/line_offers.hpp"
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
  struct Inputs {
    bool slot_taken = false;                    ///< for a ray; only if slot_valid()
    const Entered* ray = nullptr;               ///< is set up
    uint32_t node_taken = 0;                    ///< bit i: node_wants()[i]
    const LeafReader::Given* node = nullptr;    ///< is given, two cycles after its lookup
    uint32_t leaf_taken = 0;                    ///< bit i: leaf_wants()[i]
    bool leaf_waited = false;                   ///< a line of a leaf is taken for which a ray has waited
    const LeafReader::Given* leaf = nullptr;    ///< is given
    bool request_taken = false;                 ///< only if request_valid()
    const LaneStacks::Block* filled = nullptr;  ///< what was asked for has come
    bool test_taken = false;                    ///< by the triangle pipe; only if there is one
    const LaneHits::Result* result = nullptr;   ///< of the triangle pipe
    bool done_taken = false;                    ///< only if done_valid()
    std::optional<uint32_t> freed;              ///< slot
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
        nodes_{RamQueue<LineWant>(sizes.slots), RamQueue<LineWant>(sizes.slots)},
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

  LineWants node_wants() const {
    LineWants wants;
    if (stacks_.fill_waits()) return wants;
    for (uint32_t i = 0; i < wants.size(); ++i)
      if (const LineWant* const offer = node_offers_.offer(i)) wants[i] = *offer;
    return wants;
  }
  LineWants leaf_wants() const { return leaves_.wants(); }
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
    LaneStacks::Inputs stacks;
    stacks.node = node_ ? &*node_ : nullptr;
    const std::optional<LaneStacks::LeafResult> leaf = hits_.leaf(box_bits_);
    stacks.leaf = leaf ? &*leaf : nullptr;
    stacks.request_taken = inputs.request_taken;
    stacks.filled = inputs.filled;
    if (const LineWant* const asked = node_offers_.asked()) numbers_[asked->slot] = asked->line;
    node_offers_.clock(next_node(), inputs.node_taken);
    const LaneStacks::Outcome& outcome = stacks_.clock(stacks);
    if (inputs.done_taken) done_.reset();
    if (!done_ && ends_.valid()) {
      done_ = ends_.data();
      ends_.pop();
    }

    for (size_t i = 0; i < nodes_.size(); ++i)
      if (goes_on_[i].valid) nodes_[i].push(goes_on_[i]);
    goes_on_ = {};
    if (outcome.node_goes_on) go(0, node_->slot, node_->nearest);
    if (outcome.next) go(1, outcome.slot, outcome.reference);
    if (outcome.done) ends_.push(outcome.slot);
    if (outcome.ray_ready && begins_.valid()) begin();
    LeafReader::Inputs leaves;
    leaves.taken = inputs.leaf_taken;
    leaves.waited = inputs.leaf_waited;
    leaves.given = inputs.leaf;
    leaves.triangle_taken = inputs.test_taken;
    leaves_.clock(leaves);

    look_at_node();
    test_boxes_of(inputs.stop ? nullptr : inputs.node);
    hits_.clock(inputs.ray != nullptr ? std::optional<uint32_t>(inputs.ray->slot) : std::nullopt, inputs.result);
    if (inputs.ray != nullptr) {
      rays_[inputs.ray->slot] = inputs.ray->ray;
      visits_[inputs.ray->slot] = 0;
      begins_.push(inputs.ray->slot);
    }
    if (inputs.slot_taken) free_.take();
    if (inputs.freed) free_.free(*inputs.freed);
  }

  // ---- For reports of a lockstep

  const BoxPipe& boxes() const { return boxes_; }
  const std::optional<LaneStacks::NodeResult>& node() const { return node_; }
  const LaneStacks::Outcome& stacks_outcome() const { return stacks_.outcome(); }  ///< of the cycle that has ended
  std::optional<LaneStacks::LeafResult> leaf_result() const { return hits_.leaf(box_bits_); }
  /// Of which a slot is given a line in this cycle, whose boxes are tested in it.
  std::optional<uint32_t> given_slot() const { return is_given_ ? std::optional(given_slot_) : std::nullopt; }
  bool fill_waits() const { return stacks_.fill_waits(); }
  bool begin_valid() const { return begins_.valid(); }
  uint32_t begin_slot() const { return begins_.data(); }  ///< only while begin_valid()

  // ---- For measurements

  const LaneStacks::Work& stack_work() const { return stacks_.work(); }
  const LeafReader& leaves() const { return leaves_; }

 private:
  static constexpr uint32_t kBoxStages = BoxPipe::kStages;

  /// What goes along with a box test.
  struct Along {
    uint32_t slot = 0, limit = 0;
    std::array<uint32_t, kBoxes> references{};
  };

  static BoxRay no_ray(int bits) { return BoxRay({0, 0, 0}, {0, 0, 0}, 0, bits); }

  // Null, or until something is put into a queue.
  const LineWant* next_node() {
    const uint32_t first = nodes_[node_turn_].valid() ? node_turn_ : 1 - node_turn_;
    if (!node_offers_.ready() || !nodes_[first].valid()) return nullptr;
    const LineWant* const next = &nodes_[first].data();
    nodes_[first].pop();
    node_turn_ = 1 - first;
    return next;
  }

  // The node whose test begins. A way back to a node has a step to a number that is not above the one before it; ways
  // that meet again, and stacks that come back wrong, lead to more visits than there are nodes.
  void look_at_node() {
    fault_.valid = false;
    if (!is_given_) return;
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
      goes_on_[source] = {true, false, static_cast<uint8_t>(slot), reference & LeafReader::kLastLine};
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

  void test_boxes_of(const LeafReader::Given* given) {
    node_.reset();
    if (boxes_.valid()) {
      const Along& along = along_[place_ % kBoxStages];
      node_ = LaneStacks::NodeResult{};
      node_->slot = along.slot;
      node_->limit = along.limit;
      order_children(boxes_.result(), along.references, *node_);
    }
    if (is_given_) {
      BoxNode node;
      std::memcpy(&node, given_line_.data(), sizeof node);
      node.children &= 7;
      const uint32_t limit = hits_.limit_key(given_slot_);
      Along& along = along_[place_ % kBoxStages];
      along.slot = given_slot_;
      along.limit = limit;
      std::copy_n(given_line_.begin() + sizeof node / sizeof(uint32_t), kBoxes, along.references.begin());
      boxes_.clock(true, rays_[given_slot_].box, &node, limit);
    } else {
      boxes_.clock(true, rays_[0].box, nullptr, 0);
    }
    ++place_;
    is_given_ = given != nullptr;
    if (!is_given_) return;
    given_slot_ = given->slot;
    given_line_ = *given->line;
  }

  int box_bits_;
  uint32_t root_ = kNoReference, count_ = 0;
  FreeList free_;
  std::vector<uint32_t> numbers_, visits_;  // [slot] of the node that was looked up; of nodes that have come
  TreeFault fault_;
  std::vector<LaneRay> rays_;  // [slot]
  RamQueue<uint32_t> begins_;  // slots whose ray has come

  LineWants goes_on_;                        // with a node, in the cycle before
  std::array<RamQueue<LineWant>, 2> nodes_;  // that are wanted: from box results; from the stack, and roots
  uint32_t node_turn_ = 0;                   // whose head comes next
  LineOffers<LineWant> node_offers_;
  bool is_given_ = false;  // in the cycle before, for this slot this line
  uint32_t given_slot_ = 0;
  TreeLine given_line_{};
  BoxPipe boxes_;
  std::array<Along, kBoxStages> along_;
  uint32_t place_ = 0;
  std::optional<LaneStacks::NodeResult> node_;  // of boxes that had their result in the cycle before

  LaneStacks stacks_;
  LeafReader leaves_;
  RamQueue<uint32_t> ends_;       // slots whose ray is done
  std::optional<uint32_t> done_;  // that is offered
  LaneHits hits_;
};

}  // namespace raypool
