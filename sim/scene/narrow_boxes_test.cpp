// Boxes in integers of few bits: whatever the width, what a ray hits is what it hits with boxes in floats, and what it
// visits is a little more.
#include "scene/narrow_boxes.hpp"

#include <gtest/gtest.h>

#include "scene/test_traversal.hpp"

namespace raypool {
namespace {

using test::kInfinity;

/// The scene's tree, or a bad one, with boxes of so many bits.
Traversal narrow(const Traversal& tree, uint32_t bits) {
  Traversal result = tree;
  result.compress_nodes(bits);
  return result;
}

struct Outcome {
  uint64_t rays = 0, hits = 0, different = 0;
  TraversalCounts narrow, floats;
};

/// Both questions, of each ray; and again with a limit at the hit, and just behind it.
void compare(const Traversal& floats, const Traversal& narrow, const RayQuery& ray, Outcome& outcome) {
  Hit expected, found;
  const bool hits = floats.nearest(ray, expected, &outcome.floats);
  const bool same = narrow.nearest(ray, found, &outcome.narrow) == hits && (!hits || test::same(found, expected));
  TraversalCounts ignored;
  outcome.different += !same || narrow.occluded(ray, &ignored) != hits;
  outcome.hits += hits;
  ++outcome.rays;
  if (!hits || !std::isfinite(expected.t)) return;
  RayQuery nearer = ray;
  for (const float limit : {expected.t, std::nextafter(expected.t, kInfinity)}) {
    nearer.limit = std::min(limit, ray.limit);
    Hit a, b;
    const bool there = floats.nearest(nearer, a);
    outcome.different += narrow.nearest(nearer, b, &ignored) != there || (there && !test::same(a, b));
    outcome.different += narrow.occluded(nearer, &ignored) != there;
  }
}

/// Hard rays (test_traversal.hpp), and what becomes of them when directions are very long or short, nearly or wholly
/// parallel to an axis, subnormal, and origins move by some units in the last place.
std::vector<RayQuery> harder_rays(const Scene& scene, int count, uint32_t seed) {
  std::vector<RayQuery> rays = hard_rays(scene, count, seed);
  std::mt19937 random(seed);
  const auto roll = [&](uint32_t below) { return static_cast<uint32_t>(random() % below); };
  for (RayQuery& ray : rays) {
    if (roll(3) == 0) continue;
    const int scale = roll(2) == 0 ? static_cast<int>(roll(250)) - 130 : 0;
    for (int axis = 0; axis < 3; ++axis) {
      ray.direction[axis] = static_cast<float>(std::ldexp(static_cast<double>(ray.direction[axis]), scale));
      if (!std::isfinite(ray.direction[axis])) ray.direction[axis] = 0x1p127f;
      const float tiny = as_float(1 + roll(0x7fffff));  // subnormal
      if (roll(12) == 0) ray.direction[axis] = roll(2) == 0 ? tiny : -tiny;
      if (roll(12) == 0) ray.direction[axis] = roll(2) == 0 ? 0.0f : -0.0f;
      if (roll(6) == 0) ray.origin[axis] = as_float(as_bits(ray.origin[axis]) + roll(5) - 2);
      if (roll(12) == 0) ray.origin[axis] = scene.corner(roll(size32(scene.triangles)), 0)[axis];
    }
    if (ray.limit != kInfinity) ray.limit = static_cast<float>(std::ldexp(static_cast<double>(ray.limit), -scale));
  }
  return rays;
}

class NarrowHits : public testing::TestWithParam<uint32_t> {
 protected:
  void expect_the_same(const Scene& scene, int rays, uint64_t least_hits, bool bad_tree = false) const {
    const uint32_t bits = GetParam();
    Traversal floats(scene);
    if (bad_tree) floats.set_bvh(test::random_tree(floats.bvh(), bits));
    const Traversal narrow = raypool::narrow(floats, bits);
    Outcome outcome;
    for (const RayQuery& ray : harder_rays(scene, rays, bits)) compare(floats, narrow, ray, outcome);
    EXPECT_EQ(outcome.different, 0u) << "of " << outcome.rays;
    EXPECT_GT(outcome.hits, least_hits);
    EXPECT_GT(outcome.narrow.nodes, outcome.floats.nodes / 2);
  }
};

TEST_P(NarrowHits, InScenes) {
  expect_the_same(make_cornell(0.3), 3000, 800);
  expect_the_same(make_room(0.05), 3000, 800);
  expect_the_same(test::ball({1000, -2000, 500}, 24), 3000, 500);
  expect_the_same(test::ball({300, 20, 7}, 16), 1500, 200, true);
}

TEST_P(NarrowHits, InSoupsOfAnySizeAndPlace) {
  int number = 0;
  for (const int scale : {-140, -126, -100, -40, 0, 1, 30, 58}) {
    for (const float away : {0.0f, 1.0f, 3000.0f, 1e7f}) {
      const float size = std::ldexp(1.0f, scale);
      const float at = std::min(away * size, 1e25f);
      const Scene scene = soup(static_cast<uint32_t>(++number), 60, size, {at, -at, at / 3});
      SCOPED_TRACE(testing::Message() << "scale 2^" << scale << ", " << away << " away");
      expect_the_same(scene, 600, 0, number % 2 == 0);
    }
  }
}

// A triangle's plane that holds the ray but for rounding: its t is noise, held within its padded box.
TEST_P(NarrowHits, OfNeedlesSeenEdgeOn) {
  std::mt19937 random(GetParam());
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  for (const float away : {0.0f, 10.0f, 1000.0f}) {
    const auto any = [&] { return Vec3{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; };
    const Vec3 centre{away, away / 3, -away}, direction = any(), side = any();
    std::vector<std::array<Vec3, 3>> needles;
    for (int i = 0; i < 600; ++i) {
      const auto in_plane = [&] { return centre + direction * uniform(0, 4) + side * uniform(-1, 1); };
      needles.push_back({in_plane(), in_plane(), in_plane()});
    }
    const Traversal floats(scene_of(needles)), narrow = raypool::narrow(floats, GetParam());
    Outcome outcome;
    for (int i = 0; i < 1500; ++i)
      compare(floats, narrow, {centre + side * uniform(-1, 1), direction, kInfinity}, outcome);
    EXPECT_EQ(outcome.different, 0u) << away;
    EXPECT_GT(outcome.hits, 500u) << away;
  }
}

// Triangles in the planes of an axis, one behind the other, and rays along it: planes of boxes are planes of triangles,
// and all hits are ties with the boxes' faces.
TEST_P(NarrowHits, InFacesOfBoxes) {
  Outcome outcome;
  for (const float step : {1.0f, 0.1f, 0x1p-120f, 1e15f}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<std::array<Vec3, 3>> triangles;
      const auto point = [&](float along, float a, float b) {
        Vec3 result;
        result[axis] = along * step, result[(axis + 1) % 3] = a * step, result[(axis + 2) % 3] = b * step;
        return result;
      };
      for (int i = 0; i < 40; ++i) {
        const auto along = static_cast<float>(i / 2);
        triangles.push_back({point(along, 0, 0), point(along, 3, 0), point(along, 0, 3)});
        triangles.push_back({point(along, 3, 0), point(along, 3, 3), point(along, 0, 3)});
      }
      const Traversal floats(scene_of(triangles)), narrow = raypool::narrow(floats, GetParam());
      for (const float from : {-1.0f, 0.0f, 7.0f, 7.5f, 19.0f, 22.0f}) {
        for (const float a : {0.0f, 1.0f, 1.5f, 3.0f}) {
          for (const float b : {0.0f, 0.5f, 1.5f, 3.0f}) {
            for (const float towards : {1.0f, -1.0f, 0x1p-140f}) {
              RayQuery ray{point(from, a, b), {}, kInfinity};
              ray.direction[axis] = towards;
              compare(floats, narrow, ray, outcome);
              ray.direction[(axis + 1) % 3] = 0x1p-149f;
              compare(floats, narrow, ray, outcome);
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(outcome.different, 0u) << "of " << outcome.rays;
  EXPECT_GT(outcome.hits, outcome.rays / 4);
}

INSTANTIATE_TEST_SUITE_P(Bits, NarrowHits, testing::Range<uint32_t>(kLeastBoxBits, kMostBoxBits + 1));

TEST(NarrowBoxes, FewerBitsVisitMore) {
  const Scene scene = make_room(0.05);
  const Traversal floats(scene);
  std::vector<RayQuery> rays = hard_rays(scene, 3000, 11);
  const auto visits = [&](uint32_t bits) {
    Traversal traversal = floats;
    traversal.compress_nodes(bits);
    TraversalCounts counts;
    Hit hit;
    for (const RayQuery& ray : rays) traversal.nearest(ray, hit, &counts);
    return static_cast<double>(counts.nodes + counts.triangles);
  };
  const double in_floats = visits(0);
  EXPECT_LT(visits(16), 1.05 * in_floats);
  EXPECT_GT(visits(8), 1.01 * visits(16));
  EXPECT_GT(visits(6), 1.05 * visits(8));
}

// What the comparisons above would detect: boxes that miss by one unit of a plane's number.
TEST(NarrowBoxes, ABoxThatIsAUnitTooSmallIsDetected) {
  const Scene scene = make_cornell(0.3);
  const Traversal floats(scene);
  for (const int side : {0, 1}) {
    for (int axis = 0; axis < 3; ++axis) {
      Traversal broken = narrow(floats, 16);
      std::vector<CompressedNode> nodes = broken.compressed_nodes();
      for (CompressedNode& node : nodes) {
        for (int child = 0; child < node.children; ++child) {
          uint8_t &lower = node.planes[0][axis][child], &upper = node.planes[1][axis][child];
          if (lower < upper) side == 0 ? ++lower : --upper;
        }
      }
      broken.set_compressed_nodes(nodes);
      Outcome outcome;
      for (const RayQuery& ray : harder_rays(scene, 3000, 5)) compare(floats, broken, ray, outcome);
      EXPECT_GT(outcome.different, 0u) << side << ' ' << axis;
    }
  }
}

TEST(NarrowBoxes, OnlyTheirTreeCanBeReplaced) {
  Traversal traversal(make_cornell(0.1));
  EXPECT_TRUE(traversal.compressed_nodes().empty());
  traversal.compress_nodes(8);
  EXPECT_EQ(traversal.compressed_nodes().size(), traversal.bvh().nodes.size());
  EXPECT_THROW(traversal.set_compressed_nodes({}), std::logic_error);
  traversal.compress_nodes();
  EXPECT_TRUE(traversal.compressed_nodes().empty());
}

}  // namespace
}  // namespace raypool
