#include "scene/mtl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/obj_text.hpp"

namespace raypool {
namespace {

constexpr float kLargestColour = 1000;
constexpr float kGrey = 0.5f;
constexpr float kLargestExponent = 1e9f, kLargestIndex = 10, kLargestEmission = 1e9f;
constexpr float kTexturedKd = 0.6f;  // of a material with a texture and no Kd

/// Linear RGB of IEC 61966-2-1, with white D65; what is outside of it becomes 0.
Vec3 rgb_of_xyz(const Vec3& xyz) {
  const Vec3d c = xyz.as<double>();
  const Vec3d rgb{3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z,
                  -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
                  0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
  Vec3 result;
  for (int i = 0; i < 3; ++i) result[i] = std::clamp(static_cast<float>(rgb[i]), 0.0f, kLargestColour);
  return result;
}

bool any_number(const ObjLine& line, bool (*holds)(float)) {
  const std::vector<std::string_view> words = words_of(line.rest);
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    float value = 0;
    return read_float(word, value) && holds(value);
  });
}

bool is_texture(std::string_view key) {
  static constexpr std::array<std::string_view, 6> kOthers = {"bump", "disp", "decal", "refl", "norm", "Bump"};
  return (key.substr(0, 4) == "map_" && key != "map_aat") ||
         std::find(kOthers.begin(), kOthers.end(), key) != kOthers.end();
}

class MtlReader {
 public:
  MtlReader(const std::string& path, std::vector<MtlMaterial>& materials)
      : text_(path, "material file"), materials_(materials) {}

  void read() {
    for (ObjLine line; text_.next(line);) {
      if (line.key == "newmtl") {
        finish();
        now_ = {};
        now_.material.name = line.rest;
        now_.material.path = text_.path();
        now_.named = true;
      } else {
        set(line);
      }
    }
    finish();
  }

 private:
  /// The material of the statements that are read; before the first name there is none.
  struct Reading {
    MtlMaterial material;
    bool named = false, kd = false, map_kd = false, alpha_map = false;
    std::optional<bool> seen_through;  // by d, or else Tr
    bool has_d = false;
  };

  void set(const ObjLine& line) {
    MtlMaterial& material = now_.material;
    if (line.key == "Kd") {
      material.kd = colour(line, "colour Kd");
      now_.kd = material.kd_given = true;
    } else if (line.key == "Ks") {
      material.ks = colour(line, "colour Ks");
    } else if (line.key == "illum") {
      std::string_view rest = line.rest;
      material.illum = number_of(text_, line, next_word(rest), "illum", -1000, 1000);
    } else if (line.key == "Ns") {
      material.ns = first_number(line, 0, kLargestExponent);
    } else if (line.key == "Ni") {
      material.ni = first_number(line, 1, kLargestIndex);
    } else if (line.key == "Pr") {
      material.pr = first_number(line, 0, 1);
    } else if (line.key == "Ke") {
      set_emission(line);
      material.emission = material.emission || any_number(line, [](float value) { return value > 0; });
    } else if (line.key == "d" || (line.key == "Tr" && !now_.has_d)) {
      // d is how opaque the material is, and Tr how transparent.
      now_.has_d = line.key == "d";
      if (const std::optional<float> number = first_number(line, 0, 1))
        material.opacity = now_.has_d ? *number : 1 - *number;
      now_.seen_through = now_.has_d ? any_number(line, [](float value) { return value < 1; })
                                     : any_number(line, [](float value) { return value > 0; });
    } else if (line.key == "Pm" || line.key == "Ps" || line.key == "Pc") {
      const bool set = any_number(line, [](float value) { return value > 0; });
      material.extension = material.extension || set;
      if (line.key == "Pm") {
        material.pm = first_number(line, 0, 1);
      } else {
        material.other_extension = material.other_extension || set;
      }
    } else if (is_texture(line.key)) {
      material.texture = true;
      now_.map_kd = now_.map_kd || line.key == "map_Kd";
      now_.alpha_map = now_.alpha_map || line.key == "map_d";
      material.emission = material.emission || line.key == "map_Ke";
      set_map(line);
    }
  }

