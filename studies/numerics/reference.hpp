// What the picture ought to be: the ray tracer of the kernels in double precision, on the same inputs as the
// machine has: float vertices, float material records, float kernel arguments. Which triangle a ray hits is
// decided in double precision, and in 113-bit arithmetic where double does not decide the side of an edge. Secondary
// rays start on the surface itself, but for an offset a billion times smaller than the machine's, so no surface shadows
// itself and no shadow is moved.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "kernel/kernels.hpp"
#include "scene/bvh.hpp"
#include "scene/double_traversal.hpp"
#include "scene/scene.hpp"

namespace raypool::numerics {

class ReferenceTracer {
 public:
  /// `scene` must outlive this.
  explicit ReferenceTracer(const Scene& scene);
  ReferenceTracer(const ReferenceTracer&) = delete;
  ReferenceTracer& operator=(const ReferenceTracer&) = delete;

  // As DoubleTraversal.
  DoubleHit nearest(const Vec3d& origin, const Vec3d& direction, double limit) const {
    return traversal_.nearest(origin, direction, limit);
  }
  uint32_t occluder(const Vec3d& origin, const Vec3d& direction, double limit) const {
    return traversal_.occluder(origin, direction, limit);
  }
  /// Unit geometric normal, as wound.
  Vec3d normal(uint32_t triangle) const;
  const Scene& scene() const { return scene_; }

 private:
  const Scene& scene_;
  Bvh bvh_;
  DoubleTraversal traversal_;
};

/// What happens to a pixel at one depth.
struct PathStep {
  uint32_t triangle = kNoTriangle;  ///< that the normal ray hits
  bool followed = false;            ///< a normal ray of this depth was traced, with a throughput above zero
  bool lit = false;                 ///< its shadow ray reached the light, which is in front of the surface
  bool facing = false;              ///< the light is in front of the surface
};

/// A picture with its paths. Pixels in rows from the top.
struct PathImage {
  PathImage(int w, int h, int d)
      : width(w),
        height(h),
        depth(d),
        color(static_cast<size_t>(w) * static_cast<size_t>(h)),
        steps(color.size() * static_cast<size_t>(d)) {}

  int width, height, depth;
  std::vector<Vec3d> color;     ///< linear
  std::vector<PathStep> steps;  ///< [pixel * depth + number of reflections]

  PathStep& step(size_t pixel, int reflections) {
    return steps[pixel * static_cast<size_t>(depth) + static_cast<size_t>(reflections)];
  }
  const PathStep& step(size_t pixel, int reflections) const {
    return steps[pixel * static_cast<size_t>(depth) + static_cast<size_t>(reflections)];
  }
};

/// The frame's inputs as the reference takes them from the kernel arguments.
struct ReferenceCamera {
  explicit ReferenceCamera(const std::array<uint32_t, kArguments>& arguments);
  Vec3d eye, corner, step_x, step_y, light, light_color;

  Vec3d direction(int x, int y) const {
    return corner + step_x * static_cast<double>(x) + step_y * static_cast<double>(y);
  }
};

/// A shadow ray from the point `t` along a ray that hits `triangle`: from the surface, to the light (t = 1).
struct ReferenceShadowRay {
  Vec3d origin, direction;
  double cosine =
      0;  ///< of the angle between the normal on the ray's side and the direction; not above 0: the light is behind
};
ReferenceShadowRay shadow_ray(const ReferenceTracer& tracer, const Vec3d& origin, const Vec3d& direction,
                              const DoubleHit& hit, const Vec3d& light);

/// The triangle itself, or one in its plane: no shadow ray from the one is blocked by the other.
bool same_surface(const ReferenceTracer& tracer, uint32_t a, uint32_t b);

/// Draws width x height pixels with up to depth - 1 reflections (depth 1 .. 254). `progress`, if not empty, is
/// called now and then with the share done.
PathImage render_reference(const ReferenceTracer& tracer, const std::array<uint32_t, kArguments>& arguments, int width,
                           int height, int depth, const std::function<void(double)>& progress = nullptr);

}  // namespace raypool::numerics
