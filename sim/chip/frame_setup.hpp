// The inputs of a chip before it draws a frame, the same for all engines.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "chip/chip.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/tile_walk.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::chip {

/// Throws InputError for options out of range, std::logic_error without what it takes to draw.
void check_frame(const ChipOptions& options);

/// The kernels' arguments, with the words that the chip sets.
std::array<uint32_t, kArguments> frame_arguments(const ChipOptions& options);

/// What a host writes for the frame of these options.
FrameSetup frame_setup(const ChipOptions& options);
/// The walk over the tiles of a picture, which has begun.
TileWalk tile_walk(const Configuration& configuration, uint32_t width, uint32_t height);
/// The tiles in the order in which they are cast, when all are.
std::vector<PixelTile> along_walk(const Configuration& configuration, uint32_t width, uint32_t height);

}  // namespace raypool::chip
