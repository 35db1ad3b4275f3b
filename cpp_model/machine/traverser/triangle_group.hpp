// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_triangle_group.v: a triangle pipe, and the lanes that share it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bits.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/lane_hits.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/traverser_lane.hpp"
#include "machine/traverser/traverser_work.hpp"
#include "machine/traverser/triangle_pipe.hpp"

namespace raypool {

class TriangleGroup {
 public:
  static constexpr uint32_t kBits = 32;  ///< of t's significands

  using Lanes = std::vector<std::unique_ptr<TraverserLane>>;

  /// Of all lanes those share it of which `members` has a bit. `slot_bits`: of a slot's number in its lane.
  TriangleGroup(const Lanes& lanes, uint32_t members, uint32_t slot_bits)
      : lanes_(&lanes), members_(members), slot_bits_(slot_bits), pipe_(kBits) {}

  /// Cycles from a test to its result.
  static constexpr uint32_t kStages = TrianglePipe::stages(kBits);

  /// A cycle's decision: the lane that begins its test, of lanes of which one at least has one.
  uint32_t choose(uint32_t asking) {
    const uint32_t members = asking & members_, taken = turn_.choose(members);
    turn_.advance(taken);
    ++work_.tests;
    work_.waiting += popcount(members) - 1;
    return taken;
  }
  /// Of a test that began kStages cycles before this one, which its lane's results until the cycle before decide;
  /// result() stays until the next one.
  uint32_t end(uint64_t cycle) {
    pass(cycle);
    const TriangleResult& from = *pipe_.result();
    result_ = {TestTag::of(from.tag & ((uint64_t{1} << kLaneAt) - 1), slot_bits_), from.number, from.hit, from.t};
    const auto number = static_cast<uint32_t>(from.tag >> kLaneAt);
    result_.hit = from.hit && TrianglePipe::counts(from, lane(number).hits().told(result_.tag.slot, nullptr));
    return number;
  }
  const LaneHits::Result& result() const { return result_; }
  uint32_t members() const { return members_; }
  const PipeWork& work() const { return work_; }

  /// The test of the lane that has been chosen begins; before the end of the lanes' cycle.
  void begin(uint64_t cycle, uint32_t taken) {
    pass(cycle);
    const LeafReader::Test test = *lane(taken).test();
    const uint64_t tag = TestTag{test.slot, test.last, test.place}.word(slot_bits_);
    const LaneRay& ray = lane(taken).ray(test.slot);
    pipe_.begin(ray.triangle, test.triangle, uint64_t{taken} << kLaneAt | tag, ray.limit);
  }

 private:
  void pass(uint64_t cycle) {
    pipe_.pass(cycle - cycle_);
    cycle_ = cycle;
  }

  static constexpr uint32_t kLaneAt = 48;  // in a tag

  const TraverserLane& lane(uint32_t number) const { return *(*lanes_)[number]; }

  const Lanes* lanes_;
  uint32_t members_, slot_bits_;
  TrianglePipe pipe_;
  RoundRobin turn_;
  uint64_t cycle_ = 0;  // up to which the pipe has moved
  LaneHits::Result result_;
  PipeWork work_;
};

}  // namespace raypool
