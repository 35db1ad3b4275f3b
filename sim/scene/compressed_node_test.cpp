#include "scene/compressed_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scene/traversal.hpp"

namespace raypool {
namespace {

void expect_around(const BvhNode& outer, const BvhNode& inner) {
  for (int i = 0; i < kBvhWidth; ++i) {
    EXPECT_EQ(outer.children[i], inner.children[i]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(outer.bounds[0][axis][i], inner.bounds[0][axis][i]);
      EXPECT_GE(outer.bounds[1][axis][i], inner.bounds[1][axis][i]);
    }
  }
}

TEST(CompressedNode, BoxesLieAroundThoseOfTheNode) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(0, 1);
  for (int i = 0; i < 20000; ++i) {
    BvhNode node{};
    const float where = std::ldexp(share(random) - 0.5f, static_cast<int>(random() % 60) - 30);
    const float size = std::ldexp(share(random), static_cast<int>(random() % 60) - 30);
    const int children = 1 + static_cast<int>(random() % 4);
    for (int child = 0; child < kBvhWidth; ++child) {
      node.children[child] = child < children ? static_cast<uint32_t>(random()) >> 1 : kNoChild;
      for (int axis = 0; axis < 3; ++axis) {
        const float a = where + size * share(random);
        const float b = random() % 8 == 0 ? a : where + size * share(random);
        node.bounds[0][axis][child] = child < children ? std::min(a, b) : INFINITY;
        node.bounds[1][axis][child] = child < children ? std::max(a, b) : -INFINITY;
      }
    }
    expect_around(decompress(compress(node)), node);
  }
}

TEST(CompressedNode, BoxesAreWiderByNoMoreThanTwoStepsOfTheGrid) {
  const Traversal exact(make_room(0.05));
  for (const BvhNode& node : exact.bvh().nodes) {
    const CompressedNode packed = compress(node);
    const BvhNode unpacked = decompress(packed);
    expect_around(unpacked, node);
    for (int axis = 0; axis < 3; ++axis) {
      const float step = std::ldexp(1.0f, packed.exponent[axis]);
      for (int i = 0; i < packed.children; ++i) {
        EXPECT_LE(node.bounds[0][axis][i] - unpacked.bounds[0][axis][i], 2 * step);
        EXPECT_LE(unpacked.bounds[1][axis][i] - node.bounds[1][axis][i], 2 * step);
      }
    }
  }
}

}  // namespace
}  // namespace raypool
