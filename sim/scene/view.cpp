// View files, and what changes of a view.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "files/input_file.hpp"
#include "files/json_text.hpp"
#include "files/output_files.hpp"
#include "isa/did_you_mean.hpp"
#include "scene/far_places.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {
namespace {

using Json = nlohmann::ordered_json;

void refuse_unknown(const Json& object, const std::vector<std::string>& known, const std::string& where) {
  for (const auto& item : object.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      throw InputError(
          fmt::format("{}: unknown key '{}'{}", where, item.key(),
                      did_you_mean(item.key(), known, fmt::format("known are {}", fmt::join(known, ", ")))));
    }
  }
}

double read_number(const Json& value, const std::string& where, double low, double high) {
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high)) {
    throw InputError(fmt::format("{} is {}; it must be a number in {:g} .. {:g}", where, value.dump(), low, high));
  }
  return value.get<double>();
}

Vec3d read_vector(const Json& object, const char* key, const std::string& path, double low, double high) {
  const std::string where = fmt::format("{}: {}", path, key);
  if (!object.contains(key)) throw InputError(where + " is missing; give it as [x, y, z]");
  const Json& value = object[key];
  if (!value.is_array() || value.size() != 3) {
    throw InputError(fmt::format("{} is {}; it must be three numbers, [x, y, z]", where, value.dump()));
  }
  return {read_number(value[0], where + "[0]", low, high), read_number(value[1], where + "[1]", low, high),
          read_number(value[2], where + "[2]", low, high)};
}

template <typename Number>
Json to_json(const Vector3<Number>& v) {
  return Json::array({v.x, v.y, v.z});
}

}  // namespace

ViewChanges FileViewChanges::around(const Vec3d& centre) const {
  const auto place = [&](const std::optional<Vec3d>& point) {
    return point ? std::optional(from_file(centre, *point)) : std::nullopt;
  };
  return {place(eye), place(look_at), up, place(light), fov};
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
        fmt::format("the camera is to look at ({}), where its eye is: give another point (--look-at) or eye (--eye)",
                    fmt::join(texts_in_file(view.centre, camera.eye), ", ")));
  }
  camera.direction = (changes.look_at->as<double>() - camera.eye.as<double>()).as<float>();
}

View load_view(const std::string& path, const Vec3d& centre) {
  const Json json = parse_json(read_text_file(path, "view file"), path);
  if (!json.is_object()) throw InputError(path + ": a view file must be one JSON object, {\"eye\": ...}");
  refuse_unknown(json, {"eye", "direction", "target", "up", "fov", "light", "$schema"}, path);

  const double far = kLargestCoordinate;
  View view;
  view.centre = centre;
  view.camera.eye = from_file(centre, read_vector(json, "eye", path, -far, far));
  if (json.contains("direction") == json.contains("target")) {
    throw InputError(path + ": give either direction or target, and not both");
  }
  if (json.contains("direction")) {
    view.camera.direction = read_vector(json, "direction", path, -far, far).as<float>();
  } else {
    const Vec3d target = from_file(centre, read_vector(json, "target", path, -far, far)).as<double>();
    view.camera.direction = (target - view.camera.eye.as<double>()).as<float>();
  }
  if (json.contains("up")) view.camera.up = read_vector(json, "up", path, -far, far).as<float>();
  if (json.contains("fov"))
    view.camera.fov = static_cast<float>(read_number(json["fov"], path + ": fov", kLeastFov, kLargestFov));
  if (!json.contains("light") || !json["light"].is_object()) {
    throw InputError(path + ": light is missing; give it as {\"position\": [x, y, z], \"color\": [r, g, b]}");
  }
  const Json& light = json["light"];
  refuse_unknown(light, {"position", "color"}, path + ": light");
  view.light.position = from_file(centre, read_vector(light, "position", path + ": light", -far, far));
  if (light.contains("color")) view.light.color = read_vector(light, "color", path + ": light", 0, 1000).as<float>();

  check_camera(view.camera, path, centre);
  return view;
}

std::string to_json(const View& view) {
  Json json;
  json["eye"] = to_json(in_file(view.centre, view.camera.eye));
  json["direction"] = to_json(view.camera.direction);
  json["up"] = to_json(view.camera.up);
  json["fov"] = view.camera.fov;
  json["light"] = {{"position", to_json(in_file(view.centre, view.light.position))},
                   {"color", to_json(view.light.color)}};
  return to_text(json, 2) + "\n";
}

void write_view(const View& view, const std::string& path) { write_file(path, to_json(view)); }

}  // namespace raypool
