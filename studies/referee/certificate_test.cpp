// The certificate: what is right of cases with a plain answer, and what its numbers promise.
#include "referee/certificate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bits.hpp"
#include "referee/corpus.hpp"

namespace raypool::referee {
namespace {

using Triangles = std::vector<std::array<Vec3, 3>>;

/// A square in the plane z = 0 from -2 to 2, of four triangles around its middle.
Triangles square(float z = 0) {
  const Vec3 corners[] = {{-2, -2, z}, {2, -2, z}, {2, 2, z}, {-2, 2, z}};
  Triangles triangles;
  for (int i = 0; i < 4; ++i) triangles.push_back({Vec3{0, 0, z}, corners[i], corners[(i + 1) % 4]});
  return triangles;
}
RayQuery down(float x, float y) { return {{x, y, 8}, {0, 0, -1}, INFINITY}; }
Certificate of(const RayQuery& ray, const Triangles& triangles) { return certify({0, "", ray, triangles}); }

using Allowed = std::vector<uint32_t>;

TEST(Certificate, ARayInsideATriangleHitsItAndNoOther) {
  const Certificate certificate = of(down(1, 0.5f), square());
  EXPECT_EQ(certificate.allowed, Allowed{1});
  EXPECT_FALSE(certificate.miss);
  EXPECT_EQ(certificate.meetings.front().t.text(), "8");
  EXPECT_TRUE(of(down(3, 0), square()).miss);
}

TEST(Certificate, ASharedEdgeIsPartOfEitherTriangleButNotOfNone) {
  const Certificate certificate = of(down(1, 1), square());
  EXPECT_EQ(certificate.allowed, (Allowed{1, 2}));
  EXPECT_FALSE(certificate.miss);
}

TEST(Certificate, ACornerIsPartOfAnyTriangleOfAClosedFan) {
  EXPECT_EQ(of(down(0, 0), square()).allowed, (Allowed{0, 1, 2, 3}));
  EXPECT_FALSE(of(down(0, 0), square()).miss);
  Triangles open = square();
  open.pop_back();
  EXPECT_EQ(of(down(0, 0), open).allowed, (Allowed{0, 1, 2}));
  EXPECT_TRUE(of(down(0, 0), open).miss) << "a ray next to it passes where the blade is missing";
}

TEST(Certificate, AnEdgeThatIsNotSharedIsHitOrNot) {
  Triangles triangles = {square()[0]};
  EXPECT_TRUE(of(down(0, -2), triangles).miss);
  EXPECT_EQ(of(down(0, -2), triangles).allowed, Allowed{0});
  for (const auto& corners : square(-4)) triangles.push_back(corners);
  const Certificate certificate = of(down(0.5f, -2), {triangles[0], {{{-9, -9, -4}, {9, -9, -4}, {0, 9, -4}}}});
  EXPECT_EQ(certificate.allowed, (Allowed{0, 1}));
  EXPECT_FALSE(certificate.miss) << "of what lies behind the ray passes the inside";
}

TEST(Certificate, SurfacesThatEndOnEitherSideOfTheRayHideTheRestTogether) {
  // A step: near on one side of x = 0, far on the other; the ray runs along the face between them.
  const Triangles step = {{{{0, -1, 2}, {1, 0, 2}, {0, 1, 2}}}, {{{0, -1, 0}, {0, 1, 0}, {-1, 0, 0}}}};
  const Certificate certificate = of(down(0, 0), step);
  EXPECT_EQ(certificate.allowed, (Allowed{0, 1}));
  EXPECT_FALSE(certificate.miss);
  EXPECT_EQ(certificate.hidden_from.text(), "8");
}

TEST(Certificate, EdgeOnAndWithoutAreaNothingIsHit) {
  EXPECT_TRUE(of({{-8, 0, 0}, {1, 0, 0}, INFINITY}, square()).allowed.empty());
  EXPECT_TRUE(of(down(0, 0), {{{{0, 0, 0}, {1, 1, 0}, {-1, -1, 0}}}}).allowed.empty());
}

TEST(Certificate, OfTwoAtTheSameTimeBothAreRightAndOfOneBehindNot) {
  Triangles triangles = square();
  for (const auto& corners : square()) triangles.push_back(corners);
  for (const auto& corners : square(-1)) triangles.push_back(corners);
  EXPECT_EQ(of(down(1, 0.5f), triangles).allowed, (Allowed{1, 5}));
  EXPECT_EQ(of(down(1, 0.5f), triangles).meetings.size(), 3u);
  // As floats 8 and 8 + 2^-21 are the same.
  triangles.clear();
  triangles.push_back(square()[1]);
  triangles.push_back(square(-0x1p-30f)[1]);
  EXPECT_EQ(of(down(1, 0.5f), triangles).allowed, (Allowed{0, 1}));
}

TEST(Certificate, LimitsAreOpenAndWhatRoundsOntoThemIsEither) {
  RayQuery ray = down(1, 0.5f);
  ray.limit = 8;
  EXPECT_TRUE(of(ray, square()).allowed.empty());
  ray.limit = std::nextafter(8.0f, 9.0f);
  EXPECT_FALSE(of(ray, square()).miss);
  ray.limit = 8;
  const Certificate certificate = of(ray, square(0x1p-30f));
  EXPECT_TRUE(certificate.miss) << "its t is below 8, but as a float it is 8";
  EXPECT_EQ(certificate.allowed, Allowed{1});
  ray.limit = INFINITY;
  ray.origin.z = 0;
  EXPECT_TRUE(of(ray, square()).allowed.empty()) << "t is 0";
  ray.origin.z = -1;
  EXPECT_TRUE(of(ray, square()).allowed.empty()) << "behind";
}

TEST(Certificate, MalformedRaysHitNothing) {
  for (const float strange : {INFINITY, -INFINITY, std::nanf("")}) {
    RayQuery ray = down(1, 0.5f);
    ray.direction.x = strange;
    EXPECT_TRUE(of(ray, square()).allowed.empty());
    ray = down(1, 0.5f);
    ray.origin.y = strange;
    EXPECT_TRUE(of(ray, square()).allowed.empty());
  }
  RayQuery ray = down(1, 0.5f);
  ray.direction = {0, -0.0f, 0};
  EXPECT_TRUE(of(ray, square()).allowed.empty());
  for (const float limit : {0.0f, -1.0f, std::nanf("")}) {
    ray = down(1, 0.5f);
    ray.limit = limit;
    EXPECT_TRUE(of(ray, square()).allowed.empty());
  }
}

/// Moved by a power of two, or with its corners in another order, a case has the same answers.
TEST(Certificate, IsThatOfTheSameCaseInAnotherForm) {
  for (uint64_t i = 0; i < 3600; ++i) {
    const HitCase original = hard_case(3, i);
    const Certificate expected = certify(original);
    HitCase other = original;
    for (auto& corners : other.triangles) corners = {corners[2], corners[1], corners[0]};
    std::swap(other.ray.direction.x, other.ray.direction.z);
    std::swap(other.ray.origin.x, other.ray.origin.z);
    for (auto& corners : other.triangles) {
      for (Vec3& corner : corners) std::swap(corner.x, corner.z);
    }
    const Certificate found = certify(other);
    ASSERT_EQ(found.allowed, expected.allowed) << i;
    ASSERT_EQ(found.miss, expected.miss) << i;
    ASSERT_EQ(found.meetings.size(), expected.meetings.size());
    for (size_t k = 0; k < found.meetings.size(); ++k) ASSERT_TRUE(found.meetings[k].t == expected.meetings[k].t);
  }
}

/// So that the ray begins at the origin; false where floats do not resolve it, or a number is so small that others
/// beside it would not be near.
bool moves_to_origin(HitCase& hit_case) {
  bool exact = true;
  const auto check = [&](float x) { exact &= x == 0 || (std::fabs(x) > 0x1p-40f && std::fabs(x) < 0x1p40f); };
  for (int axis = 0; axis < 3; ++axis) {
    float& origin = hit_case.ray.origin[axis];
    for (auto& corners : hit_case.triangles) {
      for (Vec3& corner : corners) {
        const double moved = static_cast<double>(corner[axis]) - static_cast<double>(origin);
        corner[axis] -= origin;
        exact &= static_cast<double>(corner[axis]) == moved;
        check(corner[axis]);
      }
    }
    origin = 0;
    check(hit_case.ray.direction[axis]);
  }
  return exact;
}

/// A ray beside this one, too near to change any number of the case, that passes through no edge, hits one of those
/// allowed, or misses if a miss is allowed.
TEST(Certificate, AllowsWhatRaysBesideItHit) {
  std::mt19937 random(4);
  uint64_t seams = 0, rims = 0;
  for (uint64_t i = 0; i < 9'000; ++i) {
    HitCase hit_case = hard_case(5, i);
    if (!std::isinf(hit_case.ray.limit) || !moves_to_origin(hit_case)) continue;
    const Certificate certificate = certify(hit_case);
    for (int beside = 0; beside < 4; ++beside) {
      for (int axis = 0; axis < 3; ++axis) {
        hit_case.ray.origin[axis] = std::ldexp(static_cast<float>(random() % 2001) - 1000, -140);
      }
      const Certificate moved = certify(hit_case);
      bool through_edge = false;
      for (const Meeting& meeting : moved.meetings) through_edge |= meeting.passing != Passing::Inside;
      // Of those that begin on a surface t is zero, or nearly.
      if (through_edge || (!moved.meetings.empty() && moved.meetings.front().nearest < 0x1p-100f)) continue;
      seams += !certificate.miss && certificate.allowed.size() > 1;
      rims += certificate.miss && !certificate.allowed.empty();
      if (moved.allowed.empty()) {
        ASSERT_TRUE(certificate.miss) << i;
      } else {
        ASSERT_TRUE(certificate.allows(moved.allowed.front())) << i;
      }
    }
  }
  EXPECT_GT(seams, 1'000u);
  EXPECT_GT(rims, 300u);
}

TEST(NearestFloat, IsThatOfTheHardwareOfThisMachine) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    // Doubles of the floats' range, and between floats, below the smallest and above the largest too.
    double x = std::ldexp(1 + static_cast<double>(random() >> 12) * 0x1p-52, static_cast<int>(random() % 285) - 153);
    if (i % 4 == 0) x = static_cast<double>(as_float(static_cast<uint32_t>(random() % 0x7f800000)));
    if (i % 8 == 0) x *= 1 + 0x1p-24;
    if (i % 2 == 0) x = -x;
    ASSERT_EQ(Exact(x).nearest_float(), static_cast<float>(x)) << x;
  }
  for (const double x : {0x1p-150, 0x1.8p-150, 0x1p-149, 0x1.8p-149, 0x1p-126, 0x1.fffffep127, 0x1.ffffffp127}) {
    EXPECT_EQ(Exact(x).nearest_float(), static_cast<float>(x)) << x;
  }
}

}  // namespace
}  // namespace raypool::referee
