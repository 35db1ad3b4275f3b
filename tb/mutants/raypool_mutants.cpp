// Runs every mutant of a unit (scripts/mutants.sh makes them) on random programs in lockstep until it differs from the
// model, and says which were noticed. A process a mutant: what a fault does to the simulator itself stays there.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>
#include <vector>

#include "cosim/program_profile.hpp"
#include "faulty/judgements.hpp"
#include "faulty/trials.hpp"
#include "isa/input_error.hpp"
#include "lockstep/rtl_loader.hpp"

namespace raypool {
namespace {

using namespace faulty;
using Json = nlohmann::ordered_json;

struct Options {
  std::string unit, list, config, survivors, json;
  uint64_t programs = 120, long_programs = 10, operand_programs = 12;
  uint64_t seed = 1;
  int length = 80, long_length = 800, operand_length = 1000;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  std::vector<int> only;
  bool resume = false;
  bool verbose = false;
};

/// One fault, as Yosys' mutate describes it.
struct Mutant {
  int number = 0;
  std::string id;      ///< what it is: mode, port, bit, cell, without the numbers that Yosys makes up
  std::string module;  ///< of rtl/
  std::string source;  ///< file and line
};

std::string option_of(const std::string& line, const std::string& name) {
  std::smatch match;
  return std::regex_search(line, match, std::regex(" -" + name + " ([^ ]+)")) ? match[1].str() : "";
}

std::vector<Mutant> read_list(const std::string& path) {
  std::ifstream file(path);
  if (!file)
    throw InputError(fmt::format("{}: the list of mutants cannot be read; make it with scripts/mutants.sh", path));
  std::vector<Mutant> mutants;
  for (std::string line; std::getline(file, line);) {
    Mutant mutant;
    mutant.number = static_cast<int>(mutants.size()) + 1;
    // Lines of rtl/*.v, the first one with a number (line 0 is a whole loop); a
    // header's place says little of the module.
    static const std::regex kSource(R"(-src rtl/([a-z_0-9]+)\.v:([0-9]+)\.)");
    for (auto i = std::sregex_iterator(line.begin(), line.end(), kSource); i != std::sregex_iterator(); ++i) {
      if (!mutant.module.empty() && (*i)[2] == "0") continue;
      const bool numbered = mutant.source.size() > 2 && mutant.source.substr(mutant.source.size() - 2) != ":0";
      if (numbered) break;
      mutant.module = (*i)[1];
      mutant.source = mutant.module + ".v:" + (*i)[2].str();
    }
    if (mutant.module.empty()) mutant.module = "(made by Yosys)";
    // A cell's name: where it is in the hierarchy, what it is, its place, and a running number, which says nothing.
    std::string cell = option_of(line, "cell");
    static const std::regex kPlaced(R"(\$([a-z_]+)\$[^ $]*?([a-z_0-9]+\.vh?:[0-9]+)\$[0-9]+)");
    static const std::regex kMade(R"(\$[^ $]*\.cc:[0-9]+:)"), kNoise(R"(^\$(flatten|auto|techmap)+|\\|\$[0-9]+|\$)");
    cell = std::regex_replace(std::regex_replace(cell, kPlaced, "$1 at $2"), kMade, "");
    cell = std::regex_replace(cell, kNoise, "");
    if (cell.find(" at ") == std::string::npos && !mutant.source.empty()) cell += " at " + mutant.source;
    mutant.id = fmt::format("{}, {}[{}] of {}", option_of(line, "mode"), option_of(line, "port"),
                            option_of(line, "portbit"), cell);
    const std::string control = option_of(line, "ctrlbit");
    if (!control.empty()) mutant.id += ", by bit " + control;
    const std::string wire = option_of(line, "wire");
    if (!wire.empty()) mutant.id += fmt::format(", wire {}[{}]", wire, option_of(line, "wirebit"));
    mutants.push_back(mutant);
  }
  return mutants;
}

/// Short programs of all mixes, which notice most; then long ones, one of each mix; then long
/// ones that meet thousands of operands.
Outcome run_mutant(const Options& options, const Machine& machine, int number, const Note& note) {
  setenv("RAYPOOL_MUTANT", std::to_string(number).c_str(), 1);
  const auto kept = load_rtl_unit(machine.library, machine.configuration);  // keeps the library loaded
  struct Phase {
    uint64_t programs;
    int length;
    std::string_view mix;
  };
  const Phase phases[] = {{options.programs, options.length, ""},
                          {options.long_programs, options.long_length, ""},
                          {options.operand_programs, options.operand_length, kOperandMix}};
  Outcome outcome;
  outcome.by = machine.configuration.name;
  for (const Phase& phase : phases) {
    for (uint64_t n = 0; n < phase.programs; ++n) {
      note(++outcome.programs, outcome.by);
      run_program(machine,
                  make_random_program(machine.configuration, options.seed + n, phase.length, machine.units,
                                      std::string(phase.mix)),
                  outcome);
      if (outcome.kind != Outcome::Kind::Survived) return outcome;
    }
  }
  return outcome;
}

Trial trial_of(const Options& options, const Machine& machine, const Mutant& mutant) {
  return {mutant.id,
          {{"number", mutant.number}, {"source", mutant.source}},
          [&options, &machine, number = mutant.number](const Note& note) {
            return run_mutant(options, machine, number, note);
          }};
}

int report(const Options& options, const std::vector<Mutant>& mutants, const std::vector<Outcome>& outcomes) {
  Judgements judgements(options.survivors);
  struct Count {
    int all = 0, killed = 0;
  };
  std::map<std::string, Count> modules;
  std::map<Outcome::Kind, int> kinds;
  std::map<uint64_t, int> by_program;
  for (size_t i = 0; i < mutants.size(); ++i) {
    const Mutant& mutant = mutants[i];
    const Outcome& outcome = outcomes[i];
    const bool survived = outcome.kind == Outcome::Kind::Survived;
    ++kinds[outcome.kind];
    Count& count = modules[mutant.module];
    ++count.all;
    count.killed += survived ? 0 : 1;
    if (!survived) {
      ++by_program[outcome.programs <= 1 ? 1 : outcome.programs <= 10 ? 10 : outcome.programs <= 100 ? 100 : ~0u];
      continue;
    }
    fmt::print("survived: {:>4} {} ({})\n          {}\n", mutant.number, mutant.id, mutant.source,
               judgements.survived(mutant.id));
  }
  const int all = mutants.size();
  const int survived = kinds[Outcome::Kind::Survived], killed = all - survived;
  fmt::print("{:<24} mutants  killed\n", "module");
  for (const auto& [name, count] : modules) fmt::print("{:<24} {:>7} {:>7}\n", name, count.all, count.killed);
  for (const Outcome::Kind kind :
       {Outcome::Kind::Difference, Outcome::Kind::Hang, Outcome::Kind::Stopped, Outcome::Kind::Crashed})
    fmt::print("killed by {:<22} {:>5}\n", name_of(kind), kinds[kind]);
  for (const auto& [programs, count] : by_program)
    fmt::print("killed {:<25} {:>5}\n",
               programs == ~0u ? std::string("by a later one") : fmt::format("within {} programs", programs), count);
  fmt::print(
      "mutants: {} of {} killed ({:.1f}%); {} survived, of which {} are judged equivalent: {:.1f}% of the others "
      "killed\n",
      killed, all, 100.0 * killed / all, survived, judgements.equivalent(),
      100.0 * killed / (all - judgements.equivalent()));
  return !options.only.empty() || judgements.up_to_date() ? 0 : 1;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Runs mutants of the compute unit on random programs in lockstep; scripts/mutants.sh makes them.");
  app.add_option("--unit", options.unit, "library with the mutants")->required();
  app.add_option("--list", options.list, "list of the mutants")->required();
  app.add_option("--config", options.config, "their configuration")->required();
  app.add_option("--survivors", options.survivors, "JSON file with the judged survivors, to be compared");
  app.add_option("--json", options.json, "file that gets a JSON object a line for each mutant as it ends");
  app.add_option("--programs", options.programs, "random programs of all mixes that come first")->capture_default_str();
  app.add_option("--long-programs", options.long_programs, "then, long ones")->capture_default_str();
  app.add_option("--operand-programs", options.operand_programs,
                 "then, long ones of mix operands; a mutant that survives them survives")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first program")->capture_default_str();
  app.add_option("--length", options.length, "about how many instructions a program of all mixes has")
      ->capture_default_str();
  app.add_option("--long-length", options.long_length, "of a long one")->capture_default_str();
  app.add_option("--operand-length", options.operand_length, "of a long one of mix operands")->capture_default_str();
  app.add_option("--jobs", options.jobs, "processes")->capture_default_str();
  app.add_option("--only", options.only, "run these mutants only (numbers)");
  app.add_flag("--resume", options.resume,
               "take over what --json has of an interrupted run of the same unit, and run the others");
  app.add_flag("--verbose", options.verbose, "print the whole report of each difference");
  CLI11_PARSE(app, argc, argv);

  const Configuration configuration = load_configuration(options.config);
  std::vector<Mutant> mutants = read_list(options.list);
  if (!options.only.empty()) {
    std::vector<Mutant> chosen;
    for (const int number : options.only)
      if (number >= 1 && number <= static_cast<int>(mutants.size())) chosen.push_back(mutants[number - 1]);
    mutants = chosen;
  }
  // Without a fault there must be no difference, or every kill would be worth nothing.
  const Machine machine{configuration, 1, options.unit};
  const Outcome none = run_trial(trial_of(options, machine, Mutant()));
  if (none.kind != Outcome::Kind::Survived)
    throw InputError("without any fault the unit differs from the model: " + none.text);
  fmt::print("no fault: {} programs agree\n", none.programs);
  std::vector<Trial> trials;
  trials.reserve(mutants.size());
  for (const Mutant& mutant : mutants) trials.push_back(trial_of(options, machine, mutant));
  const std::vector<Outcome> outcomes = run_trials(trials, {"mutants", options.json, options.resume, options.jobs});
  if (options.verbose)
    for (size_t i = 0; i < mutants.size(); ++i)
      fmt::print("{} {}\n{}\n", mutants[i].number, mutants[i].id, outcomes[i].text);
  return report(options, mutants, outcomes);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  try {
    return raypool::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_mutants: {}\n", error.what());
    return 1;
  }
}
