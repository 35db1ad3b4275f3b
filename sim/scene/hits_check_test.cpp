#include "scene/hits_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/mesh_builder.hpp"
#include "scene/reference_kernels.hpp"

namespace raypool {
namespace {

TEST(HitsCheck, OursAgreeWithEmbree) {
  for (const Scene& scene : {make_cornell(0.5), make_room(0.05)}) {
    HitsOptions options;
    options.width = options.height = 96;
    options.kernel = reference::run;
    const HitsReport report = compare_with_embree(scene, options);
    EXPECT_EQ(report.primary.rays, 96u * 96);
    EXPECT_GT(report.shadow.rays, 5000u);
    for (const HitCounts& counts : {report.primary, report.shadow}) {
      EXPECT_EQ(counts.ours_wrong, 0u);
      EXPECT_EQ(counts.agree + counts.ties + counts.ours_wrong + counts.embree_wrong, counts.rays);
      EXPECT_LT(counts.ties, counts.rays / 100);
    }
    EXPECT_EQ(report.explanations.size(), report.primary.embree_wrong + report.shadow.embree_wrong);
    for (const std::string& line : report.explanations) ADD_FAILURE() << line;
  }
}

TEST(HitsCheck, ExactVerdictDistinguishesInsideBorderAndOutside) {
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.triangle({0, 0, 5}, {1, 0, 5}, {0, 1, 5});
  auto passage = [&](float x, float y, const Vec3& direction) {
    return exact_hit(scene, 0, RayQuery{{x, y, 0}, direction, INFINITY}).passage;
  };
  EXPECT_EQ(passage(0.25f, 0.25f, {0, 0, 1}), Passage::Inside);
  EXPECT_EQ(passage(0.5f, 0.5f, {0, 0, 1}), Passage::Border);
  EXPECT_EQ(passage(0.5f, 0.5f + 1e-6f, {0, 0, 1}), Passage::Border);
  EXPECT_EQ(passage(0.5f, 0.51f, {0, 0, 1}), Passage::Outside);
  EXPECT_EQ(passage(0.25f, 0.25f, {1, 0, 0}), Passage::Parallel);
  const ExactHit hit = exact_hit(scene, 0, RayQuery{{0.25f, 0.25f, 0}, {0, 0, 2}, INFINITY});
  EXPECT_DOUBLE_EQ(hit.t, 2.5);
  EXPECT_DOUBLE_EQ(hit.margin, 0.25);
}

TEST(HitsCheck, JudgeFindsTheWrongSide) {
  // Two triangles behind each other, a coplanar copy of the first one, one without area, one beside.
  Scene scene;
  MeshBuilder mesh(scene, 1);
  mesh.add_material("grey", {0.5f, 0.5f, 0.5f}, {});
  mesh.triangle({0, 0, 5}, {1, 0, 5}, {0, 1, 5});
  mesh.triangle({0, 0, 6}, {1, 0, 6}, {0, 1, 6});
  mesh.triangle({0, 0, 5}, {1, 0, 5}, {0, 1, 5});
  mesh.triangle({0, 0, 4}, {0.5f, 0.5f, 4}, {1, 1, 4});
  mesh.triangle({2, 2, 4}, {3, 2, 4}, {2, 3, 4});
  auto judge = [&](const RayQuery& ray, const HitAnswer& ours, const HitAnswer& embree) {
    std::string reason;
    return judge_hits(scene, ray, ours, embree, reason);
  };
  const RayQuery middle{{0.25f, 0.25f, 0}, {0, 0, 1}, INFINITY}, edge{{0.5f, 0.5f, 0}, {0, 0, 1}, INFINITY};
  const HitAnswer near{true, 0, 5}, far{true, 1, 6}, copy{true, 2, 5}, flat{true, 3, 4}, beside{true, 4, 4}, none;
  EXPECT_EQ(judge(middle, near, far), HitVerdict::EmbreeWrong);
  EXPECT_EQ(judge(middle, far, near), HitVerdict::OursWrong);
  EXPECT_EQ(judge(middle, near, copy), HitVerdict::Tie);
  EXPECT_EQ(judge(middle, none, near), HitVerdict::OursWrong);
  EXPECT_EQ(judge(middle, near, none), HitVerdict::EmbreeWrong);
  EXPECT_EQ(judge(middle, near, flat), HitVerdict::EmbreeWrong);
  EXPECT_EQ(judge(middle, flat, near), HitVerdict::OursWrong);
  EXPECT_EQ(judge(middle, beside, near), HitVerdict::OursWrong);
  EXPECT_EQ(judge(middle, none, beside), HitVerdict::EmbreeWrong);
  // On the edge the ray may as well pass by.
  EXPECT_EQ(judge(edge, near, none), HitVerdict::Tie);
  EXPECT_EQ(judge(edge, far, near), HitVerdict::Tie);
  // Behind the origin, and beyond the limit.
  EXPECT_EQ(judge({{0.25f, 0.25f, 5.5f}, {0, 0, 1}, INFINITY}, near, far), HitVerdict::OursWrong);
  EXPECT_EQ(judge({{0.25f, 0.25f, 0}, {0, 0, 5.5f}, 1}, none, far), HitVerdict::EmbreeWrong);
}

}  // namespace
}  // namespace raypool
