#include "scene/shader_lights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bits.hpp"
#include "scene/light_survey.hpp"

namespace raypool {
namespace {

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

/// Of all lights, at each place, one is chosen and counts 1/p times what it gives, f. The variance of that is least
/// where p is proportional to the root of the mean of f^2 over the places (importance sampling: Kahn and Marshall,
/// "Methods of reducing sample size in Monte Carlo computations", 1953). A survey measures f at some places of the
/// frame. What it has overlooked is found still, as a part of the choice is by power (defensive mixture: Hesterberg,
/// "Weighted average importance sampling and defensive mixture distributions", 1995).
///
/// Triangles, from `first_triangle` on, keep their weights: shaders compute their probabilities of area and luminance.
void weigh_by_survey(LightSurvey survey, const std::vector<ShaderLight>& lights, size_t first_triangle,
                     std::vector<double>& weights) {
  constexpr double kByPower = 0.1;
  const auto from = [&](size_t i) { return static_cast<ptrdiff_t>(i); };
  // The triangles are one group, each other light is one of its own.
  std::vector<double> power(weights.begin(), weights.begin() + from(first_triangle)), seen;
  for (size_t i = 0; i < first_triangle; ++i) seen.push_back(survey.strength({lights[i]}, {weights[i]}));
  if (first_triangle < lights.size()) {
    const std::vector<ShaderLight> triangles(lights.begin() + from(first_triangle), lights.end());
    const std::vector<double> its(weights.begin() + from(first_triangle), weights.end());
    power.push_back(std::accumulate(its.begin(), its.end(), 0.0));
    seen.push_back(survey.strength(triangles, its));
  }
  const double all_power = std::accumulate(power.begin(), power.end(), 0.0);
  const double all_seen = std::accumulate(seen.begin(), seen.end(), 0.0);
  if (!(all_power > 0) || !(all_seen > 0)) return;
  const auto share = [&](size_t i) { return kByPower * power[i] / all_power + (1 - kByPower) * seen[i] / all_seen; };
  const double scale = first_triangle < lights.size() && power.back() > 0 ? power.back() / share(power.size() - 1) : 1;
  for (size_t i = 0; i < first_triangle; ++i) weights[i] = share(i) * scale;
}

}  // namespace

double luminance(const Vec3& color) {
  const Vec3d c = color.as<double>();
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

ShaderLights shader_lights(const Scene& scene, const Surfaces& surfaces, float diagonal, const ShaderFrame* frame) {
  ShaderLights result;
  std::vector<double> weights;
  for (const SurfaceLight& light : surfaces.lights) {
    result.lights.push_back(shader_light(light));
    weights.push_back(weight_of(light, static_cast<double>(diagonal)));
  }
  const size_t first_triangle = result.lights.size();
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
  // Where there is nothing to choose, or only triangles, nothing is measured.
  if (frame != nullptr && first_triangle > 0 && result.lights.size() > 1)
    weigh_by_survey(LightSurvey(scene, *frame), result.lights, first_triangle, weights);
  double total = 0;
  for (const double weight : weights) total += weight;
  set_thresholds(result.lights, weights, total);
  if (total > 0) result.total_weight = static_cast<float>(total);
  return result;
}

}  // namespace raypool
