#include "scene/traversal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "bits.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/test_traversal.hpp"

namespace raypool {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Both ways, the fast one and the chip's, must agree.
bool nearest(const Traversal& traversal, const RayQuery& ray, Hit& hit) {
  Hit counted;
  TraversalCounts counts;
  const bool found = traversal.nearest(ray, hit);
  EXPECT_EQ(found, traversal.nearest(ray, counted, &counts));
  EXPECT_TRUE(!found || same(hit, counted))
      << hit.triangle << " at " << hit.t << ", " << counted.triangle << " at " << counted.t;
  return found;
}
bool occluded(const Traversal& traversal, const RayQuery& ray) {
  TraversalCounts counts;
  const bool found = traversal.occluded(ray);
  EXPECT_EQ(found, traversal.occluded(ray, &counts));
  return found;
}

TEST(Watertight, NoRayLeavesAClosedMesh) {
  int leaks = 0, rays = 0;
  for (const Vec3d& centre : {Vec3d{0, 0, 0}, Vec3d{1000, -2000, 500}}) {
    const Scene scene = ball(centre, 48);
    const Traversal traversal(scene);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> offset(-0.5, 0.5);
    for (int round = 0; round < 12; ++round) {
      const Vec3 origin = round == 0 ? centre.as<float>()
                                     : (centre + Vec3d{offset(random), offset(random), offset(random)}).as<float>();
      auto shoot = [&](const Vec3& target) {
        Hit hit;
        ++rays;
        leaks += !nearest(traversal, {origin, target - origin, kInfinity}, hit);
        leaks += !occluded(traversal, {origin, target - origin, 3});
      };
      for (size_t i = 0; i < scene.triangles.size(); ++i) {
        const Vec3 a = scene.corner(i, 0), b = scene.corner(i, 1), c = scene.corner(i, 2);
        shoot(a);
        shoot((a + b) * 0.5f);
        shoot((b + c) * 0.5f);
        shoot(a * 0.9f + c * 0.1f);
        shoot(((a + b) * 0.5f + c) * 0.5f);
      }
    }
  }
  EXPECT_EQ(leaks, 0) << "of " << rays << " rays";
  EXPECT_GT(rays, 200000);
}

TEST(Watertight, AxisParallelRaysThroughAGridOfSharedEdgesHit) {
  // Every ray meets an edge or a vertex exactly: all edge functions that matter are zero.
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.surface(16, 16, false, false, [](double s, double t) { return Vec3d{16 * s, 16 * t, 2}; });
  const Traversal traversal(scene);
  for (int x = 0; x <= 32; ++x) {
    for (int y = 0; y <= 32; ++y) {
      Hit hit;
      const Vec3 origin{x * 0.5f, y * 0.5f, 0};
      ASSERT_TRUE(nearest(traversal, {origin, {0, 0, 1}, kInfinity}, hit)) << x << " " << y;
      EXPECT_EQ(hit.t, 2);
      EXPECT_TRUE(nearest(traversal, {origin, {-0.0f, 0.0f, 0.25f}, kInfinity}, hit));
      EXPECT_EQ(hit.t, 8);
    }
  }
}

TEST(Ties, TheLowestIndexWins) {
  // The same square again and again, between other things, in two windings.
  const Vec3 a{-1, -1, 5}, b{1, -1, 5}, c{1, 1, 5}, d{-1, 1, 5};
  std::vector<std::array<Vec3, 3>> triangles;
  for (int i = 0; i < 40; ++i) {
    const float z = 6.0f + static_cast<float>(i);
    triangles.push_back({Vec3{-1, -1, z}, Vec3{1, -1, z}, Vec3{1, 1, z}});
  }
  for (int i = 0; i < 30; ++i) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  Scene scene = scene_of(triangles);
  const Traversal traversal(scene);
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const float x = std::uniform_real_distribution<float>(-0.9f, 0.9f)(random),
                y = std::uniform_real_distribution<float>(-0.9f, 0.9f)(random);
    Hit hit;
    ASSERT_TRUE(nearest(traversal, {{x, y, 0}, {0, 0, 1}, kInfinity}, hit));
    EXPECT_EQ(hit.t, 5);
    EXPECT_EQ(hit.triangle, y <= x ? 40u : 41u);
  }
  // On the diagonal both are hit.
  Hit hit;
  ASSERT_TRUE(nearest(traversal, {{0.5f, 0.5f, 0}, {0, 0, 1}, kInfinity}, hit));
  EXPECT_EQ(hit.triangle, 40u);
}

