#include "chip/several_frames.hpp"

#include <gtest/gtest.h>

#include "chip/test_board.hpp"

namespace raypool {
namespace {

double ceiling_of(const ChipResult& result, const std::string& name) {
  for (const Ceiling& one : result.ceilings) {
    if (one.name == name) return one.mrays_per_s;
  }
  ADD_FAILURE() << "no ceiling " << name;
  return 0;
}

TEST(SeveralFrames, TheFirstOneIsTheSum) {
  const ChipResult frame = test::TreeBoard().draw();
  ChipResult sum;
  add_frame(sum, frame);
  test::expect_the_same(sum, frame);
  EXPECT_EQ(sum.mrays_per_s, frame.mrays_per_s);
  EXPECT_EQ(sum.ceilings.size(), frame.ceilings.size());
}

TEST(SeveralFrames, OneTwiceHasItsAveragesAndTwiceItsCounts) {
  const ChipResult frame = test::TreeBoard().draw();
  ChipResult sum;
  add_frame(sum, frame);
  add_frame(sum, frame);
  EXPECT_EQ(sum.cycles, 2 * frame.cycles);
  EXPECT_EQ(sum.nanoseconds, 2 * frame.nanoseconds);
  EXPECT_EQ(sum.busy_cycles, 2 * frame.busy_cycles);
  EXPECT_EQ(sum.instructions, 2 * frame.instructions);
  EXPECT_EQ(sum.rays(), 2 * frame.rays());
  EXPECT_EQ(sum.contributions, 2 * frame.contributions);
  EXPECT_EQ(sum.memory_reads, 2 * frame.memory_reads);
  EXPECT_EQ(sum.kernels[RayKernel::CastEye].threads, 2 * frame.kernels[RayKernel::CastEye].threads);
  EXPECT_EQ(sum.warp_cycles.sum(), 2 * frame.warp_cycles.sum());
  ASSERT_TRUE(sum.traversal && frame.traversal);
  EXPECT_EQ(sum.traversal->rays, 2 * frame.traversal->rays);
  EXPECT_EQ(sum.traversal->most_rays, frame.traversal->most_rays);
  EXPECT_EQ(sum.rays_pool.peak, frame.rays_pool.peak);
  EXPECT_DOUBLE_EQ(sum.rays_pool.mean, frame.rays_pool.mean);
  EXPECT_DOUBLE_EQ(sum.mrays_per_s, frame.mrays_per_s);
  EXPECT_DOUBLE_EQ(sum.thesis_mrays_per_s, frame.thesis_mrays_per_s);
  EXPECT_DOUBLE_EQ(sum.frames_per_s, frame.frames_per_s / 2) << "of pictures";
  EXPECT_DOUBLE_EQ(sum.resource_utilisation, frame.resource_utilisation);
  for (size_t i = 0; i < kAluTypes; ++i) {
    EXPECT_DOUBLE_EQ(sum.alus[i].utilisation, frame.alus[i].utilisation);
    EXPECT_EQ(sum.alus[i].issued, 2 * frame.alus[i].issued);
  }
  for (const Ceiling& one : frame.ceilings) EXPECT_DOUBLE_EQ(ceiling_of(sum, one.name), one.mrays_per_s) << one.name;
}

TEST(SeveralFrames, AveragesOfTwoCountBothForTheirTime) {
  const ChipResult a = test::BoardRun({"", 4, 4, 1, 8, 8, 1}).draw(),
                   b = test::BoardRun({"", 4, 4, 1, 24, 16, 4}).draw();
  ASSERT_GT(b.cycles, 2 * a.cycles);
  ASSERT_NE(a.ray_port_utilisation, b.ray_port_utilisation);
  ChipResult sum;
  add_frame(sum, a);
  add_frame(sum, b);
  const auto cycles = static_cast<double>(a.cycles + b.cycles);
  EXPECT_DOUBLE_EQ(sum.ray_port_utilisation, (a.ray_port_utilisation * static_cast<double>(a.cycles) +
                                              b.ray_port_utilisation * static_cast<double>(b.cycles)) /
                                                 cycles);
  EXPECT_DOUBLE_EQ(sum.time_utilisation, static_cast<double>(a.busy_cycles + b.busy_cycles) / cycles);
  EXPECT_DOUBLE_EQ(sum.mrays_per_s, 1e3 * static_cast<double>(a.rays() + b.rays()) / cycles);
  // As of one frame: at so many times the speed the port would be busy in every cycle.
  EXPECT_NEAR(ceiling_of(sum, "ray_port"), sum.mrays_per_s / sum.ray_port_utilisation, 1e-9 * sum.mrays_per_s);
  for (size_t i = 1; i < sum.ceilings.size(); ++i)
    EXPECT_LE(sum.ceilings[i - 1].mrays_per_s, sum.ceilings[i].mrays_per_s);
  EXPECT_EQ(sum.normal_pool.peak, std::max(a.normal_pool.peak, b.normal_pool.peak));
}

}  // namespace
}  // namespace raypool
