// The frame buffer, with a content that does not depend on the order of contributions, and writing it as a PNG file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "machine/compute/compute_unit.hpp"

namespace raypool {

/// A contribution as the frame buffer adds it: unsigned fixed point, unit 2^-32. NaN and everything
/// not above zero give 0; the rest is rounded to the nearest unit, halves up; values of 2^32 and more,
/// and infinity, give the largest number.
uint64_t to_fixed(float contribution);

/// Width x height pixels of three 64-bit accumulators that saturate. Addition of non-negative numbers that saturates is
/// associative and commutative, so the picture depends on the set of contributions only.
class FrameBuffer {
 public:
  /// Throws InputError unless both lie in 1 .. 65535.
  FrameBuffer(uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// x to the right, y downwards, both from 0. Returns false, and adds nothing, when the pixel lies outside.
  bool add(const FrameContribution& contribution);
  /// Adds another frame buffer of the same size.
  void add(const FrameBuffer& other);

  /// Channel 0 .. 2, in units of 2^-32.
  uint64_t raw(uint32_t x, uint32_t y, uint32_t channel) const { return accumulators_[index(x, y) + channel]; }
  double linear(uint32_t x, uint32_t y, uint32_t channel) const { return raw(x, y, channel) * 0x1p-32; }

  bool operator==(const FrameBuffer& other) const {
    return width_ == other.width_ && height_ == other.height_ && accumulators_ == other.accumulators_;
  }

 private:
  size_t index(uint32_t x, uint32_t y) const { return 3 * (size_t{y} * width_ + x); }

  uint32_t width_, height_;
  std::vector<uint64_t> accumulators_;
};

/// 8 bits of a linear value: clamped to 0 .. 1, the sRGB transfer function (IEC 61966-2-1), times 255, rounded.
uint8_t to_srgb8(double linear);

/// Rows from the top, 3 bytes a pixel.
std::vector<uint8_t> to_rgb8(const FrameBuffer& frame);

/// The PNG file's bytes: 8 bits a channel, the same for the same frame buffer.
std::vector<uint8_t> encode_png(const FrameBuffer& frame);
/// The same of rows from the top, 3 bytes a pixel.
std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, const std::vector<uint8_t>& rgb);

/// Throws InputError when it cannot be written.
void write_png(const FrameBuffer& frame, const std::string& path);

struct ImageDifference {
  uint64_t pixels = 0;   ///< that differ in any accumulator
  uint64_t visible = 0;  ///< that differ in the 8-bit pictures
  double psnr = 0;       ///< of the 8-bit pictures, dB; infinity when they are equal
  int largest = 0;       ///< largest 8-bit difference
};
/// Throws InputError when the sizes differ.
ImageDifference compare(const FrameBuffer& a, const FrameBuffer& b);

}  // namespace raypool
