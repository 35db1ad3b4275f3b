#include "widths/triangle_widths.hpp"

#include <gtest/gtest.h>

#include "scene/mesh_builder.hpp"

namespace raypool::numerics {
namespace {

TEST(TriangleWidths, TellWhatEachWidthChanges) {
  TriangleWidthOptions options;
  options.width = 48;
  options.height = 32;
  options.depth = 2;
  options.bits = {53, 24};
  options.times = {TriangleTime::Floats, TriangleTime::Plane};
  options.seam_rays = 6000;
  std::vector<std::string> said;
  options.progress = [&](const std::string& what) { said.push_back(what); };
  const TriangleWidths tried = try_triangle_widths(make_cornell(), options);
  EXPECT_EQ(tried.seam_rays, 6000u);
  EXPECT_GT(tried.cases, 55u);
  ASSERT_EQ(tried.rows.size(), 5u);
  EXPECT_EQ(said.size(), 6u);
  for (size_t i = 0; i < 5; ++i) {
    const TriangleWidthRow& row = tried.rows[i];
    EXPECT_EQ(row.bits, std::vector<uint32_t>({0, 53, 24, 53, 24})[i]);
    EXPECT_EQ(row.leaks, 0u);
    if (row.bits == 24 && row.time == TriangleTime::Floats) {
      EXPECT_LE(row.broken, 1u) << "t of so few bits errs by more than secondary rays are moved off their surfaces";
    } else {
      EXPECT_EQ(row.broken, 0u);
    }
    EXPECT_EQ(row.sides > 20, row.bits == 24) << "a float has too few bits for triangles of 1e9";
    if (row.bits != 24) {
      EXPECT_EQ(row.sides, 0u);
    }
    EXPECT_GT(row.frame.rays, 48u * 32);
    EXPECT_GT(row.frame.hits, 48u * 32 / 2);
    EXPECT_LE(row.frame.exact, row.frame.hits);
    EXPECT_LE(row.picture.visible, row.picture.pixels);
    EXPECT_EQ(row.picture.largest == 0, row.picture.visible == 0);
  }
  // The engines' test, and what agrees with it.
  for (const size_t i : {0, 1}) {
    EXPECT_EQ(tried.rows[i].frame.other + tried.rows[i].frame.other_t + tried.rows[i].picture.pixels, 0u);
    EXPECT_EQ(tried.rows[i].soups.other + tried.rows[i].soups.other_t, 0u);
    EXPECT_EQ(tried.rows[i].frame.exact, tried.rows[0].frame.exact);
  }
  EXPECT_GT(tried.rows[2].frame.other_t, 100u);
  EXPECT_GE(tried.rows[2].frame.largest, 1);
  EXPECT_LT(tried.rows[2].frame.exact, tried.rows[1].frame.exact) << "fewer bits";
  EXPECT_GT(tried.rows[3].frame.exact, tried.rows[1].frame.exact) << "the plane is nearer to what is exact";
}

TEST(TriangleWidths, TheTableHasARowForEach) {
  TriangleWidths tried;
  tried.seam_rays = 60;
  tried.large = 9;
  tried.cases = 7;
  TriangleWidthRow row;
  tried.rows.push_back(row);
  row.time = TriangleTime::Plane;
  row.bits = 24;
  row.frame = {100, 3, 2, 1, 40, 17.2, 90, 45, 18, 0};
  row.soups = {50, 0, 0, 0, 5, 1, 10, 9, 5, 1};
  row.picture.visible = 12;
  row.picture.largest = 200;
  row.leaks = 4;
  row.sides = 8;
  row.broken = 6;
  tried.rows.push_back(row);
  const std::string table = triangle_width_table(tried);
  EXPECT_NE(table.find("of 60 rays at seams; sides: wrong ones, of 9 points"), std::string::npos);
  EXPECT_NE(table.find("\nengines"), std::string::npos);
  EXPECT_NE(table.find("\nplane      24     3     2     1       40      17  50.0%  0.20     12    200     0     0     0"
                       "  0.50      4     8     6\n"),
            std::string::npos)
      << table;
}

}  // namespace
}  // namespace raypool::numerics
