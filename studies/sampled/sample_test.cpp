#include "sampled/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace raypool::sampled {
namespace {

constexpr uint32_t kTiles = 1003;
const std::vector<double> kAlike(101, 1);

TEST(Sample, HasEachInnerBlockInOneStratum) {
  const Sample sample(kTiles, 10, kAlike, 7, 1);
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
  const Sample sample(kTiles, 10, kAlike, 3, 1);
  for (uint32_t i = 0; i < 3; ++i) {
    for (const uint32_t block : sample.strata()[i].order) EXPECT_EQ((block - 1) / 33, i);
  }
}

TEST(Sample, KeepsWhatIsRareAndLargeApart) {
  std::vector<double> sizes(100, 10);
  for (const uint32_t block : {15u, 48u, 72u, 83u}) sizes[block] = 100;
  const Sample sample(1000, 10, sizes, 24, 1);
  std::vector<uint32_t> last = sample.strata().back().order;
  std::sort(last.begin(), last.end());
  EXPECT_EQ(std::vector<uint32_t>(last.end() - 1, last.end()), std::vector<uint32_t>{98});
  for (const uint32_t block : {15u, 48u, 72u, 83u}) EXPECT_EQ(std::count(last.begin(), last.end(), block), 1);
}

TEST(Sample, DrawsWithoutReplacementAndMoreOfTheSame) {
  Sample sample(kTiles, 10, kAlike, 7, 1);
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
  EXPECT_EQ(Sample(kTiles, 10, kAlike, 7, 3).draw(30), Sample(kTiles, 10, kAlike, 7, 3).draw(30));
  EXPECT_NE(Sample(kTiles, 10, kAlike, 7, 3).draw(30), Sample(kTiles, 10, kAlike, 7, 4).draw(30));
}

TEST(Sample, RefusesStrataThatAreTooSmall) {
  EXPECT_EQ(Sample::most_strata(1003, 10), 33u);
  EXPECT_EQ(Sample::most_strata(15, 10), 0u);
  EXPECT_THROW(Sample(kTiles, 10, kAlike, 34, 1), std::logic_error);
  EXPECT_THROW(Sample(kTiles, 11, kAlike, 7, 1), std::logic_error) << "sizes of other blocks";
}

}  // namespace
}  // namespace raypool::sampled
