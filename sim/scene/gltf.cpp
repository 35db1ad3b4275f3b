// glTF files as scenes: Assimp decodes the geometry that read_gltf_document() has checked, and here meshes are put
// where the nodes have them, with the camera and the light.
#include <assimp/MemoryIOWrapper.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>

#include "bits.hpp"
#include "isa/did_you_mean.hpp"
#include "scene/far_places.hpp"
#include "scene/gltf_document.hpp"
#include "scene/mesh_builder.hpp"
#include "scene/scene_file.hpp"

namespace raypool {
namespace {

constexpr const char* kGeometryName = "geometry.gltf";
constexpr double kDistantLight = 100;  // diagonals of the box, from which a point lights as a direction does

/// The number that is all of `text`.
std::optional<size_t> number_in(const aiString& text) {
  size_t value = 0;
  const char* const end = text.C_Str() + text.length;
  const auto result = std::from_chars(text.C_Str(), end, value);
  return result.ec == std::errc() && result.ptr == end ? std::optional(value) : std::nullopt;
}

/// What Assimp may open: the document's geometry and its buffers, all in memory.
class GltfMemory : public Assimp::IOSystem {
 public:
  explicit GltfMemory(const GltfDocument& document) : document_(document) {}

  bool Exists(const char* name) const override { return find(name) != nullptr; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char*) override {
    const std::string* bytes = find(name);
    if (bytes == nullptr) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes->data()), bytes->size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const std::string* find(const char* name) const {
    if (std::strcmp(name, kGeometryName) == 0) return &document_.geometry;
    const std::optional<size_t> index = number_in(aiString(name));
    return index && *index < document_.buffers.size() ? &document_.buffers[*index] : nullptr;
  }

  const GltfDocument& document_;
};

Transform to_transform(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}, {m.a4, m.b4, m.c4}};
}

/// A node with a camera or a light, and where it is.
struct Placed {
  size_t index;
  std::string node;
  Transform transform;
};

/// Of all nodes together.
struct Assembly {
  Scene scene;  ///< without vertices
  FilePlaces places;
  Surfaces surfaces;  ///< without positions; empty unless they are asked for
  std::vector<Placed> cameras, lights;
};

/// Nodes are where Assimp has them, in single precision; `exact`: where the file has them.
class Assembler {
 public:
  Assembler(const aiScene& source, const GltfDocument& document, bool surfaces, bool exact, Assembly& result)
      : source_(source), document_(document), surfaces_(surfaces), exact_(exact), result_(result) {}

  void add(const aiNode& node, const Transform& above) {
    // The root above several nodes is Assimp's own, without a number.
    const std::optional<size_t> number = number_in(node.mName);
    const Transform here =
        above * (exact_ && number ? document_.nodes.at(*number).transform : to_transform(node.mTransformation));
    if (number) {
      const GltfNode& content = document_.nodes.at(*number);
      const Transform place = content.skinned ? Transform() : here;
      for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& mesh = *source_.mMeshes[node.mMeshes[i]];
        if (content.instances.empty()) add(mesh, place);
        for (const Transform& instance : content.instances) add(mesh, place * instance);
      }
      if (content.camera) result_.cameras.push_back({*content.camera, content.name, here});
      if (content.light) result_.lights.push_back({*content.light, content.name, here});
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], here);
  }

 private:
  void add(const aiMesh& mesh, const Transform& here) {
    Scene& scene = result_.scene;
    const auto first = static_cast<uint32_t>(result_.places.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      result_.places.add(here({v.x, v.y, v.z}));
    }
    if (surfaces_) add_surfaces(mesh, here);
    // A mirrored mesh is wound the other way round.
    const bool mirrored = dot(cross(here.x, here.y), here.z) < 0;
    const uint32_t material = material_of(mesh);
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const unsigned* corners = mesh.mFaces[i].mIndices;
      scene.triangles.push_back(
          {first + corners[0], first + corners[mirrored ? 2 : 1], first + corners[mirrored ? 1 : 2]});
      scene.triangle_materials.push_back(material);
    }
  }

  void add_surfaces(const aiMesh& mesh, const Transform& here) {
    const Transform turn = here.of_normals();
    const Surfaces& from = document_.surfaces;
    if (mesh.mTextureCoords[0] == nullptr) throw InputError("a mesh has lost its vertices' numbers");
    Surfaces& to = result_.surfaces;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      // Assimp turns v round.
      const aiVector3D& number = mesh.mTextureCoords[0][i];
      const size_t vertex = static_cast<size_t>(number.x) | static_cast<size_t>(1 - number.y) << 16;
      const Vec3d normal = turn(from.normals[vertex].as<double>());
      const double size = length(normal);
      to.normals.push_back(size > 0 ? (normal * (1 / size)).as<float>() : Vec3{});
      to.texcoords.push_back(from.texcoords[vertex]);
      to.colors.push_back(from.colors[vertex]);
    }
  }

  /// Meshes without one get the grey of other formats, behind the file's own.
  uint32_t material_of(const aiMesh& mesh) {
    const std::optional<size_t> own = number_in(source_.mMaterials[mesh.mMaterialIndex]->GetName());
    std::vector<Material>& materials = result_.scene.materials;
    if (own) return static_cast<uint32_t>(*own);
    if (materials.size() == document_.materials.size()) materials.push_back({"default_grey", {0.5f, 0.5f, 0.5f}, {}});
    return static_cast<uint32_t>(materials.size() - 1);
  }

  const aiScene& source_;
  const GltfDocument& document_;
  const bool surfaces_, exact_;
  Assembly& result_;
};

