// A glTF 2.0 document, checked: what of it is drawn, and a sentence for each kind of thing that is not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/losses.hpp"
#include "scene/mesh_builder.hpp"
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
  double range = 0;                                    ///< 0: without end
  double inner_cone = 0, outer_cone = 0.785398163397;  ///< of a spot: angles, radians
};

/// Indices into the document's lists.
struct GltfNode {
  std::string name;
  std::optional<size_t> camera, light;
  Transform transform;               ///< from its own coordinates to its parent's, in double
  std::vector<Transform> instances;  ///< in the node, of its mesh; empty: it is there once
  bool skinned = false;              ///< the mesh stands where its joints have it: no node above it counts
};

struct GltfDocument {
  /// glTF with the geometry alone, for Assimp: positions are floats, where morph targets and joints have them, and
  /// finite; indices are within them. Nodes and materials are named by their place in `nodes` and `materials`, buffers
  /// by theirs in `buffers`.
  std::string geometry;
  std::vector<std::string> buffers;
  std::vector<GltfNode> nodes;
  std::vector<Material> materials;
  std::vector<GltfCamera> cameras;
  std::vector<GltfLight> lights;
  std::vector<std::string> warnings;

  /// What only surfaces have; empty unless they are asked for. Materials, textures and images are whole, and vertices
  /// are those of the geometry: each has the number of its own as TEXCOORD_0, bits 15:0 and 31:16.
  Surfaces surfaces;
};

/// Throws InputError naming file, place and what to do.
GltfDocument read_gltf_document(const std::string& path, bool surfaces = false);

/// The rule of docs/use/scenes.md, "glTF files".
Material read_gltf_material(const JsonPlace& place, size_t index, MaterialLosses& losses);

}  // namespace raypool
