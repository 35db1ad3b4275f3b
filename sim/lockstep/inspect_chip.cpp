#include <fmt/format.h>

#include <cstring>

#include "bits.hpp"
#include "isa/records.hpp"
#include "lockstep/chip_inspection.hpp"
#include "machine/traverser/traverser.hpp"

namespace raypool::lockstep {
namespace {

constexpr const char* kScope = "gen_inside.traverser";
/// What a bank of a cache decides has a rule of its own: what is left is between the banks, or its data.
constexpr const char* kArbiter = "rtl/traverser/rp_bank_arbiter.v, rtl/traverser/rp_tree_banks.v";
constexpr const char* kBanks = "rtl/traverser/rp_tree_banks.v, rtl/traverser/rp_bank_arbiter.v";
constexpr const char* kCache = "rtl/traverser/rp_tree_cache.v, rtl/traverser/rp_tree_banks.v";
constexpr uint32_t kLineBits = 26, kBlockBits = 7;

}  // namespace

ChipInspection::ChipInspection(const Configuration& configuration, const ChipDevice& rtl)
    : rtl_(&rtl), w_(rtl, kScope), rules_(configuration, rtl) {
  active_ = !rules_.chip.empty();
  if (has_traverser(configuration.chip)) find_lanes(configuration.chip);
}

void ChipInspection::find_lanes(const ChipConfiguration& chip) {
  if (!w_.missing.empty()) return;
  for (uint32_t lane = 0; lane < chip.hardware_traverser_lanes; ++lane) {
    lanes_.emplace_back(*rtl_, fmt::format("{}.gen_lane[{}].lane", kScope, lane));
    if (!lanes_.back().missing.empty()) return;
  }
  traverser_active_ = true;
}

void ChipInspection::restart(const Traverser* model, bool reset) {
  model_ = model;
  findings_.clear();
  for (const auto& rule : rules_.chip) {
    if (reset) rule->reset();
    rule->forget();
  }
  for (const auto& rule : rules_.traverser) {
    rule->reset();
    rule->forget();
  }
}

bool ChipInspection::expect(uint64_t rtl, uint64_t expected, const char* files, const char* what) {
  if (rtl == expected) return true;
  findings_.add(files, fmt::format("traverser, lane {}, {}: {:x} in the RTL, {:x} by its rule (bits, hexadecimal)",
                                   lane_, what, rtl, expected));
  return false;
}

bool ChipInspection::expect_words(const Wire& wire, uint32_t low, const uint32_t* words, uint32_t count,
                                  const char* files, const char* what) {
  for (uint32_t i = 0; i < count; ++i)
    if (!expect(wire.bits(low + 32 * i, 32), words[i], files, what)) return false;
  return true;
}

void ChipInspection::advance(uint64_t cycle) {
  if (!active_ || !findings_.empty()) return;
  findings_.begin_cycle(cycle);
  for (const auto& rule : rules_.chip) rule->take();
  // Between frames the traverser is in reset.
  const bool reset = rtl_->outputs().ready;
  for (const auto& rule : rules_.traverser) {
    if (reset) {
      rule->reset();
    } else {
      rule->take();
    }
  }
  if (traverser_seen()) advance_traverser();
}

void ChipInspection::advance_traverser() {
  if (model_->handed().lanes.empty()) return;  // between frames the traverser is in reset
  for (uint32_t lane = 0; lane < model_->lanes(); ++lane) {
    lane_ = lane;
    advance_lane(lane);
    advance_lines(lane);
    advance_stacks(lane);
  }
  check_set();
  // The last lane of the triangle cache is ray_exit's.
  lane_ = model_->lanes();
  const Traverser::Handed::ToLane& exit = model_->handed().lanes[lane_];
  expect(w_.leaf_taken.bits(2 * lane_, 2), exit.leaf_taken, kArbiter, "want of a triangle's line that is taken");
  if (expect(w_.leaf_given.flag(lane_), exit.leaf_slot.has_value(), kBanks, "a triangle's line is given") &&
      exit.leaf_slot)
    expect_words(w_.leaf_given_data, 512 * lane_, exit.leaf.data(), 16,
                 "rtl/traverser/rp_tree_cache.v, rtl/traverser/rp_tree_banks.v", "triangle's line that is given");
}

// A ray that has been set up, for its lane and for ray_exit.
void ChipInspection::check_set() {
  const auto& set = model_->handed().set;
  constexpr const char* kSetup = "rtl/traverser/rp_ray_setup.v, rtl/traverser/rp_traverser.v";
  constexpr const char* kDirection = "rtl/traverser/rp_ray_direction.v, rtl/traverser/rp_ray_setup.v";
  constexpr const char* kPadding = "rtl/traverser/rp_ray_padding.v, rtl/traverser/rp_ray_setup.v";
  if (!expect(w_.set_valid.value(), set.has_value(), kSetup, "a ray is set up") || !set) return;
  lane_ = set->slot.lane;
  expect(w_.set_lane.value(), 1u << lane_, "rtl/traverser/rp_ray_setup.v, rtl/traverser/rp_ray_delay.v",
         "lane of the ray that is set up");
  expect(w_.set_slot.value(), set->slot.slot, "rtl/traverser/rp_ray_setup.v, rtl/traverser/rp_ray_delay.v",
         "slot of the ray that is set up");
  expect(w_.set_place.value(), set->set.place, "rtl/traverser/rp_traverser.v, rtl/traverser/rp_ray_setup.v",
         "place of the ray that is set up");
  expect(w_.set_depth.value(), set->set.depth, "rtl/traverser/rp_traverser.v, rtl/traverser/rp_ray_setup.v",
         "depth of the ray that is set up");
  expect(w_.set_shadow.value(), set->set.shadow, "rtl/traverser/rp_traverser.v, rtl/traverser/rp_ray_setup.v",
         "a shadow ray is set up");
  const LaneRay& ray = set->entered.ray;
  if (!expect(w_.meets.value(), ray.meets, "rtl/traverser/rp_ray_setup.v, rtl/traverser/rp_ray_direction.v",
              "the ray can hit something") ||
      !ray.meets)
    return;
  const auto bits = static_cast<uint32_t>(model_->box_bits());
  const TriangleRay& triangle = ray.triangle;
  expect(w_.main_axis.value(), static_cast<uint32_t>(triangle.kz), kDirection, "main axis");
  expect(w_.scale.value(), static_cast<uint32_t>(ray.limit.scale) & 0x1ff, kDirection, "scale");
  expect(w_.limit.value(), as_bits(ray.limit.limit), "rtl/traverser/rp_ray_setup.v", "limit");
  expect(w_.limit_key.value(), ray.box.limit, "rtl/traverser/rp_ray_setup.v, rtl/arith/rp_float_parts.v",
         "key of the limit");
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const BoxRay::Axis& box = ray.box.axes[axis];
    expect(w_.origin.word(axis), as_bits(triangle.origin[axis]), kPadding, "origin");
    expect(w_.padding.bits(10 * axis, 10), static_cast<uint32_t>(box.padding) & 0x3ff, kPadding, "padding of boxes");
    expect(w_.padded_lower.word(axis), as_bits(triangle.padded[0][axis]), kPadding, "padded origin");
    expect(w_.padded_upper.word(axis), as_bits(triangle.padded[1][axis]), kPadding, "padded origin");
    expect(w_.backwards.flag(axis), box.backwards, kDirection, "backwards");
    expect(w_.still.flag(axis), box.still, kDirection, "still");
    expect(w_.reciprocal.bits(bits * axis, bits), box.reciprocal, kDirection, "reciprocal of the direction");
    expect(w_.exponent.bits(10 * axis, 10), static_cast<uint32_t>(box.exponent) & 0x3ff, kDirection,
           "exponent of the reciprocal");
    expect(w_.inverse.word(axis), as_bits(triangle.inverse[axis]), kDirection, "inverse direction");
  }
  expect(w_.shear.word(0), as_bits(triangle.shear_x), kDirection, "shear");
  expect(w_.shear.word(1), as_bits(triangle.shear_y), kDirection, "shear");
}

