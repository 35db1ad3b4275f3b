// Runs trials side by side, a process each: what a fault does to the simulator itself stays there. Outcomes are written
// as they come, so that an interrupted run can be continued.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "faulty/trial.hpp"

namespace raypool::faulty {

/// Reports, before a program begins, how many there will have been and on what it runs; known also when the process
/// then dies.
using Note = std::function<void(uint64_t programs, std::string_view by)>;

struct Trial {
  std::string id;                                ///< the same in every run
  nlohmann::ordered_json facts;                  ///< for the JSON file
  std::function<Outcome(const Note& note)> run;  ///< in a process of its own
};

struct TrialOptions {
  std::string what = "trials";    ///< in messages
  std::string json;               ///< file that gets an object a line as trials end; empty: none
  bool resume = false;            ///< take over what `json` has of an interrupted run
  unsigned jobs = 1;              ///< processes at a time
  unsigned seconds_limit = 1800;  ///< of one trial
};

/// The outcomes, in the order of the trials. Progress, and an estimate of the time that is left, go to stderr.
std::vector<Outcome> run_trials(const std::vector<Trial>& trials, const TrialOptions& options);

/// One trial alone, of which nothing is written.
Outcome run_trial(const Trial& trial);

}  // namespace raypool::faulty
