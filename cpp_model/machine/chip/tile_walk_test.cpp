#include "machine/chip/tile_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace raypool {
namespace {

using Tiles = std::vector<std::pair<uint32_t, uint32_t>>;  // column, row

// Of tiles of one pixel.
Tiles walk(TileOrder order, uint32_t columns, uint32_t rows) {
  Tiles tiles;
  TileWalk at(order, 1, 1);
  at.start(columns, rows);
  for (at.await(); at.busy(); at.next()) tiles.emplace_back(at.tile().left, at.tile().top);
  return tiles;
}

// Where a step of the curve is, as textbooks compute it: two bits of the step choose a quarter, from the smallest
// square on, and what is inside is turned.
std::pair<uint32_t, uint32_t> on_curve(uint64_t step, uint32_t side) {
  uint32_t column = 0, row = 0;
  for (uint32_t size = 1; size < side; step >>= 2, size *= 2) {
    const bool right = (step >> 1 & 1) != 0, down = ((step ^ step >> 1) & 1) != 0;
    if (!down) {
      if (right) {
        column = size - 1 - column;
        row = size - 1 - row;
      }
      std::swap(column, row);
    }
    column += right ? size : 0;
    row += down ? size : 0;
  }
  return {column, row};
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

TEST(TileWalk, TilesComeAsTheCurveInTheLeastSquareHasThem) {
  Tiles sizes{{1, 1000}, {1000, 1}, {129, 64}, {64, 129}, {257, 3}, {2, 255}, {100, 75}, {512, 512}, {513, 511}};
  for (uint32_t columns = 1; columns <= 20; ++columns)
    for (uint32_t rows = 1; rows <= 20; ++rows) sizes.emplace_back(columns, rows);
  for (const auto& [columns, rows] : sizes) {
    uint32_t side = 1;
    while (side < columns || side < rows) side *= 2;
    Tiles expected;
    for (uint64_t step = 0; step < uint64_t{side} * side; ++step) {
      const auto at = on_curve(step, side);
      if (at.first < columns && at.second < rows) expected.push_back(at);
    }
    ASSERT_EQ(walk(TileOrder::Hilbert, columns, rows), expected) << columns << " x " << rows;
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

TEST(TileWalk, TilesKnowTheirPixelsAndTheLastOne) {
  for (const TileOrder order : {TileOrder::Rows, TileOrder::Hilbert}) {
    TileWalk at(order, 128, 80);  // 16 x 5: with 128 threads they are 8 high, but 80 pixels may be held
    EXPECT_EQ(at.tile_width(), 16u);
    EXPECT_EQ(at.tile_height(), 5u);
    at.start(33, 11);
    std::vector<uint32_t> pixels(33 * 11);
    uint32_t tiles = 0, last = 0;
    for (at.await(); at.busy(); at.next()) {
      const TileWalk::Tile& tile = at.tile();
      uint32_t here = 0;
      for (uint32_t y = tile.top; y < std::min(tile.top + 5, 11u); ++y)
        for (uint32_t x = tile.left; x < std::min(tile.left + 16, 33u); ++x, ++here) ++pixels[y * 33 + x];
      EXPECT_EQ(tile.pixels, here);
      EXPECT_EQ(tile.block(), tile.left | tile.top << 16);
      ++tiles;
      last += tile.last ? 1 : 0;
      EXPECT_EQ(tile.last, tiles == 9);
    }
    EXPECT_EQ(tiles, 9u);
    EXPECT_EQ(last, 1u);
    EXPECT_EQ(std::count(pixels.begin(), pixels.end(), 1u), 33 * 11);
  }
}

struct Search {
  uint32_t first = 0, longest = 0;  // cycles to the first tile; most from one to the next, if each is taken at once
  uint64_t tiles = 0, cycles = 0;

  double mean() const { return static_cast<double>(cycles) / static_cast<double>(tiles); }
};

Search search_along_curve(uint32_t columns, uint32_t rows) {
  TileWalk at(TileOrder::Hilbert, 1, 1);
  at.start(columns, rows);
  Search search;
  for (; !at.valid(); at.clock(false)) ++search.first;
  while (at.busy()) {
    uint32_t cycles = 1;
    for (at.clock(true); at.busy() && !at.valid(); at.clock(false)) ++cycles;
    search.longest = std::max(search.longest, cycles);
    search.cycles += cycles;
    ++search.tiles;
  }
  return search;
}

TEST(TileWalk, ASearchAlongTheCurveTakesFiveCyclesALevelAtMost) {
  std::vector<uint32_t> longest(7);
  for (uint32_t columns = 1; columns <= 64; ++columns)
    for (uint32_t rows = 1; rows <= 64; ++rows) {
      uint32_t levels = 0;
      while ((1u << levels) < std::max(columns, rows)) ++levels;
      const Search search = search_along_curve(columns, rows);
      longest[levels] = std::max(longest[levels], search.longest);
      ASSERT_LE(search.first, 2 * levels + 6) << columns << " x " << rows;
      ASSERT_LT(search.mean(), 4.5) << columns << " x " << rows;
    }
  for (uint32_t levels = 2; levels <= 6; ++levels) EXPECT_EQ(longest[levels], 5 * levels - 2) << levels;
  // The largest that a picture can be, and those just beyond a power of two.
  const Search search = search_along_curve(65535, 1);
  EXPECT_EQ(search.longest, 5 * 16 - 2);
  EXPECT_LE(search.first, 2 * 16 + 6);
  EXPECT_NEAR(search.mean(), 4, 0.01);
  EXPECT_NEAR(search_along_curve(512, 512).mean(), 4.0 / 3, 0.01);
  for (uint32_t levels = 7; levels <= 10; ++levels)
    for (const uint32_t more : {0u, 1u, 2u}) {
      const uint32_t side = (1u << (levels - 1)) + 1 + more;
      for (const uint32_t other : {1u, 2u, side / 2, side}) {
        EXPECT_LE(search_along_curve(side, other).longest, 5 * levels - 2) << side << " x " << other;
        EXPECT_LE(search_along_curve(other, side).longest, 5 * levels - 2) << other << " x " << side;
      }
    }
}

TEST(TileWalk, ATileIsThereWhenAKernelCanBegin) {
  constexpr uint32_t kKernel = 60;  // no kernel is shorter
  const std::vector<std::pair<uint32_t, uint32_t>> pictures{
      {320, 320}, {150, 97}, {1920, 1080}, {513, 513}, {1025, 1}, {1, 1025}, {65535, 1}, {65535, 9}, {4095, 4097}};
  for (const TileOrder order : {TileOrder::Rows, TileOrder::Hilbert}) {
    for (const auto& [width, height] : pictures) {
      TileWalk at(order, 64, 512);
      at.start(width, height);
      at.await();
      while (at.busy()) {
        ASSERT_TRUE(at.valid()) << width << " x " << height << ", after " << at.tile().left << ", " << at.tile().top;
        at.clock(true);
        for (uint32_t i = 1; i < kKernel; ++i) at.clock(false);
      }
    }
  }
}

}  // namespace
}  // namespace raypool
