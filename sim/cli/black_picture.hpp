// Explains why a picture is black.
#pragma once

#include <string>

#include "scene/image.hpp"
#include "scene/ray_counts.hpp"
#include "scene/scene.hpp"

namespace raypool {

/// What has chosen the place of the eye.
enum class EyeOf { User, File, Automatic };

/// A sentence with what to try; empty unless every pixel of the PNG is black. `shaders`: a shader set has drawn it.
std::string why_black(const FrameBuffer& frame, const RayCounts& rays, const Scene& scene, EyeOf eye,
                      bool shaders = false);

}  // namespace raypool
