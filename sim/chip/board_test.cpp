// Frames on a board, on the model of the chip, against the native renderer.
#include "chip/board.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "chip/answer_watch.hpp"
#include "chip/test_board.hpp"
#include "machine/traverser/box_pipe.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

using Case = test::BoardCase;
using test::BoardRun;
using test::TreeBoard;

std::string error_of(BoardRun& board) {
  try {
    board.draw();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

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

/// A chip that is clocked once in every call.
class OneByOne : public ChipDevice {
 public:
  explicit OneByOne(std::unique_ptr<ChipDevice> chip) : chip_(std::move(chip)) {}
  uint32_t units() const override { return chip_->units(); }
  void start(const FrameSetup& setup) override { chip_->start(setup); }
  void start_next(const FrameSetup& setup) override { chip_->start_next(setup); }
  const ChipOutputs& outputs() const override { return chip_->outputs(); }
  void clock(const ChipInputs& inputs) override { chip_->clock(inputs); }
  ChipCounts counts() override { return chip_->counts(); }
  uint64_t counter(int number) override { return chip_->counter(number); }

 private:
  std::unique_ptr<ChipDevice> chip_;
};

TEST_P(BoardFrame, TakesTheSameCyclesWhenEachOfThemIsClocked) {
  BoardRun board(GetParam()), other(GetParam());
  other.device = std::make_unique<OneByOne>(std::move(other.device));
  test::expect_the_same(board.draw(), other.draw());
  EXPECT_TRUE(board.run.frame == other.run.frame);
  // With a limit they end in the same cycle, in the same state.
  const auto at_the_limit = [](const Case& c, bool one_by_one, uint64_t limit) {
    BoardRun limited(c);
    if (one_by_one) limited.device = std::make_unique<OneByOne>(std::move(limited.device));
    limited.run.options.limits.cycles = limit;
    return error_of(limited);
  };
  for (const uint64_t limit : {100, 333, 501, 640})
    EXPECT_EQ(at_the_limit(GetParam(), false, limit), at_the_limit(GetParam(), true, limit)) << limit;
}

TEST(Board, RunsOnWhileOnlyUnitsWork) {
  BoardRun board({"", 8, 8, 1, 32, 24, 1});
  chip::FixedLatencyStore store(*board.run.options.memory, nullptr, board.run.options.configuration.chip);
  chip::Board running(board.run.options, *board.device, store);
  uint64_t calls = 0, cycles = 0;
  for (; !running.drawn(); ++calls) cycles += running.clock();
  EXPECT_LT(calls, cycles * 9 / 10);
  EXPECT_EQ(cycles, BoardRun({"", 8, 8, 1, 32, 24, 1}).draw().cycles + 1);
}

INSTANTIATE_TEST_SUITE_P(Board, BoardFrame,
                         testing::Values(Case{"one", 8, 8, 1, 32, 24, 1}, Case{"two", 4, 4, 2, 37, 29, 5},
                                         Case{"four", 8, 8, 4, 67, 41, 3, 16, fast},
                                         Case{"tiny", 1, 1, 1, 9, 7, 4, kIntersectionWords, tiny},
                                         Case{"short_of_room", 2, 2, 2, 19, 13, 5, kIntersectionWords, short_of_room},
                                         Case{"one_pixel", 4, 4, 1, 1, 1, 5}),
                         [](const testing::TestParamInfo<Case>& c) { return std::string(c.param.name); });

TEST(Board, RefusesWhatTheChipHasNot) {
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

TEST(Board, GivesUpAndReportsWhere) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  board.run.options.limits.cycles = 500;
  const std::string error = error_of(board);
  EXPECT_NE(error.find("the limit of 500 cycles has passed, at cycle 500; "), std::string::npos) << error;
}

TEST(Board, ReportsAFault) {
  BoardRun board({"", 4, 4, 1, 16, 8, 2});
  board.run.options.program_length = 3;
  EXPECT_THROW(board.draw(), ChipFault);
}

// ---- A traverser inside, with a malformed tree in its memory, or a memory that loses something

constexpr uint32_t kCountWord = 3, kFirstChild = 10;

std::string fault_of(TreeBoard& board, TreeFaultCode code) {
  try {
    board.draw();
  } catch (const TraverserFault& fault) {
    EXPECT_EQ(fault.fault.code, code);
    std::string said = fault.what();
    EXPECT_EQ(said.find("the traverser has stopped with a fault: "), 0u) << said;
    EXPECT_NE(said.find("; write the tree there as docs/use/tree-file.md has it"), std::string::npos) << said;
    return said;
  }
  return "";
}

TEST(Board, WithATraverserInsideDraws) { EXPECT_EQ(error_of(*std::make_unique<TreeBoard>()), ""); }

TEST(Board, CountsWhatItsTraverserHasDoneInEachFrame) {
  TreeBoard board;
  const test::RealFrame& run = board.run;
  const uint32_t rays = run.options.configuration.chip.hardware_traverser_rays;
  for (const FrameBegin begin : {FrameBegin::Reset, FrameBegin::Next}) {
    const ChipResult result = run_board(run.options, *board.device, begin);
    ASSERT_TRUE(result.traversal);
    const TraverserWork& work = *result.traversal;
    EXPECT_EQ(work.rays, result.rays());
    EXPECT_GT(work.most_rays, 1u);
    EXPECT_LE(work.most_rays, rays);
    EXPECT_GT(work.ray_cycles, work.rays * BoxPipe::kStages);
    EXPECT_LE(work.ray_cycles, result.cycles * rays);

    const auto lookups = [](const CacheWork& cache) { return cache.hits + cache.misses + cache.joined; };
    EXPECT_EQ(lookups(work.node_cache), work.boxes.tests);
    EXPECT_EQ(work.boxes.waiting, 0u);
    EXPECT_GT(work.leaves, 0u);
    EXPECT_GE(work.triangles.tests, work.leaves);
    EXPECT_LE(work.triangles.tests, work.leaves * 4);
    EXPECT_GE(lookups(work.triangle_cache), work.leaves) << "the exit reads the triangles of hits once more";
    EXPECT_GT(work.triangles.waiting, 0u) << "two lanes share the pipe";

    EXPECT_GT(work.deepest_stack, 0u);
    EXPECT_LE(work.stack_fills, work.stack_spills);
    EXPECT_EQ(work.memory_lines, work.node_cache.misses + work.triangle_cache.misses + work.stack_fills);
    EXPECT_EQ(work.memory_quadwords, 2 * work.stack_spills);
  }
}

// What a ray visits does not depend on time.
TEST(Board, CountsTheTestsThatTheTracerMakesOfTheSameRays) {
  TreeBoard board;
  const test::RealFrame& run = board.run;
  Traversal traversal(run.scene);
  traversal.compress_nodes(run.options.configuration.chip.hardware_traverser_box_bits);
  chip::FixedLatencyStore store(board.run.image.memory, &board.tree.memory, run.options.configuration.chip);
  chip::Board frame(run.options, *board.device, store);
  Ray ray{};
  uint32_t beats = 0;
  TraversalCounts expected;
  while (!frame.ended()) {
    const ChipOutputs& outputs = board.device->outputs();
    if (outputs.ray_valid && outputs.traverser.ray_ready) {
      std::copy(outputs.ray_data.begin(), outputs.ray_data.end(), ray.begin() + beats++ * kBeatWords);
      if (outputs.ray_last) {
        beats = 0;
        Hit hit;
        if ((ray[word::kFlags] & kShadowFlag) != 0)
          traversal.occluded(to_query(ray), &expected);
        else
          traversal.nearest(to_query(ray), hit, &expected);
      }
    }
    frame.clock();
  }
  const TraverserWork work = *frame.result().traversal;
  EXPECT_EQ(work.boxes.tests, expected.nodes);
  EXPECT_EQ(work.leaves, expected.blocks);
  EXPECT_EQ(work.triangles.tests, expected.triangles);
}

TEST(Board, ReportsMalformedTrees) {
  const auto expect = [](TreeFaultCode code, const std::string& what, const std::function<void(TreeBoard&)>& change) {
    TreeBoard board;
    change(board);
    const std::string said = fault_of(board, code);
    EXPECT_NE(said.find(what), std::string::npos) << said << "\n" << what;
  };
  expect(TreeFaultCode::NodeBeyond,
         ": a ray comes to node 100000, at byte 6400000 of the traverser's memory, and there are",
         [](TreeBoard& board) { board.tree.setup.root = 100000; });
  expect(TreeFaultCode::TriangleBeyond, ": a leaf has triangles at byte ",
         [](TreeBoard& board) { board.tree.setup.root = kLeafBit | (board.tree.setup.triangle_lines * 64 / 44 + 2); });
  expect(TreeFaultCode::TriangleBeyond, ": a leaf has triangles beyond all bytes",
         [](TreeBoard& board) { board.tree.setup.root = kLeafBit | 0x1fffffff; });
  expect(TreeFaultCode::Children, ": node 0, at byte 0 of the traverser's memory, has not one to four children",
         [](TreeBoard& board) { board.change(0, kCountWord, board.word(0, kCountWord) & 0xffffff); });
  expect(TreeFaultCode::Order, ": node 0, at byte 0 of the traverser's memory, has a child with a number not above its",
         [](TreeBoard& board) { board.change(0, kFirstChild, 0); });
  expect(TreeFaultCode::Visits, ": a ray comes to more nodes than the 2 that there are, at last to node ",
         [](TreeBoard& board) {
           // The root has the other node four times, and that a leaf; all boxes are as large as the grid.
           for (uint32_t i = 0; i < 16; ++i) board.change(1, i, board.word(0, i));
           for (uint32_t node = 0; node < 2; ++node) {
             board.change(node, kCountWord, (board.word(0, kCountWord) & 0xffffff) | 4u << 24);
             for (uint32_t i = 4; i < 7; ++i) board.change(node, i, 0);
             for (uint32_t i = 7; i < 10; ++i) board.change(node, i, 0xffffffff);
             for (uint32_t i = 0; i < 4; ++i) board.change(node, kFirstChild + i, node == 0 ? 1 : kLeafBit);
           }
           board.tree.setup.triangle_lines += board.tree.setup.triangles_line - 2;
           board.tree.setup.triangles_line = 2;
         });
}

/// A chip between which and the board something is lost.
class LossyBus : public ChipDevice {
 public:
  enum class Loses : uint8_t { Spills, ARead, Reads, Beats };
  LossyBus(std::unique_ptr<ChipDevice> chip, Loses loses) : chip_(std::move(chip)), loses_(loses) {}

  uint32_t units() const override { return chip_->units(); }
  void start(const FrameSetup& setup) override {
    chip_->start(setup);
    look();
  }
  void start_next(const FrameSetup& setup) override {
    chip_->start_next(setup);
    look();
  }
  const ChipOutputs& outputs() const override { return out_; }
  void clock(const ChipInputs& inputs) override {
    ChipInputs in = inputs;
    if (hidden_) in.memory_request_ready = true;
    if (loses_ == Loses::Beats && in.memory_beat_valid && out_.memory_beat_ready && ++beats_ >= 1000)
      in.memory_beat_valid = false;
    chip_->clock(in);
    look();
  }
  ChipCounts counts() override { return chip_->counts(); }
  uint64_t counter(int number) override { return chip_->counter(number); }

  uint64_t lost = 0;

 private:
  void look() {
    out_ = chip_->outputs();
    const MemoryPort::Access& access = out_.memory_request;
    const bool of_tree = out_.memory_request_valid && access.traverser;
    hidden_ = (loses_ == Loses::Spills && of_tree && access.request.write) ||
              (of_tree && !access.request.write && ++reads_ >= 200 &&
               (loses_ == Loses::Reads || (loses_ == Loses::ARead && reads_ == 200)));
    if (!hidden_) return;
    out_.memory_request_valid = false;
    ++lost;
  }

  std::unique_ptr<ChipDevice> chip_;
  Loses loses_;
  bool hidden_ = false;
  uint64_t beats_ = 0, reads_ = 0;
  ChipOutputs out_;
};

// Blocks of stacks that have never been written are zeros: the root, again and again.
TEST(Board, ReportsTooManyNodesWhenItsMemoryLosesStacks) {
  TreeBoard board;
  auto bus = std::make_unique<LossyBus>(std::move(board.device), LossyBus::Loses::Spills);
  const LossyBus& lossy = *bus;
  board.device = std::move(bus);
  const std::string said = fault_of(board, TreeFaultCode::Visits);
  EXPECT_NE(said.find("or the memory has not kept a stack"), std::string::npos) << said;
  EXPECT_GT(lossy.lost, 0u);
}

TEST(Board, ReportsWhatWaitsForALostAnswer) {
  for (const LossyBus::Loses loses : {LossyBus::Loses::Reads, LossyBus::Loses::Beats}) {
    TreeBoard board;
    const uint64_t limit = chip::AnswerWatch::limit(board.run.options.configuration.chip);
    board.device = std::make_unique<LossyBus>(std::move(board.device), loses);
    const std::string said = error_of(board);
    const size_t at = said.find(" waits at port ");
    ASSERT_NE(at, std::string::npos) << said;
    EXPECT_NE(said.find(" since cycle "), std::string::npos) << said;
    EXPECT_NE(said.find("and none takes more than " + std::to_string(limit) + " cycles"), std::string::npos) << said;
    EXPECT_LT(limit, 50000u);
  }
}

// Lines that come later are taken for those before them.
TEST(Board, EndsWhenItsMemoryLosesOneRead) {
  TreeBoard board;
  board.device = std::make_unique<LossyBus>(std::move(board.device), LossyBus::Loses::ARead);
  const std::string said = error_of(board);
  EXPECT_TRUE(said.find("the traverser has stopped with a fault: ") == 0 ||
              said.find(" waits at port ") != std::string::npos)
      << said;
}

TEST(Board, AnswersAreLostBehindTheirLimitAndNotBefore) {
  const ChipConfiguration chip;
  const uint64_t limit = chip::AnswerWatch::limit(chip);
  chip::AnswerWatch watch(chip);
  ChipOutputs outputs;
  ChipInputs inputs;
  inputs.memory_request_ready = true;
  outputs.memory_request_valid = true;
  EXPECT_FALSE(watch.clock(7, outputs, inputs));
  outputs.memory_request_valid = false;
  for (uint64_t cycle = 8; cycle <= 7 + limit; ++cycle) EXPECT_FALSE(watch.clock(cycle, outputs, inputs));
  EXPECT_EQ(watch.late(), "");
  EXPECT_TRUE(watch.clock(8 + limit, outputs, inputs));
  const std::string said = watch.late();
  EXPECT_EQ(said.find("the chip waits at port memory_request since cycle 7 for a line of the memory"), 0u) << said;
}

}  // namespace
}  // namespace raypool