// What a lane is given in the cycle.
void ChipInspection::advance_lane(uint32_t number) {
  const Traverser::Handed::ToLane& lane = model_->handed().lanes[number];
  const uint32_t slot_bits = model_->slot_bits();
  const bool enters = w_.enters.value() != 0 && w_.enter_grant.flag(number);
  expect(enters, lane.slot_taken, "rtl/traverser/rp_traverser.v, rtl/common/rp_round_robin.v",
         "a ray that comes gets a slot here");
  expect(w_.slot_free.flag(number), lane.freed.has_value(),
         "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_ray_finish.v", "a slot is free again");
  if (lane.freed && w_.slot_free.flag(number))
    expect(w_.slot_free_slot.value(), *lane.freed, "rtl/traverser/rp_ray_exit.v", "slot that is free again");
  // Results of tests before what they lead to.
  if (expect(w_.result_valid.flag(number), lane.result.has_value(),
             "rtl/traverser/rp_triangle_group.v, rtl/traverser/rp_triangle_pipe.v", "a triangle has its result") &&
      lane.result) {
    const uint32_t tag_bits = 30 + slot_bits;
    const uint64_t tag = lane.result->tag.word(slot_bits);
    expect(w_.result_tag.bits(number * tag_bits, 30), tag & 0x3fffffff,
           "rtl/traverser/rp_triangle_group.v, rtl/traverser/rp_triangle_pipe.v",
           "slot and place of a triangle's result");
    expect(w_.result_number.word(number), lane.result->number,
           "rtl/traverser/rp_triangle_pipe.v, rtl/traverser/rp_triangle_group.v", "number of a triangle's result");
    // Its parts have rules of their own.
    if (expect(w_.result_hit.flag(number), lane.result->hit,
               "rtl/traverser/rp_triangle_pipe.v, rtl/traverser/rp_lane_hits.v", "the triangle is hit") &&
        lane.result->hit)
      expect(w_.result_t.word(number), as_bits(lane.result->t),
             "rtl/traverser/rp_triangle_pipe.v, rtl/traverser/rp_triangle_plane.v", "time of the hit");
  }
  expect(w_.test_valid.flag(number) && w_.test_ready.flag(number), lane.test_taken,
         "rtl/traverser/rp_triangle_group.v, rtl/common/rp_round_robin.v", "a triangle's test begins");
  expect(w_.done_valid.flag(number) && w_.done_ready.flag(number), lane.done_taken,
         "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_traverser.v", "a ray that is done is taken");
}

