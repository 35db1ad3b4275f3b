#include "scene/polygon.hpp"

#include <fmt/format.h>
#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace raypool {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

constexpr double kFlatness = 0.01;     // distance from the plane / size, up to which a face counts as flat
constexpr double kAreaError = 1e-9;    // relative; sums of areas are rounded
constexpr double kNoAreaShare = 1e-9;  // twice the area / square of the size, up to which there is none

/// A corner on the axis plane on which the face is largest: exact, as a coordinate is dropped and nothing computed.
struct Point {
  double x, y;
  bool operator<(const Point& other) const { return std::pair(x, y) < std::pair(other.x, other.y); }
};

/// Twice the signed area.
double area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Face {
  Vec3d normal;               // by Newell's formula: its length is twice the enclosed area
  double size = 0;            // largest distance of a corner from the first one
  double off_plane = 0;       // largest distance of a corner from the plane through the corners' mean
  std::vector<Point> points;  // counter-clockwise when the area they enclose is positive
  double twice_area = 0;      // of the points, above zero
};

Face measure(const std::vector<Vec3>& vertices, const uint32_t* corners, size_t count) {
  Face face;
  const Vec3d first = vertices[corners[0]].as<double>();
  Vec3d mean;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d a = vertices[corners[i]].as<double>() - first,
                b = vertices[corners[(i + 1) % count]].as<double>() - first;
    face.normal = face.normal + cross(a, b);
    face.size = std::max(face.size, length(a));
    mean = mean + a * (1.0 / static_cast<double>(count));
  }
  const Vec3d n = face.normal;
  if (!(length(n) > kNoAreaShare * face.size * face.size)) return face;
  const Vec3d unit = normalized(n);
  for (size_t i = 0; i < count; ++i) {
    const Vec3d a = vertices[corners[i]].as<double>() - first;
    face.off_plane = std::max(face.off_plane, std::fabs(dot(a - mean, unit)));
  }
  int axis = 0;
  for (const int other : {1, 2}) {
    if (std::fabs(n[other]) > std::fabs(n[axis])) axis = other;
  }
  // Seen from the side to which the normal points, corners go counter-clockwise: the
  // axes change places when it points down.
  const int x = n[axis] > 0 ? (axis + 1) % 3 : (axis + 2) % 3, y = n[axis] > 0 ? (axis + 2) % 3 : (axis + 1) % 3;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d p = vertices[corners[i]].as<double>();
    face.points.push_back({p[x], p[y]});
  }
  for (size_t i = 2; i < count; ++i) face.twice_area += area(face.points[0], face.points[i - 1], face.points[i]);
  return face;
}

