// For tests: pictures that a chip draws one after another without a reset, each of another scene, tree and camera, in
// the memories of the one before.
#pragma once

#include <deque>

#include "rtl/traverser_frames.hpp"

namespace raypool::test {

/// Bytes that a chip's memory has behind the first scene, for those of the next ones that have more materials.
inline constexpr uint32_t kRoomForNext = 1024;

/// Draws them on the chip with this memory, each as soon as the chip is ready for it. The pictures must be the native
/// engine's; `told(result)` of each.
template <typename Told>
void draw_next(std::deque<Drawing>& drawings, Memory& memory, ChipDevice& chip, const Told& told) {
  for (Drawing& drawing : drawings) {
    drawing.stand_in(memory);
    const ChipResult result = drawing.draw_on(chip, FrameBegin::Next, &drawing != &drawings.back());
    drawing.expect_native(result);
    told(result);
  }
}

}  // namespace raypool::test
