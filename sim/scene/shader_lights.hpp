// The lights of a scene as shaders choose from them: RaypoolLight of shaders/raypool.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

struct ShaderFrame;

/// A RaypoolLight, word by word.
struct ShaderLight {
  enum Kind : uint32_t { kPoint, kSpot, kDirectional, kLamp, kTriangle };
  Vec3 position;
  uint32_t kind = kPoint;
  Vec3 direction;
  float spot_scale = 0;
  Vec3 edge;
  float spot_offset = 0;
  Vec3 color;
  float probability = 0, threshold = 1;
  uint32_t other = 0;
  float range = 0;
  uint32_t triangle = 0;
};
static_assert(sizeof(ShaderLight) == 80);

struct ShaderLights {
  std::vector<ShaderLight> lights;  ///< at least one; probabilities and thresholds (Walker's alias method) are set
  float total_weight = 1;           ///< a triangle's probability is area times luminance over this
};

/// As raypool_luminance().
double luminance(const Vec3& color);

/// Those of the surfaces, then triangles with emission; without any the scene's own point light. `diagonal` is that of
/// the scene's box. Of several, those are chosen more often that light what `frame` shows; without it, those of more
/// power.
ShaderLights shader_lights(const Scene& scene, const Surfaces& surfaces, float diagonal,
                           const ShaderFrame* frame = nullptr);

}  // namespace raypool
