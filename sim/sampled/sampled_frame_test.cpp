#include "sampled/sampled_frame.hpp"

#include <gtest/gtest.h>

#include "chip/test_real_frame.hpp"
#include "machine/model.hpp"

namespace raypool::sampled {
namespace {

constexpr uint32_t kSide = 96;  // pixels: 576 tiles of 4x4

struct Frame : test::RealFrame {
  explicit Frame(uint32_t side = kSide) : RealFrame(4, 4, side, side, 2), rays(size_t{side} * side) {
    options.configuration.chip.held_limit = 64;
    set_device(make_model(options.configuration, image.memory, 1).device);
    NativeOptions native;
    native.width = native.height = side;
    native.depth = 2;
    native.trace = [&](const Ray& ray, Intersection& hit) {
      ++rays[size_t{ray[word::kPixel] >> 16} * native.width + (ray[word::kPixel] & 0xffff)];
      return tracer.trace(ray, hit);
    };
    render_native(scene, image, tracer, native);
  }
  std::vector<uint32_t> rays;
};

TEST(SampledFrame, SaysWhatTheWholeFrameTakes) {
  Frame frame;
  const ChipResult whole = run_chip(frame.options);
  Wanted wanted;
  wanted.error = 0.1;
  const Figures figures = draw_sampled(frame.options, frame.rays, wanted);
  ASSERT_FALSE(figures.whole);
  EXPECT_EQ(figures.tiles, 576u);
  EXPECT_LT(figures.simulated_tiles, 288u);
  EXPECT_LT(figures.counted_tiles, figures.simulated_tiles);
  EXPECT_NEAR(figures.cycles.value, static_cast<double>(whole.cycles), 0.05 * static_cast<double>(whole.cycles));
  EXPECT_LE(figures.error(), 0.15);
  EXPECT_DOUBLE_EQ(figures.mrays_per_s.value, 1e3 * static_cast<double>(whole.rays()) / figures.cycles.value);
  EXPECT_LT(figures.mrays_per_s.low, figures.mrays_per_s.high);
  for (size_t i = 0; i < kAluTypes; ++i) EXPECT_NEAR(figures.alus[i].value, whole.alus[i].utilisation, 0.03) << i;
  EXPECT_NEAR(figures.ray_port.value, whole.ray_port_utilisation, 0.02);
  EXPECT_NEAR(figures.intersection_port.value, whole.intersection_port_utilisation, 0.02);
}

TEST(SampledFrame, SimulatesMoreWhereLessErrorIsAllowed) {
  Frame frame(160);
  Wanted coarse, fine;
  coarse.error = 0.3;
  const Figures a = draw_sampled(frame.options, frame.rays, coarse);
  fine.error = 0.7 * a.error();
  const Figures b = draw_sampled(frame.options, frame.rays, fine);
  EXPECT_GT(b.counted_tiles, a.counted_tiles);
  EXPECT_LT(b.error(), a.error());
}

TEST(SampledFrame, IsExactWhereTheWholeFrameIsAsCheap) {
  Frame frame(32);
  const ChipResult whole = run_chip(frame.options);
  const Figures figures = draw_sampled(frame.options, frame.rays, {});
  EXPECT_TRUE(figures.whole);
  EXPECT_EQ(figures.simulated_tiles, figures.tiles);
  EXPECT_EQ(figures.cycles.low, static_cast<double>(whole.cycles));
  EXPECT_EQ(figures.cycles.high, static_cast<double>(whole.cycles));
  EXPECT_EQ(figures.alus[AluType::Ray].value, whole.alus[AluType::Ray].utilisation);
  EXPECT_EQ(figures.error(), 0);
}

TEST(SampledFrame, WithoutTimeTakesTheSmallestSample) {
  Frame frame;
  Wanted wanted;
  wanted.seconds = 1e-3;
  const Figures figures = draw_sampled(frame.options, frame.rays, wanted);
  EXPECT_FALSE(figures.whole);
  wanted.seconds = 0;
  wanted.error = 0.4;
  EXPECT_EQ(draw_sampled(frame.options, frame.rays, wanted).counted_tiles, figures.counted_tiles);
}

}  // namespace
}  // namespace raypool::sampled