// What the caches and the memory give a lane in the cycle.
void ChipInspection::advance_lines(uint32_t number) {
  const Traverser::Handed::ToLane& lane = model_->handed().lanes[number];
  const uint32_t slot_bits = model_->slot_bits();
  expect(w_.node_taken.bits(2 * number, 2), lane.node_taken, kArbiter, "want of a node that is taken");
  expect(w_.leaf_taken.bits(2 * number, 2), lane.leaf_taken, kArbiter, "want of a triangle's line that is taken");
  expect(w_.leaf_waited.flag(number) && w_.leaf_room.flag(number), lane.leaf_waited, kBanks,
         "a triangle's line comes for which a ray has waited");
  if (expect(w_.node_given.flag(number), lane.node_slot.has_value(), kBanks, "a node is given") && lane.node_slot) {
    expect(w_.node_given_slot.bits(number * slot_bits, slot_bits), *lane.node_slot, kBanks, "slot that gets a node");
    expect_words(w_.node_given_data, 512 * number, lane.node.data(), 14, kCache, "node that is given");
  }
  if (expect(w_.leaf_given.flag(number), lane.leaf_slot.has_value(), kBanks, "a triangle's line is given") &&
      lane.leaf_slot) {
    expect(w_.leaf_given_slot.bits(number * slot_bits, slot_bits), *lane.leaf_slot, kBanks,
           "slot that gets a triangle's line");
    expect_words(w_.leaf_given_data, 512 * number, lane.leaf.data(), 16, kCache, "triangle's line that is given");
  }
  expect(w_.stack_request_valid.flag(number) && w_.stack_request_ready.flag(number), lane.request_taken,
         "rtl/traverser/rp_tree_port.v, rtl/common/rp_round_robin.v", "a request of a stack is taken");
  if (expect(w_.stack_fill_valid.flag(number), lane.filled.has_value(), "rtl/traverser/rp_tree_port.v",
             "a block of a stack comes") &&
      lane.filled) {
    const auto key_bits = static_cast<uint32_t>(model_->box_bits() + 9);
    for (uint32_t i = 0; i < LaneStacks::kBlock; ++i) {
      const uint32_t low = i * (key_bits + 32);
      expect(w_.stack_fill_entries.bits(low, 32), (*lane.filled)[i].reference, "rtl/traverser/rp_tree_port.v",
             "reference in a block of a stack that comes");
      expect(w_.stack_fill_entries.bits(low + 32, key_bits), (*lane.filled)[i].key, "rtl/traverser/rp_tree_port.v",
             "key in a block of a stack that comes");
    }
  }
}

