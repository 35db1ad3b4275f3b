// Sets of configurations that cover the parameters of docs/architecture.md, section 2: every value that matters, and pairs of
// values.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool {

/// A parameter and the values of it that are tried: its ends and what lies between.
struct Factor {
  std::string name;
  std::vector<int> values;
  std::function<void(Configuration& configuration, int value)> set;
  std::function<int(const Configuration& configuration)> get;
};
const std::vector<Factor>& covering_factors();

struct Covered {
  size_t values = 0, all_values = 0;
  size_t pairs = 0, all_pairs = 0;  ///< pairs of values of two parameters
};
Covered count_covered(const std::vector<Configuration>& configurations);

/// Every pair of values of any two parameters is in one of them. Greedy: each next one is the best of some that are put together
/// value by value, so that each value brings most pairs that were not there. The same set every time.
std::vector<Configuration> all_pairs_configurations();

/// Six configurations of 32 threads each, which compile quickly, with every value of every parameter and as many pairs as fit.
std::vector<Configuration> small_configurations();

}  // namespace raypool
