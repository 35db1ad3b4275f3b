#include "cli/scene_loading.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "scene/obj_text.hpp"

namespace raypool {
namespace {

/// The whole of `text`.
std::optional<double> number(const std::string& text) {
  double value = 0;
  return read_double(text, value) ? std::optional(value) : std::nullopt;
}

std::optional<Vec3d> point(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  Vec3d result;
  size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t end = axis < 2 ? text.find(',', begin) : text.size();
    const std::optional<double> value =
        end == std::string::npos ? std::nullopt : number(text.substr(begin, end - begin));
    if (!value)
      throw InputError(fmt::format("{} is '{}': give three numbers with commas between, as in 1,2.5,-3", option, text));
    if (!(std::fabs(*value) <= kLargestCoordinate)) {
      throw InputError(fmt::format("{} is '{}': each number must lie in {:g} .. {:g}", option, text,
                                   -kLargestCoordinate, kLargestCoordinate));
    }
    result[axis] = *value;
    begin = end + 1;
  }
  return result;
}

}  // namespace

FileViewChanges parse_view_words(const ViewWords& words) {
  FileViewChanges changes;
  changes.eye = point("--eye", words.eye);
  changes.look_at = point("--look-at", words.look_at);
  if (const std::optional<Vec3d> up = point("--up", words.up)) changes.up = up->as<float>();
  changes.light = point("--light", words.light);
  if (!words.fov.empty()) {
    if (const std::optional<double> fov = number(words.fov)) changes.fov = static_cast<float>(*fov);
    if (!changes.fov || !(*changes.fov >= kLeastFov && *changes.fov <= kLargestFov)) {
      throw InputError(fmt::format("--fov is '{}': give the vertical field of view in degrees, {} to {}", words.fov,
                                   kLeastFov, kLargestFov));
    }
  }
  return changes;
}

Scene load_scene_and_warn(const std::string& scene, double detail, const std::string& view, const ViewWords& words,
                          bool surfaces) {
  Scene loaded = load_scene(scene, {detail, view, parse_view_words(words), words.camera, surfaces});
  for (const std::string& warning : loaded.warnings) fmt::print(stderr, "raypool: warning: {}\n", warning);
  return loaded;
}

}  // namespace raypool