// What a lane's stacks decide in the cycle.
void ChipInspection::advance_stacks(uint32_t number) {
  const LaneWires& l = lanes_[number];
  const LaneStacks::Outcome& outcome = model_->lane(number).stacks_outcome();
  constexpr const char* kStacks = "rtl/traverser/rp_lane_stacks.v, rtl/traverser/rp_pass_queue.v";
  expect(l.goes_on.value(), outcome.node_goes_on, kStacks, "a ray goes on with its nearest child");
  expect(l.next_valid.value(), outcome.next, kStacks, "a ray goes on from its stack");
  expect(l.done.value(), outcome.done, kStacks, "a ray is done");
  if (outcome.next && l.next_valid.value() != 0) {
    expect(l.next_slot.value(), outcome.slot, kStacks, "slot that goes on from its stack");
    expect(l.next_reference.value(), outcome.reference, kStacks, "reference from the stack");
  }
  if (outcome.done && l.done.value() != 0) expect(l.done_slot.value(), outcome.slot, kStacks, "slot that is done");
  expect(l.begin_ready.value(), outcome.ray_ready, kStacks, "a ray may begin");
}

void ChipInspection::check(uint64_t cycle) {
  if (!active_ || !findings_.empty()) return;
  findings_.begin_cycle(cycle);
  for (const auto& rule : rules_.chip) rule->compare(findings_);
  for (const auto& rule : rules_.traverser) rule->compare(findings_);
  if (!traverser_seen()) return;
  lane_ = 0;
  for (uint32_t lane = 0; lane < model_->lanes(); ++lane) {
    lane_ = lane;
    check_lane(lane);
  }
  if (findings_.empty()) check_caches();
}

void ChipInspection::check_lane(uint32_t number) {
  check_lane_boxes(number);
  if (findings_.empty()) check_lane_ports(number);
}

