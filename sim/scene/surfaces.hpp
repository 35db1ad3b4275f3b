// What only shader sets see of a scene: normals, texture coordinates and colours of vertices, metallic-roughness
// materials, textures, all lights. docs/use/scenes.md, "For shader sets".
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/vec.hpp"
#include "shader/resources.hpp"

namespace raypool {

struct Scene;

using Texcoord = std::array<float, 2>;  ///< u to the right, v downwards
using Rgba = std::array<float, 4>;      ///< linear

enum class AlphaMode : uint8_t { Opaque, CutOut, Blend };

/// As glTF defines it. Textures are indices into Surfaces::textures.
struct SurfaceMaterial {
  Rgba base_color{1, 1, 1, 1};
  Vec3 emission;  ///< radiance
  float metallic = 0, roughness = 1, transmission = 0;
  float ior = 1.5f;
  AlphaMode alpha_mode = AlphaMode::Opaque;
  float alpha_cutoff = 0.5f;
  std::optional<uint32_t> base_color_texture, emission_texture, metallic_roughness_texture;

  bool emits() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
};

/// Texels from the top left, row by row: red, green, blue, alpha, linear; 65535 is 1.
struct SurfaceImage {
  uint32_t width = 0, height = 0;
  std::vector<uint16_t> texels;
};

struct SurfaceTexture {
  uint32_t image = 0;  ///< of Surfaces::images
  shader::Wrap wrap_s = shader::Wrap::Repeat, wrap_t = shader::Wrap::Repeat;
  bool nearest = false;  ///< not filtered

  bool operator==(const SurfaceTexture& other) const {
    return image == other.image && wrap_s == other.wrap_s && wrap_t == other.wrap_t && nearest == other.nearest;
  }
};

struct SurfaceLight {
  enum class Kind : uint8_t { Point, Spot, Directional };
  Kind kind = Kind::Point;
  Vec3 position;
  Vec3 direction{0, 0, -1};              ///< in which it shines, unit length
  Vec3 color;                            ///< radiant intensity; Directional: irradiance
  float range = 0;                       ///< 0: without end
  float inner_cone = 0, outer_cone = 0;  ///< of a Spot: angles from its direction, radians
};

struct Surfaces {
  std::vector<std::array<uint32_t, 3>> triangles;  ///< vertices of each triangle of the scene, in its order
  /// [vertex] Texture coordinates and colours may be empty: all are (0, 0) and 1 then.
  std::vector<Vec3> positions, normals;
  std::vector<Texcoord> texcoords;
  std::vector<Rgba> colors;
  std::vector<SurfaceMaterial> materials;  ///< [material of the scene]
  std::vector<SurfaceImage> images;
  std::vector<SurfaceTexture> textures;
  std::vector<SurfaceLight> lights;  ///< emissive triangles are not among them
  Vec3 background;

  /// The index of this texture, which is added unless it is there.
  uint32_t add_texture(const SurfaceTexture& texture);
};

/// Makes normals unit vectors, where they are zero or no numbers those of their triangles, and drops vertices that no
/// triangle has.
void finish(Surfaces& surfaces);

/// Of a scene that has none: flat, in the materials' own colours.
Surfaces surfaces_of(const Scene& scene);

/// Diffuse colour and mirror reflectance as metallic-roughness.
SurfaceMaterial surface_material(const Vec3& kd, const Vec3& ks);

/// IEC 61966-2-1.
double srgb_to_linear(double value);

}  // namespace raypool
