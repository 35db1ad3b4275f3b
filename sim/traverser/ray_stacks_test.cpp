#include "traverser/ray_stacks.hpp"

#include <gtest/gtest.h>

#include <random>

namespace raypool::traverser {
namespace {

/// Serves every request at once; returns how many cycles `entries` take.
uint64_t pop_all(RayStacks& stacks, uint32_t slot, uint32_t entries) {
  if (stacks.pop(slot, entries)) return 1;
  for (uint64_t cycles = 2;; ++cycles) {
    while (stacks.request_valid()) {
      const RayStacks::Request request = stacks.take_request();
      if (!request.write) stacks.filled(request.slot);
    }
    stacks.clock();
    if (!stacks.done().empty()) {
      EXPECT_EQ(stacks.done(), std::vector<uint32_t>{slot});
      return cycles;
    }
  }
}

TEST(RayStacks, TakeAnEntryInACycle) {
  RayStacks stacks(2, 8);
  stacks.push(1, 3);
  stacks.push(1, 3);
  EXPECT_EQ(pop_all(stacks, 1, 1), 1u);
  EXPECT_EQ(pop_all(stacks, 1, 5), 5u);
  EXPECT_EQ(stacks.spills(), 0u);
  EXPECT_EQ(stacks.deepest(), 6u);
}

TEST(RayStacks, SendTheOldestAwayAndFetchThemBack) {
  RayStacks stacks(1, 8);
  for (int i = 0; i < 4; ++i) stacks.push(0, 3);  // 12: four of them do not fit
  EXPECT_EQ(stacks.spills(), 1u);
  const RayStacks::Request spill = stacks.take_request();
  EXPECT_TRUE(spill.write);
  EXPECT_EQ(spill.block, 0u);
  EXPECT_FALSE(stacks.request_valid());
  EXPECT_EQ(pop_all(stacks, 0, 8), 8u);
  EXPECT_EQ(stacks.fills(), 0u);
  EXPECT_EQ(pop_all(stacks, 0, 4), 5u);  // none is there, then four
  EXPECT_EQ(stacks.fills(), 1u);
  EXPECT_EQ(stacks.deepest(), 12u);
}

TEST(RayStacks, GiveBackAsMuchAsTheyGotWhateverTheirSize) {
  std::mt19937 random(7);
  for (const uint32_t size : {8u, 9u, 12u, 64u}) {
    RayStacks stacks(1, size);
    uint32_t held = 0;
    for (int i = 0; i < 2000; ++i) {
      if (held < 60 && random() % 2 == 0) {
        const uint32_t entries = 1 + random() % 3;
        stacks.push(0, entries);
        held += entries;
      } else if (held > 0) {
        const uint32_t entries = 1 + random() % held;
        EXPECT_GE(pop_all(stacks, 0, entries), entries);
        held -= entries;
      }
    }
    EXPECT_GE(stacks.spills(), stacks.fills());
    if (size < 12) {
      EXPECT_GT(stacks.spills(), 0u) << size;
    }
    if (held > 0) pop_all(stacks, 0, held);
    EXPECT_EQ(stacks.spills(), stacks.fills());
  }
}

}  // namespace
}  // namespace raypool::traverser
