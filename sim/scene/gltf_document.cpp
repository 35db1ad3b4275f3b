// Assimp believes what a document says of itself: it reads beyond buffers, leaves out triangles whose indices are out
// of range, takes whole numbers for floats and follows nodes without end. So the document is checked here, and only the
// checked geometry is handed on.
#include "scene/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

#include "files/json_text.hpp"

namespace raypool {
namespace {

using Json = JsonPlace::Json;

constexpr uint64_t kLargestCount = uint64_t{1} << 31, kLargestBytes = uint64_t{1} << 40;
constexpr uint64_t kMostTriangles = 100'000'000;
constexpr int kDeepest = 1000;
constexpr double kFar = kLargestCoordinate;
constexpr int kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;

/// An accessor in the geometry, and where its elements are.
struct Elements {
  size_t accessor = 0, count = 0, stride = 0;
  int component = 0;
  const char* first = nullptr;
};

struct TriangleMesh {
  std::optional<size_t> index;  // in the geometry; none: it has no triangles
  uint64_t triangles = 0;
};

/// What is left out of the geometry, by kind.
struct Losses {
  size_t lines = 0, vertex_colours = 0, morphing = 0, skinned = 0, instanced = 0;
};

/// Builds the geometry from what the nodes of the scene use.
class Geometry {
 public:
  Geometry(GltfFile& file, GltfDocument& document) : file_(file), root_(file.root()), document_(document) {}

  void add_scene();
  Json json();
  const Losses& losses() const { return losses_; }
  /// [material] is used by triangles that are drawn.
  const std::vector<bool>& used() const { return used_; }

 private:
  Elements elements(const JsonPlace& accessor, size_t components, const std::vector<int>& types);
  Elements positions(const JsonPlace& place);
  void check_indices(const JsonPlace& place, const Elements& indices, size_t vertices) const;
  /// Null for points and lines.
  Json primitive(const JsonPlace& place, uint64_t& triangles);
  TriangleMesh mesh(const JsonPlace& place);
  size_t add_node(const JsonPlace& place, size_t index, int depth);
  Json transform(const JsonPlace& place) const;
  void add_content(const JsonPlace& place, GltfNode& node, Json& json);

