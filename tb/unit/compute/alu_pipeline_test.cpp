// rtl/compute/rp_alu_pipeline.v: when tasks are taken, where they are, when they are done.
#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <cstdint>
#include <map>
#include <random>

#include "Vpipeline_units.h"

namespace raypool {
namespace {

constexpr int kPipelines = 5;
constexpr int kLatency[kPipelines] = {1, 2, 3, 1, 16};
constexpr int kDepth[kPipelines] = {1, 2, 3, 11, 32};
constexpr uint64_t kSeed = 99;

/// Runs all pipelines for a while; a task is wanted in one of `every` cycles. Checks every output
/// in every cycle, and counts the tasks.
std::array<int, kPipelines> run(int cycles, unsigned every) {
  VerilatedContext context;
  Vpipeline_units top(&context);
  std::mt19937_64 random(kSeed);
  std::array<int, kPipelines> tasks{};
  std::array<bool, kPipelines> granted{};
  std::array<int, kPipelines> last;
  last.fill(-100);
  std::array<std::map<int, uint32_t>, kPipelines> arrived;  // cycle of arrival -> warp
  const auto tick = [&] {
    top.clk_i = 0;
    top.eval();
    top.clk_i = 1;
    top.eval();
  };
  top.rst_ni = 0;
  top.task_valid_i = 0x1f;  // reset wins
  tick();
  top.task_valid_i = 0;
  tick();
  top.rst_ni = 1;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    // What was granted arrives; then look at the outputs, which may depend on it.
    uint32_t valid = 0, warps = 0;
    for (int p = 0; p < kPipelines; ++p) {
      const uint32_t warp = random() % 32;
      if (granted[p]) {
        EXPECT_GE(cycle - last[p], kLatency[p]);
        last[p] = cycle;
        arrived[p][cycle] = warp;
        ++tasks[p];
        valid |= 1u << p;
      }
      warps |= warp << (5 * p);
    }
    top.task_valid_i = valid;
    top.task_warp_i = warps;
    top.eval();
    const uint32_t stages[kPipelines] = {top.stage_valid_0_o, top.stage_valid_1_o, top.stage_valid_2_o,
                                         top.stage_valid_3_o, top.stage_valid_4_o};
    for (int p = 0; p < kPipelines; ++p) {
      for (int k = 0; k < kDepth[p]; ++k) EXPECT_EQ(stages[p] >> k & 1, arrived[p].count(cycle - k)) << p << ' ' << k;
      const auto done = arrived[p].find(cycle - kDepth[p]);
      EXPECT_EQ(top.done_valid_o >> p & 1, done != arrived[p].end());
      if (done != arrived[p].end()) {
        EXPECT_EQ(top.done_warp_o >> (5 * p) & 31, done->second);
      }
      const bool ready = top.ready_o >> p & 1;
      EXPECT_EQ(ready, cycle + 1 - last[p] >= kLatency[p])
          << "pipeline " << p << " cycle " << cycle << " seed " << kSeed;
      granted[p] = ready && random() % every == 0;
    }
    tick();
    if (testing::Test::HasFailure()) break;
  }
  top.final();
  return tasks;
}

TEST(AluPipeline, TakesATaskEveryLatencyCyclesWhenAlwaysAsked) {
  const std::array<int, kPipelines> tasks = run(4801, 1);
  for (int p = 0; p < kPipelines; ++p) EXPECT_EQ(tasks[p], 4800 / kLatency[p]) << p;
}

TEST(AluPipeline, KeepsItsTimesWithPausesBetweenTasks) {
  const std::array<int, kPipelines> tasks = run(20000, 5);
  for (int p = 0; p < kPipelines; ++p) EXPECT_GT(tasks[p], 500) << p;
}

}  // namespace
}  // namespace raypool
