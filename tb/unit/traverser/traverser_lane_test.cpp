// A lane of the traverser with a triangle pipe, in Verilog against the classes, all outputs in every cycle, over trees
// and rays that are hard; and both against a walk of the tree, and against the engine: what every ray visits and hits.
#include <gtest/gtest.h>

#ifdef RAYPOOL_LARGE
#include "Vlane_units_1_8_6_26.h"
#include "Vlane_units_3_9_10_30.h"
#include "Vlane_units_6_8_16_28.h"
#else
#include "Vlane_units_24_16_12_32.h"
#endif
#include "scene/narrow_triangles.hpp"
#include "unit/traverser/lane_bench.hpp"

namespace raypool::bench {
namespace {

/// The scene, its tree or a bad one, and what its rays must hit: by a walk of that tree, and by the engine.
template <typename P>
class Case {
 public:
  LaneTree tree;
  std::vector<typename LaneBench<P>::Asked> rays;

  Case(const Scene& scene, int count, uint32_t seed) {
    Traversal engine(scene);
    engine.set_triangle_test(TriangleTest(TriangleTime::Plane, P::kTriangleBits));
    const Bvh& bvh = engine.bvh();
    tree = LaneTree(scene, seed % 2 == 0 && !bvh.nodes.empty() ? test::random_tree(bvh, seed) : bvh);
    const NarrowFloat narrow(P::kTriangleBits);
    std::mt19937 random(seed);
    const Scene aims = scene.triangles.empty() ? test::ball({0, 0, 0}, 4) : scene;
    for (RayQuery query : hard_rays(aims, count, seed)) {
      if (random() % 24 == 0) query.limit = random() % 2 == 0 ? 0 : NAN;
      const bool shadow = random() % 4 == 0;
      const LaneRay ray = lane_ray(query, tree.bounds, P::kBits, shadow);
      rays.push_back({ray, Walk(tree, ray, narrow)});
      const LaneHits::Hit& hit = rays.back().walk.hit;
      Hit expected;
      const bool hits = engine.nearest(query, expected);
      EXPECT_EQ(hit.hit, hits);
      if (!hits || !hit.hit || shadow) continue;
      EXPECT_EQ(hit.number, expected.triangle);
      EXPECT_EQ(as_bits(std::ldexp(hit.t, ray.limit.scale)), as_bits(expected.t));
    }
  }
};

template <typename P>
class TraverserLaneTest : public testing::Test {};
#ifdef RAYPOOL_LARGE  // traverser_lane_large_test, of make test-long
using All = testing::Types<LaneParameters<Vlane_units_1_8_6_26, 1, 8, 6, 26>,
                           LaneParameters<Vlane_units_3_9_10_30, 3, 9, 10, 30>,
                           LaneParameters<Vlane_units_6_8_16_28, 6, 8, 16, 28>>;
#else
using All = testing::Types<LaneParameters<Vlane_units_24_16_12_32, 24, 16, 12, 32>>;
#endif
TYPED_TEST_SUITE(TraverserLaneTest, All);

TYPED_TEST(TraverserLaneTest, AgreesWithItsClassInEveryCycleAndEveryRayHitsWhatItMust) {
  LaneBench<TypeParam> bench(1);
  std::mt19937 random(7);
  const LaneTraffic traffics[] = {{},
                                  {1, 0, 0, 1, 0, 0, 0, 0, 1, 1},
                                  {1, 2, 9, 30, 0, 0, 8, 2, 30, 1},
                                  {1, 9, 2, 5, 2, 2, 2, 9, 4, 3},
                                  {1, 0, 0, 1, 2, 0, 0, 0, 1, 1},
                                  {20, 3, 3, 9, 5, 9, 3, 1, 20, 9},
                                  {1, 0, 2, 9, 0, 0, 4, 1, 6, 1}};
  for (uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case<TypeParam> test(any_scene(random), 60, seed);
    ASSERT_NO_FATAL_FAILURE(bench.trace(test.tree, test.rays, traffics[random() % std::size(traffics)]));
  }
  const LaneSeen& seen = bench.seen;
  EXPECT_EQ(seen.rays, 60u * 60);
  EXPECT_GT(seen.hits, 800u);
  EXPECT_LT(seen.hits, seen.rays);
  EXPECT_GT(seen.blocked, 150u);
  EXPECT_GT(seen.shadows, seen.blocked);
  EXPECT_GT(seen.misses, 1000u);
  EXPECT_EQ(seen.offers, seen.misses);
  EXPECT_GT(seen.ahead, 200u);
  EXPECT_GT(seen.spilled, TypeParam::kEntries < 16 ? 50u : 0u);
  EXPECT_GT(seen.fetched, TypeParam::kEntries < 16 ? 50u : 0u);
  EXPECT_GT(seen.dropped, 500u);
  EXPECT_GT(seen.told_now, 15u);
  EXPECT_GT(seen.told_before, 15u);
  EXPECT_EQ(seen.most_rays, TypeParam::kSlots);
  if (TypeParam::kSlots > 1) {
    EXPECT_GT(seen.kept, 0u) << "a line comes before the one before it has left";
  }
}

// Times below 2^-125, with the float's least exponent and subnormal ones: a small soup, and triangles in boxes with
// planes right through it, as no step of a grid is below 2^-128.
TYPED_TEST(TraverserLaneTest, AgreesWhereHitsAreAtTheLeastTimes) {
  LaneBench<TypeParam> bench(9);
  std::mt19937 random(9);
  const auto place = [&] { return std::ldexp(static_cast<float>(random() % 9) - 4, -127); };
  const auto corner = [&] { return Vec3{place(), place(), place()}; };
  uint32_t seed = 0, least = 0, subnormal = 0;
  for (const float scale : {0x1p-142f, 0x1p-134f, 0x1p-126f}) {
    for (int run = 0; run < 6; ++run) {
      SCOPED_TRACE(testing::Message() << "seed " << ++seed << ", scale " << scale);
      const Scene small = soup(seed, 30, scale, {0, 0, 0});
      std::vector<std::array<Vec3, 3>> triangles;
      for (size_t i = 0; i < small.triangles.size(); ++i)
        triangles.push_back({small.corner(i, 0), small.corner(i, 1), small.corner(i, 2)});
      for (int i = 0; i < 30; ++i) triangles.push_back({corner(), corner(), corner()});
      const Case<TypeParam> test(scene_of(triangles), 100, seed);
      for (const auto& ray : test.rays) {
        const LaneHits::Hit& hit = ray.walk.hit;
        subnormal += hit.hit && hit.t < 0x1p-126f;
        least += hit.hit && hit.t >= 0x1p-126f && hit.t < 0x1p-125f;
      }
      ASSERT_NO_FATAL_FAILURE(bench.trace(test.tree, test.rays, {}));
    }
  }
  EXPECT_GT(subnormal, 100u);
  EXPECT_GT(least, 20u);
  EXPECT_GT(bench.seen.dropped, 40u);
}

TYPED_TEST(TraverserLaneTest, ThatIsStoppedComesToRest) {
  std::mt19937 random(8);
  const Case<TypeParam> test(soup(3, 400, 1, {0, 0, 0}), 400, 3);
  for (uint32_t run = 0; run < 20; ++run) {
    SCOPED_TRACE(testing::Message() << "run " << run);
    LaneBench<TypeParam> bench(run);
    const auto cycles = static_cast<uint32_t>(200 + random() % 800);
    ASSERT_NO_FATAL_FAILURE(bench.trace_and_stop(test.tree, test.rays, {}, cycles));
  }
}

}  // namespace
}  // namespace raypool::bench
