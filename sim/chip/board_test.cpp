// Frames on a board, on the model of the chip as one piece, against the native renderer.
#include "chip/board.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "chip/test_real_frame.hpp"
#include "machine/chip_model.hpp"
#include "machine/model.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

/// A machine, and what of its chip is not as it is by default.
struct Case {
  const char* name;
  uint32_t warps, lanes, units, width, height, depth;
  uint32_t intersection_words = kIntersectionWords;
  void (*change)(ChipConfiguration&) = [](ChipConfiguration&) {};
};

struct BoardRun {
  explicit BoardRun(const Case& c)
      : run(c.warps, c.lanes, c.width, c.height, c.depth, make_cornell(), false, c.intersection_words) {
    ChipConfiguration& chip = run.options.configuration.chip;
    chip.controller = ControllerName::Counters;
    c.change(chip);
    device = make_chip_model(run.options.configuration,
                             make_model(run.options.configuration, run.image.memory, c.units).device);
  }
  ChipResult draw() { return run_board(run.options, *device); }

  test::RealFrame run;
  std::unique_ptr<ChipDevice> device;
};

class BoardFrame : public testing::TestWithParam<Case> {};

TEST_P(BoardFrame, IsThatOfTheNativeRenderer) {
  const Case c = GetParam();
  BoardRun board(c);
  const test::RealFrame& run = board.run;
  NativeOptions native;
  native.width = c.width;
  native.height = c.height;
  native.depth = c.depth;
  native.culling = run.options.configuration.chip.culling;
  NativeStatistics statistics;
  const FrameBuffer expected = render_native(run.scene, run.image, run.tracer, native, &statistics);

  const ChipResult result = board.draw();
  EXPECT_TRUE(run.frame == expected);
  for (const auto kind : {&RayCounts::eye, &RayCounts::reflection, &RayCounts::shadow}) {
    EXPECT_EQ((result.ray_counts.*kind).traced, (statistics.ray_counts.*kind).traced);
    EXPECT_EQ((result.ray_counts.*kind).ended, (statistics.ray_counts.*kind).ended);
    EXPECT_EQ((result.ray_counts.*kind).left_out, (statistics.ray_counts.*kind).left_out);
  }
  EXPECT_EQ(result.dropped_depth, statistics.dropped_rays);
  EXPECT_EQ(result.contributions, statistics.contributions);
  EXPECT_GT(result.cycles, uint64_t{c.width} * c.height);
  EXPECT_EQ(result.busy_cycles, result.warp_cycles.busy / c.warps);
  EXPECT_EQ(result.warp_cycles.busy, result.warp_cycles.sum());
  EXPECT_LE(result.rays_pool.peak, run.options.configuration.chip.ray_pool_size);
}

void tiny(ChipConfiguration& chip) {
  chip.ray_pool_size = 1;
  chip.held_limit = 1;
  chip.intersection_pool_size = 1;
}
void short_of_room(ChipConfiguration& chip) {
  chip.ray_pool_size = 5;
  chip.intersection_pool_size = 9;
  chip.held_limit = 8;
  chip.policy = PolicyName::Fill;
}
void fast(ChipConfiguration& chip) {
  chip.policy = PolicyName::Fill;
  chip.ray_pool_pipelined = chip.intersection_pool_pipelined = true;
  chip.culling = true;
  chip.shading = Shading::Traverser;
}

INSTANTIATE_TEST_SUITE_P(Board, BoardFrame,
                         testing::Values(Case{"one", 8, 8, 1, 32, 24, 1}, Case{"two", 4, 4, 2, 37, 29, 5},
                                         Case{"four", 8, 8, 4, 67, 41, 3, 16, fast},
                                         Case{"tiny", 1, 1, 1, 9, 7, 4, kIntersectionWords, tiny},
                                         Case{"short_of_room", 2, 2, 2, 19, 13, 5, kIntersectionWords, short_of_room},
                                         Case{"one_pixel", 4, 4, 1, 1, 1, 5}),
                         [](const testing::TestParamInfo<Case>& c) { return std::string(c.param.name); });

std::string error_of(BoardRun& board) {
  try {
    board.draw();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Board, RefusesWhatTheChipHasNot) {
  BoardRun modelled({"", 4, 4, 1, 8, 8, 1});
  modelled.run.options.configuration.chip.traverser = TraverserName::Modelled;
  EXPECT_NE(error_of(modelled).find("--traverser static"), std::string::npos);
  BoardRun early({"", 4, 4, 1, 8, 8, 1});
  early.run.options.configuration.chip.memory_latency = 8;
  EXPECT_NE(error_of(early).find("chip.memory.latency is 8; the chip in hardware takes 9 at least"), std::string::npos);
}

TEST(Board, ShortestLatency) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2, kIntersectionWords, [](ChipConfiguration& chip) { chip.memory_latency = 9; }});
  BoardRun slow({"", 4, 4, 1, 16, 8, 2});
  EXPECT_LT(board.draw().cycles, slow.draw().cycles);
  EXPECT_TRUE(board.run.frame == slow.run.frame);
}

TEST(Board, GivesUpAndSaysWhere) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  board.run.options.cycle_limit = 500;
  const std::string error = error_of(board);
  EXPECT_NE(error.find("the limit of 500 cycles has passed, at cycle 500; "), std::string::npos) << error;
}

TEST(Board, TellsOfAFault) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  board.run.options.program_length = 3;
  EXPECT_THROW(board.draw(), ChipFault);
}

}  // namespace
}  // namespace raypool
