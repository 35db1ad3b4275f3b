// The corpus: reproducible, of the hardware's domain, and as hard as its kinds promise.
#include "referee/corpus.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "bits.hpp"
#include "referee/certificate.hpp"
#include "referee/draw.hpp"

namespace raypool::referee {
namespace {

using Place = std::array<float, 3>;

/// Each edge of each triangle is one of another in the other direction.
bool is_closed(const std::vector<Corners>& triangles) {
  std::map<std::pair<Place, Place>, int> edges;
  const auto place = [](const Vec3& v) { return Place{v.x + 0.0f, v.y + 0.0f, v.z + 0.0f}; };
  for (const auto& corners : triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const Place a = place(corners[k]), b = place(corners[(k + 1) % 3]);
      if (a < b) ++edges[{a, b}];
      if (b < a) --edges[{b, a}];
    }
  }
  bool closed = !triangles.empty();
  for (const auto& [edge, count] : edges) closed &= count == 0;
  return closed;
}

bool same_bits(float a, float b) { return as_bits(a) == as_bits(b); }

TEST(HardCases, AreThoseOfSeedAndNumberAlone) {
  for (const uint64_t number : {0u, 1u, 17u, 3000u}) {
    const HitCase one = hard_case(7, number), again = hard_case(7, number), other = hard_case(8, number);
    ASSERT_EQ(one.triangles.size(), again.triangles.size());
    for (size_t i = 0; i < one.triangles.size(); ++i) {
      for (size_t k = 0; k < 3; ++k) ASSERT_TRUE(one.triangles[i][k] == again.triangles[i][k]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_TRUE(same_bits(one.ray.origin[axis], again.ray.origin[axis]));
      ASSERT_TRUE(same_bits(one.ray.direction[axis], again.ray.direction[axis]));
    }
    ASSERT_FALSE(one.ray.origin == other.ray.origin && one.ray.direction == other.ray.direction);
  }
}

TEST(HardCases, LieWithinReachOfTheHardware) {
  for (uint64_t i = 0; i < 36'000; ++i) {
    const HitCase hit_case = hard_case(1, i);
    ASSERT_FALSE(hit_case.triangles.empty()) << i;
    ASSERT_LE(hit_case.triangles.size(), 16u) << i << ": " << hit_case.kind;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LT(std::fabs(hit_case.ray.origin[axis]), 0x1p59f) << i << ": " << hit_case.kind;
      for (const auto& corners : hit_case.triangles) {
        for (const Vec3& corner : corners) ASSERT_LT(std::fabs(corner[axis]), 0x1p57f) << i << ": " << hit_case.kind;
      }
    }
  }
}

/// What the certificates of a kind have, in so many cases.
struct Seen {
  int cases = 0, hits = 0, misses = 0, edges = 0, corners = 0, ties = 0, rims = 0, limits = 0, surfaces = 0,
      strange = 0;
  int subnormal = 0, huge = 0, closed = 0;

  void add(const HitCase& hit_case) {
    const Certificate certificate = certify(hit_case);
    ++cases;
    hits += !certificate.miss;
    misses += certificate.allowed.empty();
    rims += certificate.miss && !certificate.allowed.empty();
    ties += certificate.allowed.size() > 1;
    bool edge = false, corner = false;
    for (const Meeting& meeting : certificate.meetings) {
      edge |= meeting.passing == Passing::Edge;
      corner |= meeting.passing == Passing::Corner;
    }
    edges += edge, corners += corner;
    closed += is_closed(hit_case.triangles);
    HitCase open = hit_case;
    open.ray.limit = INFINITY;
    const Certificate unlimited = certify(open);
    limits += unlimited.meetings.size() != certificate.meetings.size();
    // Moved back by its direction, the ray begins before what it began on.
    open.ray.origin = open.ray.origin - open.ray.direction;
    for (const Meeting& meeting : certify(open).meetings) surfaces += meeting.t == Exact(1);
    const Vec3& d = hit_case.ray.direction;
    strange += !std::isfinite(d.x + d.y + d.z) || d.x == 0 || d.y == 0 || d.z == 0;
    float largest = 0;
    for (const auto& corners_of : hit_case.triangles) {
      for (const Vec3& v : corners_of) {
        largest = std::max({largest, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
      }
    }
    subnormal += largest < 0x1p-116f;
    huge += largest > 0x1p20f;
  }
};

TEST(HardCases, AreWhatTheirKindsSay) {
  std::map<std::string, Seen> seen;
  for (uint64_t i = 0; i < 200 * kinds().size(); ++i) {
    const HitCase hit_case = hard_case(2, i);
    seen[hit_case.kind].add(hit_case);
  }
  for (const std::string& kind : kinds()) {
    EXPECT_EQ(seen[kind].cases, 200) << kind;
    EXPECT_GT(seen[kind].hits, 10) << kind;
  }
  EXPECT_GT(seen["through a corner of a closed mesh"].corners, 150);
  EXPECT_EQ(seen["through a corner of a closed mesh"].closed, 200);
  EXPECT_GT(seen["through an edge of a closed mesh"].edges, 120);
  EXPECT_EQ(seen["through an edge of a closed mesh"].closed, 200);
  EXPECT_EQ(seen["next to an edge of a closed mesh"].closed, 200);
  EXPECT_GT(seen["fan around a corner"].corners, 50);
  EXPECT_GT(seen["fan around a corner"].rims, 5);
  EXPECT_GT(seen["coincident triangles"].ties, 50);
  EXPECT_GT(seen["coplanar triangles"].ties, 25);
  EXPECT_GT(seen["triangles that cross"].ties, 20);
  EXPECT_GT(seen["grazing"].misses, 50);
  EXPECT_GT(seen["huge coordinates"].huge, 190);
  EXPECT_GT(seen["subnormal coordinates"].subnormal, 190);
  EXPECT_GT(seen["a limit at the hit"].limits, 40);
  EXPECT_GT(seen["from the surface"].surfaces, 60);
  EXPECT_GT(seen["strange direction"].strange, 90);
}

}  // namespace
}  // namespace raypool::referee
