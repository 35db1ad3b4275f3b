#include "scene/light_survey.hpp"

#include <algorithm>
#include <cmath>

namespace raypool {
namespace {

constexpr double kFullTurn = 6.28318530717958647692;
constexpr uint32_t kPathsAlong = 24;  // paths along each side of the picture
constexpr int kSegments = 3;          // of a path
constexpr double kReflected = 0.5;    // what surfaces leave of a path's weight, about
constexpr float kBeforeLight = 0.9995f;

double at_cone(const ShaderLight& light, const Vec3d& to_light, double distance) {
  const double cosine = -dot(to_light, light.direction.as<double>()) / distance;
  const double cone =
      std::clamp(cosine * static_cast<double>(light.spot_scale) + static_cast<double>(light.spot_offset), 0.0, 1.0);
  return cone * cone;
}

/// Two that make a frame with it.
std::pair<Vec3d, Vec3d> across(const Vec3d& normal) {
  const Vec3d other = std::fabs(normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d first = normalized(cross(normal, other));
  return {first, cross(normal, first)};
}

}  // namespace

LightSurvey::LightSurvey(const Scene& scene, const ShaderFrame& frame)
    : traversal_(scene),
      offset_(static_cast<double>(frame.offset)),
      far_(2 * static_cast<double>(scene.bounds().diagonal())) {
  const auto get = [&](size_t first) {
    return Vec3d{frame.camera[first], frame.camera[first + 1], frame.camera[first + 2]};
  };
  for (uint32_t i = 0; i < kPathsAlong * kPathsAlong; ++i) {
    const double x = (i % kPathsAlong + uniform()) / kPathsAlong * frame.width - 0.5;
    const double y = (i / kPathsAlong + uniform()) / kPathsAlong * frame.height - 0.5;
    follow(get(argument::kEye),
           normalized(get(argument::kCorner) + get(argument::kStepX) * x + get(argument::kStepY) * y));
  }
}

void LightSurvey::follow(Vec3d origin, Vec3d direction) {
  double counts = 1;
  for (int segment = 0; segment < kSegments; ++segment) {
    std::optional<Place> place = met(origin, direction);
    if (!place) return;
    place->counts = counts;
    places_.push_back(*place);
    // On as from a matt surface: directions are the likelier the larger their cosine.
    const auto [first, second] = across(place->normal);
    const double square = uniform(), angle = kFullTurn * uniform(), radius = std::sqrt(square);
    direction = first * (radius * std::cos(angle)) + second * (radius * std::sin(angle)) +
                place->normal * std::sqrt(1 - square);
    origin = place->point;
    counts *= kReflected * kReflected;  // squares are added up
  }
}

std::optional<LightSurvey::Place> LightSurvey::met(const Vec3d& origin, const Vec3d& direction) const {
  Hit hit;
  if (!traversal_.nearest({origin.as<float>(), direction.as<float>(), INFINITY}, hit)) return std::nullopt;
  const double t = static_cast<double>(hit.t);
  Vec3d normal = hit.normal.as<double>();
  if (dot(normal, direction) > 0) normal = normal * -1.0;
  const Vec3d point = origin + direction * t;
  return Place{point + normal * (offset_ * (largest_of(point) + t)), normal, 1};
}

bool LightSurvey::is_free(const Place& place, const Vec3d& to_light) const {
  return !traversal_.occluded({place.point.as<float>(), to_light.as<float>(), kBeforeLight});
}

/// As raypool_light() of shaders/raypool.glsl.
double LightSurvey::irradiance(const ShaderLight& light, double probability, const Place& place) {
  const Vec3d at = light.position.as<double>(), along = light.direction.as<double>();
  double strength = luminance(light.color) / probability;
  Vec3d to_light = at - place.point;
  if (light.kind == ShaderLight::kDirectional) to_light = along * -far_;
  if (light.kind == ShaderLight::kTriangle) {
    const Vec3d edge = light.edge.as<double>();
    const double root = std::sqrt(uniform()), share = uniform();
    to_light = to_light + along * (root * (1 - share)) + edge * (root * share);
    const double square = dot(to_light, to_light), distance = std::sqrt(square);
    if (!(distance > 0)) return 0;
    strength *= 0.5 * std::fabs(dot(cross(along, edge), to_light)) / (square * distance);
    // Nothing of this radiance is brighter, but the estimate of what is near.
    strength = std::min(strength, kFullTurn / 2 * luminance(light.color));
  }
  const double distance = length(to_light);
  if (!(distance > 0)) return 0;
  if (light.kind == ShaderLight::kPoint || light.kind == ShaderLight::kSpot) {
    if (light.range > 0 && distance > static_cast<double>(light.range)) return 0;
    strength /= distance * distance;
  }
  if (light.kind == ShaderLight::kSpot) strength *= at_cone(light, to_light, distance);
  strength *= dot(to_light, place.normal) / distance;
  return strength > 0 && is_free(place, to_light) ? strength : 0;
}

double LightSurvey::strength(const std::vector<ShaderLight>& lights, const std::vector<double>& weights) {
  std::vector<double> sums;
  double total = 0;
  for (const double weight : weights) sums.push_back(total += weight);
  double squares = 0, counts = 0;
  for (const Place& place : places_) {
    counts += place.counts;
    if (!(total > 0)) continue;
    const auto found = std::upper_bound(sums.begin(), sums.end(), uniform() * total);
    const size_t chosen = std::min(static_cast<size_t>(found - sums.begin()), lights.size() - 1);
    const double one = irradiance(lights[chosen], weights[chosen] / total, place);
    squares += place.counts * one * one;
  }
  return counts > 0 ? std::sqrt(squares / counts) : 0;
}

}  // namespace raypool
