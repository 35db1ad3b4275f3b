#include "explore/front.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace raypool::explore {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

std::vector<Candidate> of_areas(const std::vector<double>& areas) {
  std::vector<Candidate> candidates;
  for (const double area : areas) candidates.push_back({area, 1, {}, std::nullopt});
  return candidates;
}

TEST(Front, HasWhatNothingSmallerIsAsFastAs) {
  const std::vector<size_t> front = front_of(of_areas({3, 1, 2, 4, 2, 5}), {50, 100, 100, 40, 60, 40});
  EXPECT_EQ(front, (std::vector<size_t>{1, 4, 0, 3}));
}

TEST(Front, HasTheFirstOfEqualOnesAndNoneThatCannotBe) {
  EXPECT_EQ(front_of(of_areas({1, 1, 2}), {10, 10, 10}), (std::vector<size_t>{0}));
  EXPECT_TRUE(front_of(of_areas({1, 2}), {kNone, kNone}).empty());
}

// Two fields of two values: the second value of the first field makes everything 1.5 times as slow, which the guess
// does not know.
std::vector<Candidate> skewed(size_t count, std::vector<double>& truth) {
  std::mt19937 random(3);
  std::vector<Candidate> candidates;
  truth.clear();
  for (size_t i = 0; i < count; ++i) {
    const uint32_t slow = random() % 2, other = random() % 2;
    const double area = 1 + static_cast<double>(random() % 1000) / 100;
    const double guess = 1e6 / area * (1 + static_cast<double>(random() % 100) / 100);
    const double noise = std::exp(0.02 * (static_cast<double>(random() % 200) / 100 - 1));
    candidates.push_back({area, guess, {slow, 2 + other}, std::nullopt});
    truth.push_back(guess * (slow != 0 ? 1.5 : 1) * noise);
  }
  return candidates;
}

TEST(Correction, LearnsWhatAFeatureCosts) {
  std::vector<double> truth;
  std::vector<Candidate> candidates = skewed(400, truth);
  for (size_t i = 0; i < 200; ++i) candidates[i].cycles = truth[i];
  const Correction correction = correction_of(candidates, 0.3);
  EXPECT_LT(correction.spread, 0.06);
  for (size_t i = 200; i < 400; ++i) EXPECT_NEAR(candidates[i].guess * correction.factors[i] / truth[i], 1, 0.05) << i;
}

TEST(Correction, KnowsNothingBeforeAnythingIsMeasured) {
  std::vector<double> truth;
  std::vector<Candidate> candidates = skewed(10, truth);
  EXPECT_EQ(correction_of(candidates, 0.25).spread, 0.25);
  candidates[0].cycles = kNone;  // cannot be, which says nothing of the others
  EXPECT_EQ(correction_of(candidates, 0.25).factors[1], 1.0);
}

// Where each candidate has a feature of its own, a fit explains its own measurement and no other.
TEST(Correction, DoesNotTakeWhatItIsFittedToForWhatItPredicts) {
  std::vector<Candidate> candidates;
  for (uint32_t i = 0; i < 40; ++i) candidates.push_back({1, 100, {i}, i % 2 == 0 ? 100 * 1.3 : 100 / 1.3});
  EXPECT_NEAR(correction_of(candidates, 0.1).spread, std::log(1.3), 0.04);
}

TEST(SearchFront, FindsItFromAFewMeasurements) {
  std::vector<double> truth;
  std::vector<Candidate> candidates = skewed(3000, truth);
  std::vector<size_t> first(100);
  for (size_t i = 0; i < first.size(); ++i) first[i] = i;
  size_t measurements = 0;
  search_front(candidates, first, 2, 0.3, [&](const std::vector<size_t>& numbers) {
    std::vector<double> cycles;
    for (const size_t number : numbers) cycles.push_back(truth[number]);
    measurements += numbers.size();
    return cycles;
  });
  EXPECT_EQ(measured_front(candidates), front_of(candidates, truth));
  EXPECT_LT(measurements, 300u);
}

TEST(SearchFront, GoesOnWithoutWhatCannotBeMeasured) {
  std::vector<Candidate> candidates = of_areas({1, 2, 3});
  candidates[0].guess = 10;
  candidates[1].guess = 5;
  candidates[2].guess = 4;
  search_front(candidates, {}, 1, 0.1, [&](const std::vector<size_t>& numbers) {
    std::vector<double> cycles;
    for (const size_t number : numbers) cycles.push_back(number == 1 ? kNone : candidates[number].guess);
    return cycles;
  });
  EXPECT_EQ(measured_front(candidates), (std::vector<size_t>{0, 2}));
}

}  // namespace
}  // namespace raypool::explore
