// The fast tree holds what the chip's holds, and every set of instructions finds the same. That this is also what the
// chip's walk finds, whatever the tree, is asked of every ray in traversal_test.cpp.
#include "scene/wide_bvh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <utility>

#include "bits.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

/// Triangles of every size from `smallest` to some hundred times that, among them copies of others, in both windings,
/// some that share an edge or have none of their own, and some without area.
Scene triangle_soup(uint32_t seed, float smallest, int count) {
  std::mt19937 random(seed);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  const auto point = [&](float size) { return Vec3{uniform(-size, size), uniform(-size, size), uniform(-size, size)}; };
  Scene scene;
  scene.materials.resize(1);
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    scene.triangles.push_back({a, b, c});
    scene.triangle_materials.push_back(0);
  };
  for (int i = 0; i < count; ++i) {
    const auto first = size32(scene.vertices);
    const float size = smallest * std::exp2(uniform(0, 8));
    const Vec3 middle = point(100 * smallest);
    for (int corner = 0; corner < 4; ++corner) scene.vertices.push_back(middle + point(size));
    add(first, first + 1, first + 2);
    if (i % 2 == 0) add(first + 2, first + 1, first + 3);
    if (i % 5 == 0) add(first, first + 1, first + 2);
    if (i % 7 == 0) add(first + 2, first + 1, first);
    if (i % 11 == 0) add(first, first, first + 1);
  }
  return scene;
}

/// At corners, at middles of edges, and anywhere; from far away, from between, from corners.
std::vector<RayQuery> rays_at(const Scene& scene, uint32_t seed, int count) {
  std::mt19937 random(seed);
  const Bounds bounds = scene.bounds();
  const auto corner = [&] { return scene.corner(random() % scene.triangles.size(), static_cast<int>(random() % 3)); };
  const auto anywhere = [&] {
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis)
      point[axis] = std::uniform_real_distribution<float>(bounds.lower[axis], bounds.upper[axis])(random);
    return point;
  };
  std::vector<RayQuery> rays;
  for (int i = 0; i < count; ++i) {
    const size_t triangle = random() % scene.triangles.size();
    const Vec3 edge = (scene.corner(triangle, 0) + scene.corner(triangle, 1)) * 0.5f;
    const Vec3 target = i % 3 == 0 ? corner() : i % 3 == 1 ? edge : anywhere();
    const Vec3 origin = i % 5 == 0 ? corner() : i % 5 == 1 ? anywhere() * 30.0f : anywhere();
    rays.push_back({origin, target - origin, i % 4 == 0 ? 1.0f : INFINITY});
    if (i % 13 == 0) rays.back().direction[i % 3] = 0;
  }
  return rays;
}

TEST(WideBvh, HoldsEveryTriangleOnceInBoxesOfItsOwn) {
  for (const Scene& scene : {make_room(0.05), triangle_soup(1, 1, 2000), triangle_soup(2, 1, 2), Scene{}}) {
    const Bvh bvh = build_bvh(scene);
    const WideBvh wide = widen(bvh);
    ASSERT_EQ(wide.nodes.empty(), bvh.nodes.empty());
    std::vector<int> seen(scene.triangles.size());
    size_t children = 0;
    for (const WideBvhNode& node : wide.nodes) {
      bool empty = false;
      for (int i = 0; i < kWideBvhWidth; ++i) {
        ASSERT_FALSE(empty && node.children[i] != kNoChild) << "unused children come last";
        empty = node.children[i] == kNoChild;
        ASSERT_EQ(empty, node.bounds[0][0][i] > node.bounds[1][0][i]);
        if (empty) continue;
        ++children;
        if ((node.children[i] & kLeafBit) == 0) {
          ASSERT_GT(node.children[i], static_cast<size_t>(&node - wide.nodes.data())) << "children come later";
          continue;
        }
        const TriangleBlock& block = wide.blocks.at(node.children[i] & ~kLeafBit);
        ASSERT_GE(block.count, 1u);
        for (uint32_t lane = 0; lane < block.count; ++lane) {
          ++seen.at(block.triangles[lane]);
          for (int corner = 0; corner < 3; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
              ASSERT_EQ(block.vertices[corner][axis][lane], scene.corner(block.triangles[lane], corner)[axis]);
              ASSERT_LE(node.bounds[0][axis][i], block.vertices[corner][axis][lane]);
              ASSERT_GE(node.bounds[1][axis][i], block.vertices[corner][axis][lane]);
            }
          }
        }
      }
    }
    for (size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], is_degenerate(scene, i) ? 0 : 1) << i;
    EXPECT_EQ(children + (wide.nodes.empty() ? 0 : 1), wide.nodes.size() + wide.blocks.size()) << "each has one parent";
    if (scene.triangles.size() > 1000) {
      EXPECT_LT(wide.nodes.size(), bvh.nodes.size() * 2 / 3);
      EXPECT_LT(wide.blocks.size(), bvh.blocks.size());
    }
  }
}