  /// None when it is no number in its range.
  static std::optional<float> first_number(const ObjLine& line, float low, float high) {
    std::string_view rest = line.rest;
    float value = 0;
    return read_float(next_word(rest), value) && value >= low && value <= high ? std::optional(value) : std::nullopt;
  }
  void set_emission(const ObjLine& line) {
    const std::vector<std::string_view> words = words_of(line.rest);
    now_.material.ke_given = true;
    for (size_t i = 0; i < 3 && !words.empty(); ++i) {
      float value = 0;
      if (!read_float(words[std::min(i, words.size() - 1)], value) || !(value >= 0 && value <= kLargestEmission))
        return;
      now_.material.ke[static_cast<int>(i)] = value;
    }
  }
  /// Options stand before the name, which may have blanks.
  void set_map(const ObjLine& line) {
    MtlMaterial& material = now_.material;
    MtlMaterial::Map* const map = line.key == "map_Kd"   ? &material.map_kd
                                  : line.key == "map_Ke" ? &material.map_ke
                                  : line.key == "map_d"  ? &material.map_d
                                  : line.key == "map_Pr" ? &material.map_pr
                                  : line.key == "map_Pm" ? &material.map_pm
                                                         : nullptr;
    if (map == nullptr) {
      material.other_texture = true;
      return;
    }
    std::string_view rest = line.rest;
    while (!rest.empty() && rest.front() == '-') {
      const std::string_view option = next_word(rest);
      const bool vector = option == "-o" || option == "-s" || option == "-t";
      const size_t most = vector ? 3 : option == "-mm" ? 2 : 1;
      for (size_t i = 0; i < most; ++i) {
        std::string_view behind = rest;
        const std::string_view word = next_word(behind);
        float value = 0;
        if (vector && !read_float(word, value)) break;
        rest = behind;
        if (option == "-clamp") {
          map->clamp = word == "on";
        } else if (option != "-s" ? value != 0 : value != 1) {
          material.map_options = true;
        }
      }
      rest = trimmed(rest);
    }
    map->file = rest;
    if (map->file.size() > 2 && map->file.front() == '"' && map->file.back() == '"')
      map->file = map->file.substr(1, map->file.size() - 2);
  }

  void finish() {
    if (!now_.named) return;
    MtlMaterial& material = now_.material;
    if (!now_.kd && now_.map_kd) material.kd = {kTexturedKd, kTexturedKd, kTexturedKd};
    // These models of light are glass, unless the file states how opaque it is.
    static constexpr std::array<float, 4> kGlass = {4, 6, 7, 9};
    const bool glass = material.illum && std::find(kGlass.begin(), kGlass.end(), *material.illum) != kGlass.end();
    material.transparent = now_.alpha_map || now_.seen_through.value_or(glass);
    materials_.push_back(material);
  }

  /// One number stands for all three.
  Vec3 colour(const ObjLine& line, const char* what) {
    std::vector<std::string_view> words = words_of(line.rest);
    if (!words.empty() && words[0] == "spectral") {
      now_.material.spectral = true;
      return {kGrey, kGrey, kGrey};
    }
    const bool xyz = !words.empty() && words[0] == "xyz";
    if (xyz) words.erase(words.begin());
    if (words.empty() || words.size() == 2)
      text_.fail(line, fmt::format("{} has {} numbers; give three, or one for all", what, words.size()));
    Vec3 result;
    for (size_t i = 0; i < 3; ++i)
      result[static_cast<int>(i)] = number_of(text_, line, words[words.size() == 1 ? 0 : i], what, 0, kLargestColour);
    now_.material.xyz = now_.material.xyz || xyz;
    return xyz ? rgb_of_xyz(result) : result;
  }

  ObjText text_;
  std::vector<MtlMaterial>& materials_;
  Reading now_;
};

}  // namespace

void read_mtl(const std::string& path, std::vector<MtlMaterial>& materials) { MtlReader(path, materials).read(); }

void tell_of_materials(std::vector<std::string>& warnings, const std::string& path,
                       const std::vector<MtlMaterial>& materials, const std::vector<bool>& used, bool surfaces) {
  MaterialLosses losses;
  size_t options = 0;
  size_t highlights = 0, mirrors = 0, assumed = 0, spectral = 0, xyz = 0;
  for (size_t i = 0; i < materials.size(); ++i) {
    if (!used[i]) continue;
    const MtlMaterial& material = materials[i];
    if (surfaces) {
      losses.other_textures += material.other_texture;
      losses.extensions += material.other_extension;
      options += material.map_options;
    } else {
      losses.textures += material.texture;
      losses.emissive += material.emission;
      losses.transparent += material.transparent;
      losses.extensions += material.extension;
    }
    spectral += material.spectral;
    xyz += material.xyz;
    if (!(material.ks.x > 0 || material.ks.y > 0 || material.ks.z > 0)) continue;
    highlights += !material.reflects();
    mirrors += material.illum && material.reflects();
    assumed += !material.illum;
  }
  // Where nothing is left out and nothing assumed, there is nothing to report.
  if (!surfaces && (highlights > 0 || assumed > 0)) {
    std::string text;
    const auto add = [&](const char* as, size_t count, const char* illum) {
      if (count == 0) return;
      text += fmt::format("{} as {} of {} material{} ({})", text.empty() ? "" : ",", as, count, count == 1 ? "" : "s",
                          illum);
    };
    add("a highlight, which is not drawn,", highlights, "illum 0, 1 or 2");
    add("a mirror reflection", mirrors, "illum 3 or above");
    add("a mirror reflection", assumed, "no illum");
    warnings.push_back(fmt::format("{}: Ks is taken{}", path, text));
  }
  tell_losses(warnings, path, losses);
  tell_count(warnings, path, options, "material",
             "with textures that are moved or scaled (-o, -s, -t), which is not done",
             "with textures that are moved or scaled (-o, -s, -t), which is not done");
  tell_count(warnings, path, spectral, "material", "with a spectral colour, taken as grey",
             "with spectral colours, taken as grey");
  tell_count(warnings, path, xyz, "material", "with a colour in CIE XYZ, converted to RGB",
             "with colours in CIE XYZ, converted to RGB");
}

}  // namespace raypool