  GltfFile& file_;
  const JsonPlace root_;
  GltfDocument& document_;
  Losses losses_;
  std::vector<bool> used_;
  uint64_t triangles_ = 0;
  std::map<std::string, TriangleMesh> meshes_;  // by place
  std::map<std::string, Elements> known_;       // accessors, by place
  std::map<size_t, size_t> buffer_;             // of the file -> of the geometry
  std::map<size_t, bool> reached_;              // nodes of the file
  Json json_nodes_ = Json::array(), json_meshes_ = Json::array(), json_accessors_ = Json::array(),
       json_views_ = Json::array(), json_buffers_ = Json::array();
  Json roots_ = Json::array();
};

size_t component_bytes(int type) { return type == kUnsignedByte ? 1 : type == kUnsignedShort ? 2 : 4; }

/// Each accessor gets a view of its own, of whole strides.
Elements Geometry::elements(const JsonPlace& accessor, size_t components, const std::vector<int>& types) {
  const auto known = known_.find(accessor.where());
  if (known != known_.end()) return known->second;
  if (accessor.find("sparse")) accessor.fail("is sparse, which is not read; export the file without sparse accessors");
  const JsonPlace type = accessor.at("componentType");
  const int component = type.whole(0, 65535);
  if (std::find(types.begin(), types.end(), component) == types.end() ||
      accessor.at("type").text() != (components == 3 ? "VEC3" : "SCALAR")) {
    type.fail(components == 3 ? "must be 5126 and the type VEC3: positions are three floats each; export them as such"
                              : "must be 5121, 5123 or 5125 and the type SCALAR: indices are whole numbers");
  }
  const JsonPlace view = accessor.at("bufferView").in(root_, "bufferViews");
  const JsonPlace number = view.at("buffer"), buffer = number.in(root_, "buffers");
  const size_t index = number.whole(0, kLargestCount);
  const auto optional_bytes = [](const JsonPlace& place, const char* key) {
    const std::optional<JsonPlace> found = place.find(key);
    return found ? found->whole(0, kLargestBytes) : 0;
  };
  const std::string& bytes = file_.buffer(buffer, index);
  const uint64_t size = components * component_bytes(component), count = accessor.at("count").whole(1, kLargestCount);
  const std::optional<JsonPlace> given = view.find("byteStride");
  const uint64_t stride = given ? given->whole(size, 252) : size;
  const uint64_t in_view = optional_bytes(accessor, "byteOffset"), offset = optional_bytes(view, "byteOffset");
  const uint64_t length = view.at("byteLength").whole(1, kLargestBytes);
  if (offset + length > bytes.size() - GltfFile::kPadding) {
    view.fail(fmt::format("goes to byte {} of a buffer of {}; export the file again", offset + length,
                          bytes.size() - GltfFile::kPadding));
  }
  if (in_view + (count - 1) * stride + size > length) {
    accessor.fail(fmt::format("needs {} bytes of a view of {}; export the file again",
                              in_view + (count - 1) * stride + size, length));
  }
  const auto added = buffer_.emplace(index, json_buffers_.size());
  if (added.second) json_buffers_.push_back({{"uri", std::to_string(index)}, {"byteLength", bytes.size()}});
  json_views_.push_back({{"buffer", added.first->second},
                         {"byteOffset", offset + in_view},
                         {"byteLength", count * stride},
                         {"byteStride", stride}});
  json_accessors_.push_back({{"bufferView", json_views_.size() - 1},
                             {"componentType", component},
                             {"count", count},
                             {"type", components == 3 ? "VEC3" : "SCALAR"}});
  const Elements result{json_accessors_.size() - 1, count, stride, component, bytes.data() + offset + in_view};
  known_.emplace(accessor.where(), result);
  return result;
}

Elements Geometry::positions(const JsonPlace& place) {
  const JsonPlace accessor = place.in(root_, "accessors");
  const bool checked = known_.count(accessor.where()) != 0;
  const Elements result = elements(accessor, 3, {kFloat});
  for (size_t i = 0; i < result.count && !checked; ++i) {
    std::array<float, 3> p{};
    std::memcpy(p.data(), result.first + i * result.stride, sizeof p);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
      place.fail(fmt::format("has vertex {} at ({}, {}, {}); coordinates must be finite: correct the mesh", i, p[0],
                             p[1], p[2]));
    }
  }
  return result;
}

void Geometry::check_indices(const JsonPlace& place, const Elements& indices, size_t vertices) const {
  for (size_t i = 0; i < indices.count; ++i) {
    std::array<uint8_t, 4> bytes{};
    std::memcpy(bytes.data(), indices.first + i * indices.stride, component_bytes(indices.component));
    const uint32_t index = bytes[0] | static_cast<uint32_t>(bytes[1]) << 8 | static_cast<uint32_t>(bytes[2]) << 16 |
                           static_cast<uint32_t>(bytes[3]) << 24;
    if (index >= vertices) {
      place.fail(
          fmt::format("has index {}, which is out of range: there are {} vertices; correct the mesh", index, vertices));
    }
  }
}

Json Geometry::primitive(const JsonPlace& place, uint64_t& triangles) {
  constexpr uint64_t kTriangles = 4, kFan = 6;  // between them: strips
  const std::optional<JsonPlace> given_mode = place.find("mode"), material = place.find("material"),
                                 indices = place.find("indices");
  const uint64_t mode = given_mode ? given_mode->whole(0, kFan) : kTriangles;
  if (mode < kTriangles) {
    ++losses_.lines;
    return nullptr;
  }
  const JsonPlace attributes = place.at("attributes"), position = attributes.at("POSITION");
  const Elements vertices = positions(position);
  Json json = {{"attributes", {{"POSITION", vertices.accessor}}}, {"mode", mode}};
  size_t corners = vertices.count;
  if (indices) {
    const Elements list = elements(indices->in(root_, "accessors"), 1, {kUnsignedByte, kUnsignedShort, kUnsignedInt});
    check_indices(*indices, list, vertices.count);
    corners = list.count;
    json["indices"] = list.accessor;
  }
  if (corners < 3 || (mode == kTriangles && corners % 3 != 0)) {
    place.fail(fmt::format("has {} corners, which make no triangles; {}", corners,
                           mode == kTriangles ? "give a multiple of three" : "give at least three"));
  }
  triangles += mode == kTriangles ? corners / 3 : corners - 2;
  if (material) {
    material->in(root_, "materials");
    const size_t index = material->whole(0, kLargestCount);
    json["material"] = index;
    used_.resize(std::max(used_.size(), index + 1));
    used_[index] = true;
  }
  losses_.vertex_colours += attributes.find("COLOR_0") ? 1 : 0;
  losses_.morphing += place.find("targets") ? 1 : 0;
  return json;
}

TriangleMesh Geometry::mesh(const JsonPlace& place) {
  const auto known = meshes_.find(place.where());
  if (known != meshes_.end()) return known->second;
  TriangleMesh result;
  const JsonPlace list = place.at("primitives");
  Json primitives = Json::array();
  for (size_t i = 0; i < list.size(); ++i) {
    Json json = primitive(list.at(i), result.triangles);
    if (!json.is_null()) primitives.push_back(std::move(json));
  }
  if (!primitives.empty()) {
    result.index = json_meshes_.size();
    json_meshes_.push_back({{"primitives", std::move(primitives)}});
  }
  meshes_.emplace(place.where(), result);
  return result;
}

/// Of numbers, as they stand.
Json numbers(const JsonPlace& place, size_t count) {
  if (place.size() != count) place.fail(fmt::format("has {} numbers; give {}", place.size(), count));
  Json result = Json::array();
  for (size_t i = 0; i < count; ++i) result.push_back(place.at(i).number(-kFar, kFar));
  return result;
}

/// The members of a node that say where it is.
Json Geometry::transform(const JsonPlace& place) const {
  Json json = Json::object();
  if (const std::optional<JsonPlace> matrix = place.find("matrix")) {
    json["matrix"] = numbers(*matrix, 16);
    for (const size_t i : {3, 7, 11, 15}) {
      if (json["matrix"][i] != (i == 15 ? 1 : 0)) matrix->fail("must end each column in 0, the last one in 1");
    }
    return json;
  }
  for (const char* key : {"translation", "scale"}) {
    if (const std::optional<JsonPlace> vector = place.find(key)) json[key] = numbers(*vector, 3);
  }
  if (const std::optional<JsonPlace> rotation = place.find("rotation")) {
    Json q = numbers(*rotation, 4);
    double square = 0;
    for (const Json& part : q) square += part.get<double>() * part.get<double>();
    if (!(square > 0)) rotation->fail("is zero; it must be a unit quaternion, x, y, z, w");
    for (Json& part : q) part = part.get<double>() / std::sqrt(square);
    json["rotation"] = q;
  }
  return json;
}

void Geometry::add_content(const JsonPlace& place, GltfNode& node, Json& json) {
  if (const std::optional<JsonPlace> name = place.find("name")) node.name = name->text();
  if (const std::optional<JsonPlace> index = place.find("camera")) {
    index->in(root_, "cameras");
    node.camera = index->whole(0, kLargestCount);
  }
  if (const std::optional<JsonPlace> extensions = place.find("extensions")) {
    if (const std::optional<JsonPlace> light = extensions->find("KHR_lights_punctual")) {
      const JsonPlace index = light->at("light");
      index.in(root_.at("extensions").at("KHR_lights_punctual"), "lights");
      node.light = index.whole(0, kLargestCount);
    }
    losses_.instanced += extensions->find("EXT_mesh_gpu_instancing") ? 1 : 0;
  }
  const std::optional<JsonPlace> index = place.find("mesh");
  if (!index) return;
  const TriangleMesh drawn = mesh(index->in(root_, "meshes"));
  if (drawn.index) json["mesh"] = *drawn.index;
  losses_.skinned += place.find("skin") ? 1 : 0;
  triangles_ += drawn.triangles;
  if (triangles_ > kMostTriangles)
    place.fail(fmt::format("brings the scene to {} triangles; {} are the most", triangles_, kMostTriangles));
}

/// Returns its index in the geometry.
size_t Geometry::add_node(const JsonPlace& place, size_t index, int depth) {
  if (!reached_.emplace(index, true).second) {
    place.fail("is the child of two nodes, or its own ancestor; nodes must form trees: export the file again");
  }
  if (depth > kDeepest) place.fail(fmt::format("has more than {} nodes above it; flatten the scene", kDeepest));
  const size_t number = document_.nodes.size();
  document_.nodes.emplace_back();
  json_nodes_.push_back(nullptr);
  Json json = transform(place);
  json["name"] = std::to_string(number);
  GltfNode node;
  add_content(place, node, json);
  document_.nodes[number] = node;
  if (const std::optional<JsonPlace> children = place.find("children")) {
    json["children"] = Json::array();
    for (size_t i = 0; i < children->size(); ++i) {
      const JsonPlace child = children->at(i), target = child.in(root_, "nodes");
      json["children"].push_back(add_node(target, child.whole(0, kLargestCount), depth + 1));
    }
    if (json["children"].empty()) json.erase("children");
  }
  json_nodes_[number] = std::move(json);
  return number;
}

/// The scene that the file names, or else its first one; without any, all nodes that are nobody's children.
void Geometry::add_scene() {
  const std::optional<JsonPlace> scenes = root_.find("scenes"), chosen = root_.find("scene");
  if (scenes && scenes->size() > 0) {
    const JsonPlace scene = chosen ? chosen->in(root_, "scenes") : scenes->at(size_t{0});
    if (scenes->size() > 1)
      document_.warnings.push_back(fmt::format("{} alone is drawn, of {} scenes", scene.where(), scenes->size()));
    const std::optional<JsonPlace> nodes = scene.find("nodes");
    for (size_t i = 0; nodes && i < nodes->size(); ++i) {
      const JsonPlace node = nodes->at(i), target = node.in(root_, "nodes");
      roots_.push_back(add_node(target, node.whole(0, kLargestCount), 0));
    }
    return;
  }
  const std::optional<JsonPlace> nodes = root_.find("nodes");
  std::vector<bool> is_child(nodes ? nodes->size() : 0);
  for (size_t i = 0; i < is_child.size(); ++i) {
    const std::optional<JsonPlace> children = nodes->at(i).find("children");
    for (size_t k = 0; children && k < children->size(); ++k)
      is_child[children->at(k).whole(0, is_child.size() - 1)] = true;
  }
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots_.push_back(add_node(nodes->at(i), i, 0));
  }
}