TEST(WideBvh, EveryWalkFindsWhatEveryTriangleInTurnFinds) {
  int hits = 0;
  for (const float smallest : {1.0f, 1e-19f, 1e15f}) {
    for (const int count : {1, 3, 40, 600}) {
      const Scene scene = triangle_soup(static_cast<uint32_t>(count), smallest, count);
      const Traversal traversal(scene);
      for (const RayQuery& query : rays_at(scene, 7, 1500)) {
        const PreparedRay ray = prepare(query, traversal.bvh().bounds);
        Hit expected;
        TraversalCounts counts;
        const bool found = traversal.nearest_of_all(query, expected);
        Hit chips;
        ASSERT_EQ(found, traversal.nearest(query, chips, &counts));
        if (!ray.valid) {
          ASSERT_FALSE(found);
          continue;
        }
        hits += found;
        for (const Walk& walk : walks()) {
          SCOPED_TRACE(walk.instructions);
          Candidate best, any;
          ASSERT_EQ(found, walk.nearest(traversal.wide_bvh(), ray, best, nullptr));
          ASSERT_EQ(found, walk.any(traversal.wide_bvh(), ray, any, nullptr));
          if (!found) continue;
          ASSERT_EQ(best.triangle, expected.triangle);
          ASSERT_EQ(best.triangle, chips.triangle);
          ASSERT_EQ(as_bits(static_cast<float>(static_cast<double>(best.t) * ray.t_scale)), as_bits(expected.t));
          ASSERT_EQ(as_bits(static_cast<float>(best.u)), as_bits(expected.u));
          ASSERT_EQ(as_bits(static_cast<float>(best.v)), as_bits(expected.v));
        }
      }
    }
  }
  EXPECT_GT(hits, 6000);
}

TEST(WideBvh, ReportsWhatRaysVisit) {
  const Scene scene = make_cornell();
  const Traversal traversal(scene);
  TreeVisits visits = traversal.visits();
  std::mt19937 random(3);
  const Vec3 eye = scene.camera.eye;
  for (const Walk& walk : walks()) {
    SCOPED_TRACE(walk.instructions);
    for (int i = 0; i < 200; ++i) {
      const auto number = [&] { return static_cast<float>(random() % 2000) / 1000 - 1; };
      const Vec3 d = scene.camera.direction;
      const RayQuery query{eye, {d.x + number(), d.y + number(), d.z + number()}, INFINITY};
      const PreparedRay ray = prepare(query, traversal.bvh().bounds);
      ASSERT_TRUE(ray.valid);
      Candidate silent, told;
      const bool found = walk.nearest(traversal.wide_bvh(), ray, silent, nullptr);
      visits.begin();
      EXPECT_EQ(visits.nodes + visits.triangles + visits.places.size(), 0u);
      ASSERT_EQ(walk.nearest(traversal.wide_bvh(), ray, told, &visits), found);
      ASSERT_EQ(told.triangle, silent.triangle);
      ASSERT_GE(visits.nodes, 1u);
      ASSERT_GE(visits.triangles, found ? 1u : 0u);
      ASSERT_GE(visits.places.size(), visits.nodes) << "a ray comes to no node twice";
      ASSERT_LE(visits.places.size(), visits.nodes + visits.triangles);
      const uint64_t nodes = visits.nodes, triangles = visits.triangles, places = visits.places.size();
      Candidate any;
      ASSERT_EQ(walk.any(traversal.wide_bvh(), ray, any, &visits), found);
      ASSERT_GT(visits.nodes, nodes);
      // Once more: as many visits, of no new place.
      const uint64_t both = visits.places.size(), nodes_of_both = visits.nodes, triangles_of_both = visits.triangles;
      ASSERT_EQ(walk.nearest(traversal.wide_bvh(), ray, told, &visits), found);
      ASSERT_EQ(visits.nodes, nodes_of_both + nodes);
      ASSERT_EQ(visits.triangles, triangles_of_both + triangles);
      ASSERT_EQ(visits.places.size(), both);
      ASSERT_GE(both, places);
    }
  }
}

