// Extremes of triangles and meshes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"
#include "random.hpp"

namespace raypool::numerics {
namespace {

ExtremeCase make(const char* name, const char* expected, std::function<void(const ExtremeMachine&)> check) {
  return {"triangles and meshes", name, expected, std::move(check)};
}

ExtremeFrame frame_of(Scene scene, int width, int height) {
  ExtremeFrame frame;
  frame.scene = std::move(scene);
  frame.width = width;
  frame.height = height;
  return frame;
}

std::vector<TriangleCorners> operator+(std::vector<TriangleCorners> a, const std::vector<TriangleCorners>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void zero_area(const ExtremeMachine& machine) {
  // Points and lines, also such that lie on the wall behind.
  const Vec3 p{0.1f, 0.1f, -1}, q{0.2f, 0.2f, -1};
  const std::vector<TriangleCorners> flat = {
      {p, p, p}, {p, q, q}, {p, q, q * 2.0f}, {Vec3{-1, 0, -4}, Vec3{0, 0, -4}, Vec3{1, 0, -4}}};
  Scene scene = scene_of_triangles(flat + square(3, -4) + flat);
  const Drawing drawing = machine.draw(frame_of(scene, 9, 9));
  require_no_nan(drawing);
  require(lit_pixels(drawing.frame) == 81, "a pixel of the wall behind is dark");
  for (const TracedRay& eye : drawing.rays(false, 1)) {
    require(eye.goes_on && (eye.intersection[word::kTriangle] == 4 || eye.intersection[word::kTriangle] == 5),
            "an eye ray does not hit the wall");
  }
  require_nothing(machine.draw(frame_of(scene_of_triangles(flat), 5, 5)));
}

void slivers(const ExtremeMachine& machine) {
  // A fan of 1e6 to 1: 1000 long, 0.001 wide; half of them subdivided along their length, so that needles meet needles.
  std::vector<TriangleCorners> triangles;
  for (int i = -20; i < 20; ++i) {
    const float y = 0.001f * i, next = 0.001f * (i + 1);
    triangles.push_back({Vec3{-500, y, -2}, Vec3{500, y, -2}, Vec3{500, next, -2}});
    triangles.push_back({Vec3{-500, y, -2}, Vec3{500, next, -2}, Vec3{-500, next, -2}});
  }
  const Scene scene = scene_of_triangles(triangles);
  for (float x : {-400.0f, -1.0f, 0.0f, 3.0f, 499.0f}) {
    for (int step = -38; step <= 38; step += 5) {
      const Vec3 target{x, 0.0005f * step, -2};
      const Drawing drawing = machine.draw(ray_frame(scene, {0, 0, 0}, target));
      require_no_nan(drawing);
      require(eye_ray(drawing).goes_on, fmt::format("a ray falls between the slivers at ({}, {})", target.x, target.y));
      require_right_hits(drawing, scene);
    }
  }
}

void coplanar(const ExtremeMachine& machine) {
  // The same two triangles ten times, in two windings, before and behind which others lie; then the list in other
  // orders, which give other trees. Where several lie at the same t, the lowest index wins.
  const auto near = square(1, -2);
  std::vector<TriangleCorners> triangles;
  for (int i = 0; i < 10; ++i) {
    triangles = triangles + near;
    triangles.push_back({near[0][0], near[0][2], near[0][1]});
    triangles.push_back({Vec3{-1, -1, -3 - static_cast<float>(i)}, Vec3{1, -1, -3 - static_cast<float>(i)},
                         Vec3{0, 1, -3 - static_cast<float>(i)}});
  }
  Random random(7);
  for (int order = 0; order < 5; ++order) {
    const Scene scene = scene_of_triangles(triangles);
    for (const Vec3& target :
         {Vec3{0.5f, -0.25f, -2}, Vec3{-0.5f, 0.25f, -2}, Vec3{0.25f, 0.25f, -2}, Vec3{-1, -1, -2}}) {
      uint32_t lowest = 0;
      auto holds = [&](const TriangleCorners& t) {
        // Above the diagonal, below it, or on it.
        if (t[0].z != -2 || t[1].z != -2 || t[2].z != -2) return false;
        const bool lower = (t[1] == near[0][1]) || (t[2] == near[0][1]);
        return lower ? target.y <= target.x : target.y >= target.x;
      };
      while (!holds(triangles[lowest])) ++lowest;
      const Drawing drawing = machine.draw(ray_frame(scene, {target.x, target.y, 0}, {0, 0, -1}));
      const TracedRay& eye = eye_ray(drawing);
      require(eye.goes_on, "coplanar triangles are not hit");
      require(eye.intersection[word::kTriangle] == lowest,
              fmt::format("triangle {} wins over {} at the same t", eye.intersection[word::kTriangle], lowest));
    }
    std::shuffle(triangles.begin(), triangles.end(), random);
  }
}

void bad_vertices(const ExtremeMachine& machine) {
  for (float bad : {kNan, kInf, -kInf}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 corner{0.5f, 0.5f, -1};
      corner[axis] = bad;
      const std::vector<TriangleCorners> broken = {{Vec3{-1, -1, -1}, Vec3{1, -1, -1}, corner}};
      require_refused(scene_of_triangles(broken + square(3, -4)), "vertex 2");
      // Drawn all the same, the triangle is not there.
      require_nothing(machine.draw(frame_of(scene_of_triangles(broken), 3, 3)));
    }
  }
}

void bad_indices(const ExtremeMachine&) {
  Scene scene = scene_of_triangles(square(1, -2));
  scene.triangles[1][2] = 6;
  require_refused(scene, "vertex 6");
  scene.triangles[1][2] = 0xffffffffu;
  require_refused(scene, "vertex 4294967295");
  scene = scene_of_triangles(square(1, -2));
  scene.triangle_materials[0] = 1;
  require_refused(scene, "material 1");
  scene.triangle_materials.pop_back();
  require_refused(scene, "material");
}

void tiny_triangles(const ExtremeMachine& machine) {
  // Smaller than a unit in the last place of the distance: hit or not, but the same everywhere and never a NaN.
  std::vector<TriangleCorners> triangles;
  for (int i = 0; i < 8; ++i) {
    const float x = 0.125f * i, d = std::ldexp(1.0f, -20 - 4 * i);
    triangles.push_back({Vec3{x, 0, -1}, Vec3{x + d, 0, -1}, Vec3{x, d, -1}});
  }
  const Scene scene = scene_of_triangles(triangles + square(2, -2));
  for (int i = 0; i < 8; ++i) {
    const Drawing drawing = machine.draw(ray_frame(scene, {0, 0, 0}, {0.125f * i, 0, -1}));
    require_no_nan(drawing);
    require(eye_ray(drawing).goes_on, "neither the tiny triangle nor the wall behind it is hit");
    require_right_hits(drawing, scene);
  }
}

void closed_mesh(const ExtremeMachine& machine) {
  // From inside a cube towards its corners and the middles of its edges and faces, and beyond them by a little.
  const Scene scene = scene_of_triangles(cube(-1, 1));
  for (const Vec3& origin : {Vec3{0, 0, 0}, Vec3{0.3f, -0.2f, 0.1f}, Vec3{-0.99f, 0.5f, 0.98f}}) {
    for (int i = 0; i < 27; ++i) {
      if (i == 13) continue;
      const Vec3 target{static_cast<float>(i % 3 - 1), static_cast<float>(i / 3 % 3 - 1),
                        static_cast<float>(i / 9 - 1)};
      const Drawing drawing = machine.draw(ray_frame(scene, origin, target - origin));
      require_no_nan(drawing);
      require(eye_ray(drawing).goes_on,
              fmt::format("a ray leaves the closed cube through ({}, {}, {})", target.x, target.y, target.z));
    }
  }
}

}  // namespace

std::vector<ExtremeCase> triangle_extremes() {
  return {
      make("triangles without area", "never hit; what lies behind is", zero_area),
      make("slivers of 1e6 to 1", "no ray between them; hits as in exact arithmetic", slivers),
      make("coplanar overlaps", "the lowest index wins, in every order of the list", coplanar),
      make("NaN and infinite vertices", "refused with the vertex's number; if drawn, not there", bad_vertices),
      make("indices out of range", "refused with the index", bad_indices),
      make("triangles below the resolution", "hit or missed as far as single precision resolves", tiny_triangles),
      make("closed mesh from inside", "no ray leaves through an edge or a corner", closed_mesh),
  };
}

}  // namespace raypool::numerics
