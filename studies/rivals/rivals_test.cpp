// Other ways to intersect: for plain rays all agree, and the match shows what each gets wrong.
#include "rivals/rivals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "referee/corpus.hpp"
#include "referee/judge.hpp"
#include "referee/table.hpp"

namespace raypool::referee {
namespace {

TEST(Rivals, OfPlainRaysAllAreRight) {
  const Contenders all = rivals();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-1, 1), share(0.1f, 0.4f);
  const auto point = [&] {
    const float x = coordinate(random), y = coordinate(random);
    return Vec3{x, y, coordinate(random)};
  };
  int hits = 0, misses = 0;
  for (int i = 0; i < 2000; ++i) {
    const Corners corners = {point(), point(), point()};
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const Vec3 inside = corners[0] + (corners[1] - corners[0]) * share(random) + (corners[2] - corners[0]) * 0.3f;
    // Not edge-on, nor small; half of them beside it.
    HitCase hit_case{0, "", {point() * 3.0f, {}, INFINITY}, {corners}};
    hit_case.ray.direction = (i % 2 == 0 ? inside : corners[1] * 2.5f - corners[2] * 1.5f) - hit_case.ray.origin;
    if (length(normal) < 0.3f || std::fabs(dot(normalized(normal), normalized(hit_case.ray.direction))) < 0.3f)
      continue;
    const Certificate certificate = certify(hit_case);
    ++(certificate.miss ? misses : hits);
    for (const auto& each : all) {
      Said said;
      each->answer(hit_case, &said);
      const Verdict verdict = judge(hit_case, certificate, said.value());
      ASSERT_TRUE(verdict.right) << each->names().front() << ", " << text_of(hit_case);
      if (verdict.timed) {
        ASSERT_LT(verdict.error, 200) << each->names().front();
      }
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
}

TEST(Rivals, OfHardRaysEachIsWrongAndTheSmallestCaseShowsWhere) {
  const CaseSource cases{1800, [](uint64_t number) { return hard_case(1, number); }};
  RefereeOptions options;
  options.threads = 2;
  const std::vector<Row> rows = hold_match(cases, rivals, options);
  ASSERT_EQ(rows.size(), 6u);
  for (const Row& row : rows) {
    EXPECT_GT(row.cases, 1750u) << row.name;
    EXPECT_GT(row.wrong(), 30u) << row.name;
    EXPECT_LT(row.wrong(), 600u) << row.name;
    EXPECT_LE(row.median, 0.5) << row.name;
    for (const Fault fault : kAllFaults) {
      if (row.of(fault).count == 0) continue;
      const Failing& failing = row.of(fault);
      EXPECT_TRUE(judge(failing.smallest, certify(failing.smallest), failing.answer).has(fault)) << row.name;
      EXPECT_LE(failing.smallest.triangles.size(), 4u) << row.name << ": " << text_of(failing.smallest);
    }
  }
  // Whichever thread had which case.
  options.threads = 1;
  EXPECT_EQ(table_of(hold_match(cases, rivals, options)), table_of(rows));
}

TEST(MoellerTrumbore, TakesForParallelWhatItsPaperDoes) {
  const Corners small = {Vec3{0, 0, 0}, Vec3{0.001f, 0, 0}, Vec3{0, 0.00099f, 0}};
  const RayQuery ray{{0.0001f, 0.0001f, 1}, {0, 0, -1}, INFINITY};
  EXPECT_FALSE(moeller_trumbore(ray, small).meets) << "twice its area is below 0.000001";
  EXPECT_TRUE(woop(ray, small).meets);
  EXPECT_TRUE(baldwin_weber(ray, small).meets);
  EXPECT_TRUE(pluecker(ray, small).meets);
}

}  // namespace
}  // namespace raypool::referee
