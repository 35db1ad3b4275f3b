// For tests: frames in which rays, triangles and boxes have numbers that are hard to compute with.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "machine/common/memory.hpp"
#include "machine/traverser/box_pipe.hpp"
#include "machine/traverser/ray_setup.hpp"
#include "machine/traverser/tree_setup.hpp"
#include "random.hpp"
#include "scene/scene.hpp"
#include "scene/tree_file.hpp"
#include "scene/vec.hpp"

namespace raypool::test {

/// Puts numbers in the place of some of a frame's: zeros of both signs, powers of two, neighbours, and the same number
/// again; in half of the frames also subnormal numbers, the largest ones, infinities, NaNs and any bits. The tree stays
/// a tree.
class StrangeNumbers {
 public:
  explicit StrangeNumbers(uint32_t seed)
      : random_(seed), wild_(random_() % 2 == 0), aimed_(random_() % 2 == 0), one_in_(2 + random_() % 20) {}

  /// What eye rays are made from, and the light. In half of the frames they are aimed at a triangle; of half of the
  /// others all have the same direction, of hard components, and in two of three of them they begin at a corner, or at
  /// coordinates of several, or beside those.
  void put(std::array<uint32_t, kArguments>& arguments, const Memory& tree, const TreeSetup& setup) {
    const uint32_t triangles = count_of_triangles(setup);
    if (triangles == 0) aimed_ = false;
    if (aimed_) {
      aim(arguments, tree, setup);
      return;
    }
    for (int a = argument::kEye; a < argument::kLightColor; ++a) perhaps(arguments[a]);
    perhaps(arguments[argument::kOffset]);
    if (random_() % 2 == 0) one_direction(arguments);
    if (random_() % 3 == 0 || triangles == 0) return;
    const bool one = random_() % 2 == 0, beside = random_() % 3 != 0;
    Vec3 corner = any_corner(tree, setup);
    for (int axis = 0; axis < 3; ++axis) {
      arguments[argument::kEye + axis] = as_bits(corner[axis]);
      if (beside) arguments[argument::kEye + axis] += (random_() % 33 - 16) << random_() % 18;
      if (!one) corner = any_corner(tree, setup);
    }
  }

  /// Within what coordinates may be: corners of triangles, boxes of children that a node has not, in wild frames
  /// origins of boxes, and the box of all.
  void put(Memory& tree, TreeSetup& setup) {
    const uint32_t first = setup.triangles_line * kLineBytes;
    for (uint32_t node = 0; node < first; node += sizeof(TreeNode)) fill_unused(tree, node);
    if (random_() % 4 == 0 || aimed_) return;
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

  static Vec3 corner_of(const Memory& tree, const TreeSetup& setup, uint32_t triangle, uint32_t corner) {
    const uint32_t at = static_cast<uint32_t>(setup.triangles_line * kLineBytes + triangle * sizeof(TreeTriangle) +
                                              corner * 3 * sizeof(float));
    return {as_float(tree.load(at)), as_float(tree.load(at + 4)), as_float(tree.load(at + 8))};
  }
  Vec3 any_corner(const Memory& tree, const TreeSetup& setup) {
    const uint32_t triangle = random_() % count_of_triangles(setup);
    return corner_of(tree, setup, triangle, random_() % 3);
  }
  // Eye rays go exactly through corners and edges of a triangle, or as nearly as floats can be; from a corner of
  // another one, or nearly in its plane. The light is such a point, too, so that shadow rays end on a triangle.
  void aim(std::array<uint32_t, kArguments>& arguments, const Memory& tree, const TreeSetup& setup) {
    const auto put = [&](int argument, const Vec3& value) {
      for (int axis = 0; axis < 3; ++axis) arguments[argument + axis] = as_bits(value[axis]);
    };
    const auto share = [&] { return static_cast<float>(random_() % 9) / 4 - 1; };
    const auto triangle = [&] {
      const uint32_t number = random_() % count_of_triangles(setup);
      const Vec3 first = corner_of(tree, setup, number, 0);
      return std::array<Vec3, 3>{first, corner_of(tree, setup, number, 1) - first,
                                 corner_of(tree, setup, number, 2) - first};
    };
    const auto [target, along, aside] = triangle();
    Vec3 eye{as_float(arguments[0]), as_float(arguments[1]), as_float(arguments[2])};
    switch (random_() % 5) {
      case 0:
        eye = any_corner(tree, setup);
        break;
      case 1:  // in its plane
        eye = target - along * (4 * share()) - aside * (4 * share());
        break;
      case 2:  // along an axis
        eye = target;
        eye[static_cast<int>(random_() % 3)] += along.x + along.y + along.z + aside.x;
        break;
      default:
        break;
    }
    if (random_() % 2 == 0) {
      float& moved = eye[static_cast<int>(random_() % 3)];
      const bool zero = as_bits(moved) << 1 == 0;
      moved = as_float(as_bits(moved) + (zero || random_() % 2 == 0 ? 1 : UINT32_MAX));
    }
    put(argument::kEye, eye);
    put(argument::kCorner, target - eye);
    put(argument::kStepX, along * std::ldexp(1.0f, -static_cast<int>(random_() % 4)));
    put(argument::kStepY, aside * std::ldexp(1.0f, -static_cast<int>(random_() % 4)));
    if (random_() % 4 == 0) perhaps(arguments[argument::kCorner + random_() % 9]);
    // A component stays -0 only if what is added to it is, too.
    for (int a = argument::kCorner; a < argument::kLight && random_() % 8 != 0; ++a)
      if (arguments[a] << 1 == 0) arguments[a] = 1u << 31;
    const auto [lit, lit_along, lit_aside] = triangle();
    if (random_() % 4 != 0) put(argument::kLight, lit + lit_along * share() + lit_aside * share());
    if (random_() % 2 == 0) arguments[argument::kOffset] = random_() % 4 == 0 ? power_of_two() : 0;
  }
  // A component is one of the others again in some, which decides the main axis.
  void one_direction(std::array<uint32_t, kArguments>& arguments) {
    const uint32_t long_axis = random_() % 4;  // 3: none
    const bool nowhere = random_() % 8 == 0;
    uint32_t before = power_of_two();
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const uint32_t none = zero();
      uint32_t& corner = arguments[argument::kCorner + axis];
      corner = arguments[argument::kStepX + axis] = arguments[argument::kStepY + axis] = none;
      if (nowhere) continue;
      corner = axis == long_axis ? power_of_two() : random_() % 3 == 0 ? sign() | before << 1 >> 1 : component();
      if (corner << 1 == 0) corner = none;
      before = corner;
    }
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
  bool wild_, aimed_;
  uint32_t one_in_;
  uint32_t last_ = 0;
};

}  // namespace raypool::test
