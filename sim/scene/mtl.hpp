// Material libraries of OBJ files (MTL). docs/use/scenes.md, "OBJ files", lists what is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/losses.hpp"
#include "scene/scene.hpp"

namespace raypool {

struct MtlMaterial {
  std::string name;  ///< may have blanks
  Vec3 kd{}, ks{};
  std::optional<float> illum;
  bool texture = false, emission = false, transparent = false, extension = false;
  bool spectral = false, xyz = false;  ///< Kd or Ks are given so

  /// What only surfaces have; nothing where a number is malformed.
  struct Map {
    std::string file;  ///< empty: none
    bool clamp = false;
  };
  std::string path;  ///< of the file
  Map map_kd, map_ke, map_d, map_pr, map_pm;
  std::optional<float> pm, pr, ns, ni, opacity;
  Vec3 ke{};
  bool kd_given = false, ke_given = false;
  bool other_texture = false, map_options = false, other_extension = false;  ///< which surfaces have not either

  /// illum 0, 1 and 2 are models of light without reflection: their Ks is a highlight, which is not drawn.
  bool reflects() const { return !illum || *illum >= 3; }
  Material material() const { return {name, kd, reflects() ? ks : Vec3{}}; }
};

/// Adds the materials of the file in its order. Throws InputError naming file and line.
void read_mtl(const std::string& path, std::vector<MtlMaterial>& materials);

/// A sentence for each kind of thing about the materials that are drawn as something else: used[i]: a triangle has
/// materials[i]; `surfaces`: of what not even surfaces have.
void tell_of_materials(std::vector<std::string>& warnings, const std::string& path,
                       const std::vector<MtlMaterial>& materials, const std::vector<bool>& used, bool surfaces);

}  // namespace raypool
