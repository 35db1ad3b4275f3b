// The walk over the tiles of a picture in Verilog against its class, all outputs in every cycle: random pictures, and
// those at the edges, taken as fast as they come, now and then, or broken off by another walk.
#include "machine/chip/tile_walk.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <algorithm>
#include <vector>

#include "Vtile_walk_1024_512_1.h"
#include "Vtile_walk_128_40_0.h"
#include "Vtile_walk_128_40_1.h"
#include "Vtile_walk_1_1_0.h"
#include "Vtile_walk_1_1_1.h"
#include "Vtile_walk_2_512_1.h"
#include "Vtile_walk_64_512_0.h"
#include "Vtile_walk_64_512_1.h"
#include "Vtile_walk_64_8_1.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// Its numbers are those of the class.
template <typename Unit_, uint32_t kContents, uint32_t kHeld, TileOrder kOrder>
struct Walk {
  using Unit = Unit_;
  static TileWalk walk() { return {kOrder, kContents, kHeld}; }
};

template <typename W>
class Bench {
 public:
  explicit Bench(uint32_t seed) : bench_(seed) {}

  struct Size {
    uint32_t width, height;
  };
  /// A walk begins, whatever is under way.
  void start(Size size, bool ready) {
    u_.start_i = 1;
    u_.width_i = size.width;
    u_.height_i = size.height;
    ASSERT_NO_FATAL_FAILURE(compare(ready));
    walk_.start(size.width, size.height);
    bench_.clock();
    u_.start_i = 0;
    u_.width_i = random();  // read at the start only
    u_.height_i = random();
  }
  /// A tile that is offered stays for so many cycles on average; 1: it is taken at once.
  void clock(uint32_t stall) {
    const bool ready = bench_.one_of(stall);
    ASSERT_NO_FATAL_FAILURE(compare(ready));
    tiles += walk_.valid() && ready ? 1 : 0;
    stalled += walk_.valid() && !ready ? 1 : 0;
    waited += walk_.busy() && !walk_.valid() && ready ? 1 : 0;
    walk_.clock(ready);
    bench_.clock();
  }
  /// Sees a walk to its end, for so many cycles at most.
  void finish(uint32_t stall, uint64_t cycles) {
    for (uint64_t i = 0; i < cycles && walk_.busy(); ++i) ASSERT_NO_FATAL_FAILURE(clock(stall));
    ended += walk_.busy() ? 0 : 1;
    for (uint32_t i = 0; i < 20 && !walk_.busy(); ++i) ASSERT_NO_FATAL_FAILURE(clock(stall));
  }
  uint32_t random() { return static_cast<uint32_t>(bench_.random()); }
  uint32_t below(uint32_t limit) { return random() % limit; }

  uint64_t tiles = 0, stalled = 0, waited = 0, ended = 0;
  TileWalk walk_ = W::walk();

 private:
  void compare(bool ready) {
    u_.tile_ready_i = ready;
    u_.eval();
    ASSERT_EQ(u_.busy_o, walk_.busy()) << "cycle " << cycle_;
    ASSERT_EQ(u_.tile_valid_o, walk_.valid()) << "cycle " << cycle_;
    if (walk_.valid()) {
      ASSERT_EQ(u_.tile_block_o, walk_.tile().block()) << "cycle " << cycle_;
      ASSERT_EQ(u_.tile_pixels_o, walk_.tile().pixels) << "cycle " << cycle_;
      ASSERT_EQ(u_.tile_last_o, walk_.tile().last) << "cycle " << cycle_;
    }
    ++cycle_;
  }

  Clocked<typename W::Unit> bench_;
  typename W::Unit& u_ = *bench_.u;
  uint64_t cycle_ = 0;
};

template <typename W>
class TileWalkInVerilog : public testing::Test {};
using Walks = testing::Types<
    Walk<Vtile_walk_64_512_0, 64, 512, TileOrder::Rows>, Walk<Vtile_walk_1_1_0, 1, 1, TileOrder::Rows>,
    Walk<Vtile_walk_128_40_0, 128, 40, TileOrder::Rows>, Walk<Vtile_walk_64_512_1, 64, 512, TileOrder::Hilbert>,
    Walk<Vtile_walk_1_1_1, 1, 1, TileOrder::Hilbert>, Walk<Vtile_walk_2_512_1, 2, 512, TileOrder::Hilbert>,
    Walk<Vtile_walk_64_8_1, 64, 8, TileOrder::Hilbert>, Walk<Vtile_walk_128_40_1, 128, 40, TileOrder::Hilbert>,
    Walk<Vtile_walk_1024_512_1, 1024, 512, TileOrder::Hilbert>>;
TYPED_TEST_SUITE(TileWalkInVerilog, Walks);

TYPED_TEST(TileWalkInVerilog, AgreesWithItsClassInEveryCycle) {
  constexpr uint64_t kCycles = 60'000;
  Bench<TypeParam> bench(5);
  const uint32_t wide = bench.walk_.tile_width(), high = bench.walk_.tile_height();
  // Extremes: the smallest, one column, one row, the largest each way, and pictures at powers of two.
  for (const auto& [width, height] : std::vector<typename Bench<TypeParam>::Size>{{1, 1},
                                                                                  {1, 65535},
                                                                                  {65535, 1},
                                                                                  {4095, 7},
                                                                                  {3, 4097},
                                                                                  {32768, 2},
                                                                                  {32769, 2},
                                                                                  {65535, 65535},
                                                                                  {16 * wide, 16 * high},
                                                                                  {16 * wide + 1, 3},
                                                                                  {16 * wide, 16 * high + 1},
                                                                                  {16 * wide - 1, 16 * high + 1}}) {
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    ASSERT_NO_FATAL_FAILURE(bench.start({width, height}, true));
    ASSERT_NO_FATAL_FAILURE(bench.finish(1, kCycles));
    ASSERT_NO_FATAL_FAILURE(bench.start({width, height}, false));
    ASSERT_NO_FATAL_FAILURE(bench.finish(4, kCycles / 4));
  }
  const uint64_t ended = bench.ended;
  for (uint32_t i = 0; i < 400; ++i) {
    const uint32_t most = bench.below(4) == 0 ? 40 : 9;  // tiles each way
    const uint32_t width = 1 + bench.below(most * wide), height = 1 + bench.below(most * high);
    SCOPED_TRACE(testing::Message() << "walk " << i << ", " << width << " x " << height);
    ASSERT_NO_FATAL_FAILURE(bench.start({width, height}, bench.below(2) == 0));
    const uint32_t stall = 1 + bench.below(3) * bench.below(9);
    ASSERT_NO_FATAL_FAILURE(bench.finish(stall, i % 5 == 0 ? bench.below(100) : UINT64_MAX));
  }
  EXPECT_GT(bench.ended - ended, 320u);
  EXPECT_LT(bench.ended - ended, 400u) << "no walk was broken off";
  EXPECT_GT(bench.tiles, 50'000u);
  EXPECT_GT(bench.stalled, 50'000u);
  EXPECT_GT(bench.waited, 100u);
}

}  // namespace
}  // namespace raypool::bench
