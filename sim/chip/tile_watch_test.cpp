// What each tile costs, tiles that are chosen, and caches that remember what was visited in those that are not: on a
// board.
#include "chip/tile_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "chip/board.hpp"
#include "chip/board_memory.hpp"
#include "chip/frame_setup.hpp"
#include "chip/test_board.hpp"

namespace raypool {
namespace {

using test::BoardCase;

/// A frame on a board, with what its traverser needs.
struct CostedRun : test::BoardRun {
  explicit CostedRun(const BoardCase& c) : BoardRun(c) {
    const ChipConfiguration& chip = run.options.configuration.chip;
    if (has_traverser(chip)) {
      tree = make_tree_image(run.scene, run.tracer.traversal().bvh(), chip, run.image.material_base);
      run.options.tree = &*tree;
    }
  }
  ChipResult draw(FrameBegin begin = FrameBegin::Reset) {
    costs = {};
    run.options.tile_costs = &costs;
    return run_board(run.options, *device, begin);
  }
  double total(size_t number) const {
    double sum = 0;
    for (const chip::Counts& tile : costs.costs()) sum += tile[number];
    return sum;
  }

  std::optional<TreeImage> tree;
  chip::TileCosts costs;
};

void expect_sums(const CostedRun& costed, const ChipResult& result) {
  namespace count = chip::count;
  const auto expect = [&](size_t number, double value) {
    EXPECT_NEAR(costed.total(number), value, 1e-6 * value) << number;
  };
  const auto cycles = static_cast<double>(result.cycles);
  expect(count::kCycles, cycles);
  expect(count::kEyeRays, static_cast<double>(result.ray_counts.eye.traced));
  expect(count::kReflectionRays, static_cast<double>(result.ray_counts.reflection.traced));
  expect(count::kShadowRays, static_cast<double>(result.ray_counts.shadow.traced));
  expect(count::kBusyCycles, static_cast<double>(result.busy_cycles));
  expect(count::kInstructions, static_cast<double>(result.instructions));
  expect(count::kThreadInstructions, static_cast<double>(result.thread_instructions));
  expect(count::kRayPort, result.ray_port_utilisation * cycles);
  expect(count::kIntersectionPort, result.intersection_port_utilisation * cycles);
  expect(count::kMemoryPort, result.memory_port_utilisation * cycles);
  for (size_t type = 0; type < kAluTypes; ++type) {
    expect(count::kIssued + type, static_cast<double>(result.alus[type].issued));
    const Configuration& configuration = costed.run.options.configuration;
    const double used = costed.total(count::kBusyCycles) * configuration.alus[type].count;
    EXPECT_NEAR(1 - costed.total(count::kUnused + type) / used, result.alus[type].utilisation, 1e-6) << type;
  }
}

void fast(ChipConfiguration& chip) {
  chip.policy = PolicyName::Fill;
  chip.culling = true;
  chip.shading = Shading::Traverser;
}
void fast_inside(ChipConfiguration& chip) {
  test::inside(chip);
  fast(chip);
}
void scarce(ChipConfiguration& chip) {
  chip.ray_pool_size = 5;
  chip.intersection_pool_size = 9;
  chip.held_limit = 8;
}

class TileCostsOnABoard : public testing::TestWithParam<BoardCase> {};

TEST_P(TileCostsOnABoard, SumUpToTheCountsOfTheFrame) {
  const BoardCase c = GetParam();
  CostedRun costed(c);
  const ChipResult first = costed.draw();
  EXPECT_EQ(costed.costs.costs().size(), chip::along_walk(costed.run.options.configuration, c.width, c.height).size());
  expect_sums(costed, first);
  for (const chip::Counts& tile : costed.costs.costs()) EXPECT_GT(tile[chip::count::kCycles], 0);
  expect_sums(costed, costed.draw(FrameBegin::Next));
}

TEST_P(TileCostsOnABoard, TakeNoTime) {
  CostedRun costed(GetParam());
  const uint64_t cycles = costed.draw().cycles;
  test::BoardRun plain(GetParam());
  plain.run.options.tree = costed.run.options.tree;
  EXPECT_EQ(plain.draw().cycles, cycles);
}

TEST_P(TileCostsOnABoard, AreOfTheTilesThatAreChosenAlone) {
  const BoardCase c = GetParam();
  CostedRun costed(c);
  const std::vector<PixelTile> walk = chip::along_walk(costed.run.options.configuration, c.width, c.height);
  const uint32_t last = size32(walk) - 1;
  costed.run.options.tiles = {1, 2, last / 2, last};
  const ChipResult result = costed.draw();
  EXPECT_EQ(costed.costs.costs().size(), 4u);
  EXPECT_EQ(result.kernels[RayKernel::CastEye].launches, 4u);
  expect_sums(costed, result);

  const Tracer tracer(costed.run.scene, costed.run.image.material_base, costed.run.options.configuration.chip);
  NativeOptions native;
  native.width = c.width;
  native.height = c.height;
  native.depth = c.depth;
  const FrameBuffer whole = render_native(costed.run.scene, costed.run.image, tracer, native);
  const uint32_t columns = 1u << tile_width_log2(costed.run.options.configuration.contents());
  FrameBuffer expected(c.width, c.height);
  std::set<std::pair<uint32_t, uint32_t>> chosen;
  for (const uint32_t number : costed.run.options.tiles) {
    const PixelTile& tile = walk[number];
    for (uint32_t i = 0; i < tile.pixels; ++i) chosen.insert({tile.x + i % columns, tile.y + i / columns});
  }
  for (uint32_t y = 0; y < c.height; ++y) {
    for (uint32_t x = 0; x < c.width; ++x) {
      for (uint32_t channel = 0; channel < 3; ++channel) {
        EXPECT_EQ(costed.run.frame.raw(x, y, channel), chosen.count({x, y}) != 0 ? whole.raw(x, y, channel) : 0)
            << x << ' ' << y;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Chip, TileCostsOnABoard,
    testing::Values(BoardCase{"static_one", 4, 4, 1, 33, 21, 3}, BoardCase{"static_two", 4, 4, 2, 37, 29, 2},
                    BoardCase{"static_four", 4, 4, 4, 67, 41, 3, 16, fast},
                    BoardCase{"static_scarce", 2, 2, 2, 19, 13, 4, kIntersectionWords, scarce},
                    BoardCase{"hardware_one", 4, 4, 1, 33, 21, 3, kIntersectionWords, test::inside},
                    BoardCase{"hardware_four", 4, 4, 4, 67, 41, 3, 16, fast_inside}),
    [](const testing::TestParamInfo<BoardCase>& c) { return std::string(c.param.name); });

// ---- Caches that remember

void large_caches(ChipConfiguration& chip) {
  test::inside(chip);
  chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 262144;
  chip.hardware_traverser_node_cache_ways = chip.hardware_traverser_triangle_cache_ways = 16;
  chip.hardware_traverser_cache_banks = 2;
}

struct Remembering : CostedRun {
  explicit Remembering(void (*change)(ChipConfiguration&) = large_caches)
      : CostedRun({"", 4, 4, 1, 64, 64, 2, kIntersectionWords, change}) {}

  /// Draws. Returns which lines of nodes and of triangles the traverser has read.
  std::vector<uint32_t> lines_read() {
    struct Counting : chip::FixedLatencyStore {
      Counting(const ChipOptions& options, uint64_t latency)
          : FixedLatencyStore(*options.memory, &options.tree->memory, latency),
            stacks(options.tree->setup.stacks_line) {}
      uint64_t read(bool traverser, uint32_t address, Line& line) override {
        if (traverser && address / 64 < stacks) lines.push_back(address / 64);
        return FixedLatencyStore::read(traverser, address, line);
      }
      uint32_t stacks;
      std::vector<uint32_t> lines;
    };
    costs = {};
    run.options.tile_costs = &costs;
    Counting store(run.options, run.options.configuration.chip.memory_latency);
    chip::Board board(run.options, *device, store);
    while (!board.ended()) board.clock();
    board.result();
    return store.lines;
  }
  /// All of the tree.
  VisitList everything() const {
    VisitList places;
    const uint32_t nodes = tree->setup.triangles_line;
    for (uint32_t node = 0; node < nodes; ++node) places.push_back({node, 0, 0, 0});
    for (uint32_t triangle = 0; triangle < run.scene.triangles.size(); ++triangle)
      places.push_back({triangle, 1, 0, 0});
    return places;
  }
};

TEST(RememberedTree, IsAskedForBehindTilesThatAreLeftOut) {
  Remembering frame;
  std::vector<uint32_t> asked;
  frame.run.options.visited_before = [&](uint32_t tile) {
    asked.push_back(tile);
    return VisitList{};
  };
  frame.run.options.tiles = {0, 1, 40, 41, 42, 200};
  frame.draw();
  EXPECT_EQ(asked, (std::vector<uint32_t>{40, 200}));
  asked.clear();
  frame.run.options.tiles = {5, 6, 40};
  frame.draw();
  EXPECT_EQ(asked, (std::vector<uint32_t>{5, 40})) << "a run that begins elsewhere begins behind a gap too";
  asked.clear();
  frame.run.options.tiles.clear();
  frame.draw();
  EXPECT_TRUE(asked.empty());
}

TEST(RememberedTree, IsHitAtOnce) {
  Remembering frame;
  for (uint32_t tile = 100; tile < 140; ++tile) frame.run.options.tiles.push_back(tile);
  const std::vector<uint32_t> lines = frame.lines_read();
  EXPECT_GT(lines.size(), 100u);
  const FrameBuffer drawn = frame.run.frame;
  frame.run.frame = FrameBuffer(64, 64);
  // In a line of triangles some are that begin in it, or before it.
  VisitList places;
  const uint32_t first = frame.tree->setup.triangles_line;
  for (const uint32_t line : lines)
    places.push_back(line < first ? Visit{line, 0, 0, 0} : Visit{(line - first) * 64 / 44, 2, 0, 0});
  frame.run.options.visited_before = [&](uint32_t) { return places; };
  EXPECT_TRUE(frame.lines_read().empty());
  EXPECT_TRUE(frame.run.frame == drawn);
}

// Small caches, full of lines that are on their way or about to be given, remember while they work.
TEST(RememberedTree, LosesNoRayWhereCachesAreSmall) {
  Remembering frame(test::inside);
  for (uint32_t tile = 1; tile < 256; tile += 2) frame.run.options.tiles.push_back(tile);
  frame.draw();
  const FrameBuffer drawn = frame.run.frame;
  frame.run.frame = FrameBuffer(64, 64);
  uint32_t asked = 0;
  frame.run.options.visited_before = [&](uint32_t) {
    ++asked;
    return frame.everything();
  };
  frame.draw();
  EXPECT_EQ(asked, 128u);
  EXPECT_TRUE(frame.run.frame == drawn);
}

TEST(RememberedTree, NeedsATraverserInside) {
  test::BoardRun board({"", 4, 4, 1, 8, 8, 1});
  EXPECT_THROW(remember_lines(*board.device, {}, {}), std::logic_error);
  Remembering frame([](ChipConfiguration&) {});
  frame.run.options.tiles = {7};
  frame.run.options.visited_before = [](uint32_t) -> VisitList { throw std::logic_error("asked"); };
  frame.draw();
}

}  // namespace
}  // namespace raypool
