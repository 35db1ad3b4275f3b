#include "chip/tile_costs.hpp"

#include <gtest/gtest.h>

namespace raypool::chip {
namespace {

Counts at(double cycles) {
  Counts counts{};
  counts[count::kCycles] = cycles;
  return counts;
}

TEST(TileCosts, AnIntervalIsSharedAmongThePixelsThatAreHeldInIt) {
  TileCosts tiles;
  EXPECT_EQ(tiles.cast(2, at(0)), 0u);
  EXPECT_EQ(tiles.cast(1, at(10)), 1u);  // until now the first tile was alone
  tiles.finished(0, at(16));             // of three pixels, 2 cycles each
  tiles.finished(0, at(18));             // of two, 1 each
  tiles.finished(1, at(25));             // 7 alone
  tiles.end(at(28));                     // what is left is the last tile's
  EXPECT_DOUBLE_EQ(tiles.costs()[0][count::kCycles], 10 + 2 + 2 + 1);
  EXPECT_DOUBLE_EQ(tiles.costs()[1][count::kCycles], 2 + 1 + 7 + 3);
}

TEST(TileCosts, WhatIsCountedWhileNothingIsHeldGoesToTheNextTile) {
  TileCosts tiles;
  tiles.cast(1, at(0));
  tiles.finished(0, at(4));
  tiles.cast(1, at(9));
  tiles.finished(1, at(12));
  tiles.end(at(12));
  EXPECT_DOUBLE_EQ(tiles.costs()[0][count::kCycles], 4);
  EXPECT_DOUBLE_EQ(tiles.costs()[1][count::kCycles], 8);
}

}  // namespace
}  // namespace raypool::chip
