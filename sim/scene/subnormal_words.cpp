#include "scene/subnormal_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "bits.hpp"
#include "kernel/kernels.hpp"

namespace raypool {
namespace {

/// "the coordinate y 1e-39", if the axis of that name has a subnormal number.
std::optional<std::string> subnormal_in(const Vec3& v, const char* what, const char* names) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::fpclassify(v[axis]) == FP_SUBNORMAL) return fmt::format("has the {} {} {}", what, names[axis], v[axis]);
  return std::nullopt;
}

std::string in_triangles(const Scene& scene) {
  for (size_t t = 0; t < scene.triangles.size(); ++t) {
    const std::string& material = scene.materials[scene.triangle_materials[t]].name;
    for (const uint32_t vertex : scene.triangles[t])
      if (const auto found = subnormal_in(scene.vertices[vertex], "coordinate", "xyz"))
        return fmt::format("vertex {}, a corner of triangle {} (material '{}'), {}", vertex, t, material, *found);
    if (is_degenerate(scene, t)) continue;
    if (const auto found = subnormal_in(scene.normal(t), "coordinate", "xyz"))
      return fmt::format("the normal of triangle {} (material '{}') {}", t, material, *found);
  }
  return "";
}

}  // namespace

std::string subnormal_word(const Scene& scene, const std::array<uint32_t, kArguments>& arguments) {
  for (const Material& material : scene.materials) {
    if (const auto found = subnormal_in(material.kd, "Kd", "rgb"))
      return fmt::format("material '{}' {}", material.name, *found);
    if (const auto found = subnormal_in(material.ks, "Ks", "rgb"))
      return fmt::format("material '{}' {}", material.name, *found);
  }
  if (const auto found = subnormal_in(scene.light.position, "coordinate", "xyz"))
    return fmt::format("the light {}", *found);
  if (const auto found = subnormal_in(scene.light.color, "color", "rgb")) return fmt::format("the light {}", *found);
  if (const auto found = subnormal_in(scene.camera.eye, "coordinate", "xyz"))
    return fmt::format("the camera's eye {}", *found);
  // What else the camera makes of the image: directions of the first ray and the steps from ray to ray.
  for (int n = argument::kCorner; n < argument::kTileWidthLog2; ++n) {
    if (std::fpclassify(as_float(arguments[n])) != FP_SUBNORMAL) continue;
    return fmt::format("the camera makes {} of its direction (kernel argument {})", as_float(arguments[n]), n);
  }
  return in_triangles(scene);
}

}  // namespace raypool
