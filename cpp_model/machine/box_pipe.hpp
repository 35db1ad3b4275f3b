// rtl/box_pipe.v, with an axis as rtl/box_axis.v: which of the four boxes of a node of 64 bytes a ray meets, in narrow
// integers that are rounded so that no box is missed. docs/traverser.md proves it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "machine/box_ray.hpp"

namespace raypool {

inline constexpr int kBoxes = 4;

/// The boxes of a node, as CompressedNode has them: plane q lies at origin + q x 2^exponent.
struct BoxNode {
  float origin[3];  ///< finite
  int8_t exponent[3];
  uint8_t children;              ///< that there are, at most four
  uint8_t planes[2][3][kBoxes];  ///< lower, upper, which is not less; x, y, z; child
};

/// What becomes of a test.
struct BoxResult {
  uint32_t met = 0;             ///< bit i: box i
  uint32_t entry[kBoxes] = {};  ///< key of the time from which on the ray may be in it, rounded down
};

/// A box against the slab of one axis: the times between which the ray may be in it, as keys.
struct BoxAxis {
  uint32_t near[kBoxes], far[kBoxes];
  bool missed[kBoxes];

  BoxAxis(const BoxRay::Axis& ray, int bits, const BoxNode& node, int axis) {
    const int places = bits + 3;  // of the distance n
    // The distance from the ray's origin to the grid's: its size is in n .. n + 1, x 2^unit.
    const float grid = node.origin[axis];
    const FloatParts a(grid), b(ray.origin);
    const bool swap = (as_bits(ray.origin) & 0x7fffffff) > (as_bits(grid) & 0x7fffffff);
    const FloatParts &large = swap ? b : a, &small = swap ? a : b;
    const bool grid_negative = as_bits(grid) >> 31 != 0, origin_negative = as_bits(ray.origin) >> 31 != 0;
    const bool negative = swap ? !origin_negative : grid_negative;
    const int shift = std::min(large.unit - small.unit, 31);
    const uint64_t whole = uint64_t{large.value} << 2, part = uint64_t{small.value} << 2;
    const uint64_t aligned = part >> shift;
    const bool rest = (aligned << shift) != part;
    const uint64_t sum = grid_negative != origin_negative ? whole + aligned : whole - aligned - rest;
    const int leading = sum != 0 ? leading_one(sum) : 0;
    const int sum_unit = large.unit - 2;
    const int unit = std::max(sum_unit + leading - (places - 1), ray.padding);
    const int drop = std::min(unit - sum_unit, 31);
    const int64_t n = static_cast<int64_t>(drop >= 0 ? sum >> drop : sum << -drop);

    // In time. Padding takes it to n - 1 .. n + 2; the reciprocal lies in m .. m + 1.
    const int64_t m = ray.reciprocal;
    const int64_t least = n * m - m - 1, most = n * m + 2 * m + n + 2;
    const bool behind = negative != ray.backwards;
    const int cut = bits - 1;
    const int64_t near_base = (behind ? -most : least) >> cut, far_base = (behind ? least : -most) >> cut;
    const int coarser = unit + cut - node.exponent[axis];
    const int base_drop = std::min(std::max(-coarser, 0), 31), step_drop = std::min(std::max(coarser, 0), 31);
    const int sum_at = std::max(unit + cut, static_cast<int>(node.exponent[axis])) + ray.exponent;
    for (int i = 0; i < kBoxes; ++i) {
      const int64_t first = node.planes[ray.backwards ? 1 : 0][axis][i];
      const int64_t second = node.planes[ray.backwards ? 0 : 1][axis][i];
      // The far plane's time is negated, so that dropped bits make it later.
      const auto steps = [m](int64_t q, bool negated) { return negated ? -(q * m + q) : q * m; };
      const int64_t enters = (near_base >> base_drop) + (steps(first, ray.backwards) >> step_drop);
      const int64_t leaves = -((far_base >> base_drop) + (steps(second, !ray.backwards) >> step_drop));
      missed[i] = leaves < 0 || (ray.still && enters > 0);
      near[i] = enters < 0 || ray.still ? 0 : time_key(static_cast<uint64_t>(enters), sum_at, bits);
      far[i] = leaves < 0 ? 0 : time_key(static_cast<uint64_t>(leaves), sum_at, bits);
      if (ray.still) far[i] = infinite_key(bits);
    }
  }
};

/// The test of one node; `limit` is a key.
inline BoxResult test_boxes(const BoxRay& ray, const BoxNode& node, uint32_t limit) {
  BoxResult result;
  const BoxAxis x(ray.axes[0], ray.bits, node, 0), y(ray.axes[1], ray.bits, node, 1), z(ray.axes[2], ray.bits, node, 2);
  for (int i = 0; i < kBoxes; ++i) {
    const uint32_t near = std::max({x.near[i], y.near[i], z.near[i]});
    const uint32_t far = std::min({x.far[i], y.far[i], z.far[i], limit});
    const bool missed = x.missed[i] || y.missed[i] || z.missed[i];
    result.entry[i] = near;
    result.met |= static_cast<uint32_t>(i < node.children && !missed && near <= far) << i;
  }
  return result;
}

/// The pipe: a node a cycle while it moves, which it does unless a result is there that nobody takes.
class BoxPipe {
 public:
  static constexpr int kStages = 8;

  bool valid() const { return stages_[last_].valid; }
  const BoxResult& result() const { return stages_[last_].result; }
  bool ready(bool result_ready) const { return !valid() || result_ready; }

  /// The end of a cycle. `node`: null, none is offered; `limit`: a key, of the best hit so far.
  void clock(bool result_ready, const BoxRay& ray, const BoxNode* node, uint32_t limit) {
    if (!ready(result_ready)) return;
    Stage& first = stages_[last_];
    first.valid = node != nullptr;
    if (node != nullptr) first.result = test_boxes(ray, *node, limit);
    last_ = (last_ + 1) % kStages;
  }

 private:
  struct Stage {
    bool valid = false;
    BoxResult result;
  };
  Stage stages_[kStages];
  int last_ = 0;  // whose result is there; the next node takes its place
};

}  // namespace raypool
