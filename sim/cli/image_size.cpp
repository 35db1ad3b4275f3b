#include "cli/image_size.hpp"

#include <fmt/format.h>

#include <charconv>

#include "config/configuration.hpp"

namespace raypool {

ImageSize parse_image_size(const std::string& text) {
  ImageSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  bool good = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
  if (good) {
    const auto height = std::from_chars(width.ptr + 1, end, size.height);
    good = height.ec == std::errc{} && height.ptr == end;
  }
  const auto in_range = [](int side) { return side >= 1 && side <= kLargestImageSide; };
  if (!good || !in_range(size.width) || !in_range(size.height)) {
    throw InputError(
        fmt::format("size '{}' is not WIDTHxHEIGHT in pixels, each from 1 to {}: write for example 256x256", text,
                    kLargestImageSide));
  }
  return size;
}

}  // namespace raypool
