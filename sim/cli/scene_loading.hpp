// A scene as the command line names it: with camera and light from its words, and with what cannot be drawn reported on
// stderr.
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace raypool {

/// Of a picture, WIDTHxHEIGHT in pixels, where none is given: what is drawn in half a minute by Verilog too.
constexpr char kDefaultSize[] = "200x200";

/// Camera and light on the command line; what is empty stays as the view has it.
struct ViewWords {
  std::string eye, look_at, up, light;  ///< x,y,z
  std::string fov;                      ///< degrees
  std::string camera;                   ///< of a glTF file, by name
};

/// Throws InputError that names the option.
FileViewChanges parse_view_words(const ViewWords& words);

/// load_scene() and its warnings; `surfaces` as SceneOptions have it.
Scene load_scene_and_warn(const std::string& scene, double detail, const std::string& view, const ViewWords& words,
                          bool surfaces = false);

}  // namespace raypool
