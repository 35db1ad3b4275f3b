#include "sampled/sampled_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <utility>

#include "bits.hpp"
#include "chip/board.hpp"
#include "chip/test_board.hpp"
#include "chip/tree_image.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/compute/model.hpp"

namespace raypool::sampled {
namespace {

constexpr uint32_t kSide = 160;  // pixels: 1600 tiles of 4x4

/// Half of a room: half of the eye's rays meet nothing.
Scene make_half() {
  const Scene room = make_cornell();
  Scene half = room;
  half.triangles.clear();
  half.triangle_materials.clear();
  const float middle = 0.5f * (room.bounds().lower.x + room.bounds().upper.x);
  for (size_t i = 0; i < room.triangles.size(); ++i) {
    if (std::max({room.corner(i, 0).x, room.corner(i, 1).x, room.corner(i, 2).x}) > middle) continue;
    half.triangles.push_back(room.triangles[i]);
    half.triangle_materials.push_back(room.triangle_materials[i]);
  }
  return half;
}

struct Frame : test::RealFrame {
  explicit Frame(uint32_t side = kSide, Scene drawn = make_cornell(), void (*change)(ChipConfiguration&) = {})
      : RealFrame(4, 4, side, side, 2, std::move(drawn)) {
    ChipConfiguration& chip = options.configuration.chip;
    chip.held_limit = 64;
    if (change != nullptr) change(chip);
    if (has_traverser(chip)) {
      tree = make_tree_image(scene, tracer.traversal().bvh(), chip, image.material_base);
      options.tree = &*tree;
    }
    NativeOptions native;
    native.width = native.height = side;
    native.depth = 2;
    native.contents = options.configuration.contents();
    native.parts = blocks_of(options.configuration, side, side);
    native.work = &work;
    render_native(scene, image, tracer, native);
  }
  /// All of it.
  ChipResult draw() {
    const auto chip = make_chip_model(options.configuration, make_model(options.configuration, image.memory, 1).device);
    return run_board(options, *chip);
  }

