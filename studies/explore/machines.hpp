// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Machines around one: combinations of some fields' values.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "explore/front.hpp"

namespace raypool::explore {

/// A field of configurations, or "units", and the values that it may have.
struct Axis {
  std::string field;
  std::vector<std::string> values;
};

/// What an architect chooses first: instructions, ALUs, warps, lanes, caches, pools, traverser, policy and units.
const std::vector<Axis>& usual_axes();
/// "FIELD=VALUE,VALUE,..." in place of the axis of that field, or as one more. Throws InputError for another text.
void set_axis(std::vector<Axis>& axes, const std::string& text);

struct Machine {
  Configuration configuration;
  uint32_t units = 1;
  std::string changes;  ///< "lanes=4 triples=false": what the base has otherwise
  Features features;    ///< a number for each value of each axis
};

/// Grows; what is of no machine is left out, and none comes twice.
class MachineSpace {
 public:
  /// `base`, `set`: as load_configuration() takes them, and throws. Axes must have values.
  MachineSpace(std::string base, std::vector<std::string> set, std::vector<Axis> axes);

  const std::vector<Machine>& machines() const { return machines_; }
  /// Combinations that are of no machine, and what is wrong with the first.
  size_t left_out() const { return left_out_; }
  const std::string& wrong() const { return wrong_; }
  /// Of all combinations of values; the most that fits where there are more.
  uint64_t combinations() const;
  /// All of them. This and add_random() throw InputError, with what is wrong, when there is no machine.
  void add_all();
  /// So many at random, the same for the same seed; fewer where most are of no machine.
  void add_random(size_t count, uint64_t seed);
  /// Those that differ from these in one axis, until there are `most` machines. Returns how many are new.
  size_t add_neighbours(const std::vector<size_t>& numbers, size_t most);

 private:
  using Choice = std::vector<uint32_t>;  // a value of each axis
  void add(const Choice& choice);
  void refuse_none() const;
  Machine machine_of(const Choice& choice) const;

  std::string base_;
  std::vector<std::string> set_;
  std::vector<Axis> axes_;
  nlohmann::ordered_json usual_;
  std::set<Choice> known_;
  std::vector<Choice> choices_;  // of the machines
  std::vector<Machine> machines_;
  size_t left_out_ = 0;
  std::string wrong_;
};

}  // namespace raypool::explore
