// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The walk over the tiles for a reader that looks at it now and then: clocked up to a cycle when that is asked for. It
// may be given the tiles to offer: the others take no time.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "machine/chip/controller.hpp"
#include "machine/chip/tile_walk.hpp"

namespace raypool {

class TimedTiles {
 public:
  /// The walk begins in cycle `begun`, and has its first cycle in the next one. `chosen`: numbers along it of the tiles
  /// that are offered, ascending; empty: all.
  TimedTiles(const TileWalk& walk, uint32_t width, uint32_t height, uint64_t begun = 0,
             std::vector<uint32_t> chosen = {})
      : walk_(walk), clocks_(begun), chosen_(std::move(chosen)) {
    walk_.start(width, height);
  }

  /// As they are in a cycle, not before the last one that was asked for.
  Controller::Tiles in(uint64_t cycle) {
    for (; clocks_ + 1 < cycle && !walk_.settled(); ++clocks_) walk_.clock(false);
    if (clocks_ + 1 < cycle) clocks_ = cycle - 1;
    skip();
    const bool left = walk_.busy() && !all_taken();
    return {left, left && walk_.valid() ? &walk_.tile() : nullptr};
  }
  /// The one that is offered is taken in this cycle.
  TileWalk::Tile take(uint64_t cycle) {
    in(cycle);
    const TileWalk::Tile tile = walk_.tile();
    walk_.clock(true);
    ++clocks_;
    ++number_;
    ++taken_;
    return tile;
  }

 private:
  bool all_taken() const { return !chosen_.empty() && taken_ == size32(chosen_); }
  // Tiles that are not chosen pass when the first of them is offered.
  void skip() {
    if (chosen_.empty() || all_taken()) return;
    for (; walk_.valid() && number_ < chosen_[taken_]; ++number_) walk_.next();
  }

  TileWalk walk_;
  uint64_t clocks_;               // the cycle up to which it has been clocked
  std::vector<uint32_t> chosen_;  // empty: all
  uint32_t number_ = 0;           // along the walk, of the tile that is offered or comes next
  uint32_t taken_ = 0;
};

}  // namespace raypool
