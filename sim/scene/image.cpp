// Frame buffer, tone and PNG.
#include "scene/image.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "bits.hpp"
#include "files/output_files.hpp"

namespace raypool {
namespace {

uint64_t add_saturating(uint64_t a, uint64_t b) { return a + b < a ? UINT64_MAX : a + b; }

}  // namespace

uint64_t to_fixed(float contribution) {
  if (!(contribution > 0)) return 0;
  if (contribution >= 0x1p32f) return UINT64_MAX;
  // Exact but for the rounding asked for: a float of 2^-8 and more is a whole number of units,
  // and a smaller one plus a half is exact.
  const double units = contribution * 0x1p32;
  return static_cast<uint64_t>(units < 0x1p40 ? units + 0.5 : units);
}

FrameBuffer::FrameBuffer(uint32_t width, uint32_t height) : width_(width), height_(height) {
  if (width < 1 || width > 65535 || height < 1 || height > 65535) {
    throw InputError(fmt::format("image size {} x {}: width and height must lie in 1 .. 65535 pixels", width, height));
  }
  accumulators_.assign(3 * size_t{width} * height, 0);
}

bool FrameBuffer::add(const FrameContribution& contribution) {
  const uint32_t x = contribution.pixel & 0xffffu, y = contribution.pixel >> 16;
  if (x >= width_ || y >= height_) return false;
  for (size_t channel = 0; channel < 3; ++channel) {
    uint64_t& accumulator = accumulators_[index(x, y) + channel];
    accumulator = add_saturating(accumulator, to_fixed(as_float(contribution.rgb[channel])));
  }
  return true;
}

void FrameBuffer::add(const FrameBuffer& other) {
  if (width_ != other.width_ || height_ != other.height_)
    throw InputError("frame buffers of different size cannot be added");
  for (size_t i = 0; i < accumulators_.size(); ++i)
    accumulators_[i] = add_saturating(accumulators_[i], other.accumulators_[i]);
}

uint8_t to_srgb8(double linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(encoded * 255 + 0.5);
}

std::vector<uint8_t> to_rgb8(const FrameBuffer& frame) {
  std::vector<uint8_t> bytes;
  bytes.reserve(3 * size_t{frame.width()} * frame.height());
  for (uint32_t y = 0; y < frame.height(); ++y) {
    for (uint32_t x = 0; x < frame.width(); ++x) {
      for (uint32_t channel = 0; channel < 3; ++channel) bytes.push_back(to_srgb8(frame.linear(x, y, channel)));
    }
  }
  return bytes;
}

std::vector<uint8_t> encode_png(const FrameBuffer& frame) {
  return encode_png(frame.width(), frame.height(), to_rgb8(frame));
}

std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, const std::vector<uint8_t>& rgb) {
  std::vector<uint8_t> png;
  auto append = [](void* context, void* data, int size) {
    const auto* bytes = static_cast<const uint8_t*>(data);
    auto* out = static_cast<std::vector<uint8_t>*>(context);
    out->insert(out->end(), bytes, bytes + size);
  };
  if (stbi_write_png_to_func(append, &png, static_cast<int>(width), static_cast<int>(height), 3, rgb.data(),
                             static_cast<int>(3 * width)) == 0) {
    throw std::runtime_error("the picture could not be encoded as PNG");
  }
  return png;
}

void write_png(const FrameBuffer& frame, const std::string& path) {
  const std::vector<uint8_t> png = encode_png(frame);
  write_file(path, std::string(png.begin(), png.end()));
}

ImageDifference compare(const FrameBuffer& a, const FrameBuffer& b) {
  if (a.width() != b.width() || a.height() != b.height())
    throw InputError("pictures of different size cannot be compared");
  ImageDifference result;
  for (uint32_t y = 0; y < a.height(); ++y) {
    for (uint32_t x = 0; x < a.width(); ++x) {
      bool differs = false;
      for (uint32_t channel = 0; channel < 3; ++channel) differs |= a.raw(x, y, channel) != b.raw(x, y, channel);
      result.pixels += differs;
    }
  }
  const std::vector<uint8_t> pa = to_rgb8(a), pb = to_rgb8(b);
  double squares = 0;
  bool changed = false;
  for (size_t i = 0; i < pa.size(); ++i) {
    const int difference = std::abs(pa[i] - pb[i]);
    result.largest = std::max(result.largest, difference);
    squares += difference * difference;
    changed |= difference != 0;
    if (i % 3 == 2) result.visible += std::exchange(changed, false);
  }
  result.psnr = squares == 0 ? INFINITY : 10 * std::log10(255.0 * 255.0 * pa.size() / squares);
  return result;
}

}  // namespace raypool
