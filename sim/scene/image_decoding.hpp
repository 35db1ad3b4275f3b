// PNG and JPEG files as textures.
#pragma once

#include <optional>
#include <string>

#include "scene/surfaces.hpp"

namespace raypool {

inline constexpr uint32_t kLargestImage = 16384;  ///< pixels a side

/// `srgb`: red, green and blue are sRGB, and become linear; alpha is linear in every file. None when the bytes are
/// neither a PNG nor a JPEG that can be read; `reason` says why then.
std::optional<SurfaceImage> decode_image(const std::string& bytes, bool srgb, std::string& reason);

}  // namespace raypool
