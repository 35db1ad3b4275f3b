#include "scene/shader_lights.hpp"

#include <algorithm>
#include <cmath>

#include "bits.hpp"

namespace raypool {
namespace {

/// As raypool_luminance().
double luminance(const Vec3& color) {
  const Vec3d c = color.as<double>();
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/// The area times luminance of a surface of about this power. `diagonal` is that of what is lit.
double weight_of(const SurfaceLight& light, double diagonal) {
  const double color = luminance(light.color);
  switch (light.kind) {
    case SurfaceLight::Kind::Point:
      return 2 * color;
    case SurfaceLight::Kind::Spot:
      return color * (1 - std::cos(static_cast<double>(light.outer_cone)));
    case SurfaceLight::Kind::Directional:
      return color * diagonal * diagonal / 8;
  }
  return 0;
}

ShaderLight shader_light(const SurfaceLight& light) {
  constexpr double kLeastEdge = 1e-3;  // of a cone, as a difference of cosines
  ShaderLight result;
  result.kind = light.kind == SurfaceLight::Kind::Point  ? ShaderLight::kPoint
                : light.kind == SurfaceLight::Kind::Spot ? ShaderLight::kSpot
                                                         : ShaderLight::kDirectional;
  result.position = light.position;
  result.direction = light.direction;
  result.color = light.color;
  result.range = light.range;
  const double inside = std::cos(static_cast<double>(light.inner_cone)),
               outside = std::cos(static_cast<double>(light.outer_cone));
  const double scale = 1 / std::max(inside - outside, kLeastEdge);
  result.spot_scale = static_cast<float>(scale);
  result.spot_offset = static_cast<float>(-outside * scale);
  return result;
}

/// Each light is chosen at its own place with its threshold, or else gives the place to another one.
void set_thresholds(std::vector<ShaderLight>& lights, const std::vector<double>& weights, double total) {
  const auto count = static_cast<double>(lights.size());
  std::vector<double> shares(lights.size());
  std::vector<uint32_t> small, large;
  for (uint32_t i = 0; i < lights.size(); ++i) {
    const double probability = total > 0 ? weights[i] / total : 1 / count;
    lights[i].probability = static_cast<float>(probability);
    lights[i].other = i;
    shares[i] = probability * count;
    (shares[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const uint32_t less = small.back(), more = large.back();
    small.pop_back();
    lights[less].threshold = static_cast<float>(shares[less]);
    lights[less].other = more;
    shares[more] -= 1 - shares[less];
    if (shares[more] < 1) {
      large.pop_back();
      small.push_back(more);
    }
  }
}

}  // namespace

ShaderLights shader_lights(const Scene& scene, const Surfaces& surfaces, float diagonal) {
  ShaderLights result;
  std::vector<double> weights;
  for (const SurfaceLight& light : surfaces.lights) {
    result.lights.push_back(shader_light(light));
    weights.push_back(weight_of(light, static_cast<double>(diagonal)));
  }
  for (size_t i = 0; i < surfaces.triangles.size(); ++i) {
    const SurfaceMaterial& material = surfaces.materials[scene.triangle_materials[i]];
    if (!material.emits() || material.emission_texture) continue;
    const auto& [a, b, c] = surfaces.triangles[i];
    const Vec3& corner = surfaces.positions[a];
    ShaderLight light;
    light.kind = ShaderLight::kTriangle;
    light.position = corner;
    light.direction = surfaces.positions[b] - corner;
    light.edge = surfaces.positions[c] - corner;
    light.color = material.emission;
    light.triangle = static_cast<uint32_t>(i);
    const double area = 0.5 * length(cross(light.direction.as<double>(), light.edge.as<double>()));
    if (!(area > 0)) continue;
    result.lights.push_back(light);
    weights.push_back(area * luminance(light.color));
  }
  if (result.lights.empty()) {
    ShaderLight light;
    light.kind = ShaderLight::kLamp;
    light.position = scene.light.position;
    light.color = scene.light.color;
    result.lights.push_back(light);
    weights.push_back(luminance(light.color));
  }
  double total = 0;
  for (const double weight : weights) total += weight;
  set_thresholds(result.lights, weights, total);
  if (total > 0) result.total_weight = static_cast<float>(total);
  return result;
}

}  // namespace raypool
