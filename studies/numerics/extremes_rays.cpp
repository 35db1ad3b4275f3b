// Extremes of rays and boxes: each case is a picture of one pixel, with the hard ray as eye ray.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "bits.hpp"
#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"

namespace raypool::numerics {
namespace {

Scene closed_cube() { return scene_of_triangles(cube(-1, 1)); }

Drawing shoot(const ExtremeMachine& machine, const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Drawing drawing = machine.draw(ray_frame(scene, origin, direction));
  require_no_nan(drawing);
  return drawing;
}

std::string text(const Vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

/// The ray must hit at `t`, as it does in exact arithmetic.
void require_hit(const ExtremeMachine& machine, const Scene& scene, const Vec3& origin, const Vec3& direction,
                 float t) {
  const Drawing drawing = shoot(machine, scene, origin, direction);
  const TracedRay& eye = eye_ray(drawing);
  require(eye.goes_on, "from " + text(origin) + " towards " + text(direction) + " nothing is hit");
  const float ours = as_float(eye.intersection[word::kDistance]);
  // Eight units in the last place of a significand: words of the ray and of the camera are cut off at it.
  require(std::fabs(ours - t) <= std::ldexp(16.0f, -machine.significand()) * t,
          fmt::format("from {} towards {} t is {}, not {}", text(origin), text(direction), ours, t));
  require_right_hits(drawing, scene);
}

void require_missing(const ExtremeMachine& machine, const Scene& scene, const Vec3& origin, const Vec3& direction) {
  require_nothing(shoot(machine, scene, origin, direction));
}

ExtremeCase ray_case(const char* name, const char* expected, std::function<void(const ExtremeMachine&)> check) {
  return {"rays and boxes", name, expected, std::move(check)};
}

void zero_components(const ExtremeMachine& machine) {
  for (int axis = 0; axis < 3; ++axis) {
    for (float towards : {1.0f, -1.0f}) {
      for (int signs = 0; signs < 4; ++signs) {
        Vec3 direction;
        direction[axis] = towards;
        direction[(axis + 1) % 3] = (signs & 1) != 0 ? -0.0f : 0.0f;
        direction[(axis + 2) % 3] = (signs & 2) != 0 ? -0.0f : 0.0f;
        require_hit(machine, closed_cube(), {0.25f, 0.125f, -0.5f}, direction,
                    1 - towards * Vec3{0.25f, 0.125f, -0.5f}[axis]);
      }
    }
  }
}

void no_direction(const ExtremeMachine& machine) {
  require_missing(machine, closed_cube(), {0, 0, 0}, {0, 0, 0});
  require_missing(machine, closed_cube(), {0, 0, 0}, {-0.0f, 0, -0.0f});
}

void bad_directions(const ExtremeMachine& machine) {
  for (float bad : {kNan, kInf, -kInf}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 direction{0.5f, 0.25f, -1};
      direction[axis] = bad;
      require_missing(machine, closed_cube(), {0, 0, 0}, direction);
    }
    require_missing(machine, closed_cube(), {0, 0, 0}, {bad, bad, bad});
  }
}

void bad_origins(const ExtremeMachine& machine) {
  for (float bad : {kNan, kInf, -kInf, 1e30f}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 origin;
      origin[axis] = bad;
      require_missing(machine, closed_cube(), origin, {0.5f, 0.25f, -1});
    }
  }
}

void long_directions(const ExtremeMachine& machine) {
  for (float length : {1e10f, 1e-10f, 1e18f}) {
    for (const Vec3& direction : {Vec3{0, 0, 1}, Vec3{0.5f, 0.25f, -1}, Vec3{-1, 0.125f, 0.75f}}) {
      require_hit(machine, closed_cube(), {0, 0, 0}, direction * length, 1 / length);
    }
  }
}

void tiny_direction(const ExtremeMachine& machine) {
  // t is beyond the largest float, or, where subnormal numbers are zeros, there is no direction.
  require_missing(machine, closed_cube(), {0, 0, 0}, {0, 0, -1e-44f});
  // A component that is tiny beside the others is as good as zero.
  require_hit(machine, closed_cube(), {0, 0, 0}, {1e-45f, -1e-45f, -1}, 1);
}

void on_a_slab_plane(const ExtremeMachine& machine) {
  // The origin lies in the plane of a face of the inner cube, and of its box, outside that face; the ray
  // runs along the plane, or leaves it.
  std::vector<TriangleCorners> triangles = cube(-4, 4);
  const auto inner = cube(-1, 1);
  triangles.insert(triangles.end(), inner.begin(), inner.end());
  const Scene scene = scene_of_triangles(triangles);
  for (float z : {-1.0f, 1.0f}) {
    for (const Vec3& direction : {Vec3{0, 1, 0}, Vec3{0, -1, 0.0f}, Vec3{1, 0, -0.0f}, Vec3{0, 1, -0.0f}}) {
      const Drawing drawing = shoot(machine, scene, {2, 0.3f, z}, direction);
      require(eye_ray(drawing).goes_on, "the outer cube has a gap");
      require_right_hits(drawing, scene);
    }
    require_hit(machine, scene, {0.2f, 0.3f, z}, {0, 0, z}, 3);
  }
}

void along_a_face(const ExtremeMachine& machine) {
  // Within the face's plane from outside: the face is seen edge-on and not hit; the
  // side faces end in the plane and may be.
  const Scene scene = scene_of_triangles(cube(-1, 1));
  const Drawing drawing = shoot(machine, scene, {-3, 0.25f, 1}, {1, 0, 0});
  require_right_hits(drawing, scene);
  if (eye_ray(drawing).goes_on) {
    const float x = as_float(eye_ray(drawing).intersection[word::kNormal]);
    require(std::fabs(x) == 1, "the face that is seen edge-on is hit");
  }
}

void inside_a_box(const ExtremeMachine& machine) {
  for (float x : {-0.999f, 0.0f, 0.999f}) {
    for (float y : {-0.5f, 0.7f}) {
      require_hit(machine, closed_cube(), {x, y, 0.25f}, {0, 0, -1}, 1.25f);
      require_hit(machine, closed_cube(), {x, y, 0.25f}, {0, 0, 0.5f}, 1.5f);
    }
  }
}

void in_the_plane_of_a_triangle(const ExtremeMachine& machine) {
  const Scene alone = scene_of_triangles({{Vec3{-1, -1, -2}, Vec3{1, -1, -2}, Vec3{0, 1, -2}}});
  require_missing(machine, alone, {-5, 0, -2}, {1, 0, 0});        // edge-on
  require_missing(machine, alone, {0, -0.5f, -2}, {1, 0.5f, 0});  // from within
  require_missing(machine, alone, {0, -0.5f, -2}, {0, 0, -1});    // off it: t is 0
  require_missing(machine, alone, {0, -0.5f, -2}, {0, 0, 1});
  // In a plane that no axis knows, roundings decide; a hit lies within the triangle's box.
  const Scene tilted = scene_of_triangles({{Vec3{0, 0, 0}, Vec3{3, 1, 2}, Vec3{1, 2, 3}}});
  const Drawing drawing = shoot(machine, tilted, {-4, -3, -5}, {4, 3, 5});
  const TracedRay& eye = eye_ray(drawing);
  const float t = as_float(eye.intersection[word::kDistance]);
  require(!eye.goes_on || (t > 0.999f && t < 1.601f),
          fmt::format("a triangle that is seen edge-on is hit at {}, outside its box", t));
}

void flat_boxes(const ExtremeMachine& machine) {
  // Every leaf's box has no thickness.
  std::vector<TriangleCorners> triangles;
  for (int i = 1; i <= 40; ++i) {
    const auto layer = square(1, -static_cast<float>(i));
    triangles.insert(triangles.end(), layer.begin(), layer.end());
  }
  const Scene scene = scene_of_triangles(triangles);
  for (int i = 0; i < 40; i += 13) {
    require_hit(machine, scene, {0.3f, 0.2f, -static_cast<float>(i)}, {0, 0, -1}, 1);
    require_hit(machine, scene, {0.3f, 0.2f, -static_cast<float>(i) - 0.25f}, {0.001f, -0.0f, -0.5f}, 1.5f);
  }
}

void edges_and_vertices(const ExtremeMachine& machine) {
  // A grid of 4 x 4 squares: rays through each of its vertices and the middles of its edges, straight and slanted.
  std::vector<TriangleCorners> triangles;
  for (int x = -2; x < 2; ++x) {
    for (int y = -2; y < 2; ++y) {
      const float u = x, v = y;
      const Vec3 a{u, v, -3}, b{u + 1, v, -3}, c{u + 1, v + 1, -3}, d{u, v + 1, -3};
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  const Scene scene = scene_of_triangles(triangles);
  for (int x = -4; x <= 4; x += 1) {
    for (int y = -4; y <= 4; y += 2) {
      const auto u = x * 0.5f, v = y * 0.5f;
      const Drawing straight = shoot(machine, scene, {u, v, 0}, {0, 0, -1});
      require(eye_ray(straight).goes_on, fmt::format("a ray falls through the mesh at ({}, {})", u, v));
      if (std::abs(x) == 4 || std::abs(y) == 4) continue;
      require(eye_ray(shoot(machine, scene, {0.3f, 0.1f, 0}, {u - 0.3f, v - 0.1f, -3})).goes_on,
              fmt::format("a slanted ray falls through the mesh at ({}, {})", u, v));
    }
  }
}

void limits(const ExtremeMachine& machine) {
  // The shadow ray ends at the light: a surface at or behind the light casts no shadow, one before it does.
  for (float z : {1.0f, 0.5f, 2.0f}) {
    std::vector<TriangleCorners> triangles = square(4, -4);
    const auto blocker = square(4, z);
    triangles.insert(triangles.end(), blocker.begin(), blocker.end());
    Scene scene = scene_of_triangles(triangles);
    scene.light.position = {0, 0, 1};
    const Drawing drawing = shoot(machine, scene, {0.1f, 0.2f, -1}, {0, 0, -1});
    require(is_lit(drawing.frame, 0, 0) == (z >= 1),
            fmt::format("a surface at z = {} and a light at z = 1: lit {}", z, is_lit(drawing.frame, 0, 0)));
  }
}

}  // namespace

std::vector<ExtremeCase> ray_extremes() {
  return {
      ray_case("direction components 0 and -0", "the sign of a zero changes nothing", zero_components),
      ray_case("direction all zero", "nothing is hit", no_direction),
      ray_case("NaN and infinite directions", "nothing is hit", bad_directions),
      ray_case("NaN, infinite and far origins", "nothing is hit", bad_origins),
      ray_case("directions of length 1e10, 1e-10 and 1e18", "the same hit, t divided by the length", long_directions),
      ray_case("subnormal direction", "nothing is hit; beside a larger component it is a zero", tiny_direction),
      ray_case("origin on a slab plane", "as in exact arithmetic", on_a_slab_plane),
      ray_case("ray within a face of a box", "the face is not hit", along_a_face),
      ray_case("origin inside a box", "the box is met at once", inside_a_box),
      ray_case("origin in a triangle's plane", "not hit in an axis' plane; in others at most within its box",
               in_the_plane_of_a_triangle),
      ray_case("flat boxes", "hit like others", flat_boxes),
      ray_case("rays through shared edges and vertices", "one of the triangles is hit", edges_and_vertices),
      ray_case("surface at the light", "hits count with 0 < t < limit", limits),
  };
}

}  // namespace raypool::numerics