Json Geometry::json() {
  if (triangles_ == 0) {
    throw InputError(fmt::format("{}: the scene has no triangles{}; nothing can be rendered", file_.path(),
                                 losses_.lines > 0 ? ", only points or lines" : ""));
  }
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", roots_}}}}};
  json["nodes"] = std::move(json_nodes_);
  json["meshes"] = std::move(json_meshes_);
  json["accessors"] = std::move(json_accessors_);
  json["bufferViews"] = std::move(json_views_);
  json["buffers"] = std::move(json_buffers_);
  json["materials"] = Json::array();
  for (size_t i = 0; i < document_.materials.size(); ++i) json["materials"].push_back({{"name", std::to_string(i)}});
  return json;
}

/// Extensions without which the file means something else than what would be drawn.
void check_extensions(const JsonPlace& root) {
  const std::optional<JsonPlace> required = root.find("extensionsRequired");
  for (size_t i = 0; required && i < required->size(); ++i) {
    const std::string name = required->at(i).text();
    // Of materials and textures everything that has no counterpart is left out, and told.
    const std::vector<std::string> harmless = {"KHR_lights_punctual", "KHR_materials_", "KHR_texture_", "EXT_texture_",
                                               "MSFT_texture_",       "KHR_animation_", "KHR_xmp"};
    if (std::none_of(harmless.begin(), harmless.end(),
                     [&](const std::string& start) { return name.rfind(start, 0) == 0; }))
      required->at(i).fail(fmt::format("is {}, which is not read; export the file without it", name));
  }
}

