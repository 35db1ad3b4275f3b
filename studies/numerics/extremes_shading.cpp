// Extremes of shading: normals, lights, radiance, depth.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "numerics/extreme_parts.hpp"
#include "numerics/extremes.hpp"
#include "numerics/reference.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {
namespace {

ExtremeCase shading_case(const char* name, const char* expected, std::function<void(const ExtremeMachine&)> check,
                         int least_significand = 11) {
  return {"shading", name, expected, std::move(check), least_significand};
}

std::vector<TriangleCorners> operator+(std::vector<TriangleCorners> a, const std::vector<TriangleCorners>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

ExtremeFrame frame_of(Scene scene, int size, int depth = 2) {
  ExtremeFrame frame;
  frame.scene = std::move(scene);
  frame.width = frame.height = size;
  frame.depth = depth;
  return frame;
}

/// One pixel with an eye ray that hits at `t` with `normal`; its reflection hits nothing, its shadow ray is free. With
/// `light`, secondary rays start at the hit itself.
Drawing shade_hit(const ExtremeMachine& machine, const Vec3& normal, float t, int depth, const Vec3* light = nullptr) {
  ExtremeFrame frame = ray_frame(scene_of_triangles(square(1, -2)), {0, 0, 0}, {0.25f, 0.125f, -1});
  if (light != nullptr) {
    frame.scene.light.position = *light;
    frame.change_arguments = [ray = frame.change_arguments](std::array<uint32_t, kArguments>& arguments) {
      ray(arguments);
      arguments[argument::kOffset] = 0;
    };
  }
  frame.depth = depth;
  frame.trace = [=](const Ray& ray, Intersection& intersection) {
    if ((ray[word::kFlags] & kShadowFlag) != 0) return true;
    if ((ray[word::kFlags] & kDepthMask) != 1) return false;
    intersection[word::kDistance] = as_bits(t);
    for (int axis = 0; axis < 3; ++axis) intersection[word::kNormal + axis] = as_bits(normal[axis]);
    return true;
  };
  return machine.draw(frame);
}

void zero_normals(const ExtremeMachine& machine) {
  for (int depth : {1, 2}) {
    for (const Vec3& normal : {Vec3{0, 0, 0}, Vec3{-0.0f, 0, -0.0f}}) {
      const Drawing drawing = shade_hit(machine, normal, 2, depth);
      require_no_nan(drawing);
      require(lit_pixels(drawing.frame) == 0, "a surface without a direction is lit");
    }
  }
}

void subnormal_normals(const ExtremeMachine& machine) {
  for (int depth : {1, 2}) {
    for (const Vec3& normal : {Vec3{1e-40f, -1e-40f, 1e-40f}, Vec3{0, 0, 1e-45f}}) {
      const Drawing drawing = shade_hit(machine, normal, 2, depth);
      require_no_nan(drawing);
      require(lit_pixels(drawing.frame) == 0, "a surface almost without a direction is lit");
    }
    // One subnormal component changes nothing.
    const Drawing plain = shade_hit(machine, {0, 0, 1}, 2, depth),
                  almost = shade_hit(machine, {0, 1e-45f, 1}, 2, depth);
    require(lit_pixels(plain.frame) == 1 && plain.frame == almost.frame,
            "a subnormal component of the normal changes the picture");
  }
}

void bad_hits(const ExtremeMachine& machine) {
  for (int depth : {1, 2}) {
    for (const Vec3& normal : {Vec3{kNan, 0, 1}, Vec3{0, 0, kNan}, Vec3{kNan, kNan, kNan}, Vec3{0, kInf, 0}}) {
      require_no_nan(shade_hit(machine, normal, 2, depth));
    }
    for (float t : {kNan, kInf, 1e30f, 1e-44f, 0.0f}) require_no_nan(shade_hit(machine, {0, 0, 1}, t, depth));
  }
}

void light_on_a_surface(const ExtremeMachine& machine) {
  for (const Vec3& position : {Vec3{0, 0, -2}, Vec3{0.5f, 0.25f, -2}, Vec3{1, 1, -2}}) {
    Scene scene = scene_of_triangles(square(3, -2));
    scene.light.position = position;
    const Drawing drawing = machine.draw(frame_of(scene, 11));
    require_no_nan(drawing);
    require(lit_pixels(drawing.frame) == 0, "a light in the plane of the only surface lights it");
  }
}

void light_at_the_point(const ExtremeMachine& machine) {
  // The vector to the light is zero: 0 times the infinite reciprocal of its length. An
  // ulp before it, the cosine is about 1.
  const Vec3 at{0.5f, 0.25f, -2}, before{0.5f, 0.25f, -2 + 0x1p-22f};
  for (int depth : {1, 2}) {
    const Drawing dark = shade_hit(machine, {0, 0, 1}, 2, depth, &at),
                  lit = shade_hit(machine, {0, 0, 1}, 2, depth, &before);
    require_no_nan(dark);
    require_no_nan(lit);
    require(lit_pixels(dark.frame) == 0, "a light in the very point lights it");
    require(lit_pixels(lit.frame) == 1, "a light next to the point does not light it");
  }
}

void light_behind(const ExtremeMachine& machine) {
  for (float z : {-2.001f, -3.0f, -1e9f}) {
    Scene scene = scene_of_triangles(square(3, -2));
    scene.light.position = {0.5f, 0.25f, z};
    const Drawing drawing = machine.draw(frame_of(scene, 7));
    require_no_nan(drawing);
    require(lit_pixels(drawing.frame) == 0, "a light behind the surface lights it");
  }
}

void light_inside(const ExtremeMachine& machine) {
  // The light in a closed box within a closed box: nothing that the eye sees is lit. Also in a corner of the inner box.
  std::vector<TriangleCorners> inner = cube(-0.5f, 0.5f);
  for (TriangleCorners& triangle : inner) {
    for (Vec3& corner : triangle) corner = corner + Vec3{0.25f, 0.5f, -4};
  }
  for (const Vec3& position : {Vec3{0.25f, 0.5f, -4}, Vec3{-0.2499f, 0.0001f, -3.5001f}}) {
    Scene scene = scene_of_triangles(cube(-8, 8) + inner);
    scene.light.position = position;
    const Drawing drawing = machine.draw(frame_of(scene, 13));
    require_no_nan(drawing);
    require_right_hits(drawing, scene);
    require(lit_pixels(drawing.frame) == 0,
            fmt::format("{} pixels see a light that is walled in", lit_pixels(drawing.frame)));
  }
}

void light_at_the_eye(const ExtremeMachine& machine) {
  Scene scene = scene_of_triangles(cube(-2, 2));
  const Drawing drawing = machine.draw(frame_of(scene, 7));
  require_no_nan(drawing);
  require(lit_pixels(drawing.frame) == 49, "what eye and light see alike is dark");
}

void light_next_to_a_surface(const ExtremeMachine& machine) {
  // Nearer than the offset of secondary rays; the cosine stays within 0 .. 1.
  for (float distance : {1e-3f, 1e-6f, 1e-12f}) {
    Scene scene = scene_of_triangles(square(3, -2));
    scene.light.position = {0, 0, -2 + distance};
    const Drawing drawing = machine.draw(frame_of(scene, 11));
    require_no_nan(drawing);
    for (int y = 0; y < 11; ++y) {
      for (int x = 0; x < 11; ++x)
        require(drawing.frame.linear(x, y, 0) <= 1, "a matt surface shines brighter than its light");
    }
  }
}

/// 512 triangles in the plane y = -1.3.
std::vector<TriangleCorners> wide_floor() {
  std::vector<TriangleCorners> triangles;
  for (int x = -8; x < 8; ++x) {
    for (int z = -16; z < 0; ++z) {
      const float u = 5 * static_cast<float>(x), v = 5 * static_cast<float>(z), y = -1.3f;
      const Vec3 a{u, y, v}, b{u + 5, y, v}, c{u + 5, y, v + 5}, d{u, y, v + 5};
      triangles.push_back({a, c, b});
      triangles.push_back({a, d, c});
    }
  }
  return triangles;
}

void grazing_light(const ExtremeMachine& machine) {
  // The floor and nothing else: nothing can shadow it.
  const std::vector<TriangleCorners> triangles = wide_floor();
  for (float height : {0.01f, 0.1f, 1.0f}) {
    Scene scene = scene_of_triangles(triangles);
    scene.light.position = {33, -1.3f + height, -77};
    const Drawing drawing = machine.draw(frame_of(scene, 19));
    require_no_nan(drawing);
    uint64_t acne = 0, hits = 0;
    for (const TracedRay& traced : drawing.traced) {
      const bool shadow = (traced.ray[word::kFlags] & kShadowFlag) != 0;
      acne += shadow && !traced.goes_on;
      hits += !shadow && traced.goes_on;
    }
    require(hits > 60, "the floor is not seen");
    require(acne == 0,
            fmt::format("{} of {} shadow rays are blocked by the surface that they start from, light {} above it", acne,
                        hits, height));
  }
}

void grazing_light_and_blocks(const ExtremeMachine& machine) {
  // Blocks that stand in the floor; the light is below their tops, and every shadow ray grazes the floor.
  std::vector<TriangleCorners> triangles = wide_floor();
  for (const Vec3& middle : {Vec3{-4, -1.3f, -14}, Vec3{3, -1.3f, -22}, Vec3{9, -1.3f, -31}}) {
    for (TriangleCorners block : cube(-1.7f, 1.7f)) {
      for (Vec3& corner : block) corner = corner + middle;
      triangles.push_back(block);
    }
  }
  uint64_t shadows = 0, dark = 0, acne = 0, wrong = 0;
  for (float height : {0.03f, 0.3f}) {
    Scene scene = scene_of_triangles(triangles);
    scene.light.position = {33, -1.3f + height, -77};
    const Drawing drawing = machine.draw(frame_of(scene, 19, 1));
    require_no_nan(drawing);
    const ReferenceTracer reference(scene);
    const Traversal traversal(scene);
    std::map<uint32_t, TracedRay> eyes;
    for (const TracedRay& eye : drawing.rays(false, 1)) eyes[eye.ray[word::kPixel]] = eye;
    for (const TracedRay& shadow : drawing.rays(true, 1)) {
      // The truth starts from the exact point, not from where the machine's ray does.
      const RayQuery eye = to_query(eyes.at(shadow.ray[word::kPixel]).ray);
      const Vec3d origin = eye.origin.as<double>(), direction = eye.direction.as<double>();
      const DoubleHit hit = reference.nearest(origin, direction, INFINITY);
      const ReferenceShadowRay truth = shadow_ray(reference, origin, direction, hit, scene.light.position.as<double>());
      if (truth.cosine <= 0) continue;
      const bool lit = reference.occluder(truth.origin, truth.direction, 1) == kNoTriangle;
      ++shadows;
      dark += !lit;
      if (shadow.goes_on == lit) continue;
      Hit blocker;
      const bool own = lit && traversal.nearest(to_query(shadow.ray), blocker) &&
                       same_surface(reference, blocker.triangle, hit.triangle);
      ++(own ? acne : wrong);
    }
  }
  require(shadows > 100 && dark > 20 && shadows - dark > 20,
          fmt::format("of {} shadow rays {} are dark", shadows, dark));
  require(acne == 0,
          fmt::format("{} of {} shadow rays are blocked by the surface that they start from", acne, shadows));
  require(wrong <= shadows / 100,
          fmt::format("{} of {} shadow rays end otherwise than the reference's", wrong, shadows));
}

/// A closed box with walls that multiply light by ten thousand at each reflection.
Scene shining_box(float diffuse) {
  Scene scene = scene_of_triangles(cube(-2, 2));
  scene.materials[0].kd = {diffuse, diffuse, diffuse};
  scene.materials[0].ks = {1000, 1000, 1000};
  scene.light.color = {1000, 1000, 1000};
  scene.light.position = {0.5f, 0.25f, 0.125f};
  scene.camera = {
      {0.1f, 0.2f, 0.3f}, {0.1f, -0.23f, -1}, {0, 1, 0}, 60};  // off the symmetry: no ray meets an edge of the box
  return scene;
}

void overflow(const ExtremeMachine& machine) {
  const Drawing drawing = machine.draw(frame_of(shining_box(1000), 3, 20));
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        require(drawing.frame.raw(x, y, channel) == UINT64_MAX && to_srgb8(drawing.frame.linear(x, y, channel)) == 255,
                fmt::format("pixel ({}, {}) has radiance {}", x, y, drawing.frame.linear(x, y, channel)));
      }
    }
  }
}

