#include "numerics/extreme_parts.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bits.hpp"
#include "numerics/reference.hpp"
#include "scene/hits_check.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {

Scene scene_of_triangles(const std::vector<TriangleCorners>& triangles) {
  Scene scene;
  scene.name = "extreme";
  scene.materials.push_back({"grey", {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}});
  for (const TriangleCorners& triangle : triangles) {
    const auto first = size32(scene.vertices);
    scene.vertices.insert(scene.vertices.end(), triangle.begin(), triangle.end());
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangle_materials.push_back(0);
  }
  scene.camera = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60};
  scene.light = {{0, 0, 0}, {1, 1, 1}};
  return scene;
}

std::vector<TriangleCorners> square(float half, float z) {
  const Vec3 a{-half, -half, z}, b{half, -half, z}, c{half, half, z}, d{-half, half, z};
  return {{a, b, c}, {a, c, d}};
}

std::vector<TriangleCorners> cube(float lower, float upper) {
  std::vector<TriangleCorners> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      auto corner = [&](bool u, bool v) {
        Vec3 p;
        p[axis] = side == 0 ? lower : upper;
        p[(axis + 1) % 3] = u ? upper : lower;
        p[(axis + 2) % 3] = v ? upper : lower;
        return p;
      };
      const Vec3 a = corner(false, false), b = corner(true, false), c = corner(true, true), d = corner(false, true);
      if (side == 0) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, c, b});
        triangles.push_back({a, d, c});
      }
    }
  }
  return triangles;
}

ExtremeFrame ray_frame(Scene scene, const Vec3& origin, const Vec3& direction) {
  ExtremeFrame frame;
  frame.scene = std::move(scene);
  frame.change_arguments = [origin, direction](std::array<uint32_t, kArguments>& arguments) {
    for (int axis = 0; axis < 3; ++axis) {
      const size_t i = axis;
      arguments[argument::kEye + i] = as_bits(origin[axis]);
      arguments[argument::kCorner + i] = as_bits(direction[axis]);
      // x + 0 * -0 is x, -0 included.
      arguments[argument::kStepX + i] = arguments[argument::kStepY + i] = as_bits(-0.0f);
    }
  };
  return frame;
}

const TracedRay& eye_ray(const Drawing& drawing) {
  for (const TracedRay& traced : drawing.traced) {
    if (traced.ray[word::kFlags] == 1) return traced;
  }
  throw ExtremeFailure("no eye ray was traced");
}

Scene moved(const Scene& scene, double scale, const Vec3d& offset) {
  Scene result = scene;
  auto move = [&](Vec3& p) { p = (p.as<double>() * scale + offset).as<float>(); };
  for (Vec3& vertex : result.vertices) move(vertex);
  move(result.camera.eye);
  move(result.light.position);
  return result;
}

bool is_lit(const FrameBuffer& frame, int x, int y) {
  return frame.raw(x, y, 0) > 0 || frame.raw(x, y, 1) > 0 || frame.raw(x, y, 2) > 0;
}

uint64_t lit_pixels(const FrameBuffer& frame) {
  uint64_t count = 0;
  for (uint32_t y = 0; y < frame.height(); ++y) {
    for (uint32_t x = 0; x < frame.width(); ++x) count += is_lit(frame, x, y);
  }
  return count;
}

void require_no_nan(const Drawing& drawing) {
  const uint64_t count = drawing.nan_contributions();
  require(count == 0, fmt::format("{} of {} contributions have a NaN", count, drawing.contributions.size()));
}

void require_right_hits(const Drawing& drawing, const Scene& scene) {
  const ReferenceTracer reference(scene);
  const Traversal traversal(scene);
  for (const TracedRay& traced : drawing.traced) {
    const RayQuery query = to_query(traced.ray);
    bool usable = true, moves = false;
    for (int axis = 0; axis < 3; ++axis) {
      usable &= std::isfinite(query.origin[axis]) && std::isfinite(query.direction[axis]);
      moves |= query.direction[axis] != 0;
    }
    if (!usable || !moves) continue;
    const DoubleHit truth =
        reference.nearest(query.origin.as<double>(), query.direction.as<double>(), static_cast<double>(query.limit));
    const bool shadow = (traced.ray[word::kFlags] & kShadowFlag) != 0;
    HitAnswer ours, theirs{truth.triangle != kNoTriangle, truth.triangle, static_cast<float>(truth.t)};
    ours.hit = shadow ? !traced.goes_on : traced.goes_on;
    // A blocked shadow ray names no triangle; its nearest hit stands for it.
    Hit blocker;
    if (ours.hit && shadow) {
      require(traversal.nearest(query, blocker), "a shadow ray is blocked by nothing");
      ours.triangle = blocker.triangle;
    } else if (ours.hit) {
      ours.triangle = traced.intersection[word::kTriangle];
    }
    if (ours.hit == theirs.hit && (shadow || !ours.hit || ours.triangle == theirs.triangle)) continue;
    std::string reason = fmt::format(
        "a ray from ({}, {}, {}) towards ({}, {}, {}) has another hit than in exact arithmetic", query.origin.x,
        query.origin.y, query.origin.z, query.direction.x, query.direction.y, query.direction.z);
    require(judge_hits(scene, query, ours, theirs, reason) == HitVerdict::Tie, reason);
  }
}

void require_nothing(const Drawing& drawing) {
  for (const TracedRay& traced : drawing.traced) require(!traced.goes_on, "a ray hits something");
  require(drawing.contributions.empty() && lit_pixels(drawing.frame) == 0, "the picture is not black");
}

void require_refused(const Scene& scene, const std::string& word) {
  try {
    check_scene(scene, "scene");
  } catch (const InputError& error) {
    const std::string text = error.what();
    require(text.find(word) != std::string::npos && text.find('\n') == std::string::npos, "the refusal reads: " + text);
    return;
  }
  throw ExtremeFailure("the scene is not refused");
}

}  // namespace raypool::numerics
