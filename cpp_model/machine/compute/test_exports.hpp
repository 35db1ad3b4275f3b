// For tests: what a unit reports of its exports (UnitOutputs::exports) beside what leaves at its ports.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "machine/compute/test_chip.hpp"
#include "machine/compute/test_program.hpp"

namespace raypool::test {

/// Exports thrice: a ray of every thread, a contribution of those of the upper lanes, and nothing. Every package has
/// its block's number as the pixel.
inline std::vector<uint64_t> exporting_program() {
  return assembled(R"(
      block r1
      rst 7, r1
      rout
      rst 7, r1
      lane r2
      ige p1, r2, 1
      @p1 rfb
      @!p0 rout
      exit)");
}

/// Runs `kernels` kernels of exporting_program() on a unit of its own, each when the one before has left (`alone`), or
/// as soon as it is taken. Of one alone the count must be exact when it is done. Else it may contain packages of the
/// next one; but when as many have left as it was, all packages of the kernel must have, which is all that the ports
/// alone show.
inline void expect_exports_counted(ComputeUnit& unit, TestChip& chip, const Configuration& configuration, bool alone,
                                   uint32_t kernels = 40) {
  const auto lanes = static_cast<uint32_t>(configuration.lanes),
             contents = static_cast<uint32_t>(configuration.contents());
  struct Ended {
    uint32_t block = 0;
    uint16_t exports = 0;  ///< in the cycle of its kernel_done
  };
  std::deque<Ended> ended;
  std::vector<uint64_t> expected(kernels), left(kernels);  // [block] packages
  uint64_t asked = 0, rays = 0, contributions = 0;
  uint32_t done = 0;
  ASSERT_EQ(unit.outputs().exports[0], 0u) << "after a reset";
  for (uint32_t launched = 0, limit = 200000; done < kernels || !unit.outputs().idle; --limit) {
    ASSERT_GT(limit, 0u) << "it does not end";
    if (launched < kernels && chip.launches.empty() && (!alone || (done == launched && unit.outputs().idle))) {
      LaunchCommand command;
      command.block = launched;
      command.threads = 1 + launched * 7 % contents;
      expected[launched] = uint64_t{2} * command.threads - (command.threads + lanes - 1) / lanes;
      chip.launches.push_back(command);
      ++launched;
    }
    chip.cycle();
    for (; rays < chip.rays.size(); ++rays) ++left.at(chip.rays[rays][word::kPixel]);
    for (; contributions < chip.frame.size(); ++contributions) ++left.at(chip.frame[contributions].pixel);
    const uint16_t exports = unit.outputs().exports[0];
    if (unit.outputs().kernel_done != 0) {
      ended.push_back({done, exports});
      asked += expected[done++];
      if (alone) {
        EXPECT_EQ(exports, asked) << "kernel " << done;
      }
    }
    while (!ended.empty() && rays + contributions >= ended.front().exports) {
      EXPECT_EQ(left[ended.front().block], expected[ended.front().block]) << "kernel " << ended.front().block;
      ended.pop_front();
    }
  }
  EXPECT_TRUE(ended.empty());
  EXPECT_EQ(left, expected);
  EXPECT_EQ(unit.outputs().exports[0], asked);
  EXPECT_GE(rays, kernels);
  if (lanes > 1) {
    EXPECT_GT(contributions, kernels / 2);
  }
}

}  // namespace raypool::test
