// Records a board's tiles in TileCosts: when each is cast, and when each of its pixels is finished.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "chip/chip.hpp"
#include "chip/pixel_watch.hpp"
#include "chip/tile_costs.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/tile_walk.hpp"

namespace raypool::chip {

class TileWatch {
 public:
  /// `options` has the tile_costs that it fills, and must outlive it. `begin`: what the chip shows in the frame's first
  /// cycle. `counts`: all that has been counted until now.
  TileWatch(const ChipOptions& options, uint32_t units, const ChipOutputs& begin, std::function<Counts()> counts);

  /// A unit takes a launch. Returns true for a tile that is cast without its predecessor: number() is its number.
  bool launched(uint32_t unit, RayKernel kernel, const LaunchCommand& launch);
  /// Of the last tile that was launched, along the walk.
  uint32_t number() const { return number_; }
  /// Once in a cycle, after launched(). `traverser`: what it shows, inside or at the ports.
  void clock(const ChipOutputs& outputs, const TraverserPorts& traverser);
  /// The frame has ended. Throws std::runtime_error if a pixel has not.
  void end();

 private:
  size_t place(uint32_t x, uint32_t y) const {
    return size_t{y / walk_.tile_height()} * columns_ + x / walk_.tile_width();
  }

  const ChipOptions& options_;
  const TileWalk walk_;
  const uint32_t columns_;  // tiles of a row
  std::function<Counts()> counts_;
  PixelWatch pixels_;
  std::vector<uint32_t> tile_of_;  // [place in the picture, row by row] number in the costs
  uint32_t cast_ = 0, number_ = 0;
};

}  // namespace raypool::chip
