#include "scene/scene_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "config/data_folder.hpp"
#include "isa/did_you_mean.hpp"
#include "isa/input_error.hpp"
#include "scene/scene.hpp"

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 4> kSceneEndings = {".obj", ".gltf", ".glb", ".ply"};

bool has_scene_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kSceneEndings.begin(), kSceneEndings.end(), ending) != kSceneEndings.end();
}

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// What a name may mean in a folder.
std::vector<fs::path> meanings(const fs::path& folder, const std::string& name) {
  std::vector<fs::path> paths = {folder / name};
  if (!has_scene_ending(name))
    for (const char* ending : kSceneEndings) paths.push_back(folder / (name + ending));
  return paths;
}

/// Names of the scenes in a folder.
std::vector<std::string> scenes_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, none))
    if (has_scene_ending(entry.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Those that a mistyped name may be; an extension that it lacks does not count as mistyped.
std::vector<std::string> nearest_scenes(const std::string& given, const std::vector<std::string>& names) {
  std::vector<std::string> shown;
  for (const std::string& name : names)
    shown.push_back(has_scene_ending(given) ? name : fs::path(name).replace_extension().string());
  std::vector<std::string> nearest;
  for (const std::string& close : nearest_names(given, shown))
    nearest.push_back(names[static_cast<size_t>(std::find(shown.begin(), shown.end(), close) - shown.begin())]);
  return nearest;
}

[[noreturn]] void refuse_scene(const std::string& name, const std::vector<std::string>& folders) {
  const fs::path path(name), beside = path.parent_path();
  std::vector<std::string> names = scenes_in(beside);
  std::vector<std::string> nearest = nearest_scenes(path.filename().string(), names);
  for (std::string& each : nearest) each = (beside / each).string();
  if (nearest.empty() && !path.is_absolute()) {
    names = {"cornell", "room"};
    for (const std::string& folder : folders)
      for (const std::string& each : scenes_in(folder / beside)) names.push_back((beside / each).string());
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    nearest = nearest_scenes(name, names);
  }
  throw InputError(fmt::format("{}: no such scene{}", name, did_you_mean(nearest, fmt::format("give {}", kScenes))));
}

}  // namespace

std::vector<std::string> scene_folders() {
  std::vector<std::string> folders;
  const char* own = std::getenv("SCENES");
  if (own == nullptr || *own == '\0') {
    folders.push_back(data_folder() + "/scenes");
  } else {
    for (std::string_view rest = own; !rest.empty();) {
      const size_t end = std::min(rest.find(':'), rest.size());
      if (end != 0) folders.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  for (const char* folder : {"/examples", "/examples/scenes"}) folders.push_back(data_folder() + folder);
  return folders;
}

std::string find_scene(const std::string& name) {
  std::error_code none;
  if (name.empty() || fs::exists(name, none)) return name;
  const std::vector<std::string> folders = scene_folders();
  for (const fs::path& here : meanings("", name))
    if (is_file(here)) return here.string();
  if (fs::path(name).is_absolute()) refuse_scene(name, folders);
  for (const std::string& folder : folders) {
    for (const fs::path& path : meanings(folder, name)) {
      if (is_file(path)) return path.string();
      if (const std::string packed = path.string() + ".xz"; is_file(packed))
        throw InputError(
            fmt::format("{}: the scene is packed: unpack it with xz --decompress --keep '{}'", name, packed));
    }
  }
  refuse_scene(name, folders);
}

}  // namespace raypool
