#include "scene/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace raypool {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

struct Cut {
  PolygonShape shape;
  Triangles triangles;
  std::vector<Vec3> vertices;

  Vec3d area_vector(size_t i) const {
    const auto& t = triangles[i];
    const Vec3d a = vertices[t[0]].as<double>();
    return cross(vertices[t[1]].as<double>() - a, vertices[t[2]].as<double>() - a) * 0.5;
  }
  double area() const {
    double sum = 0;
    for (size_t i = 0; i < triangles.size(); ++i) sum += length(area_vector(i));
    return sum;
  }
  /// Of the flat outline at z = 0: is the point in one of the triangles?
  bool covers(double x, double y) const {
    for (const auto& t : triangles) {
      int sides = 0;
      for (size_t k = 0; k < 3; ++k) {
        const Vec3d a = vertices[t[k]].as<double>(), b = vertices[t[(k + 1) % 3]].as<double>();
        sides += (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) > 0 ? 1 : -1;
      }
      if (std::abs(sides) == 3) return true;
    }
    return false;
  }
};

Cut cut(std::vector<Vec3> vertices, std::vector<uint32_t> corners = {}) {
  if (corners.empty()) {
    corners.resize(vertices.size());
    std::iota(corners.begin(), corners.end(), 0u);
  }
  Cut result{PolygonShape::Flat, {}, std::move(vertices)};
  result.shape = triangulate(result.vertices, corners.data(), corners.size(), result.triangles);
  return result;
}

const std::vector<Vec3> kNotched = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}};

TEST(Polygon, ANotchStaysOpenWhateverCornerComesFirst) {
  for (uint32_t first = 0; first < 5; ++first) {
    std::vector<uint32_t> corners;
    for (uint32_t i = 0; i < 5; ++i) corners.push_back((first + i) % 5);
    const Cut face = cut(kNotched, corners);
    EXPECT_EQ(face.shape, PolygonShape::Flat);
    EXPECT_EQ(face.triangles.size(), 3u);
    EXPECT_DOUBLE_EQ(face.area(), 10);
    EXPECT_FALSE(face.covers(2, 2)) << first;
    EXPECT_TRUE(face.covers(0.3, 2.9));
    EXPECT_TRUE(face.covers(3.7, 2.8));
    for (size_t i = 0; i < 3; ++i) EXPECT_GT(face.area_vector(i).z, 0) << "wound like the face";
  }
}

TEST(Polygon, AnArrowHeadOfFourCornersToo) {
  const Cut face = cut({{0, 0, 0}, {4, -4, 0}, {1, 0, 0}, {4, 4, 0}});
  EXPECT_EQ(face.shape, PolygonShape::Flat);
  ASSERT_EQ(face.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(face.area(), 4);
  EXPECT_FALSE(face.covers(3, 0));
}

TEST(Polygon, TurnedInSpaceAndWoundEitherWay) {
  for (const bool back : {false, true}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec3> vertices;
      for (const Vec3& v : kNotched) {
        Vec3 p;
        p[axis] = v.x;
        p[(axis + 1) % 3] = v.y;
        p[(axis + 2) % 3] = 0.5f * v.x - 7;
        vertices.push_back(p);
      }
      std::vector<uint32_t> corners = {0, 1, 2, 3, 4};
      if (back) std::reverse(corners.begin(), corners.end());
      const Cut face = cut(vertices, corners);
      EXPECT_EQ(face.shape, PolygonShape::Flat);
      ASSERT_EQ(face.triangles.size(), 3u);
      EXPECT_NEAR(face.area(), 10 * std::sqrt(1.25), 1e-9);
      for (size_t i = 0; i < 3; ++i) EXPECT_EQ(face.area_vector(i)[(axis + 2) % 3] > 0, !back);
    }
  }
}

TEST(Polygon, AConvexQuadrilateralIsCutAlongItsShorterDiagonal) {
  EXPECT_EQ(cut({{0, 0, 0}, {3, 0, 0}, {4, 1, 0}, {1, 1, 0}}).triangles, (Triangles{{0, 1, 3}, {1, 2, 3}}));
  EXPECT_EQ(cut({{1, 0, 0}, {4, 0, 0}, {3, 1, 0}, {0, 1, 0}}).triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(Polygon, ManyCornersSpiralsAndCornersOnEdges) {
  std::vector<Vec3> ring;
  for (int i = 0; i < 400; ++i) ring.push_back({std::cos(i * 0.0157079633f), std::sin(i * 0.0157079633f), 0});
  EXPECT_NEAR(cut(ring).area(), 3.14146, 1e-4);
  EXPECT_EQ(cut(ring).triangles.size(), 398u);
  std::vector<Vec3> spiral;
  for (const double radius : {1.0, 0.8}) {
    for (int i = 0; i <= 60; ++i) {
      const double t = 0.2 * (radius == 1.0 ? i : 60 - i), r = radius * (1 + t);
      spiral.push_back(Vec3d{r * std::cos(t), r * std::sin(t), 0}.as<float>());
    }
  }
  const Cut face = cut(spiral);
  EXPECT_EQ(face.shape, PolygonShape::Flat);
  EXPECT_EQ(face.triangles.size(), spiral.size() - 2);
  // A corner in the middle of an edge, and one that is given twice.
  EXPECT_DOUBLE_EQ(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}).area(), 4);
  EXPECT_DOUBLE_EQ(cut({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}).area(), 4);
}

TEST(Polygon, AHoleBehindAnEdgeThatIsWalkedTwice) {
  const Cut face = cut({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}},
                       {0, 1, 2, 3, 0, 4, 5, 6, 7, 4});
  EXPECT_EQ(face.shape, PolygonShape::Flat);
  EXPECT_DOUBLE_EQ(face.area(), 12);
  EXPECT_FALSE(face.covers(2, 2.1));
}

TEST(Polygon, BentFacesAreDrawnAndNamed) {
  const Cut face = cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2f}, {0, 1, 0}});
  EXPECT_EQ(face.shape, PolygonShape::Bent);
  EXPECT_EQ(face.triangles.size(), 2u);
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.001f}, {0, 1, 0}}).shape, PolygonShape::Flat);
}

TEST(Polygon, WithoutAreaItKeepsItsTrianglesAndHasNone) {
  const Cut line = cut({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {2, 2, 2}});
  EXPECT_EQ(line.shape, PolygonShape::NoArea);
  EXPECT_EQ(line.triangles.size(), 2u);
  EXPECT_EQ(cut({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}}).shape, PolygonShape::NoArea);
}

TEST(Polygon, OutlinesThatCrossThemselvesAreNamed) {
  const std::vector<Vec3> uneven = {{0, 0, 0}, {3, 2, 0}, {3, 0, 0}, {0, 1, 0}};
  const std::vector<Vec3> eight = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};  // its two areas cancel
  std::vector<Vec3> star;
  for (int i = 0; i < 5; ++i) star.push_back({std::cos(2.513274f * i), std::sin(2.513274f * i), 0});
  for (const auto& outline : {uneven, eight, star}) {
    const Cut face = cut(outline);
    EXPECT_EQ(face.shape, PolygonShape::Crossing);
    EXPECT_EQ(face.triangles.size(), outline.size() - 2) << "a fan";
  }
}

}  // namespace
}  // namespace raypool
