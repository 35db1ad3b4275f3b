// Materials of MTL files as metallic-roughness, with their textures. docs/use/scenes.md has the rules.
#pragma once

#include <string>
#include <vector>

#include "scene/mtl.hpp"
#include "scene/surfaces.hpp"

namespace raypool {

/// Adds a material for each; textures only of those that are used. `path` is the OBJ file's: images that cannot be read
/// get a warning which begins with it.
void add_mtl_surfaces(const std::string& path, const std::vector<MtlMaterial>& materials, const std::vector<bool>& used,
                      Surfaces& surfaces, std::vector<std::string>& warnings);

}  // namespace raypool
