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

struct PictureDifference {
  uint64_t pixels = 0;  ///< of the picture
  uint64_t differ = 0;  ///< of these, pixels of which a channel is another
  int largest = 0;      ///< difference of a channel, of 255
  double mean = 0;      ///< difference of a channel, over all channels of all pixels
  double psnr = 0;      ///< dB; infinity when they are equal
};

/// Both must have the same size.
PictureDifference difference_of(const Picture& a, const Picture& b);

}  // namespace raypool