TEST(Traversal, FindsWhatTestingEveryTriangleFinds) {
  for (const Scene& scene : {make_cornell(0.3), make_room(0.02), ball({0, 0, 0}, 24)}) {
    const Traversal traversal(scene);
    int hits = 0;
    for (const RayQuery& ray : hard_rays(scene, 1500, 17)) {
      Hit hit, reference;
      const bool found = nearest(traversal, ray, hit);
      ASSERT_EQ(found, traversal.nearest_of_all(ray, reference));
      ASSERT_TRUE(!found || same(hit, reference))
          << hit.triangle << " at " << hit.t << ", " << reference.triangle << " at " << reference.t;
      ASSERT_EQ(found, occluded(traversal, ray));
      hits += found;
    }
    EXPECT_GT(hits, 700);
  }
}

TEST(Traversal, AnswerDoesNotDependOnTheTree) {
  for (const Scene& scene : {make_cornell(0.3), ball({300, 20, 7}, 24)}) {
    const Traversal good(scene);
    for (uint32_t seed : {1u, 2u, 3u}) {
      Traversal bad(scene);
      bad.set_bvh(random_tree(good.bvh(), seed));
      if (seed == 2) bad.compress_nodes();
      for (const RayQuery& ray : hard_rays(scene, 6000, seed)) {
        Hit a, b;
        const bool found = nearest(good, ray, a);
        ASSERT_EQ(found, nearest(bad, ray, b)) << "seed " << seed;
        ASSERT_TRUE(!found || same(a, b)) << "seed " << seed;
        ASSERT_EQ(occluded(good, ray), found);
        ASSERT_EQ(occluded(bad, ray), found);
      }
    }
  }
}

TEST(Traversal, AnswerIsTheSameWithCompressedNodes) {
  const Scene scene = make_room(0.05);
  const Traversal exact(scene);
  Traversal compressed(scene);
  compressed.compress_nodes();
  TraversalCounts exact_counts, compressed_counts;
  for (const RayQuery& ray : hard_rays(scene, 20000, 11)) {
    Hit a, b;
    const bool found = exact.nearest(ray, a, &exact_counts);
    ASSERT_EQ(found, compressed.nearest(ray, b, &compressed_counts));
    ASSERT_TRUE(!found || same(a, b));
    ASSERT_EQ(occluded(compressed, ray), found);
  }
  EXPECT_GT(compressed_counts.nodes, exact_counts.nodes);
  EXPECT_LT(compressed_counts.nodes, exact_counts.nodes * 11 / 10);
}

TEST(Traversal, VisitsSayWhatTheStackDoes) {
  const Scene scene = make_room(0.05);
  const Traversal traversal(scene);
  for (const RayQuery& ray : hard_rays(scene, 3000, 12)) {
    for (const bool any : {false, true}) {
      Hit hit;
      TraversalCounts counts;
      VisitList visits;
      const bool found =
          any ? traversal.occluded(ray, &counts, &visits) : traversal.nearest(ray, hit, &counts, &visits);
      uint64_t nodes = 0, leaves = 0, triangles = 0;
      int64_t stack = 1;  // the root
      for (const Visit& visit : visits) {
        --stack;  // it has been taken
        ASSERT_GE(stack, 0);
        nodes += visit.triangles == 0;
        leaves += visit.triangles > 0;
        triangles += visit.triangles;
        ASSERT_TRUE(visit.children == 0 || visit.discarded == 0) << "the nearest child lies before the best hit";
        stack += visit.children - visit.discarded;
      }
      EXPECT_EQ(nodes, counts.nodes);
      EXPECT_EQ(leaves, counts.blocks);
      EXPECT_EQ(triangles, counts.triangles);
      if (any && found) {
        EXPECT_GT(visits.back().triangles, 0) << "it ends with the leaf of its blocker";
      } else if (!visits.empty()) {
        EXPECT_EQ(stack, 0);
      }
    }
  }
}

