// Rays through, or next to, what triangles share.
#include <algorithm>
#include <map>

#include "numerics/watertight.hpp"
#include "referee/hard_kinds.hpp"

namespace raypool::referee {
namespace {

/// Coordinates of below 2^24 stay floats: those of meshes are below 4 reach, of origins 16 times that.
constexpr int64_t kReaches[] = {2, 10, 200, 20000};

/// A corner, or a point of an edge at a quarter, the middle, or three quarters; points are multiples of 4.
Point3 point_on(Draw& draw, const Mesh& mesh, bool corner) {
  const auto& triangle = draw.any(mesh.triangles);
  const size_t k = draw.below(3);
  const Point3 a = mesh.points[triangle[k]], b = mesh.points[triangle[(k + 1) % 3]];
  const int64_t share = corner ? 0 : draw.from_to(1, 3);
  return {a.x + (b.x - a.x) / 4 * share, a.y + (b.y - a.y) / 4 * share, a.z + (b.z - a.z) / 4 * share};
}

/// The triangles of a mesh that have a vertex, by its number.
using Around = std::multimap<uint32_t, size_t>;

struct Seams {
  numerics::WatertightMesh mesh;
  std::vector<numerics::SharedEdge> edges;  // with few triangles around their ends
  Around around;

  explicit Seams(numerics::WatertightMesh made) : mesh(std::move(made)), edges(numerics::shared_edges(mesh.scene)) {
    const auto& triangles = mesh.scene.triangles;
    for (size_t i = 0; i < triangles.size(); ++i) {
      for (const uint32_t vertex : triangles[i]) around.insert({vertex, i});
    }
    const auto many = [&](const numerics::SharedEdge& edge) {
      return around.count(edge.a) > 8 || around.count(edge.b) > 8;
    };
    edges.erase(std::remove_if(edges.begin(), edges.end(), many), edges.end());
  }
  std::vector<Corners> triangles_at(const numerics::SharedEdge& edge) const {
    std::vector<size_t> numbers;
    for (const uint32_t vertex : {edge.a, edge.b}) {
      const auto range = around.equal_range(vertex);
      for (auto it = range.first; it != range.second; ++it) numbers.push_back(it->second);
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<Corners> triangles;
    for (const size_t i : numbers) {
      triangles.push_back({mesh.scene.corner(i, 0), mesh.scene.corner(i, 1), mesh.scene.corner(i, 2)});
    }
    return triangles;
  }
};

const std::vector<Seams>& all_seams() {
  static const std::vector<Seams> seams = [] {
    std::vector<Seams> made;
    for (numerics::WatertightMesh& mesh : numerics::watertight_meshes()) made.emplace_back(std::move(mesh));
    return made;
  }();
  return seams;
}

}  // namespace

DrawnCase exactly_through(Draw& draw, bool corner, int64_t reach, int exponent) {
  const Mesh mesh = closed_mesh(draw, reach);
  const Point3 point = point_on(draw, mesh, corner);
  Point3 origin = draw.direction(std::min<int64_t>(4, reach)), direction = point - origin;
  if (draw.one_of(2)) {  // so many steps before it
    direction = draw.direction(reach);
    origin = point - direction * draw.from_to(1, 12);
  }
  if (direction.x == 0 && direction.y == 0 && direction.z == 0) direction = {0, 0, 1};
  const auto length = static_cast<int64_t>(draw.one_of(2) ? 1 : draw.from_to(2, 7));
  return {{on_grid(origin, exponent), on_grid(direction * length, draw.small(-4, 4)), INFINITY},
          triangles_of(draw, mesh, exponent)};
}

DrawnCase through_corner(Draw& draw) {
  return exactly_through(draw, true, kReaches[draw.below(4)], draw.small(-20, 8));
}

DrawnCase through_edge(Draw& draw) { return exactly_through(draw, false, kReaches[draw.below(4)], draw.small(-20, 8)); }

DrawnCase next_to_edge(Draw& draw) {
  DrawnCase drawn = exactly_through(draw, draw.one_of(3), kReaches[draw.below(4)], draw.small(-20, 8));
  Vec3& moved = draw.one_of(2) ? drawn.ray.origin : drawn.ray.direction;
  moved = draw.nudged(moved);
  return drawn;
}

DrawnCase at_seam(Draw& draw) {
  const Seams& seams = draw.any(all_seams());
  const numerics::SharedEdge edge = draw.any(seams.edges);
  const Vec3 origin = draw.any(seams.mesh.origins);
  const double share = draw.one_of(4) ? 0 : draw.one_of(3) ? 0.5 : draw.share();
  return {numerics::ray_at(seams.mesh.scene, origin, edge, share), seams.triangles_at(edge)};
}

DrawnCase at_fan(Draw& draw) {
  // Blades from one point to the next around the hub, in any order of heights; sometimes one is missing.
  constexpr int64_t kRing[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  Mesh mesh;
  mesh.points.push_back({0, 0, 0});
  const int64_t reach = kReaches[draw.below(4)];
  for (const auto& to : kRing) {
    const int64_t radius = draw.from_to(1, reach);
    mesh.points.push_back({to[0] * radius, to[1] * radius, draw.from_to(-reach, reach)});
  }
  for (size_t i = 0; i < 8; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % 8});
  if (draw.one_of(3)) mesh.triangles.pop_back();
  const int exponent = draw.small(-20, 8);
  Point3 down{draw.from_to(-2, 2), draw.from_to(-2, 2), -draw.from_to(1, 9)};
  const auto aimed = static_cast<size_t>(draw.one_of(2) ? 0 : draw.from_to(1, 8));
  const int64_t share = draw.from_to(0, 1);
  for (Point3& p : mesh.points) p = p * int64_t{2};
  const Point3& end = mesh.points[aimed];
  const Point3 point{end.x / 2 * share, end.y / 2 * share, end.z / 2 * share};
  const Point3 origin = point - down * draw.from_to(1, 9);
  DrawnCase drawn{{on_grid(origin, exponent), on_grid(down, draw.small(-4, 4)), INFINITY},
                  triangles_of(draw, mesh, exponent)};
  if (draw.one_of(3)) drawn.ray.direction = draw.nudged(drawn.ray.direction);
  return drawn;
}

}  // namespace raypool::referee
