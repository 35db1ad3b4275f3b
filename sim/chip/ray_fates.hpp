// What becomes of rays that have been traced and go on.
#pragma once

#include <cstdint>

#include "chip/ports.hpp"
#include "config/configuration.hpp"
#include "machine/common/packages.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool::chip {

class RayFates {
 public:
  /// `depth`: the largest of a normal ray. `reflections`: normal intersections are given to a kernel that casts some.
  /// `tracer` must outlive it.
  RayFates(const RayTracer& tracer, const ChipConfiguration& chip, uint32_t depth, bool reflections)
      : tracer_(tracer),
        contributes_(chip.shading == Shading::Traverser),
        sorts_(chip.culling && reflections),
        depth_(depth) {}

  /// Direct: with culling, a hit with a reflection that could not add to the picture.
  ImportKind kind_of(const Ray& ray, const Intersection& intersection) const {
    if (is_shadow(ray)) return ImportKind::Shadow;
    if (!sorts_) return ImportKind::Normal;  // perhaps of a ray that has returned, which has no material
    const bool reflects = (ray[word::kFlags] & kDepthMask) < depth_ && tracer_.reflects(intersection);
    return reflects ? ImportKind::Normal : ImportKind::Direct;
  }
  /// Shadow rays that reach the light leave contributions in place of intersections.
  bool contributes(ImportKind kind) const { return kind == ImportKind::Shadow && contributes_; }
  /// It is apart since the reflection would be too deep.
  bool deepest(const Ray& ray, ImportKind kind) const {
    return kind == ImportKind::Direct && (ray[word::kFlags] & kDepthMask) == depth_;
  }

 private:
  const RayTracer& tracer_;
  bool contributes_;
  bool sorts_;  // hits that need no reflection are kept apart
  uint32_t depth_;
};

inline FrameContribution contribution_of(const Ray& ray) {
  return {ray[word::kPixel], {ray[word::kColor], ray[word::kColor + 1], ray[word::kColor + 2]}};
}

}  // namespace raypool::chip
