#include "scene/image_decoding.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace raypool {
namespace {

/// [value of so many bits] linear.
template <size_t kCount>
std::array<uint16_t, kCount> linear_table() {
  std::array<uint16_t, kCount> table{};
  for (size_t i = 0; i < kCount; ++i) {
    const double value = static_cast<double>(i) / (kCount - 1);
    table[i] = static_cast<uint16_t>(std::lround(65535 * srgb_to_linear(value)));
  }
  return table;
}

template <typename Channel>
using Channels = std::unique_ptr<Channel, decltype(&std::free)>;

}  // namespace

std::optional<SurfaceImage> decode_image(const std::string& bytes, bool srgb, std::string& reason) {
  constexpr size_t kChannels = 4;
  static const auto kLinear8 = linear_table<256>();
  static const auto kLinear16 = linear_table<65536>();
  if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
    reason = "it has more than 2 GiB";
    return std::nullopt;
  }
  const auto* const data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  SurfaceImage image;
  const auto take = [&](const auto* values, const auto& texel) {
    if (values == nullptr) return;
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    image.texels.resize(kChannels * image.width * image.height);
    for (size_t i = 0; i < image.texels.size(); ++i)
      image.texels[i] = texel(values[i], srgb && i % kChannels != kChannels - 1);
  };
  if (stbi_is_16_bit_from_memory(data, size) != 0) {
    const Channels<stbi_us> values(stbi_load_16_from_memory(data, size, &width, &height, &channels, kChannels),
                                   &std::free);
    take(values.get(), [](uint16_t value, bool decode) { return decode ? kLinear16[value] : value; });
  } else {
    const Channels<stbi_uc> values(stbi_load_from_memory(data, size, &width, &height, &channels, kChannels),
                                   &std::free);
    take(values.get(),
         [](uint8_t value, bool decode) { return decode ? kLinear8[value] : static_cast<uint16_t>(257 * value); });
  }
  if (image.texels.empty()) {
    const char* const why = stbi_failure_reason();
    reason = fmt::format("it is not a PNG or JPEG that can be read{}", why == nullptr ? "" : fmt::format(" ({})", why));
    return std::nullopt;
  }
  return image;
}

}  // namespace raypool
