// For tests of textures: small images as PNG and JPEG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace raypool {

inline void append_image_bytes(void* text, void* bytes, int size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(bytes), static_cast<size_t>(size));
}
/// Of 8 bits a channel, 1 .. 4 of them.
inline std::string png_file(int width, int height, int channels, const std::vector<uint8_t>& values) {
  std::string bytes;
  stbi_write_png_to_func(append_image_bytes, &bytes, width, height, channels, values.data(), width * channels);
  return bytes;
}
inline std::string jpeg_file(int width, int height, const std::vector<uint8_t>& rgb) {
  std::string bytes;
  stbi_write_jpg_to_func(append_image_bytes, &bytes, width, height, 3, rgb.data(), 100);
  return bytes;
}

}  // namespace raypool
