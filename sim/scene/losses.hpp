// The sentences about what a scene file has and a picture of it does not: the same words for every format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace raypool {

enum class Loss : uint8_t {
  Textures,
  Emission,
  Transparency,
  MaterialExtensions,
  PointsOrLines,
  VertexColours,
  VertexNormals,
  Animations,
  OtherTextures,
};

/// Adds "a.gltf: 3 materials with emission, which is not used" to `warnings`; nothing of a `count` of 0. `thing` is
/// what was counted, in the singular: "material".
void tell_loss(std::vector<std::string>& warnings, const std::string& path, size_t count, const std::string& thing,
               Loss loss);

/// The same with words of its own: "a.obj: 2 materials are odd" of `one` "is odd" and `several` "are odd".
void tell_count(std::vector<std::string>& warnings, const std::string& path, size_t count, const std::string& thing,
                const std::string& one, const std::string& several);

/// What of materials has no counterpart here: in how many of those that are drawn.
struct MaterialLosses {
  size_t other_textures = 0;  ///< which surfaces have not either
  size_t textures = 0, emissive = 0, transparent = 0, extensions = 0;
  size_t beyond = 0;  ///< 0 .. 1, where a number must lie within
};
void tell_losses(std::vector<std::string>& warnings, const std::string& path, const MaterialLosses& losses);

}  // namespace raypool
