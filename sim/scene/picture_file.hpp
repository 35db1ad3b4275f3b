// Pictures that runs have left, read again and compared.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace raypool {

struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;  ///< rows from the top, 3 bytes a pixel
};

/// Throws InputError when the file cannot be read, or is no PNG.
Picture read_png(const std::string& path);

/// A machine's picture passes when at most this share of its pixels is off from double precision, one pixel by so much
/// of 255 or more in any channel: a step of 1 is rounding, and invisible.
inline constexpr int kOffByMore = 2;
inline constexpr double kMostOff = 0.01;

struct PictureDifference {
  uint64_t pixels = 0;       ///< of the picture
  uint64_t differ = 0;       ///< of these, pixels of which a channel is another
  uint64_t off_by_more = 0;  ///< of these, pixels of which a channel is off by kOffByMore or more
  int largest = 0;           ///< difference of a channel, of 255
  double mean = 0;           ///< difference of a channel, over all channels of all pixels
  double psnr = 0;           ///< dB; infinity when they are equal

  double share_off() const { return static_cast<double>(off_by_more) / static_cast<double>(pixels); }
  bool passes() const { return share_off() <= kMostOff; }
};

/// Both must have the same size, of at least a pixel.
PictureDifference difference_of(const Picture& a, const Picture& b);

}  // namespace raypool
