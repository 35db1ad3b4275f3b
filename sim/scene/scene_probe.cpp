#include "scene/scene_probe.hpp"

#include <algorithm>
#include <cmath>

#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

/// What is drawn darker than this, of 1, looks black: 6 of 255 in the PNG.
constexpr double kBlack = 0.002;

double brightest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

const std::vector<Vec3d>& all_around() {
  static const std::vector<Vec3d> directions = [] {
    std::vector<Vec3d> made;
    for (int i = 0; i < 27; ++i) {
      if (i != 13) made.push_back(normalized(Vec3d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0}));
    }
    return made;
  }();
  return directions;
}

double half_height(float fov) {
  return static_cast<double>(static_cast<float>(std::tan(fov * 0.5 * 3.14159265358979323846 / 180)));
}

SceneProbe::SceneProbe(const Scene& scene)
    : scene_(scene),
      bounds_(scene.bounds()),
      diagonal_(std::max(length(bounds_.upper.as<double>() - bounds_.lower.as<double>()), 1e-37)),
      traversal_(scene) {}

std::optional<Sample> SceneProbe::hit(const Vec3d& from, const Vec3d& towards) const {
  Hit found;
  if (!traversal_.nearest({from.as<float>(), towards.as<float>(), INFINITY}, found)) return std::nullopt;
  const Vec3d normal = found.normal.as<double>();
  const double distance = found.t;
  const bool front = dot(normal, towards) < 0;
  return Sample{from + towards * distance, front ? normal : normal * -1.0, distance, front, found.triangle};
}

std::vector<std::optional<Sample>> SceneProbe::picture(const Camera& camera, int columns, int rows) const {
  const Vec3d eye = camera.eye.as<double>(), forward = normalized(camera.direction.as<double>());
  const Vec3d right = normalized(cross(forward, camera.up.as<double>())), up = cross(right, forward);
  const double pixel = 2 * half_height(camera.fov) / rows;
  std::vector<std::optional<Sample>> samples;
  for (int i = 0; i < columns * rows; ++i) {
    const double x = i % columns + 0.5 * (1 - columns), y = i / columns + 0.5 * (1 - rows);
    samples.push_back(hit(eye, normalized(forward + right * (x * pixel) + up * (-y * pixel))));
  }
  return samples;
}

Lit SceneProbe::lit(const std::vector<Sample>& samples, const Vec3& light) const {
  Lit result;
  int seen = 0, dark = 0;
  for (const Sample& sample : samples) {
    const double diffuse = brightest(scene_.materials[scene_.triangle_materials[sample.triangle]].kd);
    if (diffuse < 2 * kBlack) continue;
    ++seen;
    const double offset = offset_share(1) * (largest_of(sample.point) + sample.distance);
    const Vec3 origin = (sample.point + sample.normal * offset).as<float>();
    const Vec3d way = light.as<double>() - origin.as<double>();
    const double cosine = dot(sample.normal, way) / std::max(length(way), 1e-37);
    if (!(cosine * diffuse > kBlack) || traversal_.occluded({origin, way.as<float>(), 1})) {
      ++dark;
    } else {
      result.light += cosine;
    }
  }
  if (seen > 0) result.dark = static_cast<double>(dark) / seen;
  return result;
}

double SceneProbe::open_share(const Vec3d& point, const Vec3d& normal) const {
  const Vec3 origin = (point + normal * (1e-4 * diagonal_)).as<float>();
  int tried = 0, open = 0;
  for (const Vec3d& towards : all_around()) {
    if (dot(towards, normal) < 0.2) continue;
    ++tried;
    open += !traversal_.occluded({origin, towards.as<float>(), INFINITY});
  }
  return tried == 0 ? 0 : static_cast<double>(open) / tried;
}

}  // namespace raypool
