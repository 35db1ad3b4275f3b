// Metallic-roughness materials of glTF as diffuse colour and mirror reflectance.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "scene/gltf_document.hpp"

namespace raypool {
namespace {

constexpr double kDielectric = 0.04;  // what glTF has any surface reflect that is no metal
constexpr double kLeastReflectance =
    1 / 64.;  // what reflects less is matt: each hit would cost a ray for nothing to see

/// The number, or the nearest in 0 .. 1; `beyond` becomes true then.
double read_factor(const JsonPlace& place, bool& beyond) {
  constexpr double kAny = std::numeric_limits<double>::max();
  const double value = place.number(-kAny, kAny), factor = std::clamp(value, 0.0, 1.0);
  beyond = beyond || value != factor;
  return factor;
}

double read_factor(const std::optional<JsonPlace>& place, const char* key, double otherwise, bool& beyond) {
  const std::optional<JsonPlace> factor = place ? place->find(key) : std::nullopt;
  return factor ? read_factor(*factor, beyond) : otherwise;
}

/// `count` numbers.
Vec3d read_colour(const JsonPlace& place, const char* key, size_t count, const Vec3d& otherwise, bool& beyond) {
  const std::optional<JsonPlace> array = place.find(key);
  if (!array) return otherwise;
  if (array->size() != count) array->fail(fmt::format("has {} numbers; give {}", array->size(), count));
  Vec3d colour;
  for (size_t i = 0; i < 3; ++i) colour[static_cast<int>(i)] = read_factor(array->at(i), beyond);
  return colour;
}

bool has_texture(const std::optional<JsonPlace>& place, const std::vector<const char*>& keys) {
  if (!place) return false;
  for (const char* key : keys) {
    if (place->find(key)) return true;
  }
  return false;
}

void count_losses(const JsonPlace& place, MaterialLosses& losses) {
  losses.textures += has_texture(place, {"normalTexture", "occlusionTexture", "emissiveTexture"}) ||
                     has_texture(place.find("pbrMetallicRoughness"), {"baseColorTexture", "metallicRoughnessTexture"});
  bool strong = false;  // which does not matter, as it is not used
  const Vec3d emissive = read_colour(place, "emissiveFactor", 3, {}, strong);
  losses.emissive += emissive.x > 0 || emissive.y > 0 || emissive.z > 0;
  const std::optional<JsonPlace> mode = place.find("alphaMode"), extensions = place.find("extensions");
  const bool transmits = extensions && extensions->find("KHR_materials_transmission");
  losses.transparent += transmits || (mode && mode->text() != "OPAQUE");
  losses.extensions += extensions && extensions->members() > (transmits ? 1 : 0);
}

}  // namespace

Material read_gltf_material(const JsonPlace& place, size_t index, MaterialLosses& losses) {
  const std::optional<JsonPlace> name = place.find("name"), pbr = place.find("pbrMetallicRoughness");
  bool beyond = false;
  const Vec3d base = pbr ? read_colour(*pbr, "baseColorFactor", 4, {1, 1, 1}, beyond) : Vec3d{1, 1, 1};
  const double metallic = read_factor(pbr, "metallicFactor", 1, beyond),
               roughness = read_factor(pbr, "roughnessFactor", 1, beyond);
  const double sharp = (1 - roughness) * (1 - roughness);
  Vec3d mirror;
  for (int i = 0; i < 3; ++i) {
    mirror[i] = sharp * (kDielectric * (1 - metallic) + base[i] * metallic);
    if (mirror[i] < kLeastReflectance) mirror[i] = 0;
  }
  count_losses(place, losses);
  losses.beyond += beyond;
  return {name ? name->text() : fmt::format("material_{}", index), (base * (1 - metallic * sharp)).as<float>(),
          mirror.as<float>()};
}

}  // namespace raypool
