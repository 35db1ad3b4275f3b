#include "chip/tile_watch.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bits.hpp"
#include "chip/frame_setup.hpp"

namespace raypool::chip {

TileWatch::TileWatch(const ChipOptions& options, uint32_t units, const ChipOutputs& begin,
                     std::function<Counts()> counts)
    : options_(options),
      walk_(tile_walk(options.configuration, options.width, options.height)),
      columns_((options.width + walk_.tile_width() - 1) / walk_.tile_width()),
      counts_(std::move(counts)),
      pixels_({options.width, options.height, units, static_cast<uint32_t>(options.configuration.chip.ray_pool_size),
               options.configuration.kernel_overlap, options.layout, options.shaders},
              begin),
      tile_of_(place(options.width - 1, options.height - 1) + 1) {}

bool TileWatch::launched(uint32_t unit, RayKernel kernel, const LaunchCommand& launch) {
  if (kernel != RayKernel::CastEye) {
    pixels_.launched(unit, kernel, launch.threads);
    return false;
  }
  const uint32_t left = launch.block & 0xffff, top = launch.block >> 16;
  std::vector<uint32_t> pixels;
  for (uint32_t y = top; y < std::min(top + walk_.tile_height(), options_.height); ++y)
    for (uint32_t x = left; x < std::min(left + walk_.tile_width(), options_.width); ++x) pixels.push_back(x | y << 16);
  pixels_.eye_launched(unit, pixels);
  tile_of_[place(left, top)] = options_.tile_costs->cast(size32(pixels), counts_());
  const uint32_t next = cast_ == 0 ? 0 : number_ + 1;
  number_ = options_.tiles.empty() ? cast_ : options_.tiles.at(cast_);
  ++cast_;
  return number_ != next;
}

void TileWatch::clock(const ChipOutputs& outputs, const TraverserPorts& traverser) {
  pixels_.clock(outputs, traverser);
  if (pixels_.finished().empty()) return;
  const Counts now = counts_();
  for (const uint32_t pixel : pixels_.finished())
    options_.tile_costs->finished(tile_of_[place(pixel & 0xffff, pixel >> 16)], now);
}

void TileWatch::end() {
  if (pixels_.held() != 0) throw std::runtime_error("the frame has ended, and something still works on a pixel");
  options_.tile_costs->end(counts_());
}

}  // namespace raypool::chip
