// The real kernels on the chip, engine `functional`, against the native renderer.
#include <gtest/gtest.h>

#include "chip/test_real_frame.hpp"
#include "machine/compute/functional_unit.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

struct FrameCase {
  int warps, lanes, units, width, height, depth;
  uint32_t intersection_words = kIntersectionWords;
};

class Frame : public testing::TestWithParam<FrameCase> {};

TEST_P(Frame, IsThatOfTheNativeRenderer) {
  const FrameCase c = GetParam();
  test::RealFrame run(c.warps, c.lanes, c.width, c.height, c.depth, make_cornell(), false, c.intersection_words);
  NativeOptions native;
  native.width = c.width;
  native.height = c.height;
  native.depth = c.depth;
  NativeStatistics statistics;
  const FrameBuffer expected = render_native(run.scene, run.image, run.tracer, native, &statistics);
  const ChipResult result =
      run.draw(make_functional_units(run.options.configuration, run.image.memory, static_cast<uint32_t>(c.units)));

  EXPECT_TRUE(run.frame == expected);
  const auto same = [](const RayCounts::Kind& a, const RayCounts::Kind& b) {
    return a.traced == b.traced && a.ended == b.ended && a.weightless == b.weightless && a.futile == b.futile;
  };
  EXPECT_TRUE(same(result.ray_counts.eye, statistics.ray_counts.eye));
  EXPECT_TRUE(same(result.ray_counts.reflection, statistics.ray_counts.reflection));
  EXPECT_TRUE(same(result.ray_counts.shadow, statistics.ray_counts.shadow));
  EXPECT_EQ(result.dropped_depth, statistics.dropped_rays);
  EXPECT_EQ(result.contributions, statistics.contributions);
  EXPECT_FALSE(result.timed);
}

TEST(FrameWithoutTime, SpendsNoneInTheTraverser) {
  test::RealFrame run(4, 4, 32, 24, 3, make_cornell());
  run.options.configuration.chip.traverser = TraverserName::Hardware;
  EXPECT_FALSE(run.draw(make_functional_unit(run.options.configuration, run.image.memory)).traversal);
}

struct Drawn {
  FrameBuffer frame;
  RayCounts rays;
  uint64_t too_deep;
  uint64_t reflecting = 0;  ///< threads of the kernel that casts a reflection
};

Drawn draw_on_chip(const Scene& scene, uint32_t depth, bool culling) {
  test::RealFrame run(4, 4, 32, 24, depth, scene, culling);
  const ChipResult result = run.draw(make_functional_unit(run.options.configuration, run.image.memory));
  return {run.frame, result.ray_counts, result.dropped_depth, result.kernels[RayKernel::CastSecondary].threads};
}

Drawn draw_natively(const Scene& scene, uint32_t depth, bool culling) {
  const MemoryImage image = build_memory(ray_kernel_program(), scene);
  NativeOptions native;
  native.width = 32;
  native.height = 24;
  native.depth = depth;
  native.culling = culling;
  NativeStatistics statistics;
  const FrameBuffer frame = render_native(scene, image, Tracer(scene, image.material_base), native, &statistics);
  return {frame, statistics.ray_counts, statistics.dropped_rays};
}

TEST(Culling, LeavesOutRaysWithoutWeightAndChangesNoPicture) {
  Scene black = make_cornell();
  black.light.color = {0, 0, 0};
  Scene mirrors = make_cornell();
  for (Material& material : mirrors.materials) material.kd = {0, 0, 0}, material.ks = {0.5f, 0, 0};
  for (const Scene& scene : {make_cornell(), make_room(0.2), black, mirrors}) {
    for (const uint32_t depth : {1, 2, 5}) {
      SCOPED_TRACE(testing::Message() << scene.name << " depth " << depth);
      const Drawn all = draw_natively(scene, depth, false), chip = draw_on_chip(scene, depth, true);
      const Drawn native = draw_natively(scene, depth, true);
      EXPECT_TRUE(chip.frame == all.frame);
      EXPECT_TRUE(native.frame == all.frame);
      EXPECT_EQ(chip.too_deep, native.too_deep);
      EXPECT_EQ(all.rays.shadow.left_out + all.rays.reflection.left_out, 0u);
      for (const auto kind : {&RayCounts::eye, &RayCounts::reflection, &RayCounts::shadow}) {
        EXPECT_EQ((chip.rays.*kind).traced, (native.rays.*kind).traced);
        EXPECT_EQ((chip.rays.*kind).left_out, (native.rays.*kind).left_out);
        EXPECT_EQ((chip.rays.*kind).weightless, 0u);
        // What had a weight is traced as before.
        EXPECT_EQ((chip.rays.*kind).traced, (all.rays.*kind).traced - (all.rays.*kind).weightless);
      }
      EXPECT_GT(chip.rays.shadow.left_out, 0u);
      if (depth > 1) continue;
      EXPECT_EQ(chip.rays.shadow.left_out, all.rays.shadow.weightless);
    }
  }
}

TEST(Culling, GivesHitsThatReflectNothingTheShorterKernel) {
  Scene scene = make_cornell();
  scene.materials.front().ks = {0.5f, 0.5f, 0.5f};
  for (size_t i = 1; i < scene.materials.size(); ++i) scene.materials[i].ks = {0, 0, 0};
  const Drawn all = draw_on_chip(scene, 3, false), culled = draw_on_chip(scene, 3, true);
  EXPECT_TRUE(culled.frame == all.frame);
  EXPECT_GT(culled.reflecting, 0u);
  EXPECT_EQ(culled.reflecting, culled.rays.reflection.traced);
  EXPECT_LT(culled.reflecting, all.reflecting / 2);
}

INSTANTIATE_TEST_SUITE_P(Chip, Frame,
                         testing::Values(FrameCase{8, 8, 1, 32, 24, 1}, FrameCase{8, 8, 4, 67, 41, 5},
                                         FrameCase{1, 1, 2, 13, 7, 3}, FrameCase{2, 8, 2, 31, 29, 2},
                                         FrameCase{32, 32, 4, 61, 53, 4}, FrameCase{4, 4, 1, 1, 1, 5},
                                         FrameCase{8, 8, 2, 41, 31, 1, 16}, FrameCase{4, 8, 4, 37, 29, 5, 18}),
                         [](const testing::TestParamInfo<FrameCase>& c) {
                           return std::to_string(c.param.warps) + "w" + std::to_string(c.param.lanes) + "c" +
                                  std::to_string(c.param.units) + "u_depth" + std::to_string(c.param.depth) + "_" +
                                  std::to_string(c.param.intersection_words) + "words";
                         });

}  // namespace
}  // namespace raypool