TEST(Traversal, AnswerDoesNotDependOnTheTreeForNeedlesSeenEdgeOn) {
  // Long, thin triangles in a plane that holds the ray but for rounding: their t is noise, and must be the same noise
  // in every tree.
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    const Vec3 direction{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)},
        side{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    std::vector<std::array<Vec3, 3>> needles;
    for (int i = 0; i < 1500; ++i) {
      auto in_plane = [&] { return direction * uniform(0, 4) + side * uniform(-1, 1); };
      needles.push_back({in_plane(), in_plane(), in_plane()});
    }
    const Scene scene = scene_of(needles);
    const Traversal good(scene);
    Traversal bad(scene);
    bad.set_bvh(random_tree(good.bvh(), seed));
    int hits = 0;
    for (int i = 0; i < 1500; ++i) {
      const RayQuery ray{side * uniform(-1, 1), direction, kInfinity};
      Hit a, b;
      const bool found = nearest(good, ray, a);
      ASSERT_EQ(found, nearest(bad, ray, b)) << "seed " << seed << " ray " << i;
      ASSERT_TRUE(!found || same(a, b)) << "seed " << seed << " ray " << i << ": " << a.triangle << " at " << a.t
                                        << ", " << b.triangle << " at " << b.t;
      ASSERT_EQ(occluded(good, ray), found);
      hits += found;
    }
    EXPECT_GT(hits, 1000);
  }
}

TEST(Traversal, EdgesAreDecidedExactly) {
  // Along z from the origin nothing is rounded before the edge functions, so that the exact answer is known.
  std::mt19937 random(4);
  auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  int zero_in_float = 0;
  for (int i = 0; i < 20000; ++i) {
    // An edge that passes the axis within rounding, and a third corner well to its left.
    const Vec3 b{uniform(0.5f, 1), uniform(0.5f, 1), 3}, c{b.x * -0.7f, b.y * -0.7f, 3}, a{-1, 2, 3};
    const double exact = static_cast<double>(b.x) * c.y - static_cast<double>(b.y) * c.x;
    const float in_float = b.x * c.y - b.y * c.x;
    zero_in_float += in_float == 0 && exact != 0;
    Hit hit;
    // Counter-clockwise a, c, b: the axis is inside when it lies to the left of c -> b, or on it.
    ASSERT_EQ(Traversal(scene_of({{a, c, b}})).nearest({{0, 0, 0}, {0, 0, 1}, kInfinity}, hit), exact <= 0) << exact;
    if (i > 600 && zero_in_float > 50) break;
  }
  EXPECT_GT(zero_in_float, 50);
}

TEST(Traversal, AnyHitVisitsLessThanNearestHit) {
  const Scene scene = make_room(0.05);
  const Traversal traversal(scene);
  TraversalCounts any, nearest;
  for (const RayQuery& ray : hard_rays(scene, 1000, 2)) {
    Hit hit;
    traversal.nearest(ray, hit, &nearest);
    traversal.occluded(ray, &any);
  }
  EXPECT_LT(any.nodes, nearest.nodes);
  EXPECT_LT(any.triangles, nearest.triangles);
}

TEST(Traversal, TheSameSceneGivesTheSameTreeAndVisits) {
  const Scene scene = make_room(0.05);
  const Traversal a(scene), b(scene);
  ASSERT_EQ(a.bvh().nodes.size(), b.bvh().nodes.size());
  EXPECT_EQ(std::memcmp(a.bvh().nodes.data(), b.bvh().nodes.data(), a.bvh().nodes.size() * sizeof(BvhNode)), 0);
  TraversalCounts ca, cb;
  VisitList va, vb;
  for (const RayQuery& ray : hard_rays(scene, 500, 5)) {
    Hit hit;
    a.nearest(ray, hit, &ca, &va);
    b.nearest(ray, hit, &cb, &vb);
  }
  EXPECT_EQ(va, vb);
  EXPECT_EQ(ca.nodes + ca.blocks, va.size());
  EXPECT_EQ(ca.triangles, cb.triangles);
  EXPECT_GT(ca.triangles, 0u);
}

