// A path tracer in double precision, beside which pictures of shader sets are put. docs/studies/convergence.md says
// what light it counts.
#pragma once

#include <cstdint>

#include "convergence/reference_scene.hpp"

namespace raypool::convergence {

class PathReference {
 public:
  /// Paths meet at most `depth` surfaces. `scene` has surfaces and must outlive it.
  PathReference(const Scene& scene, uint32_t width, uint32_t height, uint32_t depth);

  /// What one path brings to a pixel, through a random place of it.
  Vec3d sample(uint32_t x, uint32_t y, Random& random) const;

 private:
  struct Path;
  PathRay eye_ray(double x, double y) const;
  Vec3d light_on(const Meeting& meeting, const Reflection& reflection, uint32_t left, Random& random) const;
  Vec3d shining_on(const Meeting& meeting, const Reflection& reflection, bool last, Random& random) const;
  void go_on(Path& path, const Meeting& meeting, const Reflection& reflection, Random& random) const;
  void pass_glass(Path& path, const Meeting& meeting, Random& random) const;

  ReferenceScene scene_;
  Vec3d eye_, forward_, right_, up_;  // right and up as long as half of the picture's height, one ahead
  uint32_t width_, height_, depth_;
};

}  // namespace raypool::convergence
