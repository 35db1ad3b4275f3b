// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_box_pipe.v, with an axis as rtl/traverser/rp_box_axis.v: which of the four boxes of a node of 64
// bytes a ray meets, in narrow integers that are rounded so that no box is missed. docs/machine/box-test.md proves it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "machine/common/pipe_items.hpp"
#include "machine/traverser/box_node.hpp"
#include "machine/traverser/box_ray.hpp"

namespace raypool {

/// What becomes of a test.
struct BoxResult {
  uint32_t met = 0;             ///< bit i: box i
  uint32_t entry[kBoxes] = {};  ///< key of the time from which on the ray may be in it, rounded down
};

/// Something of each child's box; of comparisons all bits are set where they hold.
using OfBoxes = int32_t __attribute__((vector_size(kBoxes * sizeof(int32_t))));
using FloatsOfBoxes = float __attribute__((vector_size(kBoxes * sizeof(float))));
inline OfBoxes larger_of(const OfBoxes& a, const OfBoxes& b) { return a > b ? a : b; }
inline OfBoxes smaller_of(const OfBoxes& a, const OfBoxes& b) { return a < b ? a : b; }

/// One of two without a branch, as no processor can predict it.
inline int64_t select(bool condition, int64_t yes, int64_t no) { return no ^ ((yes ^ no) & -int64_t{condition}); }

/// time_key() of values of less than 27 bits, not below zero: a float has their leading bit as its exponent, and behind
/// it the fraction. Of 23 bits and more the last four are left out, so that no float is rounded up; no key has them.
inline OfBoxes time_keys(const OfBoxes& values, int unit, int bits) {
  const OfBoxes kept = values & ~((values >= (1 << 22)) & 15);
  const FloatsOfBoxes floats = __builtin_convertvector(kept, FloatsOfBoxes);
  OfBoxes words;
  std::memcpy(&words, &floats, sizeof words);
  return ((words >> (24 - bits)) + (unit + kKeyBias - 127) * (1 << (bits - 1))) & (values != 0);
}

/// A box against the slab of one axis: the times between which the ray may be in it, as keys.
struct BoxAxis {
  OfBoxes near, far, missed;

