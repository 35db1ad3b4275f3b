#include "scene/gltf_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "isa/input_error.hpp"
#include "scene/surface_images.hpp"

namespace raypool {
namespace {

constexpr double kAnyFloat = std::numeric_limits<float>::max();
constexpr uint64_t kMostObjects = uint64_t{1} << 31;

std::optional<JsonPlace> inner(const JsonPlace& place, const char* key, const char* member) {
  const std::optional<JsonPlace> outer = place.find(key);
  return outer ? outer->find(member) : std::nullopt;
}
std::optional<JsonPlace> surface_extension(const JsonPlace& place, const char* name) {
  return inner(place, "extensions", name);
}

/// The nearest number in the range.
float number_in_range(const std::optional<JsonPlace>& place, const char* key, float otherwise, double low,
                      double high) {
  const std::optional<JsonPlace> number = place ? place->find(key) : std::nullopt;
  if (!number) return otherwise;
  return static_cast<float>(std::clamp(number->number(-kAnyFloat, kAnyFloat), low, high));
}

Texcoord pair_of(const JsonPlace& place, const char* key, const Texcoord& otherwise) {
  const std::optional<JsonPlace> array = place.find(key);
  if (!array) return otherwise;
  if (array->size() != 2) array->fail(fmt::format("has {} numbers; give 2", array->size()));
  Texcoord result{};
  for (size_t i = 0; i < 2; ++i) result[i] = static_cast<float>(array->at(i).number(-kAnyFloat, kAnyFloat));
  return result;
}

GltfTexcoords texcoords_of(const JsonPlace& info) {
  GltfTexcoords result;
  if (const std::optional<JsonPlace> set = info.find("texCoord")) result.set = set->whole(0, 255);
  const std::optional<JsonPlace> transform = surface_extension(info, "KHR_texture_transform");
  if (!transform) return result;
  if (const std::optional<JsonPlace> set = transform->find("texCoord")) result.set = set->whole(0, 255);
  result.offset = pair_of(*transform, "offset", result.offset);
  result.scale = pair_of(*transform, "scale", result.scale);
  result.rotation = number_in_range(transform, "rotation", 0, -kAnyFloat, kAnyFloat);
  return result;
}

std::optional<JsonPlace> base_color_texture(const JsonPlace& material) {
  return inner(material, "pbrMetallicRoughness", "baseColorTexture");
}
std::optional<JsonPlace> metallic_roughness_texture(const JsonPlace& material) {
  return inner(material, "pbrMetallicRoughness", "metallicRoughnessTexture");
}

class SurfaceReader {
 public:
  SurfaceReader(GltfFile& file, Surfaces& surfaces, MaterialLosses& losses, std::vector<std::string>& warnings)
      : file_(file),
        root_(file.root()),
        surfaces_(surfaces),
        losses_(losses),
        warnings_(warnings),
        images_(file.path(), surfaces, warnings,
                [this](const std::string& name) { return file_.image(root_.at("images").at(numbers_.at(name))); }) {}

  void read(const JsonPlace& place, bool used) {
    SurfaceMaterial material = without_textures(place);
    if (used) {
      const GltfTexcoords texcoords = gltf_texcoords(place);
      bool other = false;  // coordinates than those
      const auto texture = [&](const std::optional<JsonPlace>& info, bool srgb) -> std::optional<uint32_t> {
        if (!info) return std::nullopt;
        const bool same = texcoords_of(*info) == texcoords;
        other = other || !same;
        return same ? find(*info, srgb) : std::nullopt;
      };
      material.base_color_texture = texture(base_color_texture(place), true);
      material.emission_texture = texture(place.find("emissiveTexture"), true);
      material.metallic_roughness_texture = texture(metallic_roughness_texture(place), false);
      other_texcoords_ += other;
      count_losses(place);
    }
    surfaces_.materials.push_back(material);
  }

  void tell_of_texcoords() {
    tell_count(warnings_, file_.path(), other_texcoords_, "material",
               "with textures at other coordinates than its first one, which are left out",
               "with textures at other coordinates than their first one, which are left out");
  }

 private:
  SurfaceMaterial without_textures(const JsonPlace& place) const {
    SurfaceMaterial material;
    const std::optional<JsonPlace> pbr = place.find("pbrMetallicRoughness");
    if (const std::optional<JsonPlace> base = pbr ? pbr->find("baseColorFactor") : std::nullopt) {
      if (base->size() != 4) base->fail(fmt::format("has {} numbers; give 4", base->size()));
      for (size_t i = 0; i < 4; ++i)
        material.base_color[i] = static_cast<float>(std::clamp(base->at(i).number(-kAnyFloat, kAnyFloat), 0.0, 1.0));
    }
    material.metallic = number_in_range(pbr, "metallicFactor", 1, 0, 1);
    material.roughness = number_in_range(pbr, "roughnessFactor", 1, 0, 1);
    const std::optional<JsonPlace> strong = surface_extension(place, "KHR_materials_emissive_strength");
    const float strength = number_in_range(strong, "emissiveStrength", 1, 0, 1e9);
    if (const std::optional<JsonPlace> emission = place.find("emissiveFactor")) {
      if (emission->size() != 3) emission->fail(fmt::format("has {} numbers; give 3", emission->size()));
      for (size_t i = 0; i < 3; ++i) {
        const double factor = std::clamp(emission->at(i).number(-kAnyFloat, kAnyFloat), 0.0, 1e9);
        material.emission[static_cast<int>(i)] = static_cast<float>(factor * static_cast<double>(strength));
      }
    }
    material.transmission =
        number_in_range(surface_extension(place, "KHR_materials_transmission"), "transmissionFactor", 0, 0, 1);
    // An index of 0 stands for infinite in glTF; none beyond 10 can be told from it.
    const float ior = number_in_range(surface_extension(place, "KHR_materials_ior"), "ior", material.ior, 0, 10);
    material.ior = ior == 0 ? 10 : std::max(ior, 1.0f);
    if (const std::optional<JsonPlace> mode = place.find("alphaMode")) {
      const std::string text = mode->text();
      if (text != "OPAQUE" && text != "MASK" && text != "BLEND")
        mode->fail(fmt::format("is '{}'; it must be OPAQUE, MASK or BLEND", text));
      material.alpha_mode = text == "MASK" ? AlphaMode::CutOut : text == "BLEND" ? AlphaMode::Blend : AlphaMode::Opaque;
    }
    material.alpha_cutoff = number_in_range(place, "alphaCutoff", material.alpha_cutoff, 0, 1e9);
    return material;
  }