TEST(Traversal, EveryTriangleWithAnAreaIsInExactlyOneLeaf) {
  Scene scene = make_room(0.05);
  scene.triangles.push_back({0, 0, 1});  // no area
  scene.triangle_materials.push_back(0);
  const Bvh bvh = build_bvh(scene);
  std::vector<int> seen(scene.triangles.size());
  for (const TriangleBlock& block : bvh.blocks) {
    EXPECT_GE(block.count, 1u);
    for (uint32_t i = 0; i < block.count; ++i) ++seen[block.triangles[i]];
  }
  for (size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], is_degenerate(scene, i) ? 0 : 1) << i;
}

TEST(Traversal, StrangeRaysHaveADefinedAnswer) {
  const Scene scene = make_cornell(0.1);
  const Traversal traversal(scene);
  const Vec3 eye = scene.camera.eye;
  Hit hit;
  auto misses = [&](const RayQuery& ray) { return !nearest(traversal, ray, hit) && !occluded(traversal, ray); };
  EXPECT_TRUE(misses({eye, {0, 0, 0}, kInfinity}));
  EXPECT_TRUE(misses({eye, {-0.0f, 0, -0.0f}, kInfinity}));
  EXPECT_TRUE(misses({eye, {kNan, 0, 1}, kInfinity}));
  EXPECT_TRUE(misses({eye, {0, kInfinity, 1}, kInfinity}));
  EXPECT_TRUE(misses({{kNan, 0, 0}, {0, 0, 1}, kInfinity}));
  EXPECT_TRUE(misses({{0, -kInfinity, 0}, {0, 0, 1}, kInfinity}));
  EXPECT_TRUE(misses({{1e30f, 0, 0}, {-1, 0, 0}, kInfinity}));
  EXPECT_TRUE(misses({eye, {0, 0, -1}, kNan}));
  EXPECT_TRUE(misses({eye, {0, 0, -1}, 0}));
  EXPECT_TRUE(misses({eye, {0, 0, -1}, -1}));
  // The length of a direction changes nothing but t, down to denormal and up to the largest
  // numbers; nor does the sign of a zero.
  ASSERT_TRUE(nearest(traversal, {eye, {0.1f, 0.2f, -1}, kInfinity}, hit));
  const Hit plain = hit;
  for (float scale : {0x1p-100f, 0x1p-20f, 0x1p60f, 0x1p126f}) {
    ASSERT_TRUE(nearest(traversal, {eye, Vec3{0.1f, 0.2f, -1} * scale, kInfinity}, hit)) << scale;
    EXPECT_EQ(hit.triangle, plain.triangle);
    EXPECT_EQ(hit.t, plain.t / scale);
  }
  EXPECT_TRUE(misses({eye, {0, 0, -1e-44f}, kInfinity})) << "t would be beyond the largest float";
  ASSERT_TRUE(nearest(traversal, {eye, {0, 0.0f, -1}, kInfinity}, hit));
  const Hit straight = hit;
  ASSERT_TRUE(nearest(traversal, {eye, {-0.0f, -0.0f, -1}, kInfinity}, hit));
  EXPECT_EQ(hit.t, straight.t);
  ASSERT_TRUE(nearest(traversal, {eye, {1e-45f, -1e-45f, -1}, kInfinity}, hit));
  EXPECT_EQ(hit.t, straight.t);
}

TEST(Traversal, LimitIsExclusiveAtBothEnds) {
  const Scene scene = scene_of({{Vec3{-1, -1, 4}, Vec3{1, -1, 4}, Vec3{0, 1, 4}}});
  const Traversal traversal(scene);
  Hit hit;
  for (float direction : {1.0f, 0.5f, 3.0f}) {
    const float t = 4 / direction;
    EXPECT_FALSE(nearest(traversal, {{0, 0, 0}, {0, 0, direction}, t}, hit));
    EXPECT_FALSE(occluded(traversal, {{0, 0, 0}, {0, 0, direction}, t}));
    EXPECT_TRUE(nearest(traversal, {{0, 0, 0}, {0, 0, direction}, std::nextafter(t, kInfinity)}, hit));
    EXPECT_TRUE(occluded(traversal, {{0, 0, 0}, {0, 0, direction}, std::nextafter(t, kInfinity)}));
  }
  EXPECT_FALSE(nearest(traversal, {{0, 0, 4}, {0, 0, 1}, kInfinity}, hit)) << "the origin lies on the triangle";
  EXPECT_FALSE(nearest(traversal, {{0, 0, 5}, {0, 0, 1}, kInfinity}, hit)) << "the triangle lies behind";
}

