#include "chip/tile_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace raypool::chip {
namespace {

using Tiles = std::vector<std::pair<uint32_t, uint32_t>>;  // column, row

Tiles walk(TileOrder order, uint32_t columns, uint32_t rows) {
  Tiles tiles;
  for (TileWalk at(order, columns, rows); !at.at_end(); at.next()) tiles.emplace_back(at.column(), at.row());
  return tiles;
}

TEST(TileWalk, RowsComeFromTheTop) {
  EXPECT_EQ(walk(TileOrder::Rows, 3, 2), (Tiles{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}));
}

TEST(TileWalk, EachOrderHasEveryTileOnce) {
  for (const TileOrder order : {TileOrder::Rows, TileOrder::Hilbert}) {
    for (const auto& size : Tiles{{1, 1}, {1, 7}, {9, 1}, {5, 3}, {8, 8}, {13, 40}}) {
      Tiles tiles = walk(order, size.first, size.second);
      EXPECT_EQ(tiles.size(), size.first * size.second);
      EXPECT_EQ(tiles.front(), std::make_pair(0u, 0u));
      std::sort(tiles.begin(), tiles.end());
      EXPECT_EQ(std::unique(tiles.begin(), tiles.end()), tiles.end());
      EXPECT_TRUE(std::all_of(tiles.begin(), tiles.end(),
                              [&](const auto& tile) { return tile.first < size.first && tile.second < size.second; }));
    }
  }
}

TEST(TileWalk, AlongTheCurveATileIsBesideTheOneBefore) {
  for (const uint32_t side : {2u, 4u, 8u, 64u}) {
    const Tiles tiles = walk(TileOrder::Hilbert, side, side);
    for (size_t i = 1; i < tiles.size(); ++i) {
      const auto apart = [](uint32_t a, uint32_t b) { return a > b ? a - b : b - a; };
      EXPECT_EQ(apart(tiles[i].first, tiles[i - 1].first) + apart(tiles[i].second, tiles[i - 1].second), 1u);
    }
  }
}

}  // namespace
}  // namespace raypool::chip
