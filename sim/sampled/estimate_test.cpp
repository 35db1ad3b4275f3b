#include "sampled/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sampled/sample.hpp"

namespace raypool::sampled {
namespace {

TEST(StudentT, IsThatOfTables) {
  EXPECT_NEAR(student_t(3), 3.182, 0.03);
  EXPECT_NEAR(student_t(4), 2.776, 0.005);
  EXPECT_NEAR(student_t(10), 2.2281, 1e-3);
  EXPECT_NEAR(student_t(30), 2.0423, 1e-4);
  EXPECT_NEAR(student_t(1e6), 1.95996, 1e-4);
}

Counts costs(double first, double second = 0) {
  Counts result{};
  result[0] = first;
  result[1] = second;
  return result;
}

TEST(Estimate, IsThatOfAStratifiedSample) {
  const Estimate estimate(costs(100), {{10, {costs(4), costs(6)}}, {5, {costs(1), costs(3), costs(5)}}});
  // 100 + 10 * 5 + 5 * 3; variances 10^2 (1 - 2/10) 2 / 2 = 80 and 5^2 (1 - 3/5) 4 / 3 = 13.33.
  const Interval total = estimate.total(0);
  EXPECT_DOUBLE_EQ(total.value, 165);
  const double first = 80, second = 25 * 0.4 * 4 / 3, all = first + second;
  const double degrees = all * all / (first * first / 3 + second * second / 4) - 2;
  EXPECT_NEAR(total.high - total.value, student_t(degrees) * std::sqrt(all), 1e-9);
  EXPECT_NEAR(total.value - total.low, total.high - total.value, 1e-9);
}

TEST(Estimate, OfStrataThatAreDrawnWholeIsExact) {
  const Estimate estimate(costs(1), {{2, {costs(4), costs(6)}}, {1, {costs(9)}}});
  EXPECT_DOUBLE_EQ(estimate.total(0).low, 20);
  EXPECT_DOUBLE_EQ(estimate.total(0).high, 20);
}

TEST(Estimate, OfAQuotientIsExactWhereAllHaveTheSame) {
  const Estimate estimate(costs(2, 1), {{9, {costs(4, 2), costs(6, 3), costs(2, 1)}}});
  EXPECT_DOUBLE_EQ(estimate.ratio(0, 1).value, 2);
  EXPECT_NEAR(estimate.ratio(0, 1).high, 2, 1e-12);
  EXPECT_GT(estimate.total(0).high - estimate.total(0).value, 1);
}

TEST(Estimate, MoreBlocksNarrowIt) {
  const Estimate estimate(costs(0), {{40, {costs(4), costs(6), costs(5)}}});
  EXPECT_LT(estimate.half_width(0, 4), estimate.half_width(0, 1) / 2);
  EXPECT_DOUBLE_EQ(estimate.half_width(0, 1), estimate.total(0).high - estimate.total(0).value);
  EXPECT_DOUBLE_EQ(estimate.half_width(0, 100), 0);
}

// A population with a dear corner whose sizes tell where it is, and noise: of many samples the stated share contains
// the sum. Half of the variance would be noticed, and so would twice as much.
TEST(Estimate, ContainsTheTruthInTheStatedShareOfSamples) {
  std::mt19937 random(5);
  std::vector<uint64_t> sizes;
  std::vector<double> tiles;
  double truth = 0;
  for (uint32_t i = 0; i < 2000; ++i) {
    sizes.push_back(i >= 10 && i < 210 ? 5 : 1);  // a stratum
    tiles.push_back(static_cast<double>(sizes[i]) * (10 + std::sin(0.01 * i)) +
                    static_cast<double>(random() % 1000) / 200);
    truth += tiles.back();
  }
  int contained = 0;
  constexpr int kSamples = 1000;
  for (int seed = 1; seed <= kSamples; ++seed) {
    Sample sample(sizes, 10, 10, static_cast<uint64_t>(seed));
    sample.draw(40);
    const auto block = [&](uint32_t number) {
      double sum = 0;
      for (uint32_t tile = sample.begin(number); tile < sample.begin(number + 1); ++tile) sum += tiles[tile];
      return costs(sum);
    };
    std::vector<Drawn> strata;
    for (const Stratum& stratum : sample.strata()) {
      Drawn& drawn = strata.emplace_back();
      drawn.blocks = stratum.order.size();
      for (uint32_t i = 0; i < stratum.drawn; ++i) drawn.costs.push_back(block(stratum.order[i]));
    }
    const double always = block(0)[0] + block(sample.blocks() - 1)[0];
    contained += Estimate(costs(always), strata).total(0).contains(truth);
  }
  EXPECT_GE(contained, 0.93 * kSamples);
  EXPECT_LE(contained, 0.97 * kSamples);
}

}  // namespace
}  // namespace raypool::sampled