void overflow_of_nothing(const ExtremeMachine& machine) {
  // Infinite throughput times no diffuse reflectance adds nothing.
  const Drawing drawing = machine.draw(frame_of(shining_box(0), 3, 20));
  require(lit_pixels(drawing.frame) == 0, "a black surface shines through infinite reflectance");
}

void faint(const ExtremeMachine& machine) {
  Scene scene = scene_of_triangles(cube(-2, 2));
  scene.materials[0].kd = {1e-30f, 1e-42f, 1e-9f};
  const Drawing drawing = machine.draw(frame_of(scene, 3));
  require_no_nan(drawing);
  require(drawing.frame.raw(1, 1, 0) == 0 && drawing.frame.raw(1, 1, 1) == 0 && drawing.frame.raw(1, 1, 2) > 0,
          "radiance is not rounded to units of 2^-32");
}

void depth_limit(const ExtremeMachine& machine) {
  for (uint32_t depth : {1u, 2u, 3u, 254u}) {
    Scene scene = scene_of_triangles(cube(-2, 2));
    scene.materials[0].ks = {1, 1, 1};
    ExtremeFrame frame = ray_frame(scene, {0.1f, 0.2f, 0.3f}, {0.3f, 0.7f, -1});
    frame.depth = static_cast<int>(depth);
    const Drawing drawing = machine.draw(frame);
    require_no_nan(drawing);
    for (uint32_t d = 1; d <= depth; ++d) {
      require(drawing.rays(false, d).size() == 1 && drawing.rays(true, d).size() == 1,
              fmt::format("depth {} of {} is not traced", d, depth));
    }
    require(drawing.traced.size() == 2 * static_cast<size_t>(depth), "rays beyond the depth limit are traced");
  }
}

}  // namespace

