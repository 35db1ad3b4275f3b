// The real kernels on the chip, engine `functional`, against the native renderer.
#include <gtest/gtest.h>

#include "chip/test_real_frame.hpp"
#include "machine/functional_unit.hpp"
#include "machine/multiprocessor.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {
namespace {

struct Case {
  int warps, lanes, units, width, height, depth;
};

class Frame : public testing::TestWithParam<Case> {};

TEST_P(Frame, IsThatOfTheNativeRenderer) {
  const Case c = GetParam();
  test::RealFrame run(c.warps, c.lanes, c.width, c.height, c.depth);
  std::vector<std::unique_ptr<ComputeUnit>> units;
  for (int i = 0; i < c.units; ++i) units.push_back(make_functional_unit(run.options.configuration, run.image.memory));
  run.set_device(make_multiprocessor(std::move(units)));

  NativeOptions native;
  native.width = c.width;
  native.height = c.height;
  native.depth = c.depth;
  NativeStatistics statistics;
  const FrameBuffer expected = render_native(run.scene, run.image, run.tracer, native, &statistics);
  const ChipResult result = run_chip(run.options);

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

INSTANTIATE_TEST_SUITE_P(Chip, Frame,
                         testing::Values(Case{8, 8, 1, 32, 24, 1}, Case{8, 8, 4, 67, 41, 5}, Case{1, 1, 2, 13, 7, 3},
                                         Case{2, 8, 2, 31, 29, 2}, Case{32, 32, 4, 61, 53, 4}, Case{4, 4, 1, 1, 1, 5}),
                         [](const testing::TestParamInfo<Case>& c) {
                           return std::to_string(c.param.warps) + "w" + std::to_string(c.param.lanes) + "c" +
                                  std::to_string(c.param.units) + "u_depth" + std::to_string(c.param.depth);
                         });

}  // namespace
}  // namespace raypool
