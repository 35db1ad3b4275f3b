// What several frames come to that are drawn one after the other, on chips of the same configuration: the samples of a
// picture.
#pragma once

#include "chip/chip.hpp"

namespace raypool {

/// `sum` is then as if its frames and this one were one frame: counts and times are added, averages over time weighted
/// by it, peaks the highest. frames_per_s is that of the whole, so of pictures. An empty `sum` becomes the frame.
void add_frame(ChipResult& sum, const ChipResult& frame);

}  // namespace raypool