// From a node's boxes to the stack: registers.
void ChipInspection::check_lane_boxes(uint32_t number) {
  const TraverserLane& lane = model_->lane(number);
  const LaneWires& l = lanes_[number];
  const auto key_bits = static_cast<uint32_t>(model_->box_bits() + 9);
  expect(l.begin_valid.value(), lane.begin_valid(), "rtl/traverser/rp_traverser_lane.v, rtl/common/rp_ram_queue.v",
         "a ray is to begin");
  if (lane.begin_valid() && l.begin_valid.value() != 0)
    expect(l.begin_slot.value(), lane.begin_slot(), "rtl/traverser/rp_traverser_lane.v, rtl/common/rp_ram_queue.v",
           "slot that is to begin");
  expect(l.given_q.value(), lane.given_slot().has_value(), "rtl/traverser/rp_traverser_lane.v",
         "boxes of a node are tested");
  if (lane.given_slot() && l.given_q.value() != 0) {
    expect(l.given_slot_q.value(), *lane.given_slot(), "rtl/traverser/rp_traverser_lane.v", "slot in the box test");
    const uint32_t limit = l.best_key_valid.value() != 0 ? l.best_key.value() : l.box_limit.value();
    expect(limit, lane.hits().limit_key(*lane.given_slot()),
           "rtl/traverser/rp_lane_hits.v, rtl/traverser/rp_traverser_lane.v", "limit of the boxes' test");
    expect(l.test_limit.value(), limit, "rtl/traverser/rp_traverser_lane.v, rtl/traverser/rp_lane_hits.v",
           "limit that the boxes are given");
  }
  const BoxResult* const boxes = lane.boxes();
  if (expect(l.boxes_valid.value(), boxes != nullptr, "rtl/traverser/rp_box_pipe.v, rtl/traverser/rp_traverser_lane.v",
             "boxes have their result") &&
      boxes != nullptr) {
    const BoxResult& result = *boxes;
    constexpr const char* kAxis = "rtl/traverser/rp_box_axis.v, rtl/traverser/rp_box_pipe.v";
    expect(l.met.value(), result.met, kAxis, "boxes that are met");
    for (uint32_t i = 0; i < kBoxes; ++i)
      if ((result.met >> i & 1) != 0)
        expect(l.entry.bits(i * key_bits, key_bits), result.entry[i], kAxis, "key of a box's entry");
  }
  const LaneStacks::NodeResult* const node = lane.node();
  constexpr const char* kOrder = "rtl/traverser/rp_child_order.v, rtl/traverser/rp_traverser_lane.v";
  if (expect(l.node_valid_q.value(), node != nullptr, "rtl/traverser/rp_traverser_lane.v", "a node has been tested") &&
      node != nullptr) {
    expect(l.children.value(), node->children, kOrder, "children that are met");
    expect(l.node_slot_q.value(), node->slot, "rtl/traverser/rp_traverser_lane.v, rtl/common/rp_ram_delay.v",
           "slot of the node");
    // Their references have waited for the boxes.
    constexpr const char* kReferences = "rtl/traverser/rp_child_order.v, rtl/common/rp_ram_delay.v";
    if (node->children != 0) expect(l.nearest.value(), node->nearest, kReferences, "nearest child");
    for (uint32_t i = 0; i + 1 < node->children; ++i) {
      const uint32_t low = i * (key_bits + 32);
      expect(l.others.bits(low, 32), node->others[i].reference, kReferences, "another child");
      expect(l.others.bits(low + 32, key_bits), node->others[i].key, kOrder, "key of another child");
    }
    if (node->children == 0)
      expect(l.node_limit_q.value(), node->limit, "rtl/traverser/rp_traverser_lane.v, rtl/traverser/rp_lane_hits.v",
             "limit of the node");
  }
  const std::optional<LaneStacks::LeafResult> leaf = lane.leaf_result();
  constexpr const char* kHits = "rtl/traverser/rp_lane_hits.v, rtl/traverser/rp_traverser_lane.v";
  if (expect(l.leaf_valid.value(), leaf.has_value(), kHits, "a leaf has its results") && leaf) {
    expect(l.leaf_over.value(), leaf->over, kHits, "the leaf's ray is done");
    expect(l.leaf_limit.value(), leaf->limit, kHits, "limit after the leaf");
  }
}

