#include "scene/unstable_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "bits.hpp"
#include "kernel/kernels.hpp"

namespace raypool {

void move_last_bits(std::array<uint32_t, kArguments>& arguments, int number) {
  std::mt19937 random(static_cast<uint32_t>(number));
  constexpr float kEnds[2] = {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  for (int i = argument::kEye; i < argument::kLight; ++i) {
    const uint32_t choice = random() % 3;
    if (choice != 2) arguments[i] = as_bits(std::nextafter(as_float(arguments[i]), kEnds[choice]));
  }
}

UnstablePixels::UnstablePixels(const FrameBuffer& frame)
    : width_(frame.width()), height_(frame.height()), rgb_(to_rgb8(frame)), changes_(size_t{width_} * height_) {}

void UnstablePixels::add(const FrameBuffer& moved) {
  const std::vector<uint8_t> rgb = to_rgb8(moved);
  for (size_t pixel = 0; pixel < changes_.size(); ++pixel) {
    if (std::equal(&rgb[3 * pixel], &rgb[3 * pixel] + 3, &rgb_[3 * pixel])) continue;
    pixels += changes_[pixel] == 0;
    ++changes_[pixel];
  }
  ++frames;
}

std::vector<uint8_t> UnstablePixels::png() const {
  std::vector<uint8_t> map(rgb_.size());
  for (size_t pixel = 0; pixel < changes_.size(); ++pixel) {
    const int grey = (rgb_[3 * pixel] + rgb_[3 * pixel + 1] + rgb_[3 * pixel + 2]) / 6;
    std::fill_n(&map[3 * pixel], 3, static_cast<uint8_t>(grey));
    if (changes_[pixel] == 0) continue;
    map[3 * pixel] = static_cast<uint8_t>(128 + 127 * changes_[pixel] / frames);
    map[3 * pixel + 1] = map[3 * pixel + 2] = 0;
  }
  return encode_png(width_, height_, map);
}

}  // namespace raypool
