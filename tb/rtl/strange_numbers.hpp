// For tests: frames whose rays, triangles and boxes have numbers that are hard to compute with.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "machine/box_pipe.hpp"
#include "machine/memory.hpp"
#include "machine/ray_setup.hpp"
#include "machine/tree_setup.hpp"
#include "random.hpp"
#include "scene/scene.hpp"
#include "scene/tree_file.hpp"

namespace raypool::test {

/// Puts numbers in the place of some of a frame's: zeros of both signs, powers of two, neighbours, and the same number
/// again; in half of the frames also subnormal numbers, the largest ones, infinities, NaNs and any bits. The tree stays
/// a tree.
class StrangeNumbers {
 public:
  explicit StrangeNumbers(uint32_t seed) : random_(seed), wild_(random_() % 2 == 0), one_in_(2 + random_() % 20) {}

  /// What eye rays are made from, and the light. In one frame of three all eye rays have the same direction, of hard
  /// components; in one of three they begin at a corner, or at coordinates of several.
  void put(std::array<uint32_t, kArguments>& arguments, const Memory& tree, const TreeSetup& setup) {
    for (int a = argument::kEye; a < argument::kLightColor; ++a) perhaps(arguments[a]);
    perhaps(arguments[argument::kOffset]);
    if (random_() % 3 == 0) {
      for (int a = argument::kCorner; a < argument::kLight; ++a) arguments[a] = zero();
      const uint32_t long_axis = random_() % 4;  // 3: none
      const bool nowhere = random_() % 8 == 0;
      for (uint32_t axis = 0; axis < 3 && !nowhere; ++axis)
        arguments[argument::kCorner + axis] = axis == long_axis ? power_of_two() : component();
    }
    const uint32_t triangles = count_of_triangles(setup);
    if (random_() % 3 != 0 || triangles == 0) return;
    uint32_t corner = corner_of(random_() % triangles, random_() % 3);
    const bool one = random_() % 2 == 0;
    for (int axis = 0; axis < 3; ++axis) {
      arguments[argument::kEye + axis] = tree.load(setup.triangles_line * kLineBytes + corner + axis * 4);
      if (!one) corner = corner_of(random_() % triangles, random_() % 3);
    }
  }

  /// Within what coordinates may be: corners of triangles, boxes of children that a node has not, in wild frames
  /// origins of boxes, and the box of all.
  void put(Memory& tree, TreeSetup& setup) {
    const uint32_t first = setup.triangles_line * kLineBytes;
    for (uint32_t node = 0; node < first; node += sizeof(TreeNode)) fill_unused(tree, node);
    if (random_() % 4 == 0) return;
    const auto change = [&](uint32_t address) {
      uint32_t word = tree.load(address);
      perhaps(word);
      if (std::fabs(as_float(word)) <= kLargestCoordinate) tree.store(address, word);
    };
    for (uint32_t t = 0; t < count_of_triangles(setup); ++t)
      for (uint32_t word = 0; word < 9; ++word) change(first + t * sizeof(TreeTriangle) + word * 4);
    if (!wild_) return;
    for (uint32_t node = 0; node < first && random_() % 2 == 0; node += sizeof(TreeNode))
      for (uint32_t word = 0; word < 3; ++word) change(node + word * 4);
    for (float* const bound : {setup.bounds.lower, setup.bounds.upper}) {
      for (int axis = 0; axis < 3; ++axis) {
        uint32_t word = as_bits(bound[axis]);
        perhaps(word);
        bound[axis] = as_float(word);
      }
    }
    if (random_() % 8 == 0) setup.bounds.upper[random_() % 3] = kLargestDistance;
  }

 private:
  static constexpr uint32_t kLineBytes = 64;

  static uint32_t corner_of(uint32_t triangle, uint32_t corner) {
    return triangle * sizeof(TreeTriangle) + corner * 3 * sizeof(float);
  }
  static uint32_t count_of_triangles(const TreeSetup& setup) {
    return setup.triangle_lines * kLineBytes / sizeof(TreeTriangle);
  }
  /// A child that a node has not is everywhere in its grid.
  static void fill_unused(Memory& tree, uint32_t node) {
    const uint32_t children = tree.load(node + 12) >> 24,
                   used = children < kBoxes ? (1u << 8 * children) - 1 : UINT32_MAX;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const uint32_t lower = node + 16 + 4 * axis, upper = lower + 12;
      tree.store(lower, tree.load(lower) & used);
      tree.store(upper, tree.load(upper) | ~used);
    }
  }
  /// Of a direction.
  uint32_t component() {
    switch (random_() % 4) {
      case 0:
        return zero();
      case 1:
        return power_of_two();
      case 2:
        return extreme();
      default:
        return random_();
    }
  }
  uint32_t sign() { return random_() % 2 << 31; }
  uint32_t zero() { return sign(); }
  uint32_t power_of_two() { return sign() | (127 - 4 + random_() % 9) << 23; }
  uint32_t extreme() {
    constexpr std::array<uint32_t, 10> kExtremes = {0x00000001, 0x007fffff, 0x00800000, 0x7f7fffff, 0x7f800000,
                                                    0x7fc00001, 0x7f000000, 0x1f800000, 0x5f800000, 0x7e800000};
    return sign() | kExtremes[random_() % kExtremes.size()];
  }
  uint32_t other(uint32_t word) {
    switch (random_() % (wild_ ? 8 : 4)) {
      case 0:
        return zero();
      case 1:
        return power_of_two();
      case 2:
        return word + (random_() % 2 == 0 ? 1 : UINT32_MAX);
      case 3:
        return last_;
      case 4:
        return sign() | (random_() & 0x7fffff) >> random_() % 23;
      case 5:
        return extreme();
      case 6:  // another exponent
        return word ^ random_() % 256 << 23;
      default:
        return random_();
    }
  }
  void perhaps(uint32_t& word) {
    if (random_() % one_in_ == 0) word = other(word);
    last_ = word;
  }

  Random random_;
  bool wild_;
  uint32_t one_in_;
  uint32_t last_ = 0;
};

}  // namespace raypool::test
