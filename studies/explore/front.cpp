#include "explore/front.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace raypool::explore {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
// How much a feature must explain to count: as if so many candidates without it were measured as they were guessed.
constexpr double kRidge = 2, kRidgeOfAll = 0.01;
// The spread that is expected before anything is measured counts as so many measurements; a row that alone decides on a
// feature says nothing about the spread beyond this leverage.
constexpr double kExpected = 4, kMostLeverage = 0.8;

bool teaches(const Candidate& candidate) {
  return candidate.cycles && *candidate.cycles < kNone && candidate.guess < kNone;
}

}  // namespace

std::vector<size_t> front_of(const std::vector<Candidate>& candidates, const std::vector<double>& cycles) {
  std::vector<size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return candidates[a].area != candidates[b].area ? candidates[a].area < candidates[b].area : cycles[a] < cycles[b];
  });
  std::vector<size_t> front;
  double fewest = kNone;
  for (const size_t number : order) {
    if (!(cycles[number] < fewest)) continue;
    fewest = cycles[number];
    front.push_back(number);
  }
  return front;
}

std::vector<size_t> measured_front(const std::vector<Candidate>& candidates) {
  std::vector<double> cycles;
  for (const Candidate& candidate : candidates) cycles.push_back(candidate.cycles.value_or(kNone));
  return front_of(candidates, cycles);
}

Correction correction_of(const std::vector<Candidate>& candidates, double before) {
  Correction correction{std::vector<double>(candidates.size(), 1.0), before};
  uint32_t features = 0;
  std::vector<const Candidate*> known;
  for (const Candidate& candidate : candidates) {
    for (const uint32_t feature : candidate.features) features = std::max(features, feature + 1);
    if (teaches(candidate)) known.push_back(&candidate);
  }
  if (known.empty()) return correction;
  // The last column is what all have.
  const auto rows = static_cast<Eigen::Index>(known.size()), columns = static_cast<Eigen::Index>(features) + 1;
  const auto row_of = [&](const Candidate& candidate) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(columns);
    for (const uint32_t feature : candidate.features) row[feature] = 1;
    row[columns - 1] = 1;
    return row;
  };
  Eigen::MatrixXd matrix(rows, columns);
  Eigen::VectorXd logs(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Candidate& candidate = *known[static_cast<size_t>(i)];
    matrix.row(i) = row_of(candidate);
    logs[i] = std::log(*candidate.cycles / candidate.guess);
  }
  Eigen::MatrixXd normal = matrix.transpose() * matrix;
  normal.diagonal().array() += kRidge;
  normal(columns - 1, columns - 1) += kRidgeOfAll - kRidge;
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  const Eigen::VectorXd weights = solver.solve(matrix.transpose() * logs);
  // A row's residual without itself is its residual / (1 - leverage).
  const Eigen::MatrixXd solved = solver.solve(matrix.transpose());
  double squares = kExpected * before * before;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double leverage = std::min(kMostLeverage, matrix.row(i).dot(solved.col(i)));
    squares += std::pow((logs[i] - matrix.row(i).dot(weights)) / (1 - leverage), 2);
  }
  correction.spread = std::sqrt(squares / (static_cast<double>(rows) + kExpected));
  for (size_t i = 0; i < candidates.size(); ++i) correction.factors[i] = std::exp(row_of(candidates[i]).dot(weights));
  return correction;
}

void search_front(std::vector<Candidate>& candidates, const std::vector<size_t>& first, double deviations,
                  double before, const MeasureCycles& measure) {
  std::vector<size_t> open = first;
  for (;;) {
    const std::vector<double> cycles = measure(open);
    for (size_t i = 0; i < open.size(); ++i) candidates[open[i]].cycles = cycles[i];
    const Correction correction = correction_of(candidates, before);
    const double hope = std::exp(-deviations * correction.spread);
    std::vector<double> hoped;
    for (size_t i = 0; i < candidates.size(); ++i)
      hoped.push_back(candidates[i].cycles.value_or(candidates[i].guess * correction.factors[i] * hope));
    open.clear();
    for (const size_t number : front_of(candidates, hoped))
      if (!candidates[number].cycles) open.push_back(number);
    if (open.empty()) return;
  }
}

}  // namespace raypool::explore
