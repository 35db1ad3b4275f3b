// Some tiles of a walk, in its order and without its cycles.
#pragma once

#include <cstdint>
#include <vector>

#include "bits.hpp"
#include "machine/chip/tile_walk.hpp"

namespace raypool::chip {

class ChosenTiles {
 public:
  /// `walk` has begun. `numbers`: of the tiles, counted along it from 0, ascending; empty: all of them.
  ChosenTiles(const TileWalk& walk, const std::vector<uint32_t>& numbers) : walk_(walk), numbers_(numbers) {
    walk_.await();
    skip();
  }

  bool at_end() const { return !walk_.busy() || (!numbers_.empty() && chosen_ == size32(numbers_)); }
  const TileWalk::Tile& tile() const { return walk_.tile(); }
  uint32_t number() const { return number_; }  ///< of the tile, along the walk
  uint32_t tile_width() const { return walk_.tile_width(); }
  uint32_t tile_height() const { return walk_.tile_height(); }

  void next() {
    advance();
    ++chosen_;
    skip();
  }

 private:
  void advance() {
    walk_.next();
    ++number_;
  }
  void skip() {
    while (!numbers_.empty() && !at_end() && number_ < numbers_[chosen_]) advance();
  }

  TileWalk walk_;
  const std::vector<uint32_t>& numbers_;
  uint32_t number_ = 0, chosen_ = 0;  // of the present tile: along the walk, among those chosen
};

}  // namespace raypool::chip
