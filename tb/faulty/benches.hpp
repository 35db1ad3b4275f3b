// Benches of single blocks, built from Verilog with faults, of which an environment variable selects one.
#pragma once

#include <string>
#include <vector>

#include "faulty/guilty.hpp"
#include "faulty/trial.hpp"

namespace raypool::faulty {

struct Bench {
  std::string name;
  std::string command;
  std::vector<std::string> tops;  ///< modules that it instantiates
};

/// `path`: a JSON list of {"bench", "tops", "filter"}, the last of tests, or {"bench", "tops", "arguments"}. They are
/// programs in `folder`. Throws InputError when one is not there: what cannot be started would seem to notice every
/// fault.
std::vector<Bench> read_benches(const std::string& path, const std::string& folder);

/// Those that have the module, in their order.
std::vector<Bench> benches_of(const std::vector<Bench>& benches, const Hierarchy& hierarchy, const std::string& module);

/// Runs them in turn until one fails: then the outcome is by this bench, and its text the first line that says so.
void run_benches(const std::vector<Bench>& benches, Outcome& outcome);

/// A module's file is of its name.
std::string module_of(const std::string& file);

}  // namespace raypool::faulty
