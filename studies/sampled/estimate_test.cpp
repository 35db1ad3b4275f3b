#include "sampled/estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
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

/// Of a stratum of so many blocks, of which nothing is known.
Drawn drawn(size_t blocks, std::vector<Counts> costs) { return {std::vector<Known>(blocks), std::move(costs)}; }

TEST(Estimate, IsThatOfAStratifiedSample) {
  const Estimate estimate(costs(100), {drawn(10, {costs(4), costs(6)}), drawn(5, {costs(1), costs(3), costs(5)})});
  // 100 + 10 * 5 + 5 * 3; variances 10^2 (1 - 2/10) 2 / 2 = 80 and 5^2 (1 - 3/5) 4 / 3 = 13.33.
  const Interval total = estimate.total(0);
  EXPECT_DOUBLE_EQ(total.value, 165);
  const double first = 80, second = 25 * 0.4 * 4 / 3, all = first + second;
  const double degrees = all * all / (first * first / 3 + second * second / 4) - 2;
  EXPECT_NEAR(total.high - total.value, student_t(degrees) * std::sqrt(all), 1e-9);
  EXPECT_NEAR(total.value - total.low, total.high - total.value, 1e-9);
}

TEST(Estimate, OfStrataThatAreDrawnWholeIsExact) {
  const Estimate estimate(costs(1), {drawn(2, {costs(4), costs(6)}), drawn(1, {costs(9)})});
  EXPECT_DOUBLE_EQ(estimate.total(0).low, 20);
  EXPECT_DOUBLE_EQ(estimate.total(0).high, 20);
}

TEST(Estimate, OfAQuotientIsExactWhereAllHaveTheSame) {
  const Estimate estimate(costs(2, 1), {drawn(9, {costs(4, 2), costs(6, 3), costs(2, 1)})});
  EXPECT_DOUBLE_EQ(estimate.ratio(0, 1).value, 2);
  EXPECT_NEAR(estimate.ratio(0, 1).high, 2, 1e-12);
  EXPECT_GT(estimate.total(0).high - estimate.total(0).value, 1);
}

TEST(Estimate, MoreBlocksNarrowIt) {
  const Estimate estimate(costs(0), {drawn(40, {costs(4), costs(6), costs(5)})});
  EXPECT_LT(estimate.half_width(0, 4), estimate.half_width(0, 1) / 2);
  EXPECT_DOUBLE_EQ(estimate.half_width(0, 1), estimate.total(0).high - estimate.total(0).value);
  EXPECT_DOUBLE_EQ(estimate.half_width(0, 100), 0);
}

// Two strata of four blocks, of each of which two are drawn, and of each block one number x is known: 0 1 2 3 and 4 5 6
// 7, costs 3 + 2 x, but for a residual of 1 of the first. By hand: x has mean 3.5 and variance 5.25; drawn are those of
// z = (x - 3.5) / sqrt(5.25); slope = sum z' y / (sum z'^2 + 1) around the means of the sample.
TEST(Estimate, IsTheRegressionEstimator) {
  const std::vector<double> x = {0, 2, 5, 6}, y = {4, 7, 13, 15};
  double mean_x = 0, mean_y = 0, squares = 0, products = 0;
  for (size_t i = 0; i < 4; ++i) mean_x += x[i] / 4, mean_y += y[i] / 4;
  for (size_t i = 0; i < 4; ++i) {
    squares += (x[i] - mean_x) * (x[i] - mean_x) / 5.25;
    products += (x[i] - mean_x) * (y[i] - mean_y) / std::sqrt(5.25);
  }
  const double slope = products / (squares + 1) / std::sqrt(5.25);  // of x
  double truth = 0;
  for (size_t i = 0; i < 4; ++i) truth += 2 * (y[i] - slope * x[i]);  // 4 / 2 of each
  truth += slope * (0 + 1 + 2 + 3 + 4 + 5 + 6 + 7);
  const Estimate estimate(
      costs(0), {{{{0}, {2}, {1}, {3}}, {costs(4), costs(7)}}, {{{5}, {6}, {4}, {7}}, {costs(13), costs(15)}}});
  EXPECT_NEAR(estimate.total(0).value, truth, 1e-9);

  // Residuals without each block itself.
  std::vector<double> residuals;
  for (size_t i = 0; i < 4; ++i) {
    const double leverage = (x[i] - mean_x) * (x[i] - mean_x) / 5.25 / (squares + 1);
    residuals.push_back((y[i] - mean_y - slope * (x[i] - mean_x)) / (1 - leverage));
  }
  const auto variance = [&](size_t i) { return 4 * 4 * 0.5 / 2 * std::pow(residuals[i] - residuals[i + 1], 2) / 2; };
  const double first = variance(0), second = variance(2), all = first + second;
  const double degrees = all * all / (first * first / 3 + second * second / 3) - 2;
  EXPECT_NEAR(estimate.total(0).high - estimate.total(0).value, student_t(degrees) * std::sqrt(all), 1e-9);
}

