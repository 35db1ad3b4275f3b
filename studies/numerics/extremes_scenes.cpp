// Extremes of whole scenes: none at all, tiny, huge, far away.
#include <fmt/format.h>

#include <cmath>

#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"

namespace raypool::numerics {
namespace {

constexpr int kSize = 11;

ExtremeCase scene_case(const char* name, const char* expected, std::function<void(const ExtremeMachine&)> check) {
  return {"scenes", name, expected, std::move(check)};
}

ExtremeFrame scene_frame(Scene scene, int depth = 2) {
  ExtremeFrame frame;
  frame.scene = std::move(scene);
  frame.width = frame.height = kSize;
  frame.depth = depth;
  return frame;
}

Scene small_cornell() { return make_cornell(0.05); }

void empty_scene(const ExtremeMachine& machine) {
  const Scene scene = scene_of_triangles({});
  require_refused(scene, "no triangles");
  require_nothing(machine.draw(scene_frame(scene)));
}

/// The picture at another scale lights the pixels that it lights at scale 1.
void require_same_light(const ExtremeMachine& machine, double scale) {
  const Drawing plain = machine.draw(scene_frame(small_cornell()));
  const Scene scene = moved(small_cornell(), scale, {});
  const Drawing scaled = machine.draw(scene_frame(scene));
  require_no_nan(scaled);
  require_right_hits(scaled, scene);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      require(is_lit(scaled.frame, x, y) == is_lit(plain.frame, x, y),
              fmt::format("pixel ({}, {}) is lit at one scale only", x, y));
      for (int channel = 0; channel < 3; ++channel) {
        require(scaled.frame.linear(x, y, channel) < 4,
                fmt::format("pixel ({}, {}) has radiance {}", x, y, scaled.frame.linear(x, y, channel)));
      }
    }
  }
}

void tiny_scene(const ExtremeMachine& machine) {
  // A power of two, so that nothing is rounded: near 1e-20. Squares of distances are subnormal.
  require_same_light(machine, 0x1p-66);
}

void tinier_scene(const ExtremeMachine& machine) {
  // Near 1e-30: squares of distances are zero in every mode, and the cosine is 1.
  require_same_light(machine, 0x1p-100);
}

void large_scene(const ExtremeMachine& machine) { require_same_light(machine, 0x1p26); }

void huge_scene(const ExtremeMachine& machine) {
  const Scene scene = moved(small_cornell(), 1e20, {});
  require_refused(scene, "1e+09");
  require_nothing(machine.draw(scene_frame(scene)));
}

/// Every eye ray hits the closed box, and what it hits in exact arithmetic.
void require_closed(const ExtremeMachine& machine, const Vec3d& offset) {
  const Scene scene = moved(small_cornell(), 1, offset);
  const Drawing drawing = machine.draw(scene_frame(scene, 3));
  require_no_nan(drawing);
  for (const TracedRay& eye : drawing.rays(false, 1)) require(eye.goes_on, "an eye ray leaves the closed box");
  require_right_hits(drawing, scene);
}

void far_scene(const ExtremeMachine& machine) { require_closed(machine, {1e5, -1e5, 1e5}); }

void very_far_scene(const ExtremeMachine& machine) {
  // A unit in the last place is a metre here: of the box of 5.5 m little is left, and the eye may lie in a wall.
  const Scene scene = moved(small_cornell(), 1, {1e7, -1e7, 1e7});
  const Drawing drawing = machine.draw(scene_frame(scene, 3));
  require_no_nan(drawing);
  require_right_hits(drawing, scene);
}

void far_and_large_scene(const ExtremeMachine& machine) {
  const Scene scene = moved(small_cornell(), 1e3, {1e7, 1e7, -1e7});
  const Drawing drawing = machine.draw(scene_frame(scene, 3));
  require_no_nan(drawing);
  for (const TracedRay& eye : drawing.rays(false, 1)) require(eye.goes_on, "an eye ray leaves the closed box");
  require_right_hits(drawing, scene);
}

void mixed_scales(const ExtremeMachine& machine) {
  // A triangle of 1e9 below a square of 1e-3 before the eye.
  std::vector<TriangleCorners> triangles = square(0.001f, -0.01f);
  triangles.push_back({Vec3{-1e9f, -1, 1e9f}, Vec3{1e9f, -1, 1e9f}, Vec3{0, -1, -1e9f}});
  const Scene scene = scene_of_triangles(triangles);
  check_scene(scene, "scene");
  const Drawing drawing = machine.draw(scene_frame(scene));
  require_no_nan(drawing);
  require_right_hits(drawing, scene);
  bool near = false, far = false;
  for (const TracedRay& eye : drawing.rays(false, 1)) {
    near |= eye.goes_on && eye.intersection[word::kTriangle] < 2;
    far |= eye.goes_on && eye.intersection[word::kTriangle] == 2;
  }
  require(near && far, "one of the two surfaces is not seen");
}

}  // namespace

std::vector<ExtremeCase> scene_extremes() {
  return {
      scene_case("an empty scene", "refused; if drawn, black", empty_scene),
      scene_case("coordinates of 1e-20", "the same pixels are lit as at scale 1", tiny_scene),
      scene_case("coordinates of 1e-30", "the same pixels are lit as at scale 1", tinier_scene),
      scene_case("coordinates of 1e+8", "the same pixels are lit as at scale 1", large_scene),
      scene_case("coordinates of 1e+20", "refused; if drawn, black", huge_scene),
      scene_case("a scene moved by 1e5", "closed; hits as in exact arithmetic", far_scene),
      scene_case("a scene moved by 1e7", "hits as in exact arithmetic", very_far_scene),
      scene_case("a scene of 1e4 moved by 1e7", "closed; hits as in exact arithmetic", far_and_large_scene),
      scene_case("1e9 beside 1e-3", "both are seen; hits as in exact arithmetic", mixed_scales),
  };
}

}  // namespace raypool::numerics