// The wide tree has other hits than the hardware; so what is visited is of the chip's.
TEST(TreeVisits, OfTheHardwaresHitsArePlacesInTheChipsTree) {
  const Scene scene = make_room(0.05);
  Traversal traversal(scene);
  ChipConfiguration chip;
  chip.traverser = TraverserName::Hardware;
  traversal.take_hits_of(chip);
  TreeVisits recorded = traversal.visits();
  recorded.begin();
  VisitList visits, places;
  for (const RayQuery& ray : rays_at(scene, 11, 300)) {
    Hit expected, hit;
    const bool found = traversal.nearest(ray, expected, nullptr, &visits);
    ASSERT_EQ(traversal.nearest(ray, hit, recorded), found);
    EXPECT_EQ(traversal.occluded(ray, recorded), traversal.occluded(ray, nullptr, &visits));
    if (!found) continue;
    EXPECT_EQ(hit.triangle, expected.triangle);
    EXPECT_EQ(as_bits(hit.t), as_bits(expected.t));
    EXPECT_EQ(as_bits(hit.u), as_bits(expected.u));
  }
  traversal.places_of(recorded, 0, places);
  const auto key = [](const Visit& visit) { return std::pair(visit.place, visit.triangles); };
  std::set<std::pair<uint32_t, uint8_t>> visited, said;
  uint64_t nodes = 0, triangles = 0;
  for (const Visit& visit : visits) {
    visited.insert(key(visit));
    nodes += visit.triangles == 0 ? 1 : 0;
    triangles += visit.triangles;
  }
  for (const Visit& place : places) EXPECT_TRUE(said.insert(key(place)).second) << "a place twice";
  EXPECT_GT(visited.size(), 2000u);
  EXPECT_TRUE(said == visited);
  EXPECT_EQ(recorded.nodes, nodes);
  EXPECT_EQ(recorded.triangles, triangles);
}

TEST(WideBvh, WalksAreThoseOfTheProcessor) {
  ASSERT_FALSE(walks().empty());
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  EXPECT_EQ(walks().size(), __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi2") != 0 ? 2u : 1u);
#endif
}

// What a ray begins with once came from std::frexp, std::ldexp and std::nextafter.
TEST(PreparedRay, IsScaledAndPaddedAsTheLibrarysFunctionsSay) {
  std::mt19937 random(5);
  const auto any_float = [&](int low, int high) {
    const auto exponent = static_cast<uint32_t>(std::uniform_int_distribution<int>(low, high)(random) + 127);
    return as_float((random() & 0x807fffffu) | exponent << 23);
  };
  for (int i = 0; i < 100000; ++i) {
    Bounds bounds{{-1, -2, -3}, {1, 2, 3}};
    RayQuery query{{any_float(-126, 40), any_float(-126, 40), i % 9 == 0 ? 0 : any_float(-20, 20)},
                   {any_float(-127, 127), any_float(-127, 127), i % 7 == 0 ? 0 : any_float(-127, 127)},
                   std::fabs(any_float(-127, 127))};
    if (i % 11 == 0) query.direction = {as_float(random() & 0x800000ff), as_float(random() & 0xff), as_float(1)};
    const PreparedRay ray = prepare(query, bounds);
    ASSERT_TRUE(ray.valid);
    float largest = 0, distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
      largest = std::max(largest, std::fabs(query.direction[axis]));
      for (const float bound : {bounds.lower[axis], bounds.upper[axis]})
        distance = std::max(distance, std::fabs(bound - query.origin[axis]));
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    ASSERT_EQ(ray.t_scale, std::ldexp(1.0, 1 - exponent));
    const double padding = static_cast<double>(8 * kUlp) * distance;
    for (int axis = 0; axis < 3; ++axis) {
      const double o = query.origin[axis];
      ASSERT_EQ(ray.padded[0][axis], std::nextafter(static_cast<float>(o + padding), INFINITY));
      ASSERT_EQ(ray.padded[1][axis], std::nextafter(static_cast<float>(o - padding), -INFINITY));
      const double direction = static_cast<double>(query.direction[axis]) * ray.t_scale;
      const double d = std::fabs(direction) < 0x1p-100 ? std::copysign(0x1p-100, direction) : direction;
      ASSERT_EQ(ray.origin[axis], query.origin[axis]);
      ASSERT_EQ(ray.direction[axis], direction);
      ASSERT_EQ(ray.inverse[axis], static_cast<float>(1.0 / d));
      ASSERT_EQ(ray.near_side[axis], std::signbit(query.direction[axis]) ? 1 : 0);
    }
    const int kz = ray.kz;
    ASSERT_EQ(std::fabs(query.direction[kz]), largest);
    ASSERT_EQ(ray.kx, (kz + 1) % 3);
    ASSERT_EQ(ray.ky, (kz + 2) % 3);
    ASSERT_EQ(ray.inverse_z, 1.0 / ray.direction[kz]);
    ASSERT_EQ(ray.shear_x, static_cast<float>(ray.direction[ray.kx] / ray.direction[kz]));
    ASSERT_EQ(ray.shear_y, static_cast<float>(ray.direction[ray.ky] / ray.direction[kz]));
    const double limit = static_cast<double>(query.limit) / ray.t_scale;
    ASSERT_GE(static_cast<double>(ray.internal_limit), limit);
    ASSERT_TRUE(ray.internal_limit == 0 || static_cast<double>(std::nextafter(ray.internal_limit, 0.0f)) < limit);
  }
}

}  // namespace
}  // namespace raypool
