// How much of each light's light falls on what a frame shows. Lights are then chosen for shadow rays by what they do,
// not by their power: most of a sun's falls on roofs, and a lamp in another room shines on its walls.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "scene/shader_lights.hpp"
#include "scene/shader_memory.hpp"
#include "scene/traversal.hpp"

namespace raypool {

class LightSurvey {
 public:
  /// Sends a few hundred paths of a few segments from the camera. `scene` must outlive it. The same each time.
  LightSurvey(const Scene& scene, const ShaderFrame& frame);

  /// The root mean square, over the places where paths came to, of the irradiance (luminance) by one of `lights`,
  /// which is chosen in proportion to its weight: it counts divided by its probability. 0: none of them shines on any.
  double strength(const std::vector<ShaderLight>& lights, const std::vector<double>& weights);

 private:
  struct Place {
    Vec3d point;   // off the surface, where rays leave it
    Vec3d normal;  // unit length, on the side from which the path came
    double counts;
  };
  double uniform() { return static_cast<double>(random_()) / 0x1p32; }
  std::optional<Place> met(const Vec3d& origin, const Vec3d& direction) const;
  void follow(Vec3d origin, Vec3d direction);
  double irradiance(const ShaderLight& light, double probability, const Place& place);
  bool is_free(const Place& place, const Vec3d& to_light) const;

  Traversal traversal_;
  double offset_, far_;
  std::mt19937 random_;
  std::vector<Place> places_;
};

}  // namespace raypool
