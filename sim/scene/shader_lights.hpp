// The lights of a scene as shaders choose from them: RaypoolLight of shaders/raypool.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

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

/// Those of the surfaces, then triangles with emission; without any the scene's own point light. `diagonal` is that of
/// the scene's box.
ShaderLights shader_lights(const Scene& scene, const Surfaces& surfaces, float diagonal);

}  // namespace raypool
