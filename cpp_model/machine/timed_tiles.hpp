// The walk over the tiles for who looks at it now and then: clocked up to a cycle when that is asked for.
#pragma once

#include <cstdint>

#include "machine/controller.hpp"
#include "machine/tile_walk.hpp"

namespace raypool {

class TimedTiles {
 public:
  /// The walk begins in cycle `begun`, and has its first cycle in the next one.
  TimedTiles(const TileWalk& walk, uint32_t width, uint32_t height, uint64_t begun = 0) : walk_(walk), clocks_(begun) {
    walk_.start(width, height);
  }

  /// As they are in a cycle, not before the last one that was asked for.
  Controller::Tiles in(uint64_t cycle) {
    for (; clocks_ + 1 < cycle && !walk_.settled(); ++clocks_) walk_.clock(false);
    if (clocks_ + 1 < cycle) clocks_ = cycle - 1;
    return {walk_.busy(), walk_.valid() ? &walk_.tile() : nullptr};
  }
  /// The one that is offered is taken in this cycle.
  TileWalk::Tile take(uint64_t cycle) {
    in(cycle);
    const TileWalk::Tile tile = walk_.tile();
    walk_.clock(true);
    ++clocks_;
    return tile;
  }

 private:
  TileWalk walk_;
  uint64_t clocks_;  // the cycle up to which it has been clocked
};

}  // namespace raypool
