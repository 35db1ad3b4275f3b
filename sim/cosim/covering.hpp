// Sets of configurations that cover the parameters of docs/machine/parameters.md: every value that matters, and pairs
// of values.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "config/configuration.hpp"

namespace raypool {

/// A configuration, and how many units of it.
struct Machine {
  Configuration configuration;
  int units = 1;
};

/// A parameter and the values of it that are tried: its ends and what lies between.
struct Factor {
  std::string name;
  std::vector<int> values;
  std::function<void(Machine& machine, int value)> set;
  std::function<int(const Machine& machine)> get;
  bool multiplies = false;  ///< the number of threads
  bool of_alu = false;
};
/// Of a unit, and how many.
const std::vector<Factor>& covering_factors();
/// Of the chip around small units (rtl/chip/rp_chip.v), and those of the units that it depends on.
const std::vector<Factor>& chip_factors();
/// Of one with the traverser inside (rtl/traverser/rp_traverser.v).
const std::vector<Factor>& inside_factors();

/// Threads, over all units, up to which a machine compiles in seconds.
inline constexpr int kSmallThreads = 8;
/// Threads of the largest unit.
inline constexpr int kMostThreads = 1024;

struct Covered {
  size_t values = 0, all_values = 0;
  size_t pairs = 0, all_pairs = 0;  ///< pairs of values of two parameters that machines of so many threads can have
};
Covered count_covered(const std::vector<Factor>& factors, const std::vector<Machine>& machines, int most_threads);

/// Every pair of values of any two parameters that a machine of at most `most_threads` threads can have is in one of
/// them. Greedy: each next one is the best of some that are put together value by value, so that each value brings most
/// pairs that were not there. Then, for each value that takes more threads alone, the default ALUs with it. The same
/// set every time. `most_pairings`: only so many of the first kind, which have fewer pairs.
std::vector<Machine> covering_machines(int most_threads, size_t most_pairings = ~size_t{0});
/// Every pair of values of two chip_factors() that a machine of kSmallThreads can have is in one of them.
std::vector<Machine> covering_chips();
/// The same of inside_factors(); of those without culling every other one has miss_records.
std::vector<Machine> covering_inside();

}  // namespace raypool
