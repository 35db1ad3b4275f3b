// A glTF 2.0 document, checked: what of it is drawn, and a sentence for each kind of thing that is not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/scene.hpp"

namespace raypool {

struct GltfCamera {
  std::string name;          ///< empty: none
  std::optional<float> fov;  ///< vertical, degrees; none: orthographic
};

struct GltfLight {
  std::string name, type;  ///< point, spot or directional
  Vec3 color;
  double intensity = 1;
};

/// Indices into the document's lists.
struct GltfNode {
  std::string name;
  std::optional<size_t> camera, light;
};

struct GltfDocument {
  /// glTF with the geometry alone, for Assimp: every accessor lies within its buffer, every index within its
  /// positions, every position is finite; nodes and materials are named by their place in `nodes` and `materials`.
  /// The uri of a buffer is its number in the file.
  std::string geometry;
  std::vector<GltfNode> nodes;
  std::vector<Material> materials;
  std::vector<GltfCamera> cameras;
  std::vector<GltfLight> lights;
  std::vector<std::string> warnings;
};

/// Loads the buffers that the geometry needs. Throws InputError naming file, place and what to do.
GltfDocument read_gltf_document(GltfFile& file);

/// What of materials has no counterpart here: in how many of them.
struct GltfMaterialLosses {
  size_t textures = 0, emissive = 0, transparent = 0, extensions = 0;
};

/// The rule of docs/scenes.md, "glTF files".
Material read_gltf_material(const JsonPlace& place, size_t index, GltfMaterialLosses& losses);

}  // namespace raypool
