#include "machine/compute/launcher.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace raypool {
namespace {

// A launcher of four warps of two lanes, and its warps, which run until they are ended.
class Warps {
 public:
  explicit Warps(bool overlap)
      : launcher([overlap] {
          Configuration configuration;
          configuration.warps = 4;
          configuration.lanes = 2;
          configuration.kernel_overlap = overlap;
          return configuration;
        }()) {}

  /// A cycle; warps in `end` run no longer in the next one. Returns those that were started.
  uint32_t cycle(uint32_t end = 0) {
    const uint32_t starts = launcher.starts(active);
    started_pc = launcher.start_launch().pc;
    done = launcher.kernel_done(active);
    launcher.clock(active);
    active = (active & ~end) | starts;
    return starts;
  }
  void launch(uint32_t pc, uint32_t threads) {
    ASSERT_TRUE(launcher.launch_ready(false));
    LaunchCommand command;
    command.pc = pc;
    command.threads = threads;
    cycle();
    launcher.accept(command);
  }

  Launcher launcher;
  uint32_t active = 0, started_pc = 0;
  bool done = false;
};

TEST(Launcher, AWarpThatHasEndedGoesOnWithTheNextKernelWhileOthersRunTheOneBefore) {
  Warps warps(true);
  warps.launch(10, 8);
  EXPECT_EQ(warps.cycle(), 0u);
  EXPECT_EQ(warps.cycle(), 0b1111u);
  warps.launch(20, 5);
  warps.cycle();
  EXPECT_EQ(warps.launcher.older() & warps.active, 0b1111u);
  EXPECT_EQ(warps.cycle(0b0110), 0u);
  EXPECT_EQ(warps.cycle(), 0b0110u);
  EXPECT_EQ(warps.started_pc, 20u);
  EXPECT_EQ(warps.launcher.older() & warps.active, 0b1001u);
  // The newer one's warps end first; it is over after the older one all the same, and warp 0 has yet to run in it.
  warps.cycle(0b0110);
  EXPECT_EQ(warps.cycle(0b1000), 0u);
  EXPECT_FALSE(warps.done);
  EXPECT_EQ(warps.cycle(0b0001), 0u) << "warp 3 has no thread of it";
  EXPECT_FALSE(warps.done);
  EXPECT_EQ(warps.cycle(), 0b0001u);
  EXPECT_TRUE(warps.done);
  EXPECT_TRUE(warps.launcher.running());
  EXPECT_EQ(warps.launcher.older(), 0u);
  warps.cycle(0b0001);
  EXPECT_FALSE(warps.done);
  warps.cycle();
  EXPECT_TRUE(warps.done);
  EXPECT_FALSE(warps.launcher.running());
}

TEST(Launcher, AThirdLaunchWaitsUntilTheOlderKernelHasEnded) {
  Warps warps(true);
  warps.launch(10, 8);
  warps.cycle();
  warps.cycle();
  warps.launch(20, 2);
  warps.cycle();
  warps.cycle(0b0001);
  EXPECT_EQ(warps.cycle(), 0b0001u);
  warps.launch(30, 8);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(warps.cycle(i == 0 ? 0b0011u : 0u), 0u);
  EXPECT_TRUE(warps.launcher.waiting());
  EXPECT_FALSE(warps.launcher.launch_ready(false));
  warps.cycle(0b1100);
  warps.cycle();
  EXPECT_TRUE(warps.done);
  warps.cycle();
  EXPECT_TRUE(warps.done) << "the second one's warp had long ended";
  EXPECT_FALSE(warps.launcher.waiting());
  EXPECT_EQ(warps.cycle(), 0b1111u);
  EXPECT_EQ(warps.started_pc, 30u);
}

TEST(Launcher, WithoutOverlapTheNextKernelStartsWhenTheOneBeforeHasEnded) {
  Warps warps(false);
  warps.launch(10, 8);
  EXPECT_EQ(warps.cycle(), 0b1111u);
  warps.launch(20, 3);
  EXPECT_EQ(warps.cycle(0b0111), 0u);
  EXPECT_EQ(warps.cycle(0b1000), 0u);
  EXPECT_EQ(warps.cycle(), 0u);
  EXPECT_TRUE(warps.done);
  EXPECT_EQ(warps.cycle(), 0b0011u);
  EXPECT_EQ(warps.started_pc, 20u);
  EXPECT_EQ(warps.launcher.older(), 0u);
}

}  // namespace
}  // namespace raypool
