// Metallic-roughness materials of glTF as diffuse colour and mirror reflectance.
#include <fmt/format.h>

#include "scene/gltf_document.hpp"

namespace raypool {
namespace {

constexpr double kDielectric = 0.04;  // what glTF has any surface reflect that is no metal
constexpr double kLeastReflectance =
    1 / 64.;  // what reflects less is matt: each hit would cost a ray for nothing to see

/// `count` numbers of 0 .. 1.
Vec3d read_colour(const JsonPlace& place, const char* key, size_t count, const Vec3d& otherwise) {
  const std::optional<JsonPlace> array = place.find(key);
  if (!array) return otherwise;
  if (array->size() != count) array->fail(fmt::format("has {} numbers; give {}", array->size(), count));
  Vec3d colour;
  for (size_t i = 0; i < count; ++i) {
    const double value = array->at(i).number(0, 1);
    if (i < 3) colour[static_cast<int>(i)] = value;
  }
  return colour;
}

double read_factor(const std::optional<JsonPlace>& place, const char* key, double otherwise) {
  const std::optional<JsonPlace> factor = place ? place->find(key) : std::nullopt;
  return factor ? factor->number(0, 1) : otherwise;
}

bool has_texture(const std::optional<JsonPlace>& place, const std::vector<const char*>& keys) {
  if (!place) return false;
  for (const char* key : keys) {
    if (place->find(key)) return true;
  }
  return false;
}

void count_losses(const JsonPlace& place, GltfMaterialLosses& losses) {
  losses.textures += has_texture(place, {"normalTexture", "occlusionTexture", "emissiveTexture"}) ||
                     has_texture(place.find("pbrMetallicRoughness"), {"baseColorTexture", "metallicRoughnessTexture"});
  const Vec3d emissive = read_colour(place, "emissiveFactor", 3, {});
  losses.emissive += emissive.x > 0 || emissive.y > 0 || emissive.z > 0;
  const std::optional<JsonPlace> mode = place.find("alphaMode"), extensions = place.find("extensions");
  const bool transmits = extensions && extensions->find("KHR_materials_transmission");
  losses.transparent += transmits || (mode && mode->text() != "OPAQUE");
  losses.extensions += extensions && extensions->members() > (transmits ? 1 : 0);
}

}  // namespace

Material read_gltf_material(const JsonPlace& place, size_t index, GltfMaterialLosses& losses) {
  const std::optional<JsonPlace> name = place.find("name"), pbr = place.find("pbrMetallicRoughness");
  const Vec3d base = pbr ? read_colour(*pbr, "baseColorFactor", 4, {1, 1, 1}) : Vec3d{1, 1, 1};
  const double metallic = read_factor(pbr, "metallicFactor", 1), roughness = read_factor(pbr, "roughnessFactor", 1);
  const double sharp = (1 - roughness) * (1 - roughness);
  Vec3d mirror;
  for (int i = 0; i < 3; ++i) {
    mirror[i] = sharp * (kDielectric * (1 - metallic) + base[i] * metallic);
    if (mirror[i] < kLeastReflectance) mirror[i] = 0;
  }
  count_losses(place, losses);
  return {name ? name->text() : fmt::format("material_{}", index), (base * (1 - metallic * sharp)).as<float>(),
          mirror.as<float>()};
}

}  // namespace raypool
