// What only shader sets see of a glTF document: materials with textures, the texture coordinates that they use, lights.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/losses.hpp"
#include "scene/surfaces.hpp"

namespace raypool {

/// Which texture coordinates of the file textures of a material use, and what KHR_texture_transform makes of them.
struct GltfTexcoords {
  size_t set = 0;
  Texcoord offset{0, 0}, scale{1, 1};
  float rotation = 0;  ///< radians

  bool operator==(const GltfTexcoords& other) const {
    return set == other.set && offset == other.offset && scale == other.scale && rotation == other.rotation;
  }
  Texcoord operator()(const Texcoord& uv) const;
};

/// Of a material: those of its base colour's texture, or else of another one that is used.
GltfTexcoords gltf_texcoords(const JsonPlace& material);

/// Adds all materials of the file, and the textures of those that are used. What cannot be used of them is counted in
/// `losses`, and images that cannot be read get a warning. Throws InputError naming the place.
void read_gltf_surfaces(GltfFile& file, const std::vector<bool>& used, Surfaces& surfaces, MaterialLosses& losses,
                        std::vector<std::string>& warnings);

}  // namespace raypool