void ChipInspection::check_wants(const LineWants& wants, const Wire& valid, const Wire& line, const Wire& slot,
                                 uint32_t number, const char* files, const char* what) {
  const uint32_t slot_bits = model_->slot_bits();
  for (uint32_t i = 0; i < wants.size(); ++i) {
    const uint32_t place = 2 * number + i;
    if (!expect(valid.flag(place), wants[i].valid, files, what) || !wants[i].valid) continue;
    expect(line.bits(place * kLineBits, kLineBits), wants[i].line, files, what);
    if (!wants[i].prefetch) expect(slot.bits(place * slot_bits, slot_bits), wants[i].slot, files, what);
  }
}

void ChipInspection::check_lane_ports(uint32_t number) {
  const TraverserLane& lane = model_->lane(number);
  const uint32_t slot_bits = model_->slot_bits();
  expect(w_.slot_valid.flag(number), lane.slot_valid(), "rtl/common/rp_free_list.v, rtl/traverser/rp_traverser_lane.v",
         "a slot is free");
  if (lane.slot_valid() && w_.slot_valid.flag(number))
    expect(w_.slot_of.bits(number * slot_bits, slot_bits), lane.slot(),
           "rtl/common/rp_free_list.v, rtl/traverser/rp_traverser_lane.v", "slot that is free");
  expect(lanes_[number].fill_waits.value(), lane.fill_waits(), "rtl/traverser/rp_lane_stacks.v",
         "a block of a stack waits");
  check_wants(lane.wants_node() ? lane.node_wants() : LineWants{}, w_.node_want, w_.node_want_line, w_.node_want_slot,
              number, "rtl/traverser/rp_traverser_lane.v, rtl/traverser/rp_line_offers.v", "node that is wanted");
  check_wants(lane.leaf_wants(), w_.leaf_want, w_.leaf_want_line, w_.leaf_want_slot, number,
              "rtl/traverser/rp_leaf_reader.v, rtl/traverser/rp_line_offers.v", "triangle's line that is wanted");
  expect(w_.leaf_room.flag(number), lane.leaf_room(), "rtl/traverser/rp_leaf_reader.v", "room for a triangle's line");
  const TreeFault& fault = lane.fault();
  constexpr const char* kLane = "rtl/traverser/rp_traverser_lane.v";
  if (expect(w_.node_fault.flag(number), fault.valid, kLane, "fault of a node") && fault.valid)
    expect(w_.node_fault_line.bits(number * kLineBits, kLineBits), fault.line, kLane, "number of that node");
  constexpr const char* kStacks = "rtl/traverser/rp_lane_stacks.v, rtl/traverser/rp_pass_queue.v";
  if (expect(w_.stack_request_valid.flag(number), lane.request_valid(), kStacks, "request of a stack") &&
      lane.request_valid()) {
    const LaneStacks::Request& request = lane.request();
    const auto key_bits = static_cast<uint32_t>(model_->box_bits() + 9);
    expect(w_.stack_request_write.flag(number), request.write, kStacks, "a stack's request writes");
    expect(w_.stack_request_slot.bits(number * slot_bits, slot_bits), request.slot, kStacks, "slot of the request");
    expect(w_.stack_request_block.bits(number * kBlockBits, kBlockBits), request.block, kStacks, "block of a stack");
    for (uint32_t i = 0; request.write && i < LaneStacks::kBlock; ++i) {
      const uint32_t low = (number * LaneStacks::kBlock + i) * (key_bits + 32);
      expect(w_.stack_request_entries.bits(low, 32), request.entries[i].reference, kStacks, "reference of an entry");
      expect(w_.stack_request_entries.bits(low + 32, key_bits), request.entries[i].key, kStacks, "key of an entry");
    }
  }
  check_test(number);
  if (expect(w_.done_valid.flag(number), lane.done_valid(),
             "rtl/traverser/rp_traverser_lane.v, rtl/traverser/rp_lane_stacks.v", "a ray is done") &&
      lane.done_valid()) {
    constexpr const char* kHits = "rtl/traverser/rp_lane_hits.v, rtl/traverser/rp_traverser_lane.v";
    expect(w_.done_slot.bits(number * slot_bits, slot_bits), lane.done_slot(), kLane, "slot of the ray that is done");
    const LaneHits::Hit& hit = lane.hits().best(lane.done_slot());
    if (expect(w_.done_hit.flag(number), hit.hit, kHits, "the ray has hit something") && hit.hit) {
      expect(w_.done_t.word(number), as_bits(hit.t), kHits, "time of the ray's hit");
      expect(w_.done_place.bits(number * 29, 29), hit.place, kHits, "place of the triangle that is hit");
    }
  }
}