void read_cameras(const JsonPlace& root, std::vector<GltfCamera>& cameras) {
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  const std::optional<JsonPlace> list = root.find("cameras");
  for (size_t i = 0; list && i < list->size(); ++i) {
    const JsonPlace place = list->at(i);
    GltfCamera camera;
    if (const std::optional<JsonPlace> name = place.find("name")) camera.name = name->text();
    const JsonPlace type = place.at("type");
    if (type.text() == "perspective") {
      const JsonPlace yfov = place.at("perspective").at("yfov");
      camera.fov = static_cast<float>(yfov.number(kLeastFov / kDegrees, kLargestFov / kDegrees) * kDegrees);
    } else if (type.text() != "orthographic") {
      type.fail(fmt::format("is '{}'; it must be perspective or orthographic", type.text()));
    }
    cameras.push_back(camera);
  }
}

void read_lights(const JsonPlace& root, std::vector<GltfLight>& lights) {
  const std::optional<JsonPlace> extensions = root.find("extensions");
  const std::optional<JsonPlace> punctual = extensions ? extensions->find("KHR_lights_punctual") : std::nullopt;
  const std::optional<JsonPlace> list = punctual ? punctual->find("lights") : std::nullopt;
  for (size_t i = 0; list && i < list->size(); ++i) {
    const JsonPlace place = list->at(i), type = place.at("type");
    GltfLight light{"", type.text(), {1, 1, 1}, 1};
    if (light.type != "point" && light.type != "spot" && light.type != "directional")
      type.fail(fmt::format("is '{}'; it must be point, spot or directional", light.type));
    if (const std::optional<JsonPlace> name = place.find("name")) light.name = name->text();
    if (const std::optional<JsonPlace> color = place.find("color")) {
      if (color->size() != 3) color->fail(fmt::format("has {} numbers; give 3", color->size()));
      for (size_t k = 0; k < 3; ++k)
        light.color[static_cast<int>(k)] = static_cast<float>(color->at(k).number(0, 1000));
    }
    if (const std::optional<JsonPlace> intensity = place.find("intensity"))
      light.intensity = intensity->number(0, 1e30);
    lights.push_back(light);
  }
}

