// Size of an image as a user writes it: WIDTHxHEIGHT.
#pragma once

#include <string>

namespace raypool {

inline constexpr int kLargestImageSide = 16384;

struct ImageSize {
  int width = 0, height = 0;  ///< pixels, 1 .. kLargestImageSide
};

/// Throws InputError when `text` is not WIDTHxHEIGHT with both in range.
ImageSize parse_image_size(const std::string& text);

}  // namespace raypool
