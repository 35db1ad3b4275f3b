#include "sampled/estimate.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace raypool::sampled {
namespace {

// Of each coefficient but the constant: as if there were one more block, of variance 1, in which it is 0. So a fit
// exists whatever is known, of more things than blocks too.
constexpr double kRidge = 1;
// What is known first is used, as far as there are enough blocks: a fit of fewer depends more on them than on others.
constexpr size_t kBlocksACoefficient = 4;

using Vector = std::vector<double>;

Eigen::Map<const Eigen::VectorXd> vector(const Vector& x) { return {x.data(), static_cast<Eigen::Index>(x.size())}; }
double dot(const Vector& a, const Vector& b) { return vector(a).dot(vector(b)); }

}  // namespace

double student_t(double n) {
  constexpr double x = 1.959963984540054;  // of the normal distribution
  const double x3 = x * x * x, x5 = x3 * x * x, x7 = x5 * x * x, x9 = x7 * x * x;
  if (n < 2) return 12.7062;  // 1 degree; the series is of no use there
  return x + (x3 + x) / (4 * n) + (5 * x5 + 16 * x3 + 3 * x) / (96 * n * n) +
         (3 * x7 + 19 * x5 + 17 * x3 - 15 * x) / (384 * n * n * n) +
         (79 * x9 + 776 * x7 + 1482 * x5 - 1920 * x3 - 945 * x) / (92160 * n * n * n * n);
}

Estimate::Estimate(const Counts& always, std::vector<Drawn> strata) : always_(always), strata_(std::move(strata)) {
  standardise();
  fit();
}

void Estimate::standardise() {
  double all = 0;
  size_t drawn = 0;
  for (const Drawn& stratum : strata_) drawn += stratum.costs.size();
  Vector mean, deviation;
  for (const Drawn& stratum : strata_) {
    all += static_cast<double>(stratum.known.size());
    mean.resize(std::min(stratum.known.front().size(), drawn / kBlocksACoefficient));
    for (const Known& known : stratum.known)
      for (size_t i = 0; i < mean.size(); ++i) mean[i] += known[i];
  }
  for (double& x : mean) x /= all;
  deviation.resize(mean.size());
  for (const Drawn& stratum : strata_)
    for (const Known& known : stratum.known)
      for (size_t i = 0; i < mean.size(); ++i) deviation[i] += std::pow(known[i] - mean[i], 2) / all;
  for (Drawn& stratum : strata_) {
    for (Known& known : stratum.known) {
      // What is equal in all blocks predicts nothing.
      known.resize(mean.size());
      for (size_t i = 0; i < mean.size(); ++i)
        known[i] = deviation[i] == 0 ? 0 : (known[i] - mean[i]) / std::sqrt(deviation[i]);
      known.insert(known.begin(), 1);
    }
  }
}

// Each block drawn stands for as many as its stratum has to one drawn, in the fit too. The estimate is linear in the
// costs: weights determine it.
void Estimate::fit() {
  double all = 0, drawn = 0;
  for (const Drawn& stratum : strata_) {
    all += static_cast<double>(stratum.known.size());
    drawn += static_cast<double>(stratum.costs.size());
  }
  if (strata_.empty()) return;
  const auto size = vector(strata_.front().known.front()).size();
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd missing =
      Eigen::VectorXd::Zero(size);  // in the sum over all blocks, from the sample's estimate of it
  const auto stands_for = [](const Drawn& stratum) {
    return static_cast<double>(stratum.known.size()) / static_cast<double>(stratum.costs.size());
  };
  for (const Drawn& stratum : strata_) {
    const double weight = stands_for(stratum) * drawn / all;
    for (size_t block = 0; block < stratum.known.size(); ++block) {
      const auto known = vector(stratum.known[block]);
      missing += known;
      if (block >= stratum.costs.size()) continue;
      missing -= stands_for(stratum) * known;
      squares += weight * known * known.transpose();
    }
  }
  squares.diagonal().tail(size - 1).array() += kRidge;
  const Eigen::LLT<Eigen::MatrixXd> factored(squares);
  for (const Drawn& stratum : strata_) {
    std::vector<Block>& blocks = blocks_.emplace_back();
    const double weight = stands_for(stratum) * drawn / all;
    for (size_t i = 0; i < stratum.costs.size(); ++i) {
      Block& block = blocks.emplace_back();
      block.known = stratum.known[i];
      const Eigen::VectorXd fitted = weight * factored.solve(vector(block.known));
      block.fitted.assign(fitted.begin(), fitted.end());
      // Without the constant's, which the strata's own means take the place of.
      block.leverage = dot(block.fitted, block.known) - weight / drawn;
      block.weight = stands_for(stratum) + fitted.dot(missing);
    }
  }
}

