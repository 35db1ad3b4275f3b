// Pixels of a picture that change when the last bits of the camera's numbers do: what is on them is not decided by
// what the picture shows, but by how its numbers are rounded.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "machine/common/packages.hpp"
#include "scene/image.hpp"

namespace raypool {

/// Moves each of the twelve numbers of eye and directions of pixels by a unit in the last place, up, down or not at
/// all; `number` chooses which, and the same number always the same.
void move_last_bits(std::array<uint32_t, kArguments>& arguments, int number);

class UnstablePixels {
 public:
  explicit UnstablePixels(const FrameBuffer& frame);
  /// One of the same frame with last bits moved, of the same size.
  void add(const FrameBuffer& moved);
  /// The picture in grey, and in red the pixels that have changed; the brighter, the more of the frames.
  std::vector<uint8_t> png() const;

  uint64_t frames = 0;  ///< so many have been added
  uint64_t pixels = 0;  ///< of which a channel of 8 bits is another in one of them

 private:
  uint32_t width_, height_;
  std::vector<uint8_t> rgb_;
  std::vector<uint32_t> changes_;  // [pixel]
};

}  // namespace raypool
