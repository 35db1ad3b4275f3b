#include "scene/picture_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "files/input_file.hpp"
#include "isa/input_error.hpp"

namespace raypool {

Picture read_png(const std::string& path) {
  const std::string bytes = read_file(path, "picture");
  Picture picture;
  int channels = 0;
  const bool fits = bytes.size() <= static_cast<size_t>(std::numeric_limits<int>::max());
  const std::unique_ptr<stbi_uc, decltype(&std::free)> data(
      fits ? stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                                   &picture.width, &picture.height, &channels, 3)
           : nullptr,
      &std::free);
  if (!data) throw InputError(fmt::format("{}: not a PNG that can be read", path));
  picture.rgb.assign(data.get(),
                     data.get() + size_t{3} * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  return picture;
}

PictureDifference difference_of(const Picture& a, const Picture& b) {
  PictureDifference result;
  uint64_t sum = 0, squares = 0;
  for (size_t i = 0; i < a.rgb.size(); i += 3) {
    int largest = 0;  // of this pixel
    for (size_t channel = 0; channel < 3; ++channel) {
      const int difference = std::abs(int{a.rgb[i + channel]} - int{b.rgb[i + channel]});
      largest = std::max(largest, difference);
      sum += static_cast<uint64_t>(difference);
      squares += static_cast<uint64_t>(difference * difference);
    }
    ++result.pixels;
    result.differ += largest > 0;
    result.off_by_more += largest >= kOffByMore;
    result.largest = std::max(result.largest, largest);
  }
  result.mean = a.rgb.empty() ? 0 : static_cast<double>(sum) / a.rgb.size();
  result.psnr = squares == 0 ? INFINITY : 10 * std::log10(255.0 * 255.0 * a.rgb.size() / squares);
  return result;
}

}  // namespace raypool