Assembly assemble(const aiScene& source, const std::string& path, const GltfDocument& document, bool surfaces,
                  bool exact) {
  Assembly result;
  result.scene.name = std::filesystem::path(path).stem().string();
  result.scene.materials = document.materials;
  Assembler(source, document, surfaces, exact, result).add(*source.mRootNode, {});
  return result;
}

std::vector<uint32_t> used_corners(const Scene& scene) {
  std::vector<uint32_t> corners;
  for (const auto& triangle : scene.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

Assembly assemble(const std::string& path, const GltfDocument& document, bool surfaces) {
  Assimp::Importer importer;
  importer.SetIOHandler(new GltfMemory(document));
  const aiScene* source = importer.ReadFile(kGeometryName, 0);
  if (source == nullptr) {
    throw InputError(
        fmt::format("{}: not a readable glTF file ({}); export it again", path, importer.GetErrorString()));
  }
  Assembly result = assemble(*source, path, document, surfaces, false);
  const Vec3d centre = result.places.centre(used_corners(result.scene));
  if (!(centre == Vec3d{})) result = assemble(*source, path, document, surfaces, true);
  result.places.put_into(result.scene, centre);
  return result;
}

std::string name_of(const std::string& own, const std::string& node, const char* kind, size_t index) {
  return !own.empty() ? own : !node.empty() ? node : fmt::format("{}_{}", kind, index);
}

/// The camera that is asked for, or the first one that is ours too; none: the file has none such.
std::optional<Camera> choose_camera(const std::string& path, const std::string& wanted, const GltfDocument& document,
                                    const Assembly& assembly, Scene& scene) {
  const Placed* chosen = nullptr;
  size_t orthographic = 0;
  std::vector<std::string> names;
  for (const Placed& placed : assembly.cameras) {
    const GltfCamera& camera = document.cameras[placed.index];
    const std::string name = name_of(camera.name, placed.node, "camera", placed.index);
    names.push_back(name);
    const bool is_wanted = name == wanted || placed.node == wanted;
    if (!camera.fov) ++orthographic;
    if (!wanted.empty() && is_wanted && !camera.fov)
      throw InputError(fmt::format("{}: camera '{}' is orthographic, which ours is not; choose another", path, wanted));
    if (chosen == nullptr && camera.fov && (wanted.empty() || is_wanted)) {
      chosen = &placed;
      scene.cameras.insert(scene.cameras.begin(), name);
    } else {
      scene.cameras.push_back(name);
    }
  }
  if (chosen == nullptr && !wanted.empty()) {
    throw InputError(
        names.empty()
            ? fmt::format("{}: there is no camera in it; leave --camera '{}' out", path, wanted)
            : fmt::format("{}: there is no camera '{}' in it{}", path, wanted,
                          did_you_mean(wanted, names, fmt::format("its cameras are {}", fmt::join(names, ", ")))));
  }
  if (chosen == nullptr) {
    scene.cameras.clear();
    if (orthographic > 0) {
      scene.warnings.push_back(fmt::format("{}: {} orthographic, which ours is not: the view is chosen automatically",
                                           path, orthographic == 1 ? "the camera is" : "all cameras are"));
    }
    return std::nullopt;
  }
  const Transform& at = chosen->transform;
  Camera camera{from_file(scene.centre, at.origin), (at.z * -1.0).as<float>(), at.y.as<float>(),
                *document.cameras[chosen->index].fov};
  check_camera(camera, fmt::format("{}: camera '{}'", path, scene.cameras.front()), scene.centre);
  return camera;
}

/// The first point light, or else the first spot, or else the first directional one.
std::optional<PointLight> choose_light(const std::string& path, const GltfDocument& document, const Assembly& assembly,
                                       Scene& scene) {
  const Placed* chosen = nullptr;
  for (const char* type : {"point", "spot", "directional"}) {
    for (const Placed& placed : assembly.lights) {
      if (chosen == nullptr && document.lights[placed.index].type == type) chosen = &placed;
    }
  }
  if (chosen == nullptr) return std::nullopt;
  const GltfLight& light = document.lights[chosen->index];
  Vec3d position = chosen->transform.origin - scene.centre;
  std::string lost = fmt::format("fall-off and intensity ({:g})", light.intensity);
  if (light.type == "spot") lost += " and cone";
  if (light.type == "directional") {
    const Bounds bounds = scene.bounds();
    const Vec3d backwards = chosen->transform.z;
    if (!(length(backwards) > 0)) throw InputError(path + ": the node of a directional light has a scale of zero");
    position = (bounds.lower.as<double>() + bounds.upper.as<double>()) * 0.5 +
               normalized(backwards) * (kDistantLight * static_cast<double>(bounds.diagonal()));
    lost = fmt::format("intensity ({:g})", light.intensity);
  }
  if (scene.surfaces) return PointLight{position.as<float>(), light.color};  // which have all of it
  scene.warnings.push_back(fmt::format("{}: the light is '{}' ({}), as a point with its colour: its {} {} not used",
                                       path, name_of(light.name, chosen->node, "light", chosen->index), light.type,
                                       lost, light.type == "directional" ? "is" : "are"));
  if (const size_t others = assembly.lights.size() - 1; others > 0) {
    scene.warnings.push_back(fmt::format(
        "{}: a scene has one light, and {} of the file {} not used: remove what should not shine from the file, or put "
        "the light elsewhere with --light=X,Y,Z",
        path, others == 1 ? "another one" : fmt::format("{} others", others), others == 1 ? "is" : "are"));
  }
  return PointLight{position.as<float>(), light.color};
}

void add_lights(const GltfDocument& document, const Assembly& assembly, const Vec3d& centre, Surfaces& surfaces) {
  for (const Placed& placed : assembly.lights) {
    const GltfLight& light = document.lights[placed.index];
    SurfaceLight result;
    result.kind = light.type == "point"  ? SurfaceLight::Kind::Point
                  : light.type == "spot" ? SurfaceLight::Kind::Spot
                                         : SurfaceLight::Kind::Directional;
    result.position = from_file(centre, placed.transform.origin);
    const Vec3d backwards = placed.transform.z;
    if (length(backwards) > 0) result.direction = (normalized(backwards) * -1.0).as<float>();
    result.color = light.color * static_cast<float>(light.intensity);
    result.range = static_cast<float>(light.range);
    result.inner_cone = static_cast<float>(light.inner_cone);
    result.outer_cone = static_cast<float>(light.outer_cone);
    surfaces.lights.push_back(result);
  }
}

/// Of the scene before its vertices are welded.
std::shared_ptr<const Surfaces> finished_surfaces(GltfDocument& document, Assembly& assembly, const Scene& scene) {
  Surfaces& surfaces = assembly.surfaces;
  surfaces.triangles = scene.triangles;
  surfaces.positions = scene.vertices;
  surfaces.materials = std::move(document.surfaces.materials);
  surfaces.images = std::move(document.surfaces.images);
  surfaces.textures = std::move(document.surfaces.textures);
  if (surfaces.materials.size() < scene.materials.size())
    surfaces.materials.push_back(surface_material(scene.materials.back().kd, {}));
  add_lights(document, assembly, scene.centre, surfaces);
  finish(surfaces);
  return std::make_shared<const Surfaces>(std::move(surfaces));
}

}  // namespace

SceneFile load_gltf(const std::string& path, const std::string& camera, bool surfaces) {
  GltfDocument document = read_gltf_document(path, surfaces);
  Assembly assembly = assemble(path, document, surfaces);
  SceneFile result;
  result.scene = std::move(assembly.scene);
  result.scene.warnings = document.warnings;
  result.up = Vec3{0, 1, 0};
  check_scene(result.scene, path);
  assembly.places.tell_lost_detail(result.scene, path);
  if (surfaces) result.scene.surfaces = finished_surfaces(document, assembly, result.scene);
  weld_vertices(result.scene);
  result.camera = choose_camera(path, camera, document, assembly, result.scene);
  result.light = choose_light(path, document, assembly, result.scene);
  return result;
}

}  // namespace raypool
