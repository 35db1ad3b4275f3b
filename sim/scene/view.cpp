// View files, and views framed from a bounding box.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "files/output_files.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

void refuse_unknown(const Json& object, const std::vector<std::string>& known, const std::string& where) {
  for (const auto& item : object.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      throw InputError(fmt::format("{}: unknown key '{}'; known are {}", where, item.key(), fmt::join(known, ", ")));
    }
  }
}

float read_number(const Json& value, const std::string& where, double low, double high) {
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high)) {
    throw InputError(fmt::format("{} is {}; it must be a number in {:g} .. {:g}", where, value.dump(), low, high));
  }
  return static_cast<float>(value.get<double>());
}

Vec3 read_vector(const Json& object, const char* key, const std::string& path, double low, double high) {
  const std::string where = fmt::format("{}: {}", path, key);
  if (!object.contains(key)) throw InputError(where + " is missing; give it as [x, y, z]");
  const Json& value = object[key];
  if (!value.is_array() || value.size() != 3) {
    throw InputError(fmt::format("{} is {}; it must be three numbers, [x, y, z]", where, value.dump()));
  }
  return {read_number(value[0], where + "[0]", low, high), read_number(value[1], where + "[1]", low, high),
          read_number(value[2], where + "[2]", low, high)};
}

Json to_json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

/// Share of one side of the bounding box that is covered by triangles lying on it, within 3% of the box.
double side_coverage(const Scene& scene, const Bounds& bounds, int axis, bool upper) {
  const Vec3d extent = bounds.upper.as<double>() - bounds.lower.as<double>();
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  const double side = extent[b] * extent[c];
  if (!(side > 0)) return 0;
  const double wall = upper ? bounds.upper[axis] : bounds.lower[axis];
  double covered = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const Vec3d p = scene.corner(i, 0).as<double>(), q = scene.corner(i, 1).as<double>(), r = scene.corner(i, 2).as<double>();
    const double distance = std::max({std::fabs(p[axis] - wall), std::fabs(q[axis] - wall), std::fabs(r[axis] - wall)});
    if (distance <= 0.03 * extent[axis]) covered += 0.5 * std::fabs(cross(q - p, r - p)[axis]);
  }
  return covered / side;
}

/// Walls close the bounding box, and there is something within: a room, not a solid block.
bool is_indoor(const Scene& scene, const Bounds& bounds) {
  int walls = 0;
  for (int axis = 0; axis < 3; ++axis) {
    walls += side_coverage(scene, bounds, axis, false) > 0.5;
    walls += side_coverage(scene, bounds, axis, true) > 0.5;
  }
  if (walls < 5) return false;
  const Vec3d lower = bounds.lower.as<double>(), extent = bounds.upper.as<double>() - lower;
  for (const auto& triangle : scene.triangles) {
    for (uint32_t index : triangle) {
      const Vec3d p = scene.vertices[index].as<double>() - lower;
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) inside &= p[axis] > 0.03 * extent[axis] && p[axis] < 0.97 * extent[axis];
      if (inside) return true;
    }
  }
  return false;
}

/// What an n x n grid of rays of a square picture hits.
struct Sample {
  Vec3d point, normal;  // the normal turned towards the eye
  double distance;
};
std::vector<Sample> look(const Traversal& traversal, const Camera& camera, int n) {
  const Vec3d eye = camera.eye.as<double>(), forward = normalized(camera.direction.as<double>());
  const Vec3d right = normalized(cross(forward, camera.up.as<double>())), up = cross(right, forward);
  const double half = std::tan(static_cast<double>(camera.fov) * 0.5 * 3.14159265358979323846 / 180);
  std::vector<Sample> samples;
  for (int i = 0; i < n * n; ++i) {
    const double x = (2 * (i % n) + 1.0) / n - 1, y = (2 * (i / n) + 1.0) / n - 1;
    const Vec3d direction = normalized(forward + right * (x * half) + up * (y * half));
    Hit hit;
    if (!traversal.nearest({camera.eye, direction.as<float>(), INFINITY}, hit)) continue;
    const Vec3d normal = hit.normal.as<double>();
    const double distance = hit.t;
    samples.push_back({eye + direction * distance, dot(normal, direction) > 0 ? normal * -1.0 : normal, distance});
  }
  return samples;
}

