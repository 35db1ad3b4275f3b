// What is rendered: triangles, materials, one camera, one point light; the built-in scenes, scene files and view files.
// docs/use/scenes.md describes the formats.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "scene/surfaces.hpp"
#include "scene/vec.hpp"

namespace raypool {

struct Material {
  std::string name;
  Vec3 kd{0.5f, 0.5f, 0.5f};  ///< diffuse
  Vec3 ks{};                  ///< mirror reflectance; zero is matt

  bool reflects() const { return ks.x > 0 || ks.y > 0 || ks.z > 0; }
};

struct Camera {
  Vec3 eye{0, 0, 0};
  Vec3 direction{0, 0, -1};  ///< any length but zero, not parallel to up
  Vec3 up{0, 1, 0};
  float fov = 60;  ///< vertical field of view, degrees
};
inline constexpr float kLeastFov = 1, kLargestFov = 170;

/// Point light without fall-off.
struct PointLight {
  Vec3 position{0, 0, 0};
  Vec3 color{1, 1, 1};
};

struct Bounds {
  Vec3 lower, upper;
  float diagonal() const { return static_cast<float>(length(upper.as<double>() - lower.as<double>())); }
};

struct View {
  Camera camera;
  PointLight light;
  Vec3d centre;  ///< of the scene: what camera and light are counted from, in the file's coordinates
};

struct Scene {
  std::string name;
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> triangle_materials;  ///< one a triangle, below materials.size()
  std::vector<Material> materials;
  Camera camera;
  PointLight light;
  std::vector<std::string> cameras;   ///< names of those a file has, the one that is looked through first
  std::vector<std::string> warnings;  ///< a sentence each: what of a file could not be drawn as it is
  Vec3d
      centre;  ///< what all places are counted from, in the file's coordinates: zero unless recentred (far_places.hpp)
  std::shared_ptr<const Surfaces> surfaces;  ///< null unless SceneOptions ask for them

  const Vec3& corner(size_t triangle, int k) const { return vertices[triangles[triangle][k]]; }
  /// Of unit length, on the side from which the corners turn left.
  Vec3 normal(size_t triangle) const {
    const Vec3d a = corner(triangle, 0).as<double>();
    return normalized(cross(corner(triangle, 1).as<double>() - a, corner(triangle, 2).as<double>() - a)).as<float>();
  }
  /// Of the vertices that triangles use; both corners zero without triangles.
  Bounds bounds() const;
  /// The material of the first triangle that has one that does; null: none has.
  const Material* reflecting() const;
  bool reflects() const { return reflecting() != nullptr; }
  View view() const { return {camera, light, centre}; }
  bool recentred() const { return !(centre == Vec3d{}); }
};

/// Coordinates beyond this are refused: products of four of them must stay finite in single precision.
inline constexpr float kLargestCoordinate = 1e9f;

/// What is set replaces what a view has, in its scene's coordinates. An eye without look_at keeps the direction.
struct ViewChanges {
  std::optional<Vec3> eye, look_at, up, light;
  std::optional<float> fov;
};
/// The same in the file's coordinates.
struct FileViewChanges {
  std::optional<Vec3d> eye, look_at;
  std::optional<Vec3> up;
  std::optional<Vec3d> light;
  std::optional<float> fov;

  ViewChanges around(const Vec3d& centre) const;
};

struct SceneOptions {
  double detail = 1.0;  ///< built-in scenes: share of the full triangle count, 0.01 .. 16
  std::string view;     ///< view file; empty: the scene's own camera and light, or for a file without automatic_view()
  FileViewChanges changes;
  std::string camera;  ///< of a glTF file, by name; empty: its first one
  /// Scene::surfaces get what only shader sets see of a file; its warnings are then of what they do not see either.
  bool surfaces = false;
};

/// What can be drawn, for a refusal's end.
inline constexpr const char* kScenes = "cornell, room, or the path of a .obj, .gltf, .glb or .ply file";

/// `name_or_path` is "cornell", "room", or names a file as find_scene() has it; its ending gives its format. Throws
/// InputError.
Scene load_scene(const std::string& name_or_path, const SceneOptions& options = {});

/// Closed box of 5.5 m with two blocks, one of them a mirror, camera and light inside.
Scene make_cornell(double detail = 1.0);
/// Furnished meeting room, 331,000 triangles at detail 1, 36 materials that each mirror
/// half of what they reflect diffusely.
Scene make_room(double detail = 1.0);

/// Reads Wavefront OBJ with its MTL files; polygons become triangles (scene/polygon.hpp),
/// faces without a material a grey one.
/// Sets no camera and no light; `surfaces` as SceneOptions have it. Throws InputError naming file and line.
Scene load_obj(const std::string& path, bool surfaces = false);
/// Writes `path` and, beside it with the ending .mtl, its materials; load_obj reads the same
/// triangles and materials back, bit for bit.
void write_obj(const Scene& scene, const std::string& path);

/// Reads a view file (JSON): eye, direction or target, up, fov, light {position, color}, for a scene with this centre.
/// Throws InputError naming file, key and range.
View load_view(const std::string& path, const Vec3d& centre = {});
void write_view(const View& view, const std::string& path);
/// A view file's text, in the file's coordinates.
std::string to_json(const View& view);
/// Throws InputError when look_at is where the eye is.
void change_view(View& view, const ViewChanges& changes);

/// A view for a scene of which nothing is known but its triangles, as docs/use/views.md
/// describes; what `changes` sets is kept.
/// Throws InputError when it cannot be used.
View automatic_view(const Scene& scene, const ViewChanges& changes = {});

/// Throws InputError when the camera cannot be used; `where` begins the sentence, `centre` is its scene's.
void check_camera(const Camera& camera, const std::string& where, const Vec3d& centre = {});
/// Throws InputError when camera, light, indices, coordinates or materials cannot be
/// rendered; `where` begins the sentence.
void check_scene(const Scene& scene, const std::string& where);

/// True when the triangle has no area, so that no ray hits it.
bool is_degenerate(const Scene& scene, size_t triangle);

}  // namespace raypool
