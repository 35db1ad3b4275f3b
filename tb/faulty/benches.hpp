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

/// `path`: a JSON object with a list of {"bench", "tops", "filter"} for each source, the last of tests, or of {"bench",
/// "tops", "arguments"}, to which `arguments` are added. They are programs in `folder`. Throws InputError when one is
/// not there: what cannot be started would seem to detect every fault.
std::vector<Bench> read_benches(const std::string& path, const std::string& source, const std::string& folder,
                                const std::string& arguments);

/// Those that have the module, in their order.
std::vector<Bench> benches_of(const std::vector<Bench>& benches, const Hierarchy& hierarchy, const std::string& module);

/// Runs them in turn until one fails: then the outcome is by this bench, and its text what it prints from the first
/// line on that reports it.
void run_benches(const std::vector<Bench>& benches, Outcome& outcome);

}  // namespace raypool::faulty
