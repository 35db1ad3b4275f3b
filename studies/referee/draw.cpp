#include "referee/draw.hpp"

namespace raypool::referee {
namespace {

/// Two apexes, and a ring around the line between them.
Mesh pyramids(Draw& draw, int64_t reach) {
  constexpr int64_t kRing[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  Mesh mesh;
  mesh.points = {{0, 0, draw.from_to(1, reach)}, {0, 0, -draw.from_to(1, reach)}};
  const size_t every = draw.one_of(2) ? 1 : 2;
  for (size_t i = 0; i < 8; i += every) {
    const int64_t radius = draw.from_to(1, reach);
    mesh.points.push_back({kRing[i][0] * radius, kRing[i][1] * radius, draw.from_to(-1, 1)});
  }
  const size_t ring = mesh.points.size() - 2;
  for (size_t i = 0; i < ring; ++i) {
    const size_t here = 2 + i, next = 2 + (i + 1) % ring;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

Mesh box(Draw& draw, int64_t reach) {
  Mesh mesh;
  const Point3 size{draw.from_to(1, reach), draw.from_to(1, reach), draw.from_to(1, reach)};
  for (unsigned i = 0; i < 8; ++i) {
    mesh.points.push_back(
        {(i & 1) != 0 ? size.x : -size.x, (i & 2) != 0 ? size.y : -size.y, (i & 4) != 0 ? size.z : -size.z});
  }
  constexpr size_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : kFaces) {
    const size_t turn = draw.below(4);
    const auto at = [&](size_t i) { return face[(i + turn) % 4]; };
    mesh.triangles.push_back({at(0), at(1), at(2)});
    mesh.triangles.push_back({at(0), at(2), at(3)});
  }
  return mesh;
}

/// The origin may lie outside.
Mesh tetrahedron(Draw& draw, int64_t reach) {
  Mesh mesh;
  for (int i = 0; i < 4; ++i) mesh.points.push_back(draw.point(reach));
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return mesh;
}

}  // namespace

Mesh closed_mesh(Draw& draw, int64_t reach) {
  const uint64_t kind = draw.below(4);
  Mesh mesh = kind == 0 ? box(draw, reach) : kind == 1 ? tetrahedron(draw, reach) : pyramids(draw, reach);
  const int turn = draw.small(0, 2);
  for (Point3& p : mesh.points) p = Point3{p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]} * int64_t{4};
  return mesh;
}

std::vector<Corners> triangles_of(Draw& draw, const Mesh& mesh, int exponent) {
  std::vector<Corners> triangles;
  const bool inside_out = draw.one_of(2);
  for (const auto& corners : mesh.triangles) {
    const size_t first = draw.below(3);
    const auto corner = [&](size_t k) { return on_grid(mesh.points[corners[(first + k) % 3]], exponent); };
    triangles.push_back({corner(0), corner(inside_out ? 2 : 1), corner(inside_out ? 1 : 2)});
  }
  draw.shuffle(triangles);
  return triangles;
}

}  // namespace raypool::referee
