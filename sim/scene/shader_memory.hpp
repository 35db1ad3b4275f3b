// The unit's memory as shader sets see it: the buffers, textures and uniform blocks of shaders/raypool.glsl, or those
// that a set's own shaders.json describes (schemas/shaders.json).
#pragma once

#include <cstdint>

#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "shader/resources.hpp"
#include "shader/shader_set.hpp"

namespace raypool {

/// What of a frame shaders see.
struct ShaderFrame {
  uint32_t width = 0, height = 0;  ///< pixels
  uint32_t depth = 1;              ///< of the deepest rays
  uint32_t samples = 1;            ///< frames that are added up
  float offset = 0;                ///< offset_share()
  CameraNumbers camera{};          ///< camera_numbers() of this width and height
};

/// Data of shaders begin here, or behind program and material records where those are larger.
inline constexpr uint32_t kShaderDataBegin = 1u << 20;
/// Of a 32-byte material record: the address of the RaypoolMaterial, where a shader set draws.
inline constexpr uint32_t kMaterialSurface = 12;
/// The kernel argument with the sample's number.
inline constexpr uint32_t kSampleArgument = 23;

/// Puts what the set's bindings hold into the memory, which grows, and links the material records to their
/// RaypoolMaterial. `image` is build_memory()'s of the same scene; one without Scene::surfaces gets flat ones. Throws
/// InputError naming set, binding and member where the set wants what is not known or has another shape.
shader::Resources build_shader_memory(MemoryImage& image, const Scene& scene, const shader::ShaderSet& set,
                                      const ShaderFrame& frame);

}  // namespace raypool