void ChipInspection::check_test(uint32_t number) {
  const TraverserLane& lane = model_->lane(number);
  constexpr const char* kReader = "rtl/traverser/rp_leaf_reader.v, rtl/traverser/rp_pass_queue.v";
  constexpr const char* kRays = "rtl/traverser/rp_traverser_lane.v, rtl/traverser/rp_leaf_reader.v";
  if (!expect(w_.test_valid.flag(number), lane.test_valid(), kReader, "a triangle can be tested") || !lane.test_valid())
    return;
  const LeafReader::Test test = *lane.test();
  const uint32_t slot_bits = model_->slot_bits(), tag_bits = 30 + slot_bits, low = number * record::kTest.bits();
  const uint64_t tag = TestTag{test.slot, test.last, test.place}.word(slot_bits);
  expect(w_.test_tag.bits(number * tag_bits, 30), tag & 0x3fffffff, kReader, "slot and place of a triangle's test");
  std::array<uint32_t, 10> words;
  std::memcpy(words.data(), &test.triangle, sizeof words);
  expect_words(w_.test, low, words.data(), 10, kReader, "triangle that is tested");
  const TriangleRay& ray = lane.ray(test.slot).triangle;
  const auto floats = [&](int at, const float* values, uint32_t count, const char* what) {
    for (uint32_t i = 0; i < count; ++i) expect(w_.test.bits(low + at + 32 * i, 32), as_bits(values[i]), kRays, what);
  };
  floats(record::kTest.low("origin"), ray.origin, 3, "origin of a triangle's ray");
  floats(record::kTest.low("padded_lower"), ray.padded[0], 3, "padded origin of a triangle's ray");
  floats(record::kTest.low("padded_upper"), ray.padded[1], 3, "padded origin of a triangle's ray");
  floats(record::kTest.low("inverse"), ray.inverse, 3, "inverse direction of a triangle's ray");
  floats(record::kTest.low("shear"), &ray.shear_x, 1, "shear of a triangle's ray");
  floats(record::kTest.low("shear") + 32, &ray.shear_y, 1, "shear of a triangle's ray");
}