  std::optional<TreeImage> tree;
  std::vector<NativeWork> work;
};

TEST(SampledFrame, PredictsWhatTheWholeFrameTakes) {
  Frame frame;
  const ChipResult whole = frame.draw();
  Wanted wanted;
  wanted.error = 0.1;
  const Figures figures = draw_sampled(frame.options, 1, frame.work, wanted);
  ASSERT_FALSE(figures.whole);
  EXPECT_EQ(figures.tiles, 1600u);
  EXPECT_LT(figures.simulated_tiles, 1000u);
  EXPECT_LT(figures.counted_tiles, figures.simulated_tiles);
  EXPECT_NEAR(figures.cycles.value, static_cast<double>(whole.cycles), 0.05 * static_cast<double>(whole.cycles));
  EXPECT_LE(figures.error(), 0.15);
  EXPECT_DOUBLE_EQ(figures.mrays_per_s.value, 1e3 * static_cast<double>(whole.rays()) / figures.cycles.value);
  EXPECT_LT(figures.mrays_per_s.low, figures.mrays_per_s.high);
  for (size_t i = 0; i < kAluTypes; ++i) EXPECT_NEAR(figures.alus[i].value, whole.alus[i].utilisation, 0.03) << i;
  EXPECT_NEAR(figures.ray_port.value, whole.ray_port_utilisation, 0.02);
  EXPECT_NEAR(figures.intersection_port.value, whole.intersection_port_utilisation, 0.02);
}

// A block reads what the frame's tiles before it have not read, and no more.
TEST(SampledFrame, FindsTheTreeInTheCachesBehindTilesThatAreLeftOut) {
  Frame frame(kSide, make_cornell(), [](ChipConfiguration& chip) {
    test::inside(chip);
    chip.hardware_traverser_lanes = 4;
    chip.hardware_traverser_rays = 64;
    chip.hardware_traverser_triangle_pipes = 4;
    chip.hardware_traverser_node_cache_bytes = chip.hardware_traverser_triangle_cache_bytes = 65536;
    chip.hardware_traverser_node_cache_mshrs = chip.hardware_traverser_triangle_cache_mshrs = 8;
  });
  const ChipResult whole = frame.draw();
  Wanted wanted;
  wanted.error = 0.1;
  double mean = 0;
  for (wanted.seed = 1; wanted.seed <= 8; ++wanted.seed) {
    const Figures figures = draw_sampled(frame.options, 1, frame.work, wanted);
    ASSERT_FALSE(figures.whole);
    mean += figures.memory_port.value / 8;
  }
  EXPECT_NEAR(mean, whole.memory_port_utilisation, 0.2 * whole.memory_port_utilisation);
}

TEST(SampledFrame, SimulatesMoreWhereLessErrorIsAllowed) {
  Frame frame;
  Wanted coarse, fine;
  coarse.error = 0.3;
  const Figures a = draw_sampled(frame.options, 1, frame.work, coarse);
  fine.error = 0.7 * a.error();
  const Figures b = draw_sampled(frame.options, 1, frame.work, fine);
  EXPECT_GT(b.counted_tiles, a.counted_tiles);
  EXPECT_LT(b.error(), a.error());
}

TEST(SampledFrame, IsExactWhereTheWholeFrameIsAsCheap) {
  Frame frame(32);
  const ChipResult whole = frame.draw();
  const Figures figures = draw_sampled(frame.options, 1, frame.work, {});
  EXPECT_TRUE(figures.whole);
  EXPECT_EQ(figures.simulated_tiles, figures.tiles);
  EXPECT_EQ(figures.cycles.low, static_cast<double>(whole.cycles));
  EXPECT_EQ(figures.cycles.high, static_cast<double>(whole.cycles));
  EXPECT_EQ(figures.alus[AluType::Ray].value, whole.alus[AluType::Ray].utilisation);
  EXPECT_EQ(figures.error(), 0);
}

TEST(SampledFrame, IsTheSameHoweverManyProcesses) {
  Frame frame;
  Wanted wanted;
  wanted.error = 0.05;
  const Figures one = draw_sampled(frame.options, 1, frame.work, wanted);
  ASSERT_FALSE(one.whole);
  for (const uint32_t processes : {2u, 3u, 64u}) {
    wanted.processes = processes;
    const Figures several = draw_sampled(frame.options, 1, frame.work, wanted);
    EXPECT_EQ(several.cycles.value, one.cycles.value);
    EXPECT_EQ(several.cycles.low, one.cycles.low);
    EXPECT_EQ(several.alus[AluType::Ray].high, one.alus[AluType::Ray].high);
    EXPECT_EQ(several.simulated_tiles, one.simulated_tiles);
  }
  wanted.seed = 2;
  EXPECT_NE(draw_sampled(frame.options, 1, frame.work, wanted).cycles.value, one.cycles.value);
}

// With what is known of the blocks in the wrong order it predicts nothing.
TEST(SampledFrame, IsNarrowerForWhatNativeKnows) {
  Frame frame(kSide, make_half());
  std::vector<NativeWork> mixed = frame.work;
  std::shuffle(mixed.begin(), mixed.end(), std::mt19937(1));
  Wanted wanted;
  wanted.seconds = 1e-3;
  double known = 0, unknown = 0;
  for (wanted.seed = 1; wanted.seed <= 4; ++wanted.seed) {
    known += draw_sampled(frame.options, 1, frame.work, wanted).error();
    unknown += draw_sampled(frame.options, 1, mixed, wanted).error();
  }
  EXPECT_LT(known, 0.6 * unknown);
}

TEST(SampledFrame, ReportsItsProgress) {
  Frame frame;
  std::vector<ChipProgress> told;
  frame.options.progress = [&](const ChipProgress& done) { told.push_back(done); };
  Wanted wanted;
  wanted.error = 0.4;
  ASSERT_FALSE(draw_sampled(frame.options, 1, frame.work, wanted).whole);
  ASSERT_GE(told.size(), 2u);
  EXPECT_LT(told.front().pixels_done, 1);
  EXPECT_EQ(told.back().pixels_done, 1);
  EXPECT_GT(told.back().cycles, told.front().cycles);
  EXPECT_GT(told.front().rays, 0u);
}

TEST(SampledFrame, PassesOnWhatGoesWrong) {
  Frame frame;
  frame.options.limits.cycles = 1000;
  EXPECT_THROW(draw_sampled(frame.options, 1, frame.work, {}), std::runtime_error);
  frame.work.pop_back();
  EXPECT_THROW(draw_sampled(frame.options, 1, frame.work, {}), std::logic_error);
}

TEST(SampledFrame, WithoutTimeTakesTheSmallestSample) {
  Frame frame;
  Wanted wanted;
  wanted.seconds = 1e-3;
  const Figures figures = draw_sampled(frame.options, 1, frame.work, wanted);
  EXPECT_FALSE(figures.whole);
  wanted.seconds = 0;
  wanted.error = 0.4;
  EXPECT_EQ(draw_sampled(frame.options, 1, frame.work, wanted).counted_tiles, figures.counted_tiles);
}

}  // namespace
}  // namespace raypool::sampled