TEST(Estimate, WhereWhatIsKnownPredictsAllOnlyTheRidgeIsLeft) {
  std::vector<Drawn> strata(8);
  double truth = 0;
  for (size_t i = 0; i < 800; ++i) {
    const double x = 10 + 3 * std::sin(static_cast<double>(i));
    strata[i / 100].known.push_back({x, 1});  // the second is the same everywhere
    if (i % 100 < 10) strata[i / 100].costs.push_back(costs(7 * x));
    truth += 7 * x;
  }
  const Estimate estimate(costs(0), strata);
  EXPECT_NEAR(estimate.total(0).value, truth, 1e-3 * truth);
  EXPECT_LT(estimate.half_width(0, 1), 2e-3 * truth);
  for (Drawn& stratum : strata) stratum.known.assign(100, {});
  EXPECT_GT(Estimate(costs(0), strata).half_width(0, 1), 0.01 * truth);
}

/// A population of blocks: what each costs, and what is known of it.
struct Population {
  std::vector<double> costs;
  std::vector<Known> known;
};
struct Found {
  double contained = 0, half_width = 0, error = 0;  // a share of the samples; means
};

/// 1000 samples of so many blocks, in so many strata.
Found sampled(const Population& population, uint32_t strata, uint32_t blocks) {
  std::vector<double> sizes(population.costs.size());
  for (size_t i = 0; i < sizes.size(); ++i) sizes[i] = population.known[i].empty() ? 0 : population.known[i][0];
  double truth = 0;
  for (const double cost : population.costs) truth += cost;
  constexpr int kSamples = 1000;
  Found found;
  for (int seed = 1; seed <= kSamples; ++seed) {
    Sample sample(static_cast<uint32_t>(sizes.size()), 1, sizes, strata, static_cast<uint64_t>(seed));
    sample.draw(blocks);
    std::vector<Drawn> drawn;
    for (const Stratum& stratum : sample.strata()) {
      Drawn& here = drawn.emplace_back();
      for (const uint32_t block : stratum.order) here.known.push_back(population.known[block]);
      for (uint32_t i = 0; i < stratum.drawn; ++i) here.costs.push_back(costs(population.costs[stratum.order[i]]));
    }
    const Interval total = Estimate(costs(population.costs.front() + population.costs.back()), drawn).total(0);
    found.contained += total.contains(truth) / static_cast<double>(kSamples);
    found.half_width += (total.high - total.value) / truth / kSamples;
    found.error += (total.value / truth - 1) / kSamples;
  }
  return found;
}

/// So many numbers are known of each of 200 blocks, costs follow them, by `slope`, with so much noise; with a dear
/// tenth.
Population population(uint32_t known, double slope, double noise) {
  std::mt19937 random(5);
  const auto number = [&] { return static_cast<double>(random() % 10000) / 5000 - 1; };
  Population made;
  for (uint32_t i = 0; i < 200; ++i) {
    const double size = i >= 10 && i < 30 ? 5 : 1;  // a stratum, nearly
    Known here;
    double cost = size * 10;
    for (uint32_t k = 0; k < known; ++k) {
      here.push_back(size * (5 + number()));
      cost += slope * here.back() / known;
    }
    made.known.push_back(here);
    made.costs.push_back(cost + noise * size * number());
  }
  return made;
}

void covers_the_value(const Found& found) {
  EXPECT_GE(found.contained, 0.93);
  EXPECT_LE(found.contained, 0.98);
  EXPECT_LT(std::fabs(found.error), 0.15 * found.half_width);
}

// Half of the variance would be detected, and so would twice as much.
TEST(Estimate, ContainsTheTruthInTheStatedShareOfSamples) {
  Population here = population(1, 0, 1);
  for (size_t i = 0; i < here.known.size(); ++i) here.known[i] = {};
  covers_the_value(sampled(here, 10, 40));
}

TEST(Estimate, CoversTheValueAndIsNarrowWhereWhatIsKnownPredictsWell) {
  const Population here = population(4, 6, 0.5);
  Population unknown = here;
  for (Known& known : unknown.known) known.resize(1);
  const Found with = sampled(here, 10, 40), without = sampled(unknown, 10, 40);
  covers_the_value(with);
  EXPECT_LT(with.half_width, 0.6 * without.half_width);
}

TEST(Estimate, CoversTheValueAndIsHardlyWiderWhereWhatIsKnownPredictsNothing) {
  Population here = population(1, 0, 4);
  const Found without = sampled(here, 10, 40);
  covers_the_value(without);
  std::mt19937 random(7);
  for (Known& known : here.known)
    for (int k = 0; k < 4; ++k) known.push_back(static_cast<double>(random() % 1000));
  const Found with = sampled(here, 10, 40);
  covers_the_value(with);
  EXPECT_LT(with.half_width, 1.2 * without.half_width);
}

TEST(Estimate, CoversTheValueWithFewerBlocksThanThingsKnown) {
  covers_the_value(sampled(population(40, 20, 1), 8, 24));
}

}  // namespace
}  // namespace raypool::sampled