/// The eye that sees furthest, from a few places at both ends of the longer horizontal side; then the light that shows most of
/// what it sees.
View indoor_view(const Scene& scene, const Bounds& bounds) {
  const Traversal traversal(scene);
  const Vec3d lower = bounds.lower.as<double>(), extent = bounds.upper.as<double>() - lower;
  const bool along_x = extent.x >= extent.z;
  auto at = [&](double along, double y, double across) {
    const double x = along_x ? along : across, z = along_x ? across : along;
    return Vec3d{lower.x + x * extent.x, lower.y + y * extent.y, lower.z + z * extent.z};
  };
  View view;
  double best = -1;
  for (double along : {0.06, 0.14, 0.22, 0.94, 0.86, 0.78}) {
    for (double across : {0.62, 0.38, 0.78, 0.22}) {
      const Vec3d eye = at(along, 0.58, across), target = at(1 - along, 0.40, 0.7 - 0.4 * across);
      const Camera camera{eye.as<float>(), (target - eye).as<float>(), {0, 1, 0}, 60};
      double sum = 0;
      for (const Sample& sample : look(traversal, camera, 12)) sum += sample.distance;
      if (sum > best) best = sum, view.camera = camera;
    }
  }
  const std::vector<Sample> samples = look(traversal, view.camera, 24);
  const double offset = 1e-5 * length(extent);
  best = -1;
  for (double y : {0.75, 0.85}) {
    for (double along : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8, 0.12, 0.88}) {
      for (double across : {0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8}) {
        const Vec3d light = at(along, y, across);
        double sum = 0;
        for (const Sample& sample : samples) {
          const Vec3d origin = sample.point + sample.normal * offset, way = light - origin;
          const double cosine = dot(sample.normal, way) / std::max(length(way), 1e-30);
          if (cosine > 0 && !traversal.occluded({origin.as<float>(), way.as<float>(), 1})) sum += cosine;
        }
        if (sum > best) best = sum, view.light.position = light.as<float>();
      }
    }
  }
  return view;
}

View object_view(const Bounds& bounds) {
  const Vec3d lower = bounds.lower.as<double>(), upper = bounds.upper.as<double>();
  const Vec3d centre = (lower + upper) * 0.5;
  const double radius = std::max(length(upper - lower) * 0.5, 1e-6);
  const Vec3d from = normalized(Vec3d{0.55, 0.4, 1.0});
  const double fov = 40, pi = 3.14159265358979323846;
  const Vec3d eye = centre + from * (1.02 * radius / std::sin(fov * 0.5 * pi / 180));
  View view;
  view.camera = {eye.as<float>(), (from * -1.0).as<float>(), {0, 1, 0}, static_cast<float>(fov)};
  view.light.position = (centre + normalized(Vec3d{0.35, 0.75, 1.0}) * (4 * radius)).as<float>();
  return view;
}

}  // namespace

View automatic_view(const Scene& scene, const ViewChanges& changes) {
  const Bounds bounds = scene.bounds();
  View view = is_indoor(scene, bounds) ? indoor_view(scene, bounds) : object_view(bounds);
  change_view(view, changes);
  return view;
}

void change_view(View& view, const ViewChanges& changes) {
  Camera& camera = view.camera;
  camera.eye = changes.eye.value_or(camera.eye);
  camera.up = changes.up.value_or(camera.up);
  camera.fov = changes.fov.value_or(camera.fov);
  view.light.position = changes.light.value_or(view.light.position);
  if (!changes.look_at) return;
  if (*changes.look_at == camera.eye) {
    throw InputError(
        fmt::format("the camera is to look at ({}, {}, {}), where its eye is: give another point (--look-at) or eye (--eye)",
                    camera.eye.x, camera.eye.y, camera.eye.z));
  }
  camera.direction = (changes.look_at->as<double>() - camera.eye.as<double>()).as<float>();
}

View load_view(const std::string& path) {
  const Json json = parse_json(read_file(path, "view file"), path);
  if (!json.is_object()) throw InputError(path + ": a view file must be one JSON object, {\"eye\": ...}");
  refuse_unknown(json, {"eye", "direction", "target", "up", "fov", "light", "$schema"}, path);

  const double far = kLargestCoordinate;
  View view;
  view.camera.eye = read_vector(json, "eye", path, -far, far);
  if (json.contains("direction") == json.contains("target")) {
    throw InputError(path + ": give either direction or target, and not both");
  }
  if (json.contains("direction")) {
    view.camera.direction = read_vector(json, "direction", path, -far, far);
  } else {
    const Vec3d target = read_vector(json, "target", path, -far, far).as<double>();
    view.camera.direction = (target - view.camera.eye.as<double>()).as<float>();
  }
  if (json.contains("up")) view.camera.up = read_vector(json, "up", path, -far, far);
  if (json.contains("fov")) view.camera.fov = read_number(json["fov"], path + ": fov", kLeastFov, kLargestFov);
  if (!json.contains("light") || !json["light"].is_object()) {
    throw InputError(path + ": light is missing; give it as {\"position\": [x, y, z], \"color\": [r, g, b]}");
  }
  const Json& light = json["light"];
  refuse_unknown(light, {"position", "color"}, path + ": light");
  view.light.position = read_vector(light, "position", path + ": light", -far, far);
  if (light.contains("color")) view.light.color = read_vector(light, "color", path + ": light", 0, 1000);

  check_camera(view.camera, path);
  return view;
}

std::string to_json(const View& view) {
  Json json;
  json["eye"] = to_json(view.camera.eye);
  json["direction"] = to_json(view.camera.direction);
  json["up"] = to_json(view.camera.up);
  json["fov"] = view.camera.fov;
  json["light"] = {{"position", to_json(view.light.position)}, {"color", to_json(view.light.color)}};
  return to_text(json, 2) + "\n";
}

void write_view(const View& view, const std::string& path) { write_file(path, to_json(view)); }

}  // namespace raypool
