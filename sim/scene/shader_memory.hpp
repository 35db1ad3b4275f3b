// What a shader set is given of a frame and a scene, in the memory of the units.
#pragma once

#include <cstdint>

#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "shader/resources.hpp"
#include "shader/shader_set.hpp"

namespace raypool {

/// The frame that the set draws.
struct ShaderFrame {
  uint32_t width = 0, height = 0;  ///< pixels
  uint32_t samples = 1;            ///< frames that add up to the picture
  float offset = 0;                ///< offset_share() of the eye rays
  CameraNumbers camera{};
};

/// Puts behind the program and the materials of `image`, from 1 MiB on, what the bindings of the set hold, and returns
/// where. Throws InputError when the scene or the memory lacks something.
shader::Resources build_shader_memory(MemoryImage& image, const Scene& scene, const shader::ShaderSet& set,
                                      const ShaderFrame& frame);

}  // namespace raypool
