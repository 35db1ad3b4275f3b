// Readers of scene files that may bring their own camera and light. docs/use/scenes.md describes what they read.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.hpp"

namespace raypool {

struct SceneFile {
  Scene scene;  ///< its camera and light mean nothing
  std::optional<Camera> camera;
  std::optional<PointLight> light;
  std::optional<Vec3> up;  ///< as the format defines
};

/// glTF 2.0, text or binary. `camera`: name of a camera or of its node; empty: the first one that can be used.
/// `surfaces`: as SceneOptions have it, here and below. Throws InputError.
SceneFile load_gltf(const std::string& path, const std::string& camera = "", bool surfaces = false);

/// PLY, text or binary. Throws InputError naming file and place.
Scene load_ply(const std::string& path, bool surfaces = false);

/// Vertices at the same place become one, in the order in which triangles use them; those that none uses are left out.
void weld_vertices(Scene& scene);

}  // namespace raypool
