// The frame buffer's port in Verilog against its class, all outputs in every cycle: units and traverser offer when they
// like, and the frame buffer takes when it likes.
#include "machine/chip/frame_port.hpp"

#include <gtest/gtest.h>
#include <verilated.h>

#include <deque>

#include "Vframe_port.h"
#include "unit/common/clocked.hpp"

namespace raypool::bench {
namespace {

/// One in so many cycles: a unit offers a contribution, the traverser does, the frame buffer does not take one (0:
/// never).
struct Traffic {
  uint32_t unit = 1, traverser = 1, stall = 0;
};

class Bench {
 public:
  explicit Bench(uint32_t seed) : bench_(seed) {}

  void clock(const Traffic& traffic) {
    const bool is_new = offer(unit_waits_, traffic.unit, unit_);
    if (is_new) number_ = bench_.random() % 4;
    offer(traverser_waits_, traffic.traverser, traverser_);
    u_.unit_valid_i = unit_waits_;
    u_.unit_pixel_i = unit_.pixel;
    u_.unit_number_i = number_;
    u_.traverser_valid_i = traverser_waits_;
    u_.traverser_pixel_i = traverser_.pixel;
    for (uint32_t i = 0; i < 3; ++i) {
      u_.unit_color_i[i] = unit_.rgb[i];
      u_.traverser_color_i[i] = traverser_.rgb[i];
    }
    const bool frame_ready = traffic.stall == 0 || !bench_.one_of(traffic.stall);
    u_.frame_ready_i = frame_ready;
    u_.eval();

    const bool leaves = port_.valid() && frame_ready;
    ASSERT_EQ(u_.frame_valid_o, port_.valid()) << "cycle " << cycle_;
    if (port_.valid()) {
      ASSERT_EQ(u_.frame_pixel_o, port_.data().pixel) << "cycle " << cycle_;
      for (uint32_t i = 0; i < 3; ++i) ASSERT_EQ(u_.frame_color_o[i], port_.data().rgb[i]) << "cycle " << cycle_;
    }
    ASSERT_EQ(u_.exported_valid_o, exported_) << "cycle " << cycle_;
    if (exported_) {
      ASSERT_EQ(u_.exported_unit_o, exported_unit_) << "cycle " << cycle_;
      ASSERT_EQ(u_.exported_pixel_o, exported_pixel_) << "cycle " << cycle_;
    }
    const bool room = port_.ready(cycle_);
    ASSERT_EQ(u_.unit_ready_o, room) << "cycle " << cycle_;
    full += room ? 0 : 1;
    passed_over += traverser_waits_ && unit_waits_ && room ? 1 : 0;
    exported_ = unit_waits_ && room;
    exported_unit_ = number_;
    exported_pixel_ = unit_.pixel;
    if (exported_) give(unit_waits_, unit_);
    ASSERT_EQ(u_.traverser_ready_o, port_.ready(cycle_)) << "cycle " << cycle_;
    if (traverser_waits_ && port_.ready(cycle_)) give(traverser_waits_, traverser_);
    if (leaves) {
      ASSERT_EQ(port_.data().pixel, expected_.front().pixel) << "not in the order in which they came";
      ASSERT_EQ(port_.data().rgb, expected_.front().rgb);
      expected_.pop_front();
      port_.leave();
      ++left;
    }
    bench_.clock();
    ++cycle_;
  }
  /// Nothing more comes, and everything leaves.
  void drain() {
    for (uint32_t i = 0; i < 100 && (unit_waits_ || traverser_waits_ || port_.valid()); ++i)
      ASSERT_NO_FATAL_FAILURE(clock({0, 0, 0}));
    for (uint32_t i = 0; i < 2; ++i) ASSERT_NO_FATAL_FAILURE(clock({0, 0, 0}));
    EXPECT_EQ(expected_.size(), 0u);
    EXPECT_EQ(left, port_.taken());
    EXPECT_EQ(u_.taken_o, port_.taken());
  }

  uint64_t left = 0, full = 0, passed_over = 0;

 private:
  bool offer(bool& waits, uint32_t one_in, FrameContribution& contribution) {
    if (waits || one_in == 0 || !bench_.one_of(one_in)) return false;
    waits = true;
    contribution.pixel = static_cast<uint32_t>(bench_.random());
    for (uint32_t& word : contribution.rgb) word = static_cast<uint32_t>(bench_.random());
    return true;
  }
  void give(bool& waits, const FrameContribution& contribution) {
    port_.take(cycle_, contribution);
    expected_.push_back(contribution);
    waits = false;
  }

  Clocked<Vframe_port> bench_;
  Vframe_port& u_ = *bench_.u;
  FramePort port_;
  uint64_t cycle_ = 0;
  FrameContribution unit_, traverser_;  // offered
  uint32_t number_ = 0;
  bool unit_waits_ = false, traverser_waits_ = false;
  bool exported_ = false;
  uint32_t exported_unit_ = 0, exported_pixel_ = 0;
  std::deque<FrameContribution> expected_;
};

TEST(FramePortInVerilog, AgreesWithItsClassInEveryCycle) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Bench bench(seed);
    constexpr uint32_t kCycles = 3000;
    for (uint32_t i = 0; i < kCycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({0, 1, 0}));
    EXPECT_GE(bench.left, kCycles - 1) << "not one a cycle";
    for (uint32_t i = 0; i < kCycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock({1, 0, 0}));
    EXPECT_GE(bench.left, 2 * kCycles - 1) << "not one a cycle";
    EXPECT_EQ(bench.full, 0u);
    for (const Traffic& traffic : {Traffic{1, 1, 0}, {2, 1, 0}, {2, 2, 2}, {3, 1, 4}, {9, 5, 0}, {1, 1, 1}, {4, 4, 3}})
      for (uint32_t i = 0; i < kCycles; ++i) ASSERT_NO_FATAL_FAILURE(bench.clock(traffic));
    ASSERT_NO_FATAL_FAILURE(bench.drain());
    EXPECT_GT(bench.full, kCycles);
    EXPECT_GT(bench.passed_over, kCycles);
  }
}

}  // namespace
}  // namespace raypool::bench
