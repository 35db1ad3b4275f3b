// The traverser in Verilog against its class, all outputs in every cycle, over trees and rays that are hard, between
// pools and a memory that stall; and both against a walk of each tree: what becomes of every ray.
#include <gtest/gtest.h>

#include "Vtraverser_1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0.h"
#include "Vtraverser_3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1.h"
#include "Vtraverser_5_24_16_12_2_64_4_16_8_32_2_5_1_160_20_0_1.h"
#include "unit/traverser_bench.hpp"

namespace raypool::bench {
namespace {

/// The scene, its tree or a bad one, and what its rays must become.
template <typename P>
class Case {
 public:
  LaneTree tree;
  std::vector<typename TraverserBench<P>::Asked> rays;

  Case(const Scene& scene, int count, uint32_t seed) {
    const Traversal engine(scene);
    const Bvh& bvh = engine.bvh();
    tree = LaneTree(scene, seed % 2 == 0 && !bvh.nodes.empty() ? test::random_tree(bvh, seed) : bvh);
    const NarrowFloat narrow(TriangleGroup::kBits);
    std::mt19937 random(seed);
    const Scene aims = scene.triangles.empty() ? test::ball({0, 0, 0}, 4) : scene;
    for (RayQuery query : hard_rays(aims, count, seed)) {
      if (random() % 24 == 0) query.limit = random() % 2 == 0 ? 0 : NAN;
      const bool shadow = random() % 3 == 0;
      const LaneRay ray = lane_ray(query, tree.bounds, P::kBits, shadow);
      rays.push_back({words(query, shadow, random), Walk(tree, ray, narrow), ray.limit.scale, ray.triangle});
    }
  }

 private:
  // The first colour is the ray's number.
  Ray words(const RayQuery& query, bool shadow, std::mt19937& random) const {
    Ray ray{};
    for (int axis = 0; axis < 3; ++axis) {
      ray[word::kOrigin + axis] = as_bits(query.origin[axis]);
      ray[word::kDirection + axis] = as_bits(query.direction[axis]);
    }
    ray[word::kLimit] = as_bits(query.limit);
    ray[word::kPixel] = random();
    ray[word::kColor] = static_cast<uint32_t>(rays.size());
    ray[word::kColor + 1] = random();
    ray[word::kColor + 2] = random();
    ray[word::kFlags] = (shadow ? kShadowFlag : 0) | (random() & 0x7fffff00) | random() % 8;
    return ray;
  }
};

template <typename P>
class TraverserTest : public testing::Test {};
using All = testing::Types<TraverserParameters<Vtraverser_1_1_8_6_1_4_2_1_1_4_2_1_1_1_21_0_0, 1, 1, 8, 6, 1,
                                               Cache<4, 2, 1, 1>, Cache<4, 2, 1, 1>, 1, 21, false, false>,
                           TraverserParameters<Vtraverser_3_4_9_10_2_16_2_4_2_32_4_6_2_9_16_1_1, 3, 4, 9, 10, 2,
                                               Cache<16, 2, 4, 2>, Cache<32, 4, 6, 2>, 9, 16, true, true>,
                           TraverserParameters<Vtraverser_5_24_16_12_2_64_4_16_8_32_2_5_1_160_20_0_1, 5, 24, 16, 12, 2,
                                               Cache<64, 4, 16, 8>, Cache<32, 2, 5, 1>, 160, 20, false, true>>;
TYPED_TEST_SUITE(TraverserTest, All);

TYPED_TEST(TraverserTest, AgreesWithItsClassInEveryCycleAndEveryRayBecomesWhatItMust) {
  TraverserBench<TypeParam> bench(1);
  std::mt19937 random(7);
  const TraverserTraffic traffics[] = {
      {}, {0, 2, 1, 0, 0, 0}, {3, 0, 9, 4, 3, 3}, {0, 3, 40, 0, 2, 9}, {40, 0, 1, 2, 0, 0}, {0, 0, 12, 0, 40, 2}};
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case<TypeParam> test(any_scene(random), 120, seed);
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.tree, test.rays, traffics[random() % std::size(traffics)]));
  }
  const TraverserSeen& seen = bench.seen;
  const Traverser::Sizes sizes = TypeParam::sizes();
  EXPECT_EQ(seen.rays, 20u * 120);
  EXPECT_GT(seen.normal + seen.direct, 250u);
  if (sizes.culling) EXPECT_GT(seen.direct, 100u);
  EXPECT_EQ(seen.shadow == 0, sizes.contributes);
  EXPECT_GT(seen.shadow + seen.contributions, 50u);
  EXPECT_GT(seen.dropped, 300u);
  EXPECT_GT(seen.reads, 1000u);
  if (sizes.stack_entries < 16) EXPECT_GT(seen.spills, 20u);
  EXPECT_EQ(seen.spills == 0, seen.stack_reads == 0);
}

TYPED_TEST(TraverserTest, RaysThatWaitForRoomHoldUpNoOthers) {
  TraverserBench<TypeParam> bench(2);
  std::mt19937 random(9);
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case<TypeParam> test(any_scene(random), 300, 2 * seed);
    ASSERT_NO_FATAL_FAILURE(bench.trace_without_room(test.tree, test.rays));
  }
  EXPECT_GT(bench.seen.full, 0u);
}

}  // namespace
}  // namespace raypool::bench
