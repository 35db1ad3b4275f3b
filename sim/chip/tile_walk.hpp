// The order in which the tiles of a picture are cast: row for row, or along a Hilbert curve, which stays longer among
// neighbours, so that rays find in the traverser's caches what those before them have read.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "config/parameters.hpp"

namespace raypool::chip {

class TileWalk {
 public:
  /// Over so many tiles, from the one in the upper left corner on.
  TileWalk(TileOrder order, uint32_t columns, uint32_t rows) : order_(order), columns_(columns), rows_(rows) {
    while (side_ < columns || side_ < rows) side_ *= 2;
  }

  bool at_end() const { return left_ == 0; }
  /// Tiles, the present one included.
  uint64_t left() const { return left_; }
  uint32_t column() const { return column_; }
  uint32_t row() const { return row_; }

  void next() {
    if (--left_ == 0) return;
    if (order_ == TileOrder::Rows) {
      column_ = (column_ + 1) % columns_;
      row_ += column_ == 0;
      return;
    }
    do {
      ++step_;
      place();
    } while (column_ >= columns_ || row_ >= rows_);
  }

 private:
  /// Two bits of the step choose a quarter, from the smallest square on; what is inside is turned as the curve needs
  /// it.
  void place() {
    column_ = row_ = 0;
    uint32_t size = 1;
    for (uint64_t step = step_; step != 0 || size < side_; step >>= 2, size *= 2) {
      const bool right = (step >> 1 & 1) != 0, down = ((step ^ step >> 1) & 1) != 0;
      if (!down) {
        if (right) {
          column_ = size - 1 - column_;
          row_ = size - 1 - row_;
        }
        std::swap(column_, row_);
      }
      column_ += right ? size : 0;
      row_ += down ? size : 0;
    }
  }

  TileOrder order_;
  uint32_t columns_, rows_;
  uint64_t left_ = uint64_t{columns_} * rows_;
  uint32_t side_ = 1;  // of the square that the curve fills
  uint64_t step_ = 0;  // along the curve
  uint32_t column_ = 0, row_ = 0;
};

/// Some tiles of a walk, in its order.
class ChosenTiles {
 public:
  /// `numbers`: of the tiles, counted along the walk from 0, ascending; empty: all of them.
  ChosenTiles(TileWalk walk, const std::vector<uint32_t>& numbers) : walk_(walk), numbers_(numbers) { skip(); }

  bool at_end() const { return walk_.at_end() || (!numbers_.empty() && chosen_ == size32(numbers_)); }
  uint32_t column() const { return walk_.column(); }
  uint32_t row() const { return walk_.row(); }

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