TEST(Traversal, HitCarriesPointBarycentricsAndNormal) {
  const Scene scene =
      scene_of({{Vec3{0, 0, 2}, Vec3{4, 0, 2}, Vec3{0, 4, 2}}, {Vec3{0, 0, 3}, Vec3{0, 4, 3}, Vec3{4, 0, 3}}});
  const Traversal traversal(scene);
  Hit hit;
  ASSERT_TRUE(nearest(traversal, {{1, 2, 0}, {0, 0, 0.5f}, kInfinity}, hit));
  EXPECT_EQ(hit.t, 4);
  EXPECT_FLOAT_EQ(hit.u, 0.25f);
  EXPECT_FLOAT_EQ(hit.v, 0.5f);
  EXPECT_EQ(hit.normal, (Vec3{0, 0, 1}));
  ASSERT_TRUE(nearest(traversal, {{1, 2, 9}, {0, 0, -1}, kInfinity}, hit));
  EXPECT_EQ(hit.triangle, 1u);
  EXPECT_EQ(hit.normal, (Vec3{0, 0, -1}));
}

TEST(Traversal, ASceneWithoutAreaIsNeverHit) {
  const Scene scene = scene_of({{Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{2, 2, 2}}});
  Hit hit;
  EXPECT_FALSE(Traversal(scene).nearest({{0, 0, -1}, {0, 0, 1}, kInfinity}, hit));
}

TEST(Tracer, FillsPackagesAsTheChipWantsThem) {
  Scene scene =
      scene_of({{Vec3{-9, -9, 2}, Vec3{9, -9, 2}, Vec3{0, 9, 2}}, {Vec3{-9, -9, 4}, Vec3{9, -9, 4}, Vec3{0, 9, 4}}});
  scene.materials.resize(8);
  scene.triangle_materials = {5, 7};
  const Tracer tracer(scene, 0x1000);
  Ray ray{};
  ray[word::kOrigin + 2] = as_bits(3);
  ray[word::kDirection + 2] = as_bits(2);
  ray[word::kLimit] = as_bits(kInfinity);
  ray[word::kPixel] = 0x00020001;
  ray[word::kColor] = as_bits(0.5f);
  ray[word::kFlags] = 3;
  Intersection hit;
  ASSERT_TRUE(tracer.trace(ray, hit));
  EXPECT_TRUE(std::equal(ray.begin(), ray.end(), hit.begin()));
  EXPECT_EQ(hit[word::kDistance], as_bits(0.5f));
  EXPECT_EQ(hit[word::kNormal + 2], as_bits(1));
  EXPECT_EQ(hit[word::kMaterial], 0x1000u + 7 * 32);
  EXPECT_EQ(hit[word::kTriangle], 1u);
  EXPECT_EQ(hit[20], 0u);

  ray[word::kFlags] |= kShadowFlag;
  ray[word::kLimit] = as_bits(1);
  EXPECT_FALSE(tracer.trace(ray, hit)) << "blocked at t = 0.5";
  ray[word::kDirection + 2] = as_bits(0.5f);  // would meet it at t = 2
  hit.fill(0xdeadbeef);
  ASSERT_TRUE(tracer.trace(ray, hit));
  EXPECT_TRUE(std::equal(ray.begin(), ray.end(), hit.begin()));
  for (size_t i = kRayWords; i < hit.size(); ++i) EXPECT_EQ(hit[i], 0u) << i;

  ray[word::kFlags] = 1;
  ray[word::kLimit] = as_bits(kInfinity);
  ray[word::kDirection] = as_bits(100);
  EXPECT_FALSE(tracer.trace(ray, hit)) << "misses";
}

}  // namespace
}  // namespace raypool
