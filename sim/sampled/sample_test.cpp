#include "sampled/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace raypool::sampled {
namespace {

const std::vector<uint64_t> kAlike(1003, 1);

TEST(Sample, HasEachInnerBlockInOneStratum) {
  const Sample sample(kAlike, 10, 7, 1);
  EXPECT_EQ(sample.blocks(), 101u);
  EXPECT_EQ(sample.begin(100), 1000u);
  EXPECT_EQ(sample.begin(101), 1003u) << "the last block is shorter";
  std::set<uint32_t> seen;
  for (const Stratum& stratum : sample.strata()) seen.insert(stratum.order.begin(), stratum.order.end());
  EXPECT_EQ(seen.size(), 99u);
  EXPECT_EQ(*seen.begin(), 1u);
  EXPECT_EQ(*seen.rbegin(), 99u);
}

TEST(Sample, OfAlikeBlocksHasNeighboursInAStratum) {
  const Sample sample(kAlike, 10, 3, 1);
  for (uint32_t i = 0; i < 3; ++i) {
    for (const uint32_t block : sample.strata()[i].order) EXPECT_EQ((block - 1) / 33, i);
  }
}

TEST(Sample, KeepsWhatIsRareAndLargeApart) {
  std::vector<uint64_t> sizes(1000, 1);
  for (const uint32_t tile : {155u, 488u, 489u, 725u, 831u}) sizes[tile] = 100;  // of blocks 15, 48, 72, 83
  const Sample sample(sizes, 10, 24, 1);
  std::vector<uint32_t> last = sample.strata().back().order;
  std::sort(last.begin(), last.end());
  EXPECT_EQ(std::vector<uint32_t>(last.end() - 1, last.end()), std::vector<uint32_t>{98});
  for (const uint32_t block : {15u, 48u, 72u, 83u}) EXPECT_EQ(std::count(last.begin(), last.end(), block), 1);
}

TEST(Sample, DrawsWithoutReplacementAndMoreOfTheSame) {
  Sample sample(kAlike, 10, 7, 1);
  std::vector<uint32_t> all = sample.draw(0);
  EXPECT_EQ(all.size(), 7 * kLeastDrawn);
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  const std::vector<uint32_t> more = sample.draw(50);
  all.insert(all.end(), more.begin(), more.end());
  EXPECT_NEAR(all.size(), 50, 4);
  EXPECT_EQ(sample.drawn(), all.size());
  EXPECT_EQ(std::set<uint32_t>(all.begin(), all.end()).size(), all.size());
  EXPECT_TRUE(sample.draw(50).empty());
  EXPECT_EQ(sample.draw(99).size(), 99 - all.size());
}

TEST(Sample, IsAnotherWithAnotherSeedAndTheSameWithTheSame) {
  EXPECT_EQ(Sample(kAlike, 10, 7, 3).draw(30), Sample(kAlike, 10, 7, 3).draw(30));
  EXPECT_NE(Sample(kAlike, 10, 7, 3).draw(30), Sample(kAlike, 10, 7, 4).draw(30));
}

TEST(Sample, RefusesStrataThatAreTooSmall) {
  EXPECT_EQ(Sample::most_strata(1003, 10), 33u);
  EXPECT_EQ(Sample::most_strata(15, 10), 0u);
  EXPECT_THROW(Sample(kAlike, 10, 34, 1), std::logic_error);
}

}  // namespace
}  // namespace raypool::sampled
