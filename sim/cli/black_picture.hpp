// Why a picture is black, for one who looks at it and wonders.
#pragma once

#include <string>

#include "scene/image.hpp"
#include "scene/ray_counts.hpp"

namespace raypool {

/// A sentence with what to try; empty unless every pixel of the PNG is black.
std::string why_black(const FrameBuffer& frame, const RayCounts& rays);

}  // namespace raypool
