// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_tile_walk.v: the tiles of a picture in the order in which they are cast, row for row, or along a Hilbert
// curve, which stays longer among neighbours, so that rays find in the traverser's caches what those before them have
// read.
//
// It is clocked; await() and next() give the order without its cycles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "config/configuration.hpp"
#include "machine/common/request_queue.hpp"

namespace raypool {

class TileWalk {
 public:
  struct Tile {
    uint32_t left = 0, top = 0;  ///< of its upper left corner, in pixels
    uint32_t pixels = 0;         ///< of it that lie in the picture
    bool last = false;

    uint32_t block() const { return left | top << 16; }  ///< the word that its launch has
  };

  /// Of a machine with so many threads in a full kernel. A tile that would have more pixels than may be held is cut
  /// into bands of whole rows.
  TileWalk(TileOrder order, uint32_t contents, uint32_t held_limit)
      : curve_(order == TileOrder::Hilbert),
        tile_width_(1u << tile_width_log2(contents)),
        tile_height_(std::min(contents, held_limit) >> tile_width_log2(contents)) {}

  uint32_t tile_width() const { return tile_width_; }
  uint32_t tile_height() const { return tile_height_; }

  bool busy() const { return busy_; }         ///< a tile is still to be taken
  bool valid() const { return valid_; }       ///< one is offered
  const Tile& tile() const { return tile_; }  ///< this one; when none is left, the last one

  /// A cycle in which nothing is taken changes nothing.
  bool settled() const { return (valid_ || !busy_) && (!searching_ || (held_up_ && found_.count() == kAhead)); }

  /// The end of a cycle: what is offered is taken if `ready`.
  void clock(bool ready) {
    const bool taken = valid_ && ready, room = found_.count() < kAhead;
    // Whether a tile is the last one is known when there is another one, or the search is over.
    const bool moves = (!valid_ || ready) && found_.count() > (searching_ ? 1u : 0u);
    if (taken && tile_.last) busy_ = false;
    if (taken) valid_ = false;
    if (moves) offer();
    found_.clock(moves);
    if (searching_) search(room);
  }
  /// The end of a cycle in which a walk begins, over a picture of 1 to 65535 pixels each way, whatever was there.
  void start(uint32_t width, uint32_t height) {
    width_ = width;
    height_ = height;
    busy_ = searching_ = true;
    valid_ = false;
    found_ = {};
    sizing_ = curve_;
    level_ = 0;
    column_ = row_ = sizing_ ? 1 : 0;
    quarters_.fill(kLastQuarter);
    inner_.fill({});
  }

  // The order without its cycles.
  /// Goes on until a tile is offered, or none is left.
  void await() {
    while (busy_ && !valid_) clock(false);
  }
  /// The tile that is offered is taken; goes on to the one behind it.
  void next() {
    clock(true);
    await();
  }

 private:
  static constexpr uint32_t kAhead = 3;    // tiles found and not offered
  static constexpr uint32_t kLevels = 16;  // of squares within squares: 1 to 2^16 tiles wide
  static constexpr uint8_t kLastQuarter = 3;

  /// How the curve is turned: columns and rows exchanged, both counted from the other end.
  struct Turn {
    bool swap = false, flip = false;
  };
  struct Corner {
    uint32_t left = 0, top = 0;
  };

  void offer() {
    const Corner corner = found_.data();
    tile_.left = corner.left;
    tile_.top = corner.top;
    tile_.pixels = std::min(tile_width_, width_ - corner.left) * std::min(tile_height_, height_ - corner.top);
    tile_.last = !searching_ && found_.count() == 1;
    valid_ = true;
  }

  // One step.
  void search(bool room) {
    held_up_ = false;
    const uint32_t left = column_ * tile_width_, top = row_ * tile_height_;
    const bool beyond_right = left >= width_, below = top >= height_;
    if (sizing_) {
      grow(beyond_right && below);
      return;
    }
    const bool outside = beyond_right || below;
    const bool found = !outside && level_ == 0;
    held_up_ = found && !room;
    if (held_up_) return;
    if (found) found_.push({left, top});
    if (curve_) {
      follow_curve(outside);
    } else {
      follow_row(left, top);
    }
  }

  void follow_row(uint32_t left, uint32_t top) {
    ++column_;
    if (left + tile_width_ < width_) return;
    column_ = 0;
    ++row_;
    searching_ = top + tile_height_ < height_;
  }

  // The curve fills a square of 2^level tiles each way: the least that the picture fits into. A step doubles it.
  void grow(bool fits) {
    sizing_ = !fits;
    level_ += fits ? 0 : 1;
    column_ = fits ? 0 : column_ * 2;
    row_ = fits ? 0 : row_ * 2;
  }

  // A step sees one square, with its upper left tile at column_, row_. One that is outside, or one tile, is done with:
  // the next quarter of the smallest square around it comes that has one left. Of another one its first quarter comes.
  void follow_curve(bool outside) {
    uint32_t to = level_;
    if (!outside && level_ != 0) {
      --to;  // its quarter is the last one of another square, or was never set
    } else {
      while (to < kLevels && quarters_[to] == kLastQuarter) ++to;
    }
    searching_ = to < kLevels;
    if (!searching_) return;
    const uint32_t quarter = quarters_[to] = (quarters_[to] + 1) & kLastQuarter;
    // Upper left, lower left, lower right, upper right.
    const bool right = quarter >= 2, down = quarter == 1 || quarter == 2;
    const Turn turn = inner_[to + 1];
    const uint32_t in_column = (turn.swap ? down : right) != turn.flip;
    const uint32_t in_row = (turn.swap ? right : down) != turn.flip;
    column_ = (column_ >> (to + 1) << 1 | in_column) << to;
    row_ = (row_ >> (to + 1) << 1 | in_row) << to;
    inner_[to] = {turn.swap != !down, turn.flip != (right && !down)};
    level_ = to;
  }

  bool curve_;
  uint32_t tile_width_, tile_height_;
  uint32_t width_ = 0, height_ = 0;  // of the picture
  bool busy_ = false, valid_ = false;
  Tile tile_;
  RequestQueue<Corner, kAhead> found_;
  bool searching_ = false, sizing_ = false;
  bool held_up_ = false;                       // a tile is found that there is no room for
  uint32_t level_ = 0, column_ = 0, row_ = 0;  // of the square that is looked at; 0: one tile
  std::array<uint8_t, kLevels> quarters_{};    // [level] which one of the square around it; below level_ the last
  std::array<Turn, kLevels + 1> inner_{};      // [level] of the curve inside it
};

}  // namespace raypool