/// "a.gltf: 1 material has ..., 3 materials have ..."; nothing of none.
void warn(GltfDocument& document, const GltfFile& file, size_t count, const char* one, const char* several,
          const std::string& rest) {
  if (count == 0) return;
  document.warnings.push_back(fmt::format("{}: {} {}{}", file.path(), count, count == 1 ? one : several, rest));
}

void read_materials(const JsonPlace& root, const std::vector<bool>& used, GltfDocument& document,
                    const GltfFile& file) {
  const std::optional<JsonPlace> list = root.find("materials");
  GltfMaterialLosses losses, unused;
  for (size_t i = 0; list && i < list->size(); ++i) {
    document.materials.push_back(read_gltf_material(list->at(i), i, i < used.size() && used[i] ? losses : unused));
  }
  const char *one = "material ", *several = "materials ";
  warn(document, file, losses.textures, one, several, "with textures: the factors beside them are used alone");
  warn(document, file, losses.emissive, one, several, "with emission, which is not used: the one light is a point");
  warn(document, file, losses.transparent, one, several, "with transparency, drawn opaque");
  warn(document, file, losses.extensions, one, several, "with extensions (KHR_materials_...), which are not used");
}

void warn_of_geometry(GltfDocument& document, const GltfFile& file, const Losses& losses) {
  const auto animations = file.root().find("animations");
  const char *one = "primitive ", *several = "primitives ";
  warn(document, file, losses.lines, one, several, "of points or lines, not drawn");
  warn(document, file, losses.vertex_colours, one, several, "with vertex colours, which are not used");
  warn(document, file, losses.morphing, one, several, "with morph targets, drawn without them");
  warn(document, file, losses.skinned, "node ", "nodes ", "with a skin, drawn as the mesh stands without its joints");
  warn(document, file, losses.instanced, "node ", "nodes ", "with EXT_mesh_gpu_instancing, drawn once each");
  warn(document, file, animations ? animations->size() : 0, "animation ", "animations ",
       "not played: all is where the nodes are");
}

}  // namespace

GltfDocument read_gltf_document(GltfFile& file) {
  const JsonPlace root = file.root(), version = root.at("asset").at("version");
  if (version.text().rfind("2.", 0) != 0)
    version.fail(fmt::format("is '{}'; export the file as glTF 2.0", version.text()));
  check_extensions(root);
  GltfDocument document;
  read_cameras(root, document.cameras);
  read_lights(root, document.lights);
  Geometry geometry(file, document);
  geometry.add_scene();
  read_materials(root, geometry.used(), document, file);
  document.geometry = to_text(geometry.json(), -1);
  warn_of_geometry(document, file, geometry.losses());
  return document;
}

}  // namespace raypool
