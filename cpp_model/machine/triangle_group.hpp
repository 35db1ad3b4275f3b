// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/triangle_group.v: a triangle pipe, and the lanes that share it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bits.hpp"
#include "machine/lane_hits.hpp"
#include "machine/leaf_reader.hpp"
#include "machine/round_robin.hpp"
#include "machine/traverser_lane.hpp"
#include "machine/traverser_work.hpp"
#include "machine/triangle_pipe.hpp"

namespace raypool {

class TriangleGroup {
 public:
  static constexpr uint32_t kBits = 32;  ///< of t's significands

  using Lanes = std::vector<std::unique_ptr<TraverserLane>>;
  static constexpr uint32_t kNone = UINT32_MAX;

  /// Of all lanes those share it of which `members` has a bit. `slot_bits`: of a slot's number in its lane.
  TriangleGroup(const Lanes& lanes, uint32_t members, uint32_t slot_bits)
      : lanes_(&lanes), members_(members), slot_bits_(slot_bits), pipe_(kBits) {}

  /// A cycle's decisions: whose test begins, of the lanes that have one, and whose result is there.
  void choose(uint32_t asking) {
    const uint32_t members = asking & members_;
    taken_ = result_lane_ = kNone;
    if (members != 0) {
      taken_ = turn_.choose(members);
      turn_.advance(taken_);
      ++work_.tests;
      work_.waiting += popcount(members) - 1;
    }
    if (pipe_.result() == nullptr) return;
    const TriangleResult& from = *pipe_.result();
    result_ = {tag_of(from), from.number, from.hit, from.t};
    result_lane_ = lane_of(from);
  }
  /// Lane whose test begins, and lane whose result() is there, or kNone.
  uint32_t taken() const { return taken_; }
  uint32_t result_lane() const { return result_lane_; }
  const LaneHits::Result& result() const { return result_; }
  const PipeWork& work() const { return work_; }

  /// The end of a cycle, before that of its lanes.
  void clock() {
    TrianglePipe::Limit limit{1, 0};
    TrianglePipe::Best best{1, 0};
    if (const TriangleResult* const told = pipe_.told_limit())
      limit = lane(lane_of(*told)).ray(tag_of(*told).slot).limit;
    if (const TriangleResult* const told = pipe_.told_best())
      best = lane(lane_of(*told)).hits().told(tag_of(*told).slot, result_lane_ == lane_of(*told) ? &result_ : nullptr);
    if (taken_ != kNone) begin(*lane(taken_).test());
    pipe_.clock(limit, best);
  }

 private:
  void begin(const LeafReader::Test& test) {
    const uint64_t tag = TestTag{test.slot, test.last, test.place}.word(slot_bits_);
    pipe_.begin(lane(taken_).ray(test.slot).triangle, test.triangle, uint64_t{taken_} << kLaneAt | tag);
  }

  static constexpr uint32_t kLaneAt = 48;  // in a tag

  const TraverserLane& lane(uint32_t number) const { return *(*lanes_)[number]; }
  static uint32_t lane_of(const TriangleResult& of) { return static_cast<uint32_t>(of.tag >> kLaneAt); }
  TestTag tag_of(const TriangleResult& of) const {
    return TestTag::of(of.tag & ((uint64_t{1} << kLaneAt) - 1), slot_bits_);
  }

  const Lanes* lanes_;
  uint32_t members_, slot_bits_;
  TrianglePipe pipe_;
  RoundRobin turn_;
  uint32_t taken_ = kNone, result_lane_ = kNone;
  LaneHits::Result result_;
  PipeWork work_;
};

}  // namespace raypool
