#include "scene/losses.hpp"

#include <fmt/format.h>

#include "enum_array.hpp"

namespace raypool {
namespace {

constexpr EnumArray<Loss, const char*, 9> kWords = {
    "with textures: the colours beside them are used alone",
    "with emission, which is not used: the one light is a point",
    "with transparency, drawn opaque",
    "with extensions (KHR_materials_..., or Pm, Ps and Pc of MTL), which are not used",
    "of points or lines, not drawn",
    "with vertex colours, which are not used",
    "with vertex normals, which are not used: shading is flat",
    "not played: all is where the nodes are",
    "with textures of normals, occlusion or other things, which are not used"};

}  // namespace

void tell_count(std::vector<std::string>& warnings, const std::string& path, size_t count, const std::string& thing,
                const std::string& one, const std::string& several) {
  if (count == 0) return;
  warnings.push_back(
      fmt::format("{}: {} {}{} {}", path, count, thing, count == 1 ? "" : "s", count == 1 ? one : several));
}

void tell_loss(std::vector<std::string>& warnings, const std::string& path, size_t count, const std::string& thing,
               Loss loss) {
  tell_count(warnings, path, count, thing, kWords[loss], kWords[loss]);
}

void tell_losses(std::vector<std::string>& warnings, const std::string& path, const MaterialLosses& losses) {
  tell_loss(warnings, path, losses.textures, "material", Loss::Textures);
  tell_loss(warnings, path, losses.other_textures, "material", Loss::OtherTextures);
  tell_loss(warnings, path, losses.emissive, "material", Loss::Emission);
  tell_loss(warnings, path, losses.transparent, "material", Loss::Transparency);
  tell_loss(warnings, path, losses.extensions, "material", Loss::MaterialExtensions);
  tell_count(warnings, path, losses.beyond, "material", "with factors beyond 0 .. 1, of which the nearest is taken",
             "with factors beyond 0 .. 1, of which the nearest are taken");
}

}  // namespace raypool
