#include "scene/mtl_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "files/input_file.hpp"
#include "isa/input_error.hpp"
#include "scene/obj_text.hpp"
#include "scene/surface_images.hpp"

namespace raypool {
namespace {

bool is_black(const Vec3& colour) { return !(colour.x > 0 || colour.y > 0 || colour.z > 0); }

/// Where the cosine's power of a highlight falls off as a microfacet distribution of this roughness does.
float roughness_of_exponent(float exponent) { return std::sqrt(std::sqrt(2 / (exponent + 2))); }

bool is_glass(const MtlMaterial& material) {
  static constexpr std::array<float, 4> kGlass = {4, 6, 7, 9};
  return material.illum && std::find(kGlass.begin(), kGlass.end(), *material.illum) != kGlass.end();
}

SurfaceMaterial without_textures(const MtlMaterial& material) {
  const bool coloured = material.kd_given || material.map_kd.file.empty();
  const Vec3 kd = coloured ? material.kd : Vec3{1, 1, 1};
  SurfaceMaterial result = surface_material(kd, {});
  const float exponent = is_black(material.ks) ? 0 : material.ns.value_or(0);
  if (is_glass(material) && material.opacity.value_or(0) < 1) {
    result.transmission = 1 - material.opacity.value_or(0);
    result.roughness = material.pr.value_or(0);
    if (is_black(kd)) result.base_color = {1, 1, 1, 1};
  } else if (material.pm || material.pr) {
    result.metallic = material.pm.value_or(0);
    result.roughness = material.pr.value_or(roughness_of_exponent(exponent));
  } else if (material.reflects()) {
    result = surface_material(kd, material.ks);
  } else {
    result.roughness = roughness_of_exponent(exponent);
  }
  if (result.transmission == 0 && material.opacity.value_or(1) < 1) {
    result.base_color[3] = *material.opacity;
    result.alpha_mode = AlphaMode::Blend;
  }
  result.ior = material.ni.value_or(result.ior);
  result.emission = material.ke_given || material.map_ke.file.empty() ? material.ke : Vec3{1, 1, 1};
  return result;
}

class MtlTextures {
 public:
  MtlTextures(const std::string& path, Surfaces& surfaces, std::vector<std::string>& warnings)
      : surfaces_(surfaces),
        images_(path, surfaces, warnings, [this](const std::string& name) { return read(name); }) {}

  void add(const MtlMaterial& source, SurfaceMaterial& material) {
    folder_ = std::filesystem::path(source.path).parent_path().string();
    const std::string base = source.map_kd.file, alpha = source.map_d.file;
    if (!alpha.empty()) {
      // The alpha of the colours' own file, or else what another file is made of.
      const ImageChannel opacity = {alpha, 3, alpha != base};
      material.base_color_texture = texture(
          source.map_kd.file.empty() ? source.map_d : source.map_kd,
          images_.combine({ImageChannel{base, 0}, ImageChannel{base, 1}, ImageChannel{base, 2}, opacity}, true));
      if (material.base_color_texture) material.alpha_mode = AlphaMode::CutOut;
    } else if (!base.empty()) {
      material.base_color_texture = texture(source.map_kd, images_.find(base, true));
    }
    if (!source.map_ke.file.empty())
      material.emission_texture = texture(source.map_ke, images_.find(source.map_ke.file, true));
    const std::string rough = source.map_pr.file, metal = source.map_pm.file;
    if (rough.empty() && metal.empty()) return;
    material.metallic_roughness_texture = texture(
        rough.empty() ? source.map_pm : source.map_pr,
        images_.combine({ImageChannel{}, ImageChannel{rough, 0}, ImageChannel{metal, 0}, ImageChannel{}}, false));
    if (!material.metallic_roughness_texture) return;
    // Without a number of its own the texture counts alone.
    if (!rough.empty() && !source.pr) material.roughness = 1;
    if (!metal.empty() && !source.pm) material.metallic = 1;
  }

 private:
  std::string read(const std::string& name) const {
    const std::string path = find_named_file(folder_, name);
    if (path.empty()) {
      throw InputError(fmt::format("it is not in '{}': put it there", folder_.empty() ? std::string(".") : folder_));
    }
    return read_file(path, "image");
  }
  std::optional<uint32_t> texture(const MtlMaterial::Map& map, const std::optional<uint32_t>& image) {
    if (!image) return std::nullopt;
    const shader::Wrap wrap = map.clamp ? shader::Wrap::Clamp : shader::Wrap::Repeat;
    return surfaces_.add_texture({*image, wrap, wrap, false});
  }

  Surfaces& surfaces_;
  std::string folder_;  // of the material file at hand
  SurfaceImages images_;
};

}  // namespace

void add_mtl_surfaces(const std::string& path, const std::vector<MtlMaterial>& materials, const std::vector<bool>& used,
                      Surfaces& surfaces, std::vector<std::string>& warnings) {
  std::map<std::string, MtlTextures> textures;  // by material file: names count from its folder
  for (size_t i = 0; i < materials.size(); ++i) {
    SurfaceMaterial material = without_textures(materials[i]);
    if (used[i]) {
      auto found = textures.find(materials[i].path);
      if (found == textures.end()) found = textures.try_emplace(materials[i].path, path, surfaces, warnings).first;
      found->second.add(materials[i], material);
    }
    surfaces.materials.push_back(material);
  }
}

}  // namespace raypool
