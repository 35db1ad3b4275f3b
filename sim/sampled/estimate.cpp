#include "sampled/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raypool::sampled {

double student_t(double n) {
  constexpr double x = 1.959963984540054;  // of the normal distribution
  const double x3 = x * x * x, x5 = x3 * x * x, x7 = x5 * x * x, x9 = x7 * x * x;
  if (n < 2) return 12.7062;  // 1 degree; the series is of no use there
  return x + (x3 + x) / (4 * n) + (5 * x5 + 16 * x3 + 3 * x) / (96 * n * n) +
         (3 * x7 + 19 * x5 + 17 * x3 - 15 * x) / (384 * n * n * n) +
         (79 * x9 + 776 * x7 + 1482 * x5 - 1920 * x3 - 945 * x) / (92160 * n * n * n * n);
}

Estimate::Estimate(const Counts& always, std::vector<Drawn> strata) : always_(always), strata_(std::move(strata)) {}

double Estimate::sum(const Linear& figure) const {
  double result = figure(always_);
  for (const Drawn& stratum : strata_) {
    double drawn = 0;
    for (const Counts& costs : stratum.costs) drawn += figure(costs);
    result += drawn * static_cast<double>(stratum.blocks) / static_cast<double>(stratum.costs.size());
  }
  return result;
}

// Degrees of freedom as Satterthwaite has them, but that the squares of the strata's variances, which are estimates
// themselves, are counted without bias: of a stratum with n degrees of freedom n / (n + 2) of the square.
double Estimate::half_width(const Linear& figure, double times) const {
  double variance = 0, squares = 0;
  for (const Drawn& stratum : strata_) {
    const auto all = static_cast<double>(stratum.blocks), here = static_cast<double>(stratum.costs.size());
    const double drawn = std::min(all, times * here);
    if (here < 2 || drawn >= all) continue;
    double mean = 0, deviations = 0;
    for (const Counts& costs : stratum.costs) mean += figure(costs) / here;
    for (const Counts& costs : stratum.costs) deviations += std::pow(figure(costs) - mean, 2);
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
