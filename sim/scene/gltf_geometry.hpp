// The shape of a glTF scene, from what its nodes use, as they stand: for Assimp, in plain glTF.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scene/gltf_accessors.hpp"
#include "scene/gltf_document.hpp"

namespace raypool {

class GltfGeometry {
 public:
  using Json = JsonPlace::Json;

  /// What is left out, by kind.
  struct Losses {
    size_t lines = 0, vertex_colours = 0, vertex_normals = 0, hidden = 0;
  };

  /// `surfaces`: vertices get their numbers, and the document what they have of normals, texture coordinates, colours.
  GltfGeometry(GltfFile& file, GltfDocument& document, bool surfaces)
      : file_(file), root_(file.root()), document_(document), accessors_(file), surfaces_(surfaces) {}

  /// Adds the nodes of the scene to the document. Throws InputError naming the place of what cannot be drawn.
  void add_scene();
  /// GltfDocument::geometry.
  Json json();
  const Losses& losses() const { return losses_; }
  /// [material] is used by triangles that are drawn.
  const std::vector<bool>& used() const { return used_; }

 private:
  /// An accessor of the geometry.
  struct Written {
    size_t accessor = 0, count = 0;
  };
  struct TriangleMesh {
    std::optional<size_t> index;  // in the geometry; none: it has no triangles
    uint64_t triangles = 0;
  };
  /// What a node makes of its mesh.
  struct Pose {
    std::vector<double> weights;                     // of the morph targets; empty: none counts
    const std::vector<Transform>* joints = nullptr;  // of its skin; null: none
    std::optional<bool> skinned;                     // the primitives that have joints alone, or those that have none
    std::string name;                                // the same for the same pose
  };

  Written write(const void* elements, size_t count, const char* type, int component, size_t bytes);
  Written positions(const JsonPlace& place, const Pose& pose);
  void morph(const JsonPlace& place, const Pose& pose, const char* attribute, std::vector<float>& values);
  void bend(const JsonPlace& place, const std::vector<Transform>& joints, std::vector<float>& positions);
  /// The numbers of a primitive's vertices, as an accessor; their surfaces' data are added to the document.
  Written surface_vertices(const JsonPlace& place, const Pose& pose, size_t count);
  std::vector<float> surface_values(const JsonPlace& attribute, const GltfForm& form, size_t count);
  /// And the largest of them.
  std::pair<Written, uint32_t> indices(const JsonPlace& accessor);
  /// Null for points and lines.
  Json primitive(const JsonPlace& place, const Pose& pose, uint64_t& triangles);
  TriangleMesh mesh(const JsonPlace& place, const Pose& pose);
  const std::vector<Transform>& joints_of(const JsonPlace& skin);
  /// Of a node of the file, with all that is above it.
  Transform place_of(size_t node);
  std::vector<Transform> instances(const JsonPlace& node);
  size_t add_node(const JsonPlace& place, size_t index, int depth, bool hidden);
  void add_content(const JsonPlace& place, GltfNode& node, bool hidden);
  void add_mesh(const JsonPlace& place, size_t number, Json& json);
  void use(const TriangleMesh& drawn, const GltfNode& node, const JsonPlace& place, Json& json);

  GltfFile& file_;
  const JsonPlace root_;
  GltfDocument& document_;
  GltfAccessors accessors_;
  const bool surfaces_;
  Losses losses_;
  std::vector<bool> used_;
  uint64_t triangles_ = 0;
  std::map<std::string, TriangleMesh> meshes_;                   // by place and pose
  std::map<std::string, Written> written_;                       // accessors without a pose, by place
  std::map<std::string, Written> vertices_;                      // numbers of vertices, by all that they are made of
  std::map<std::string, std::pair<Written, uint32_t>> indices_;  // and the largest of them
  std::map<std::string, std::vector<Transform>> skins_;          // by place
  std::set<std::string> counted_;                                // primitives: their losses have been
  std::set<size_t> reached_;                                     // nodes of the file
  std::optional<std::vector<std::optional<size_t>>> parents_;    // of all nodes of the file, once they are needed
  Json json_nodes_ = Json::array(), json_meshes_ = Json::array(), json_accessors_ = Json::array(),
       json_views_ = Json::array(), json_buffers_ = Json::array();
  Json roots_ = Json::array();
};

}  // namespace raypool
