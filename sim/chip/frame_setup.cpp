#include "chip/frame_setup.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "config/limits.hpp"

namespace raypool::chip {

namespace {

void require_range(const char* what, uint32_t value, uint32_t low, uint32_t high) {
  if (value < low || value > high)
    throw InputError(fmt::format("{} is {}; it must lie in {} .. {}", what, value, low, high));
}

}  // namespace

void check_frame(const ChipOptions& options) {
  if (options.memory == nullptr || options.frame == nullptr) throw std::logic_error("a frame needs memory and frame");
  require_range("image width", options.width, 1, 65535);
  require_range("image height", options.height, 1, 65535);
  require_range("depth", options.depth, 1, kLargestDepth);
  check_configuration(options.configuration, "configuration " + options.configuration.name);
  check_program_length(options.configuration, options.program_length);
  if (options.layout.words != options.configuration.intersection_words)
    throw std::logic_error("the program imports records of another size than the configuration has");
}

std::array<uint32_t, kArguments> frame_arguments(const ChipOptions& options) {
  const uint32_t width_log2 = tile_width_log2(options.configuration.contents());
  std::array<uint32_t, kArguments> arguments = options.arguments;
  arguments[argument::kTileWidthLog2] = width_log2;
  arguments[argument::kTileMask] = (1u << width_log2) - 1;
  arguments[argument::kWidth] = options.width;
  arguments[argument::kHeight] = options.height;
  return arguments;
}

FrameSetup frame_setup(const ChipOptions& options) {
  FrameSetup setup;
  setup.program_length = options.program_length;
  setup.memory_limit = options.memory->size();
  setup.arguments = frame_arguments(options);
  setup.entries = options.entries;
  setup.width = options.width;
  setup.height = options.height;
  setup.depth = options.depth;
  setup.reflections = secondary_kernel(options.depth, options.reflections) == RayKernel::CastSecondary;
  if (options.tree != nullptr) setup.tree = options.tree->setup;
  setup.tree.layout = options.layout;
  setup.tiles = options.tiles;
  return setup;
}

TileWalk tile_walk(const Configuration& configuration, uint32_t width, uint32_t height) {
  TileWalk walk(configuration.chip.tile_order, configuration.contents(), configuration.chip.held_limit);
  walk.start(width, height);
  return walk;
}

std::vector<PixelTile> along_walk(const Configuration& configuration, uint32_t width, uint32_t height) {
  std::vector<PixelTile> tiles;
  TileWalk walk = tile_walk(configuration, width, height);
  for (walk.await(); walk.busy(); walk.next())
    tiles.push_back({walk.tile().left, walk.tile().top, walk.tile_width() * walk.tile_height()});
  return tiles;
}

}  // namespace raypool::chip
