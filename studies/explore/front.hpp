// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The Pareto front of area and cycles where measuring cycles is expensive, and something cheaper is off by what a few
// measurements show: only what may be on the front is measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace raypool::explore {

/// What of all features a candidate has, by their numbers: the value of each of its fields.
using Features = std::vector<uint32_t>;

struct Candidate {
  double area = 0;
  double guess = 0;  ///< of its cycles; infinite: it is none
  Features features;
  std::optional<double> cycles;  ///< measured; infinite: it cannot be
};

/// Numbers of those that no other one is as small and as fast as, by area and these cycles, the smallest first. Of
/// equal ones the first counts; those with infinite cycles do not.
std::vector<size_t> front_of(const std::vector<Candidate>& candidates, const std::vector<double>& cycles);
/// Of what has been measured.
std::vector<size_t> measured_front(const std::vector<Candidate>& candidates);

/// What guesses are off by, from those candidates that have been measured.
struct Correction {
  std::vector<double> factors;  ///< of each candidate: cycles are about guess x factor
  double spread = 0;  ///< standard deviation of the logarithm of what is left, each without its own measurement
};
/// Ridge regression of the logarithms on the features. Without measurements factors are 1, and the spread is
/// `before`.
Correction correction_of(const std::vector<Candidate>& candidates, double before);

/// The cycles of so many candidates; infinite for one that cannot be measured.
using MeasureCycles = std::function<std::vector<double>(const std::vector<size_t>&)>;

/// Measures `first` of the candidates, and then those that would be on the front if corrected guesses were too high by
/// so many standard deviations, until all of these have been measured. `before` as in correction_of().
void search_front(std::vector<Candidate>& candidates, const std::vector<size_t>& first, double deviations,
                  double before, const MeasureCycles& measure);

}  // namespace raypool::explore