  BoxAxis(const BoxRay::Axis& ray, int bits, const BoxNode& node, int axis) {
    const int places = bits + 3;  // of the distance n
    // The distance from the ray's origin to the grid's: its size is in n .. n + 1, x 2^unit.
    const float grid = node.origin[axis];
    const FloatParts a(grid), b(ray.origin);
    const bool swap = (as_bits(ray.origin) & 0x7fffffff) > (as_bits(grid) & 0x7fffffff);
    const int large_unit = static_cast<int>(select(swap, b.unit, a.unit)), small_unit = a.unit + b.unit - large_unit;
    const auto large = static_cast<uint32_t>(select(swap, b.value, a.value)), small = a.value + b.value - large;
    const bool grid_negative = as_bits(grid) >> 31 != 0, origin_negative = as_bits(ray.origin) >> 31 != 0;
    const bool negative = swap ? !origin_negative : grid_negative;
    const int shift = std::min(large_unit - small_unit, 31);
    const uint64_t whole = uint64_t{large} << 2, part = uint64_t{small} << 2;
    const uint64_t aligned = part >> shift;
    const bool rest = (aligned << shift) != part;
    const bool subtracts = grid_negative == origin_negative;
    const auto change = static_cast<int64_t>(aligned + (subtracts & rest));
    const uint64_t sum = whole + static_cast<uint64_t>(select(subtracts, -change, change));
    const int leading = sum != 0 ? leading_one(sum) : 0;
    const int sum_unit = large_unit - 2;
    const int unit = std::max(sum_unit + leading - (places - 1), ray.padding);
    const int drop = std::min(unit - sum_unit, 31);
    const int64_t n = static_cast<int64_t>(drop >= 0 ? sum >> drop : sum << -drop);

    // In time. Padding takes it to n - 1 .. n + 2; the reciprocal lies in m .. m + 1.
    const int64_t m = ray.reciprocal;
    const int64_t least = n * m - m - 1, most = n * m + 2 * m + n + 2;
    const bool behind = negative != ray.backwards;
    const int cut = bits - 1;
    const int64_t near_base = select(behind, -most, least) >> cut, far_base = select(behind, least, -most) >> cut;
    const int coarser = unit + cut - node.exponent[axis];
    const int base_drop = std::min(std::max(-coarser, 0), 31), step_drop = std::min(std::max(coarser, 0), 31);
    const int sum_at = std::max(unit + cut, static_cast<int>(node.exponent[axis])) + ray.exponent;
    // Of both planes that side first that the ray meets first. The far one's time is negated, so that dropped bits make
    // it later.
    const auto steps = [&](int side, bool negated) {
      const uint8_t(&q)[kBoxes] = node.planes[side][axis];
      const OfBoxes planes = {q[0], q[1], q[2], q[3]}, times = planes * static_cast<int32_t>(m);
      const int32_t mask = -int32_t{negated};
      return (((times + (planes & mask)) ^ mask) - mask) >> step_drop;
    };
    const OfBoxes enters = static_cast<int32_t>(near_base >> base_drop) + steps(ray.backwards ? 1 : 0, ray.backwards);
    const OfBoxes leaves =
        -(static_cast<int32_t>(far_base >> base_drop) + steps(ray.backwards ? 0 : 1, !ray.backwards));
    if (ray.still) {
      near = OfBoxes{};
      far = OfBoxes{} + static_cast<int32_t>(infinite_key(bits));
      missed = (leaves < 0) | (enters > 0);
    } else {
      near = time_keys(larger_of(enters, OfBoxes{}), sum_at, bits);
      far = time_keys(larger_of(leaves, OfBoxes{}), sum_at, bits);
      missed = leaves < 0;
    }
  }
};

/// The test of one node; `limit` is a key.
inline BoxResult test_boxes(const BoxRay& ray, const BoxNode& node, uint32_t limit) {
  BoxResult result;
  const BoxAxis x(ray.axes[0], ray.bits, node, 0), y(ray.axes[1], ray.bits, node, 1), z(ray.axes[2], ray.bits, node, 2);
  const OfBoxes near = larger_of(larger_of(x.near, y.near), z.near);
  const OfBoxes far = smaller_of(smaller_of(x.far, y.far), smaller_of(z.far, OfBoxes{} + static_cast<int32_t>(limit)));
  const OfBoxes bit = {1, 2, 4, 8}, met = (near <= far) & ~(x.missed | y.missed | z.missed) & bit;
  for (int i = 0; i < kBoxes; ++i) {
    result.entry[i] = static_cast<uint32_t>(near[i]);
    result.met |= static_cast<uint32_t>(met[i]);
  }
  result.met &= (1u << std::min<uint32_t>(node.children, kBoxes)) - 1;
  return result;
}

/// The pipe: a node a cycle while it moves, which it does unless a result is there and is not taken.
class BoxPipe {
 public:
  static constexpr int kStages = 8;

  bool valid() const { return nodes_.there(kStages); }
  const BoxResult& result() const { return *nodes_.at(kStages); }  ///< only while valid()
  bool ready(bool result_ready) const { return !valid() || result_ready; }

  /// The end of a cycle. `node`: null, none is offered; `limit`: a key, of the best hit so far.
  void clock(bool result_ready, const BoxRay& ray, const BoxNode* node, uint32_t limit) {
    if (!ready(result_ready)) return;
    if (node != nullptr) nodes_.begin() = test_boxes(ray, *node, limit);
    nodes_.clock();
  }

 private:
  PipeItems<BoxResult, kStages> nodes_;
};

}  // namespace raypool