void fan(const uint32_t* corners, size_t count, Triangles& triangles) {
  for (size_t i = 2; i < count; ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

bool is_convex_quadrilateral(const std::vector<Point>& p) {
  if (p.size() != 4) return false;
  for (size_t i = 0; i < 4; ++i) {
    if (!(area(p[i], p[(i + 1) % 4], p[(i + 2) % 4]) > 0)) return false;
  }
  return true;
}

void cut_quadrilateral(const std::vector<Vec3>& vertices, const uint32_t* c, Triangles& triangles) {
  const auto diagonal = [&](size_t a, size_t b) {
    const Vec3d way = vertices[c[b]].as<double>() - vertices[c[a]].as<double>();
    return dot(way, way);
  };
  if (diagonal(0, 2) < diagonal(1, 3)) {
    triangles.insert(triangles.end(), {{c[0], c[1], c[2]}, {c[0], c[2], c[3]}});
  } else {
    triangles.insert(triangles.end(), {{c[0], c[1], c[3]}, {c[1], c[2], c[3]}});
  }
}

/// GEOS, quiet: an error shows as a null result.
class Geos {
 public:
  Geos() : context_(GEOS_init_r()) {}
  ~Geos() { GEOS_finish_r(context_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;

  /// Triangles of the outline's constrained Delaunay triangulation; none where GEOS finds the outline at fault.
  std::vector<std::array<Point, 3>> triangulate(const std::vector<Point>& outline) const {
    GEOSCoordSequence* ring = GEOSCoordSeq_create_r(context_, static_cast<unsigned>(outline.size() + 1), 2);
    for (size_t i = 0; i <= outline.size(); ++i) {
      const Point& p = outline[i % outline.size()];
      GEOSCoordSeq_setXY_r(context_, ring, static_cast<unsigned>(i), p.x, p.y);
    }
    const Geometry polygon =
        own(GEOSGeom_createPolygon_r(context_, GEOSGeom_createLinearRing_r(context_, ring), nullptr, 0));
    std::vector<std::array<Point, 3>> triangles;
    if (!polygon) return triangles;
    const Geometry all = own(GEOSConstrainedDelaunayTriangulation_r(context_, polygon.get()));
    if (!all) return triangles;
    for (int i = 0; i < GEOSGetNumGeometries_r(context_, all.get()); ++i) {
      const GEOSGeometry* shell = GEOSGetExteriorRing_r(context_, GEOSGetGeometryN_r(context_, all.get(), i));
      const GEOSCoordSequence* corners = GEOSGeom_getCoordSeq_r(context_, shell);
      std::array<Point, 3> triangle{};
      for (unsigned k = 0; k < 3; ++k) GEOSCoordSeq_getXY_r(context_, corners, k, &triangle[k].x, &triangle[k].y);
      triangles.push_back(triangle);
    }
    return triangles;
  }

 private:
  using Geometry = std::unique_ptr<GEOSGeometry, std::function<void(GEOSGeometry*)>>;
  Geometry own(GEOSGeometry* geometry) const {
    return {geometry, [this](GEOSGeometry* g) { GEOSGeom_destroy_r(context_, g); }};
  }

  GEOSContextHandle_t context_;
};

/// False, and nothing appended, unless the triangles of GEOS cover exactly what the outline encloses.
bool cut_outline(const std::vector<Point>& points, double twice_area, const uint32_t* corners, Triangles& triangles) {
  std::map<Point, uint32_t> vertex;
  for (size_t i = 0; i < points.size(); ++i) vertex.emplace(points[i], corners[i]);
  const Geos geos;
  Triangles cut;
  double covered = 0;
  for (const std::array<Point, 3>& t : geos.triangulate(points)) {
    const auto a = vertex.find(t[0]), b = vertex.find(t[1]), c = vertex.find(t[2]);
    if (a == vertex.end() || b == vertex.end() || c == vertex.end()) return false;
    const double part = area(t[0], t[1], t[2]);
    covered += std::fabs(part);
    if (part > 0) cut.push_back({a->second, b->second, c->second});
    if (part < 0) cut.push_back({a->second, c->second, b->second});
  }
  // Where an outline crosses itself, parts are enclosed twice or the wrong way round, and the areas differ.
  if (!(std::fabs(covered - twice_area) <= kAreaError * twice_area)) return false;
  triangles.insert(triangles.end(), cut.begin(), cut.end());
  return true;
}

/// Corners that are all on one line; an outline may also cross itself so that the areas cancel.
bool on_one_line(const std::vector<Vec3>& vertices, const uint32_t* corners, size_t count, double size) {
  const Vec3d first = vertices[corners[0]].as<double>();
  Vec3d furthest;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d way = vertices[corners[i]].as<double>() - first;
    if (length(way) > length(furthest)) furthest = way;
  }
  return std::all_of(corners, corners + count, [&](uint32_t corner) {
    return length(cross(vertices[corner].as<double>() - first, furthest)) <= kNoAreaShare * size * size;
  });
}

}  // namespace

PolygonShape triangulate(const std::vector<Vec3>& vertices, const uint32_t* corners, size_t count,
                         Triangles& triangles) {
  if (count == 3) {
    fan(corners, count, triangles);
    return PolygonShape::Flat;
  }
  const Face face = measure(vertices, corners, count);
  const PolygonShape shape = face.off_plane > kFlatness * face.size ? PolygonShape::Bent : PolygonShape::Flat;
  if (is_convex_quadrilateral(face.points)) {
    cut_quadrilateral(vertices, corners, triangles);
    return shape;
  }
  if (!face.points.empty() && cut_outline(face.points, face.twice_area, corners, triangles)) return shape;
  fan(corners, count, triangles);
  return on_one_line(vertices, corners, count, face.size) ? PolygonShape::NoArea : PolygonShape::Crossing;
}

void warn_of_faces(std::vector<std::string>& warnings, const std::map<PolygonShape, std::vector<size_t>>& faces,
                   const std::function<std::string(size_t)>& name) {
  for (const auto& [shape, of_shape] : faces) {
    const char* what =
        shape == PolygonShape::Bent     ? "is not flat: which triangles it becomes is a guess; give triangles"
        : shape == PolygonShape::NoArea ? "has no area, as all its corners are on one line: no ray hits it"
                                        : "crosses itself: it is filled as a fan, which may be wrong; cut it up";
    const std::string more = of_shape.size() == 1 ? "" : fmt::format(" (as do {} more)", of_shape.size() - 1);
    warnings.push_back(fmt::format("{}{} {}", name(of_shape.front()), more, what));
  }
}

}  // namespace raypool
