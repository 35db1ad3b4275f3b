// Assimp trusts what a document declares: it reads beyond buffers, leaves out triangles with indices out of range,
// takes whole numbers for floats, follows nodes without end and poses skins wrongly. So the document is checked here,
// and only plain geometry is handed on.
#include "scene/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "files/json_text.hpp"
#include "scene/gltf_geometry.hpp"
#include "scene/gltf_surface.hpp"
#include "scene/losses.hpp"

namespace raypool {
namespace {

/// Extensions without which the file means something else than what would be drawn.
void check_extensions(const JsonPlace& root) {
  const std::optional<JsonPlace> required = root.find("extensionsRequired");
  for (size_t i = 0; required && i < required->size(); ++i) {
    const std::string name = required->at(i).text();
    // These are read; of materials and textures everything that has no counterpart is left out, and reported.
    const std::vector<std::string> harmless = {
        "KHR_lights_punctual",     "KHR_materials_",     "KHR_texture_", "EXT_texture_",
        "MSFT_texture_",           "KHR_animation_",     "KHR_xmp",      "KHR_mesh_quantization",
        "EXT_mesh_gpu_instancing", "KHR_node_visibility"};
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

/// Where it shines.
void read_reach(const JsonPlace& place, GltfLight& light) {
  if (const std::optional<JsonPlace> range = place.find("range")) light.range = range->number(0, 1e30);
  constexpr double kRight = 1.57079632679489662;
  const std::optional<JsonPlace> spot = place.find("spot");
  if (light.type != "spot" || !spot) return;
  const auto read = [&](const char* key, double& angle) {
    if (const std::optional<JsonPlace> given = spot->find(key)) angle = given->number(0, kRight + 1e-6);
  };
  read("innerConeAngle", light.inner_cone);
  read("outerConeAngle", light.outer_cone);
  light.inner_cone = std::min(light.inner_cone, light.outer_cone);
}

void read_lights(const JsonPlace& root, std::vector<GltfLight>& lights, bool surfaces) {
  const std::optional<JsonPlace> extensions = root.find("extensions");
  const std::optional<JsonPlace> punctual = extensions ? extensions->find("KHR_lights_punctual") : std::nullopt;
  const std::optional<JsonPlace> list = punctual ? punctual->find("lights") : std::nullopt;
  for (size_t i = 0; list && i < list->size(); ++i) {
    const JsonPlace place = list->at(i), type = place.at("type");
    GltfLight light{"", type.text(), {1, 1, 1}};
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
    if (surfaces) read_reach(place, light);
    lights.push_back(light);
  }
}

void read_materials(const JsonPlace& root, const std::vector<bool>& used, GltfDocument& document, GltfFile& file,
                    bool surfaces) {
  const std::optional<JsonPlace> list = root.find("materials");
  MaterialLosses losses, unused;
  for (size_t i = 0; list && i < list->size(); ++i) {
    document.materials.push_back(read_gltf_material(list->at(i), i, i < used.size() && used[i] ? losses : unused));
  }
  if (surfaces) {
    const size_t beyond = losses.beyond;
    losses = {};
    losses.beyond = beyond;
    read_gltf_surfaces(file, used, document.surfaces, losses, document.warnings);
  }
  tell_losses(document.warnings, file.path(), losses);
}

void warn_of_geometry(GltfDocument& document, const GltfFile& file, const GltfGeometry::Losses& losses) {
  const auto animations = file.root().find("animations");
  std::vector<std::string>& warnings = document.warnings;
  tell_loss(warnings, file.path(), losses.lines, "primitive", Loss::PointsOrLines);
  tell_loss(warnings, file.path(), losses.vertex_colours, "primitive", Loss::VertexColours);
  tell_loss(warnings, file.path(), losses.vertex_normals, "primitive", Loss::VertexNormals);
  tell_count(warnings, file.path(), losses.hidden, "node", "that is hidden (KHR_node_visibility), not drawn",
             "that are hidden (KHR_node_visibility), not drawn");
  tell_loss(warnings, file.path(), animations ? animations->size() : 0, "animation", Loss::Animations);
}

}  // namespace

GltfDocument read_gltf_document(const std::string& path, bool surfaces) {
  GltfFile file(path);
  const JsonPlace root = file.root(), version = root.at("asset").at("version");
  if (version.text().rfind("2.", 0) != 0)
    version.fail(fmt::format("is '{}'; export the file as glTF 2.0", version.text()));
  check_extensions(root);
  GltfDocument document;
  read_cameras(root, document.cameras);
  read_lights(root, document.lights, surfaces);
  GltfGeometry geometry(file, document, surfaces);
  geometry.add_scene();
  read_materials(root, geometry.used(), document, file, surfaces);
  document.geometry = to_text(geometry.json(), -1);
  warn_of_geometry(document, file, geometry.losses());
  return document;
}

}  // namespace raypool