  std::optional<uint32_t> find(const JsonPlace& info, bool srgb) {
    const JsonPlace texture = info.at("index").in(root_, "textures");
    const std::optional<JsonPlace> source = texture.find("source");
    if (!source) {
      if (warned_.emplace(texture.where(), true).second)
        warnings_.push_back(texture.where() + " has no PNG or JPEG image, and is left out: export it with one");
      return std::nullopt;
    }
    const JsonPlace image = source->in(root_, "images");
    const size_t number = source->whole(0, kMostObjects);
    const std::optional<JsonPlace> uri = image.find("uri");
    std::string name = uri ? uri->text() : "";
    if (name.empty() || name.compare(0, 5, "data:") == 0) name = fmt::format("images[{}]", number);
    numbers_.emplace(name, number);
    const std::optional<uint32_t> found = images_.find(name, srgb);
    if (!found) return std::nullopt;
    SurfaceTexture result;
    result.image = *found;
    if (const std::optional<JsonPlace> given = texture.find("sampler")) {
      const JsonPlace sampler = given->in(root_, "samplers");
      result.wrap_s = wrap(sampler, "wrapS");
      result.wrap_t = wrap(sampler, "wrapT");
      const std::optional<JsonPlace> filter = sampler.find("magFilter");
      constexpr uint64_t kNearest = 9728, kLinear = 9729;
      result.nearest = filter && filter->whole(kNearest, kLinear) == kNearest;
    }
    return surfaces_.add_texture(result);
  }
  static shader::Wrap wrap(const JsonPlace& sampler, const char* key) {
    constexpr uint64_t kRepeat = 10497, kClamp = 33071, kMirror = 33648;
    const std::optional<JsonPlace> given = sampler.find(key);
    if (!given) return shader::Wrap::Repeat;
    switch (given->whole(0, 65535)) {
      case kRepeat:
        return shader::Wrap::Repeat;
      case kClamp:
        return shader::Wrap::Clamp;
      case kMirror:
        return shader::Wrap::Mirror;
      default:
        given->fail("must be 10497, 33071 or 33648: repeat, clamp or mirror");
    }
  }

  void count_losses(const JsonPlace& place) {
    bool textures = place.find("normalTexture") || place.find("occlusionTexture");
    const std::optional<JsonPlace> extensions = place.find("extensions");
    size_t read = 0;
    for (const char* name : {"KHR_materials_transmission", "KHR_materials_emissive_strength", "KHR_materials_ior"})
      read += extensions && extensions->find(name);
    const std::optional<JsonPlace> glass = surface_extension(place, "KHR_materials_transmission");
    textures = textures || (glass && glass->find("transmissionTexture"));
    losses_.other_textures += textures;
    losses_.extensions += extensions && extensions->members() > read;
  }

  GltfFile& file_;
  const JsonPlace root_;
  Surfaces& surfaces_;
  MaterialLosses& losses_;
  std::vector<std::string>& warnings_;
  std::map<std::string, size_t> numbers_;  // of images, by name
  std::map<std::string, bool> warned_;     // of textures, by place
  SurfaceImages images_;
  size_t other_texcoords_ = 0;
};

}  // namespace

Texcoord GltfTexcoords::operator()(const Texcoord& uv) const {
  const float u = uv[0] * scale[0], v = uv[1] * scale[1], c = std::cos(rotation), s = std::sin(rotation);
  return {c * u + s * v + offset[0], c * v - s * u + offset[1]};
}

GltfTexcoords gltf_texcoords(const JsonPlace& material) {
  for (const std::optional<JsonPlace>& info :
       {base_color_texture(material), material.find("emissiveTexture"), metallic_roughness_texture(material)}) {
    if (info) return texcoords_of(*info);
  }
  return {};
}

void read_gltf_surfaces(GltfFile& file, const std::vector<bool>& used, Surfaces& surfaces, MaterialLosses& losses,
                        std::vector<std::string>& warnings) {
  SurfaceReader reader(file, surfaces, losses, warnings);
  const std::optional<JsonPlace> list = file.root().find("materials");
  for (size_t i = 0; list && i < list->size(); ++i) reader.read(list->at(i), i < used.size() && used[i]);
  reader.tell_of_texcoords();
}

}  // namespace raypool