std::vector<ExtremeCase> shading_extremes() {
  return {
      shading_case("zero normals", "no light; no NaN", zero_normals),
      shading_case("subnormal normals", "no light; beside a larger component nothing", subnormal_normals),
      shading_case("NaN and infinite normals and distances", "no NaN", bad_hits),
      shading_case("a light on a surface", "does not light it", light_on_a_surface),
      shading_case("a light in the shaded point", "does not light it; no NaN", light_at_the_point),
      shading_case("a light behind the surface", "does not light it", light_behind),
      shading_case("a light inside the geometry", "walls hold it", light_inside, 20),
      shading_case("a light at the eye", "lights all that is seen", light_at_the_eye),
      shading_case("a light next to a surface", "the cosine stays within 0 .. 1", light_next_to_a_surface),
      shading_case("grazing shadow rays", "no surface shadows itself", grazing_light),
      shading_case("grazing shadow rays among blocks", "light and shadow as in the double-precision reference, no acne",
                   grazing_light_and_blocks),
      shading_case("radiance that overflows", "white", overflow),
      shading_case("infinite throughput times zero", "adds nothing", overflow_of_nothing),
      shading_case("radiance below the frame buffer's unit", "rounded to multiples of 2^-32", faint),
      shading_case("the depth limit", "as many normal rays as the depth, for 1 .. 254", depth_limit),
  };
}

}  // namespace raypool::numerics
