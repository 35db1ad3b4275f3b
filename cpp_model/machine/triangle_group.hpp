// rtl/triangle_group.v: a triangle pipe, and the lanes that share it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "machine/lane_hits.hpp"
#include "machine/leaf_reader.hpp"
#include "machine/round_robin.hpp"
#include "machine/traverser_lane.hpp"
#include "machine/triangle_pipe.hpp"

namespace raypool {

class TriangleGroup {
 public:
  static constexpr uint32_t kBits = 32;  ///< of t's significands

  /// `slot_bits`: of a slot's number in its lane.
  explicit TriangleGroup(uint32_t slot_bits) : slot_bits_(slot_bits), pipe_(kBits) {}

  /// So many lanes share it. All of them, once.
  void add(TraverserLane* lane) { lanes_.push_back(lane); }

  /// A cycle's decisions: whose test begins, of the lanes that have one, and whose result is there.
  void choose(uint32_t asking) {
    chosen_.reset();
    if (asking != 0) {
      chosen_ = turn_.choose(asking);
      turn_.advance(*chosen_);
    }
    result_lane_.reset();
    if (pipe_.result() == nullptr) return;
    const TriangleResult& from = *pipe_.result();
    result_ = {tag_of(from), from.number, from.hit, from.t};
    result_lane_ = lane_of(from);
  }
  /// Of the lane with this number in the group.
  bool test_taken(uint32_t lane) const { return chosen_ == lane; }
  const LaneHits::Result* result(uint32_t lane) const { return result_lane_ == lane ? &result_ : nullptr; }

  /// The end of a cycle, before that of its lanes.
  void clock() {
    TrianglePipe::Limit limit{1, 0};
    TrianglePipe::Best best{1, 0};
    if (const TriangleResult* const told = pipe_.told_limit())
      limit = lanes_[lane_of(*told)]->ray(tag_of(*told).slot).limit;
    if (const TriangleResult* const told = pipe_.told_best())
      best = lanes_[lane_of(*told)]->hits().told(tag_of(*told).slot, result(lane_of(*told)));
    if (!chosen_) {
      pipe_.clock(nullptr, {}, 0, limit, best);
      return;
    }
    const LeafReader::Test test = *lanes_[*chosen_]->test();
    const uint64_t tag = TestTag{test.slot, test.last, test.place}.word(slot_bits_);
    pipe_.clock(&lanes_[*chosen_]->ray(test.slot).triangle, test.triangle, uint64_t{*chosen_} << kLaneAt | tag, limit,
                best);
  }

 private:
  static constexpr uint32_t kLaneAt = 48;  // in a tag

  static uint32_t lane_of(const TriangleResult& of) { return static_cast<uint32_t>(of.tag >> kLaneAt); }
  TestTag tag_of(const TriangleResult& of) const {
    return TestTag::of(of.tag & ((uint64_t{1} << kLaneAt) - 1), slot_bits_);
  }

  uint32_t slot_bits_;
  TrianglePipe pipe_;
  std::vector<TraverserLane*> lanes_;
  RoundRobin turn_;
  std::optional<uint32_t> chosen_, result_lane_;
  LaneHits::Result result_;
};

}  // namespace raypool
