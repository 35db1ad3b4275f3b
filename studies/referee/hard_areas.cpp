// Triangles of hardly any area, or several in one place.
#include "referee/hard_kinds.hpp"

namespace raypool::referee {
namespace {

/// Any order of the corners, and so either side.
Corners turned(Draw& draw, const Corners& corners) {
  const size_t first = draw.below(3), step = draw.one_of(2) ? 1 : 2;
  return {corners[first], corners[(first + step) % 3], corners[(first + 2 * step) % 3]};
}

Corners any_triangle(Draw& draw, double reach) {
  return {draw.place(reach).as<float>(), draw.place(reach).as<float>(), draw.place(reach).as<float>()};
}

/// At any of the triangles, from somewhere around.
RayQuery aimed_at(Draw& draw, const std::vector<Corners>& triangles) {
  const Corners& corners = draw.any(triangles);
  return ray_towards(draw, draw.place(8), point_of(draw, corners));
}

/// Whole points in a plane through the origin.
struct Plane {
  Point3 along, across;

  explicit Plane(Draw& draw) : along(draw.direction(9)), across(draw.direction(9)) {}
  Point3 at(int64_t a, int64_t b) const { return along * a + across * b; }
};

Corners in_plane(Draw& draw, const Plane& plane) {
  const auto corner = [&] {
    const int64_t a = draw.from_to(-8, 8);
    return on_grid(plane.at(a, draw.from_to(-8, 8)), 0);
  };
  const Vec3 first = corner(), second = corner();
  return {first, second, corner()};
}

/// A ray that passes the plane exactly at one of its whole points, in front of it.
RayQuery through_plane(Draw& draw, const Point3& point) {
  const Point3 direction = draw.direction(9);
  return {on_grid(point - direction * draw.from_to(1, 30), 0), on_grid(direction * draw.from_to(1, 7), 0), INFINITY};
}

}  // namespace

Vec3d point_of(Draw& draw, const Corners& corners) {
  double u = draw.share(), v = draw.share() * (1 - u);
  if (draw.one_of(4)) v = 0;
  if (draw.one_of(8)) u = v = 0;
  const Vec3d a = corners[0].as<double>();
  return a + (corners[1].as<double>() - a) * u + (corners[2].as<double>() - a) * v;
}

RayQuery ray_towards(Draw& draw, const Vec3d& from, const Vec3d& to) {
  const Vec3 origin = from.as<float>();
  const double length = draw.one_of(2) ? 1 : std::ldexp(draw.uniform(1, 2), draw.small(-10, 10));
  return {origin, ((to - origin.as<double>()) * length).as<float>(), INFINITY};
}

DrawnCase at_slivers(Draw& draw) {
  // The third corner is next to the line between the others; the same line, from the other side, has another triangle.
  const Corners any = any_triangle(draw, 1);
  const Vec3d a = any[0].as<double>(), b = any[1].as<double>();
  const Vec3 middle = draw.nudged((a + (b - a) * draw.share()).as<float>());
  std::vector<Corners> triangles = {turned(draw, {any[0], any[1], middle})};
  if (draw.one_of(2)) triangles.push_back(turned(draw, {any[0], middle, any[2]}));
  if (draw.one_of(2)) triangles.push_back(turned(draw, {middle, any[1], any[2]}));
  const RayQuery ray = aimed_at(draw, triangles);
  return {ray, std::move(triangles)};
}

DrawnCase at_needles(Draw& draw) {
  // A row of triangles with one far corner, the others a float from each other, or a few.
  const Vec3 far = draw.place(draw.one_of(2) ? 1 : 1000).as<float>();
  std::vector<Corners> triangles;
  Vec3 corner = draw.place(1).as<float>();
  for (uint64_t i = 1 + draw.below(5); i > 0; --i) {
    const Vec3 next = draw.nudged(draw.nudged(corner));
    triangles.push_back(turned(draw, {far, corner, next}));
    corner = next;
  }
  const RayQuery ray = aimed_at(draw, triangles);
  return {ray, std::move(triangles)};
}

DrawnCase at_coincident(Draw& draw) {
  const Corners corners = any_triangle(draw, 1);
  std::vector<Corners> triangles;
  for (uint64_t i = 2 + draw.below(3); i > 0; --i) {
    Corners copy = turned(draw, corners);
    if (draw.one_of(2)) {  // a copy that lies a float beside it, whole or with a corner
      Vec3& moved = copy[draw.below(3)];
      moved = draw.nudged(moved);
    }
    triangles.push_back(copy);
  }
  const RayQuery ray = aimed_at(draw, triangles);
  return {ray, std::move(triangles)};
}

DrawnCase at_coplanar(Draw& draw) {
  const Plane plane(draw);
  std::vector<Corners> triangles;
  for (uint64_t i = 2 + draw.below(5); i > 0; --i) triangles.push_back(in_plane(draw, plane));
  const int64_t a = draw.from_to(-4, 4);
  return {through_plane(draw, plane.at(a, draw.from_to(-4, 4))), std::move(triangles)};
}

DrawnCase at_crossing(Draw& draw) {
  // Two planes or three, all with the origin, where the ray passes, or next to it.
  std::vector<Corners> triangles;
  for (uint64_t i = 2 + draw.below(2); i > 0; --i) {
    const Plane plane(draw);
    triangles.push_back(in_plane(draw, plane));
    triangles.push_back(in_plane(draw, plane));
  }
  RayQuery ray = through_plane(draw, {0, 0, 0});
  if (draw.one_of(3)) ray.direction = draw.nudged(ray.direction);
  return {ray, std::move(triangles)};
}

DrawnCase grazing(Draw& draw) {
  // In the plane of a triangle, or along one of its edges; then perhaps a float off, with a wall behind.
  const Plane plane(draw);
  std::vector<Corners> triangles = {in_plane(draw, plane), in_plane(draw, plane)};
  const int64_t a = draw.from_to(-9, 9), b = draw.from_to(-9, 9);
  const Point3 from = plane.at(16 * a, 16 * b), to = plane.at(draw.from_to(-4, 4), draw.from_to(-4, 4));
  RayQuery ray{on_grid(from, 0), on_grid(to - from, draw.small(-3, 3)), INFINITY};
  if (draw.one_of(4)) {  // along an edge, from before its corner
    const Corners& corners = triangles[0];
    const Vec3 edge = corners[1] - corners[0];
    ray = {corners[0] - edge * 2.0f, edge, INFINITY};
  }
  if (draw.one_of(2)) triangles.push_back(any_triangle(draw, 100));
  Vec3& moved = draw.one_of(2) ? ray.origin : ray.direction;
  if (draw.one_of(2)) moved = draw.nudged(moved);
  return {ray, std::move(triangles)};
}

}  // namespace raypool::referee
