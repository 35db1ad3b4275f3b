// Scene checks and the choice between built-in scenes and files.
#include "scene/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "scene/far_places.hpp"
#include "scene/scene_cache.hpp"
#include "scene/scene_file.hpp"
#include "scene/scene_files.hpp"

namespace raypool {
namespace {

bool usable(const Vec3& v) {
  // A NaN fails every comparison.
  return std::fabs(v.x) <= kLargestCoordinate && std::fabs(v.y) <= kLargestCoordinate &&
         std::fabs(v.z) <= kLargestCoordinate;
}

std::string text(const Vec3& v, const Vec3d& centre = {}) {
  return fmt::format("({})", fmt::join(texts_in_file(centre, v), ", "));
}

/// In the file's coordinates.
void require_usable(const Vec3& v, const std::string& where, const char* what, const Vec3d& centre = {}) {
  if (!usable(in_file(centre, v).as<float>())) {
    throw InputError(fmt::format("{}: {} is {}; each component must be a number of at most {:g} in magnitude", where,
                                 what, text(v, centre), kLargestCoordinate));
  }
}

void require_colour(const Vec3& v, const std::string& where, const std::string& what) {
  const bool good = v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x <= 1000 && v.y <= 1000 && v.z <= 1000;
  if (!good) throw InputError(fmt::format("{}: {} is {}; each component must lie in 0 .. 1000", where, what, text(v)));
}

}  // namespace

Bounds Scene::bounds() const {
  if (triangles.empty()) return {};
  const float infinity = INFINITY;
  Bounds result{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const auto& triangle : triangles) {
    for (uint32_t index : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        result.lower[axis] = std::min(result.lower[axis], vertices[index][axis]);
        result.upper[axis] = std::max(result.upper[axis], vertices[index][axis]);
      }
    }
  }
  return result;
}

const Material* Scene::reflecting() const {
  const auto found = std::find_if(triangle_materials.begin(), triangle_materials.end(),
                                  [this](uint32_t material) { return materials[material].reflects(); });
  return found == triangle_materials.end() ? nullptr : &materials[*found];
}

bool is_degenerate(const Scene& scene, size_t triangle) {
  const Vec3d a = scene.corner(triangle, 0).as<double>();
  const Vec3d normal = cross(scene.corner(triangle, 1).as<double>() - a, scene.corner(triangle, 2).as<double>() - a);
  return !(dot(normal, normal) > 0);
}

void check_camera(const Camera& camera, const std::string& where, const Vec3d& centre) {
  require_usable(camera.eye, where, "the camera's eye", centre);
  require_usable(camera.direction, where, "the camera's direction");
  require_usable(camera.up, where, "the camera's up");
  const Vec3d direction = camera.direction.as<double>(), up = camera.up.as<double>();
  if (!(length(direction) > 0))
    throw InputError(where + ": the camera's direction is zero; give a direction or a target off the eye");
  if (!(length(up) > 0)) throw InputError(where + ": the camera's up is zero; give for example [0, 1, 0]");
  if (length(cross(direction, up)) <= 1e-6 * length(direction) * length(up)) {
    throw InputError(where + ": the camera's up is parallel to its direction; choose another up");
  }
  if (!(camera.fov >= kLeastFov && camera.fov <= kLargestFov)) {
    throw InputError(
        fmt::format("{}: fov is {}; it must lie in {} .. {} degrees", where, camera.fov, kLeastFov, kLargestFov));
  }
}

void check_scene(const Scene& scene, const std::string& where) {
  if (scene.triangles.empty()) throw InputError(where + ": the scene has no triangles; give it at least one face");
  if (scene.triangle_materials.size() != scene.triangles.size()) {
    throw InputError(fmt::format("{}: {} triangles but {} material indices; give each triangle one", where,
                                 scene.triangles.size(), scene.triangle_materials.size()));
  }
  for (size_t i = 0; i < scene.vertices.size(); ++i) {
    if (!usable(scene.vertices[i])) require_usable(scene.vertices[i], where, fmt::format("vertex {}", i).c_str());
  }
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    for (uint32_t index : scene.triangles[i]) {
      if (index >= scene.vertices.size()) {
        throw InputError(fmt::format("{}: triangle {} names vertex {}, but there are {}; correct the index", where, i,
                                     index, scene.vertices.size()));
      }
    }
    if (scene.triangle_materials[i] >= scene.materials.size()) {
      throw InputError(fmt::format("{}: triangle {} names material {}, but there are {}; correct the index", where, i,
                                   scene.triangle_materials[i], scene.materials.size()));
    }
  }
  for (const Material& material : scene.materials) {
    require_colour(material.kd, where, fmt::format("Kd of material '{}'", material.name));
    require_colour(material.ks, where, fmt::format("Ks of material '{}'", material.name));
  }
  check_camera(scene.camera, where, scene.centre);
  require_usable(scene.light.position, where, "the light's position", scene.centre);
  require_colour(scene.light.color, where, "the light's color");
}

