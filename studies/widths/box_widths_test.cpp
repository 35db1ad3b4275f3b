#include "widths/box_widths.hpp"

#include <gtest/gtest.h>

namespace raypool {
namespace {

TEST(BoxWidths, TellVisitsOfEachWidthAndFindNoOtherAnswer) {
  const Scene scene = make_room(0.05);
  const std::vector<BenchRays> rays = rays_of_frame(scene, Tracer(scene), 48, 32, 3);
  double last = -1;
  const BoxWidths tried = try_box_widths(scene, rays, {16, 8, 6}, [&](double share) {
    EXPECT_GT(share, last);
    EXPECT_LE(share, 1);
    last = share;
  });
  EXPECT_GT(last, 0);
  EXPECT_EQ(tried.rays, rays[0].rays.size() + rays[1].rays.size() + rays[2].rays.size());
  ASSERT_EQ(tried.rows.size(), 4u);
  TraversalCounts floats;  // the same frame, by the tree of compressed nodes
  Traversal compressed(scene);
  compressed.compress_nodes();
  for (const BenchRays& kind : rays) {
    for (const RayQuery& ray : kind.rays) {
      Hit hit;
      kind.any ? compressed.occluded(ray, &floats) : compressed.nearest(ray, hit, &floats);
    }
  }
  EXPECT_EQ(tried.rows[0].visits.nodes, floats.nodes);
  EXPECT_EQ(tried.rows[0].visits.triangles, floats.triangles);
  for (size_t i = 0; i < tried.rows.size(); ++i) {
    EXPECT_EQ(tried.rows[i].different, 0u);
    EXPECT_EQ(tried.rows[i].bits, std::vector<uint32_t>({0, 16, 8, 6})[i]);
    if (i > 0) {
      EXPECT_GT(tried.rows[i].visits.nodes, tried.rows[i - 1].visits.nodes);
    }
  }
}

TEST(BoxWidths, TheTableHasARowForEach) {
  BoxWidths tried;
  tried.rays = 4;
  tried.rows = {{0, {40, 4, 8}, 0}, {12, {41, 4, 8}, 0}, {6, {80, 4, 4}, 3}};
  EXPECT_EQ(box_width_table(tried),
            "bits   nodes a ray    more  triangles a ray    more  different answers\n"
            "float       10.000                    2.000                          0\n"
            "12          10.250   +2.5%            2.000   +0.0%                  0\n"
            "6           20.000 +100.0%            1.000  -50.0%                  3\n");
  tried.rows = {{0, {0, 0, 0}, 0}, {6, {0, 0, 0}, 0}};
  EXPECT_NE(box_width_table(tried).find("6            0.000 "), std::string::npos);
}

}  // namespace
}  // namespace raypool
