// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_lane_hits.v: what a lane knows of its rays' hits, each ray's best one so far, and when the last
// triangle of a leaf has its result.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "machine/traverser/box_ray.hpp"
#include "machine/traverser/lane_stacks.hpp"
#include "machine/traverser/triangle_pipe.hpp"

namespace raypool {

/// A ray as a lane has it: what its set-up computes.
struct LaneRay {
  bool meets = false;   ///< false: it hits nothing, and nothing else matters
  bool shadow = false;  ///< any hit ends it
  BoxRay box;           ///< with its limit's key
  TriangleRay triangle{};
  TrianglePipe::Limit limit{};
};

/// Of a triangle's test: which ray, and what lane_hits wants to know when it has its result.
struct TestTag {
  uint32_t slot = 0;
  bool last = false;   ///< of its leaf
  uint32_t place = 0;  ///< of the triangle in the tree

  /// As the pipe carries it.
  uint64_t word(uint32_t slot_bits) const { return (uint64_t{place} << 1 | (last ? 1u : 0u)) << slot_bits | slot; }
  static TestTag of(uint64_t word, uint32_t slot_bits) {
    return {static_cast<uint32_t>(word & ((uint64_t{1} << slot_bits) - 1)), (word >> slot_bits & 1) != 0,
            static_cast<uint32_t>(word >> (slot_bits + 1))};
  }
};

class LaneHits {
 public:
  struct Hit {
    bool hit = false;
    float t = 0;  ///< internal
    uint32_t number = 0, place = 0;
  };
  struct Result {
    TestTag tag;
    uint32_t number = 0;
    bool hit = false;
    float t = 0;
  };

  explicit LaneHits(const std::vector<LaneRay>& rays) : rays_(&rays), hits_(rays.size()) {}

  const Hit& best(uint32_t slot) const { return hits_[slot]; }
  /// What a test of this ray is given, when in the same cycle this result is there, or none (null).
  TrianglePipe::Best told(uint32_t slot, const Result* result) const {
    if (result != nullptr && result->hit && result->tag.slot == slot) return {result->t, result->number};
    return hits_[slot].hit ? TrianglePipe::Best{hits_[slot].t, hits_[slot].number} : TrianglePipe::Best{INFINITY, 0};
  }
  /// Of boxes that the ray may still meet.
  uint32_t limit_key(uint32_t slot) const {
    const LaneRay& ray = (*rays_)[slot];
    return hits_[slot].hit ? ray.box.key(hits_[slot].t, ray.limit.scale) : ray.box.limit;
  }
  bool leaf_valid() const { return ends_.has_value(); }
  /// A leaf with results for all its triangles, the last of which came in the cycle before; `bits`: of keys.
  std::optional<LaneStacks::LeafResult> leaf(int bits) const {
    if (!ends_) return {};
    const bool hit = hits_[*ends_].hit;
    // Without a hit all entries are within the ray's limit, as their boxes were.
    return LaneStacks::LeafResult{*ends_, hit ? limit_key(*ends_) : infinite_key(bits), (*rays_)[*ends_].shadow && hit};
  }

  /// In this cycle a ray enters this slot, which has no results.
  void enter(uint32_t slot) { hits_[slot].hit = false; }
  /// The end of a cycle.
  void clock(const Result* result) {
    ends_.reset();
    if (result == nullptr) return;
    if (result->hit) hits_[result->tag.slot] = {true, result->t, result->number, result->tag.place};
    if (result->tag.last) ends_ = result->tag.slot;
  }

 private:
  const std::vector<LaneRay>* rays_;
  std::vector<Hit> hits_;         // [slot]
  std::optional<uint32_t> ends_;  // slot with a leaf that had its last triangle's result in the cycle before
};

}  // namespace raypool