namespace {

/// Below it products of two lengths may be zero in single precision.
constexpr float kLeastDiagonal = 1e-18f;

SceneFile load_file(const std::string& path, const std::string& camera, bool surfaces) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".gltf" || ending == ".glb") return load_gltf(path, camera, surfaces);
  SceneFile file;
  if (ending == ".obj") {
    file.scene = load_obj(path, surfaces);
  } else if (ending == ".ply") {
    file.scene = load_ply(path, surfaces);
  } else {
    throw InputError(fmt::format("{}: a scene cannot be read from this; give {}", path, kScenes));
  }
  if (!camera.empty()) throw InputError(fmt::format("{}: --camera is for glTF files; leave it out", path));
  return file;
}

/// With what the file leaves open chosen to go with the rest.
View view_of_file(const SceneFile& file, ViewChanges changes) {
  if (!changes.light && file.light) changes.light = file.light->position;
  View view;
  view.centre = file.scene.centre;
  if (file.camera) {
    view.camera = *file.camera;
    change_view(view, changes);
  } else {
    if (!changes.up) changes.up = file.up;
    view = automatic_view(file.scene, changes);
  }
  if (file.camera && !changes.light) {
    // The point looked at is as far away as the scene is large, so that it keeps the direction.
    const Camera& camera = view.camera;
    const double far = std::max(file.scene.bounds().diagonal(), 1.0f);
    const Vec3d point = camera.eye.as<double>() + normalized(camera.direction.as<double>()) * far;
    view.light = automatic_view(file.scene, {camera.eye, point.as<float>(), camera.up, {}, camera.fov}).light;
  }
  if (file.light) view.light.color = file.light->color;
  return view;
}

}  // namespace

Scene load_scene(const std::string& name_or_path, const SceneOptions& options) {
  if (!(options.detail >= 0.01 && options.detail <= 16)) {
    throw InputError(fmt::format("detail is {}; it must lie in 0.01 .. 16", options.detail));
  }
  const bool built_in = name_or_path == "cornell" || name_or_path == "room";
  if (!options.camera.empty() && !options.view.empty())
    throw InputError("a view file has its own camera: give --view or --camera, not both");
  if (!options.camera.empty() && built_in)
    throw InputError(fmt::format("{}: --camera is for glTF files; leave it out", name_or_path));
  SceneFile file;
  if (!built_in) {
    const std::string path = find_scene(name_or_path);
    const auto read = [&] { return load_file(path, options.camera, options.surfaces); };
    const std::optional<SceneCache>& cache = SceneCache::of_program();
    // The cache keeps no surfaces: textures are as quickly decoded as found.
    file = cache && !options.surfaces ? cache->file(path, options.camera, read) : read();
    if (const float size = file.scene.bounds().diagonal(); size > 0 && size < kLeastDiagonal) {
      file.scene.warnings.push_back(fmt::format(
          "{}: all of it is {:.2g} across, too small for single precision: its shading is wrong; scale the file up",
          name_or_path, size));
    }
  } else {
    file.scene = name_or_path == "room" ? make_room(options.detail) : make_cornell(options.detail);
  }
  Scene& scene = file.scene;
  if (options.surfaces && !scene.surfaces) scene.surfaces = std::make_shared<const Surfaces>(surfaces_of(scene));
  View view = scene.view();
  const ViewChanges changes = options.changes.around(scene.centre);
  if (!options.view.empty()) view = load_view(options.view, scene.centre);
  if (built_in || !options.view.empty()) {
    change_view(view, changes);
  } else {
    view = view_of_file(file, changes);
  }
  scene.camera = view.camera;
  scene.light = view.light;
  check_scene(scene, name_or_path);
  return std::move(scene);
}

}  // namespace raypool
