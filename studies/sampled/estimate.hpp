// Estimates of the whole from a sample, with 95% confidence intervals.
//
// The sample is a stratified random one without replacement (Cochran, Sampling Techniques, 3rd edition, chapters 5 and
// 6). Where something is known of every block, drawn or not, that predicts what it costs, the estimate is the
// generalised regression estimator (Cochran, chapter 7; Saerndal, Swensson, Wretman, Model Assisted Survey Sampling,
// chapter 6): costs are fitted linearly to what is known, and the estimate is the sum of all predictions, and of the
// residuals of those drawn as a stratified sample estimates it. So a bad prediction makes it no worse than without.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "chip/sampling.hpp"
#include "chip/tile_costs.hpp"

namespace raypool::sampled {

using chip::Counts;
using Known = std::vector<double>;  ///< of a block; as many numbers of each, or none

/// Those drawn of a stratum.
struct Drawn {
  std::vector<Known> known;   ///< of all blocks of the stratum, first those drawn
  std::vector<Counts> costs;  ///< of those drawn, in the same order; at least two, or all
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
  /// A block that is drawn.
  struct Block {
    std::vector<double> known;   // 1, and what is known of it: mean 0 and variance 1 over all blocks
    std::vector<double> fitted;  // what a unit of its cost adds to each coefficient
    double leverage = 0;         // what a unit of its cost adds to its own prediction, 0 .. 1
    double weight = 0;           // what a unit of its cost adds to the estimate
  };

  void standardise();
  void fit();
  double sum(const Linear& figure) const;
  double half_width(const Linear& figure, double times = 1) const;
  /// Of the fit of this figure.
  std::vector<double> coefficients(const Linear& figure) const;

  Counts always_;
  std::vector<Drawn> strata_;
  std::vector<std::vector<Block>> blocks_;  // [stratum]
};

}  // namespace raypool::sampled
