#include "estimate/tree_reads.hpp"

#include <gtest/gtest.h>

namespace raypool::estimate {
namespace {

/// Nodes that a ray visits, by their lines.
void add_ray(RayVisits& rays, const std::vector<uint32_t>& nodes, uint32_t tile = 0) {
  for (const uint32_t node : nodes) rays.places.push_back({node, 0, 0, 0});
  rays.ends.push_back(rays.places.size());
  rays.kinds.push_back({tile, 1});
}

/// Caches of two lines, in one set.
ChipConfiguration small_caches() {
  ChipConfiguration chip;
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 128;
  chip.hardware_traverser_node_cache_ways = chip.hardware_traverser_triangle_cache_ways = 2;
  return chip;
}

TEST(TreeReads, KeepTheLinesThatWereUsedLast) {
  RayVisits rays;
  rays.counts = {true};
  add_ray(rays, {1, 2, 1, 3, 1, 2});  // 3 takes the place of 2, and 2 that of 3
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {}, 1).nodes, 4);
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {}, 1).triangles, 0);
}

TEST(TreeReads, GrowWithTheRaysInFlight) {
  RayVisits rays;
  rays.counts = {true};
  add_ray(rays, {1, 2, 1, 2});
  add_ray(rays, {3, 4, 3, 4});
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {}, 1).nodes, 2);  // a ray
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {}, 2).nodes, 4);
}

TEST(TreeReads, FollowTheOrderOfTheRays) {
  RayVisits rays;
  rays.counts = {true, true};
  for (const uint32_t tile : {0u, 1u, 0u, 1u})
    add_ray(rays, tile == 0 ? std::vector{1u, 2u} : std::vector{3u, 4u}, tile);
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {{0, 1}, {0, 1}, {1, 1}, {1, 1}}, 1).nodes, 1);
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {{0, 1}, {1, 1}, {0, 1}, {1, 1}}, 1).nodes, 2);
}

TEST(TreeReads, DoNotCountRaysThatFillTheCaches) {
  RayVisits rays;
  rays.counts = {false, true};
  add_ray(rays, {1, 2}, 0);
  add_ray(rays, {1, 2}, 1);
  EXPECT_EQ(reads_a_ray(small_caches(), rays, {}, 1).nodes, 0);
}

}  // namespace
}  // namespace raypool::estimate
