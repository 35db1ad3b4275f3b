// What a chip is told before it draws a frame, whoever plays it.
#pragma once

#include <array>
#include <cstdint>

#include "chip/chip.hpp"

namespace raypool::chip {

/// Throws InputError for options out of range, std::logic_error without what it takes to draw.
void check_frame(const ChipOptions& options);

/// The kernels' arguments, with the words that the chip sets.
std::array<uint32_t, kArguments> frame_arguments(const ChipOptions& options);

}  // namespace raypool::chip
