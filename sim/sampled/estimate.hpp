// What a sample says of the whole: estimates with 95% confidence intervals, as for a stratified random sample without
// replacement (Cochran, Sampling Techniques, 3rd edition, chapters 5 and 6).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "chip/tile_costs.hpp"

namespace raypool::sampled {

using chip::Counts;

/// 95% of such intervals contain the true value.
struct Interval {
  double value = 0;
  double low = 0, high = 0;

  bool contains(double x) const { return low <= x && x <= high; }
};

/// Those drawn of a stratum of so many blocks.
struct Drawn {
  size_t blocks = 0;
  std::vector<Counts> costs;  ///< at least two, or all
};

/// The value that Student's t with so many degrees of freedom, 1 or more, exceeds in absolute value in 5% of cases.
/// Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.5; from 3 on within 1%.
double student_t(double degrees_of_freedom);

class Estimate {
 public:
  /// `always`: the costs of the blocks that are simulated in every sample.
  Estimate(const Counts& always, std::vector<Drawn> strata);

  /// Of the sum over all blocks.
  Interval total(size_t count) const;
  /// Of the quotient of two such sums, linearised; the divisor's must not be 0.
  Interval ratio(size_t count, size_t by) const;

  /// Half of total's interval with so many times as many blocks of each stratum drawn, as far as there are as many.
  double half_width(size_t count, double times) const;

 private:
  using Linear = std::function<double(const Counts&)>;
  double sum(const Linear& figure) const;
  double half_width(const Linear& figure, double times = 1) const;

  Counts always_;
  std::vector<Drawn> strata_;
};

}  // namespace raypool::sampled