void ChipInspection::check_caches() {
  const TreeBanks &nodes = model_->node_cache(), &leaves = model_->triangle_cache();
  if (expect(w_.node_request_valid.value(), nodes.request_valid(), kBanks, "the node cache asks for a line") &&
      nodes.request_valid()) {
    expect(w_.node_request_line.value(), nodes.request_line(), kBanks, "line that the node cache asks for");
    expect(w_.node_request_id.value(), nodes.request_id(), kBanks, "register of the node cache's request");
  }
  if (expect(w_.triangle_request_valid.value(), leaves.request_valid(), kBanks, "the triangle cache asks for a line") &&
      leaves.request_valid()) {
    expect(w_.triangle_request_line.value(), leaves.request_line(), kBanks, "line that the triangle cache asks for");
    expect(w_.triangle_request_id.value(), leaves.request_id(), kBanks, "register of the triangle cache's request");
  }
  const std::optional<TreePort::Line>& line = model_->port().line();
  constexpr const char* kPort = "rtl/traverser/rp_tree_port.v";
  const bool to_nodes = line && line->source == TreePort::Source::Nodes;
  const bool to_leaves = line && line->source == TreePort::Source::Triangles;
  // One that has gone has been taken.
  const auto expect_line = [&](const Wire& wire, bool comes, const char* what) {
    expect(wire.value(), comes,
           comes ? "rtl/traverser/rp_tree_banks.v, rtl/traverser/rp_tree_port.v"
                 : "rtl/traverser/rp_tree_port.v, rtl/traverser/rp_tree_banks.v",
           what);
  };
  expect_line(w_.node_fill_valid, to_nodes, "a line comes for the node cache");
  expect_line(w_.triangle_fill_valid, to_leaves, "a line comes for the triangle cache");
  if (to_nodes && w_.node_fill_valid.value() != 0)
    expect(w_.node_fill_id.value(), line->id, kPort, "request that gets its line");
  if (to_leaves && w_.triangle_fill_valid.value() != 0)
    expect(w_.triangle_fill_id.value(), line->id, kPort, "request that gets its line");
  if (to_nodes || to_leaves) expect_words(w_.fill_data, 0, line->data.data(), 16, kPort, "line that comes");
  expect(w_.port_fault.value(), model_->port().fault().valid, kPort, "a line beyond the tree");
  check_exit();
  lane_ = model_->lanes();
  check_wants(model_->exit().wants(), w_.leaf_want, w_.leaf_want_line, w_.leaf_want_slot, lane_,
              "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_leaf_reader.v",
              "line of a triangle that was hit, which is wanted");
  expect(w_.leaf_room.flag(lane_), model_->exit().room(), "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_leaf_reader.v",
         "room for the line of a triangle that was hit");
}

// What leaves with a ray: each word of an intersection is the work of one block.
void ChipInspection::check_exit() {
  const RayExit& exit = model_->exit();
  const TraverserPorts& ports = rtl_->outputs().traverser;
  constexpr const char* kExit = "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_ray_finish.v";
  const TreePort& port = model_->port();
  constexpr const char* kPort = "rtl/traverser/rp_tree_port.v, rtl/traverser/rp_traverser.v";
  if (expect(ports.tree_request_valid, port.request_valid(), kPort, "request to the memory") && port.request_valid()) {
    expect(ports.tree_request.address, port.request().address, kPort, "address of a request");
    expect(ports.tree_request.write, port.request().write, kPort, "a request writes");
  }
  expect(ports.free_valid, exit.free_valid(), kExit, "a ray leaves its place");
  expect(ports.contribution_valid, exit.contribution_valid(), kExit, "a contribution");
  if (!expect(ports.put_valid, exit.put_valid(), kExit, "a beat of an intersection") || !exit.put_valid()) return;
  expect(to_underlying(ports.put_kind), to_underlying(exit.put_kind()), kExit, "kind of an intersection");
  const Beat expected = exit.put_data();
  for (uint32_t i = 0; i < kBeatWords; ++i) {
    const uint32_t number = exit.put_word(i);
    const bool normal = number >= word::kNormal && number < word::kNormal + 3;
    const bool shares = number >= word::kBarycentric && number < word::kBarycentric + 2;
    const char* files = normal   ? "rtl/traverser/rp_ray_finish.v, rtl/traverser/rp_triangle_normal.v"
                        : shares ? "rtl/traverser/rp_triangle_shares.v, rtl/traverser/rp_ray_finish.v"
                        : number == word::kDistance ? "rtl/traverser/rp_ray_finish.v, rtl/traverser/rp_ray_delay.v"
                        : number == word::kMaterial ? "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_leaf_reader.v"
                                                    : "rtl/traverser/rp_ray_exit.v, rtl/traverser/rp_ray_finish.v";
    if (number != kNoWord) expect(ports.put_data[i], expected[i], files, "word of an intersection");
  }
}

}  // namespace raypool::lockstep