double Estimate::sum(const Linear& figure) const {
  double result = figure(always_);
  for (size_t stratum = 0; stratum < strata_.size(); ++stratum)
    for (size_t i = 0; i < blocks_[stratum].size(); ++i)
      result += blocks_[stratum][i].weight * figure(strata_[stratum].costs[i]);
  return result;
}

std::vector<double> Estimate::coefficients(const Linear& figure) const {
  Vector coefficients;
  for (size_t stratum = 0; stratum < strata_.size(); ++stratum) {
    for (size_t i = 0; i < blocks_[stratum].size(); ++i) {
      const Vector& fitted = blocks_[stratum][i].fitted;
      const double cost = figure(strata_[stratum].costs[i]);
      coefficients.resize(fitted.size());
      for (size_t k = 0; k < fitted.size(); ++k) coefficients[k] += cost * fitted[k];
    }
  }
  return coefficients;
}

// The variance is that of a stratified sample of residuals. What is left of a block that took part in the fit is too
// little: its residual in a fit without it is residual / (1 - leverage), which has the variance of the fit itself too.
// With n times the sample leverages are an n-th. Degrees of freedom as Satterthwaite has them, but that the squares of
// the strata's variances, which are estimates themselves, are counted without bias: of a stratum with n degrees of
// freedom n / (n + 2) of the square.
double Estimate::half_width(const Linear& figure, double times) const {
  const Vector fit = coefficients(figure);
  double variance = 0, squares = 0;
  for (size_t stratum = 0; stratum < strata_.size(); ++stratum) {
    const std::vector<Block>& blocks = blocks_[stratum];
    const auto all = static_cast<double>(strata_[stratum].known.size()), here = static_cast<double>(blocks.size());
    const double drawn = std::min(all, times * here);
    if (here < 2 || drawn >= all) continue;
    Vector residuals;
    double mean = 0, deviations = 0;
    for (size_t i = 0; i < blocks.size(); ++i) {
      const double residual = figure(strata_[stratum].costs[i]) - dot(fit, blocks[i].known);
      const double without = std::sqrt((1 - blocks[i].leverage) * (1 - blocks[i].leverage / times));
      residuals.push_back(residual / without);
      mean += residuals.back() / here;
    }
    for (const double residual : residuals) deviations += std::pow(residual - mean, 2);
    const double part = all * all * (1 - drawn / all) / drawn * deviations / (here - 1);
    variance += part;
    squares += part * part / (drawn + 1);
  }
  return variance == 0 ? 0 : student_t(variance * variance / squares - 2) * std::sqrt(variance);
}

double Estimate::half_width(size_t count, double times) const {
  return half_width([&](const Counts& costs) { return costs[count]; }, times);
}

Interval Estimate::total(size_t count) const {
  const Linear figure = [&](const Counts& costs) { return costs[count]; };
  const double value = sum(figure), half = half_width(figure);
  return {value, value - half, value + half};
}

Interval Estimate::ratio(size_t count, size_t by) const {
  const double divisor = total(by).value, value = total(count).value / divisor;
  const double half = half_width([&](const Counts& costs) { return (costs[count] - value * costs[by]) / divisor; });
  return {value, value - half, value + half};
}

}  // namespace raypool::sampled
