// Runs every mistake of tb/faults/catalogue.json (scripts/faults.sh builds the machines that make them) on
// random programs in lockstep, then, if none notices, on the benches of single blocks; says what noticed each,
// and where the report sends its reader.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "enum_array.hpp"
#include "faulty/benches.hpp"
#include "faulty/guilty.hpp"
#include "faulty/judgements.hpp"
#include "faulty/trials.hpp"
#include "isa/input_error.hpp"
#include "lockstep/rtl_loader.hpp"

namespace raypool {
namespace {

using namespace faulty;
using Json = nlohmann::ordered_json;

struct Options {
  std::string folder, catalogue = "tb/faults/catalogue.json", survivors = "tb/faults/survivors.json", rtl = "rtl", json;
  std::string benches, bench_list = "tb/faults/benches.json";
  uint64_t programs = 2000, first = 100, turn = 20;
  uint64_t seed = 1;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  std::vector<int> only;
  size_t every = 0;  ///< 0: all, those too that are in no machine
  bool beside_units = false;
  double least = 0;  ///< percent
  bool resume = false;
  bool verbose = false;
};

/// A mistake of the catalogue.
struct Fault {
  int number = 0;
  std::string file;  ///< of rtl/
  std::string mistake;
};

Json read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: the file cannot be read", path));
  try {
    return Json::parse(file);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: not JSON: {}", path, error.what()));
  }
}

std::vector<Fault> read_catalogue(const std::string& path) {
  std::vector<Fault> faults;
  for (const Json& entry : read_json(path))
    faults.push_back(
        {entry.at("number").get<int>(), entry.at("file").get<std::string>(), entry.at("mistake").get<std::string>()});
  return faults;
}

/// The folder that scripts/faults.sh has filled: `list` has a line for each machine, its
/// configuration's file and its units.
std::vector<Machine> read_machines(const std::string& folder) {
  std::ifstream list(folder + "/list");
  if (!list)
    throw InputError(
        fmt::format("{}/list cannot be read: build the machines with scripts/faults.sh {}", folder, folder));
  std::vector<Machine> machines;
  std::string name, file;
  int units = 1;
  while (list >> name >> file >> units)
    machines.push_back({load_configuration(file), units, fmt::format("{}/{}/libraypool_unit.so", folder, name)});
  if (machines.empty()) throw InputError(fmt::format("{}/list names no machine", folder));
  return machines;
}

std::string name_of_machine(const Machine& machine) {
  return machine.configuration.name + (machine.units > 1 ? fmt::format(", {} units", machine.units) : "");
}

// About how many instructions a program has: as many as in `raypool cosim`.
constexpr int kLength = 120;

/// The first machine, which is quick, runs some programs; then all take turns. Each
/// goes on with the seeds where it was.
Outcome run_fault(const Options& options, const std::vector<Machine>& machines, int number, const Note& note) {
  setenv("RAYPOOL_FAULT", std::to_string(number).c_str(), 1);
  std::vector<std::unique_ptr<ComputeUnit>> kept;  // keeps the libraries loaded
  std::vector<uint64_t> seeds(machines.size(), options.seed);
  Outcome outcome;
  for (uint64_t turn = 0; outcome.programs < options.programs; ++turn) {
    const size_t m = turn % machines.size();
    const Machine& machine = machines[m];
    outcome.by = name_of_machine(machine);
    if (turn < machines.size()) kept.push_back(load_rtl_unit(machine.library, machine.configuration, machine.units));
    for (uint64_t n = turn == 0 ? options.first : options.turn; n > 0 && outcome.programs < options.programs; --n) {
      note(++outcome.programs, outcome.by);
      run_program(machine, make_random_program(machine.configuration, seeds[m]++, kLength, machine.units), outcome);
      if (outcome.kind != Outcome::Kind::Survived) return outcome;
    }
  }
  outcome.by.clear();
  return outcome;
}

/// What noticed the faults of a module, or of all.
struct Count {
  int all = 0, cosim = 0, bench = 0, right = 0, parent = 0;
  int early = 0;  ///< the right file was named first or second
};

std::string percent(int part, int all) {
  return fmt::format("{} of {} ({:.1f}%)", part, all, all == 0 ? 0.0 : 100.0 * part / all);
}

void count_outcome(const Outcome& outcome, Verdict verdict, bool early, Count& count) {
  const bool survived = outcome.kind == Outcome::Kind::Survived, bench = outcome.kind == Outcome::Kind::Bench;
  ++count.all;
  count.bench += bench;
  count.cosim += !survived && !bench;
  count.right += verdict == Verdict::Right;
  count.early += early;
  count.parent += verdict == Verdict::Parent;
}

/// What became of a mistake, in a line.
std::string outcome_text(const Outcome& outcome, const std::vector<std::string>& named, Verdict verdict) {
  if (outcome.kind == Outcome::Kind::Survived) return fmt::format("SURVIVED {} programs", outcome.programs);
  if (outcome.kind == Outcome::Kind::Bench) return fmt::format("killed by {}: {}", outcome.by, outcome.text);
  static const EnumArray<Verdict, const char*, 4> kVerdicts = {"right", "its parent", "WRONG", "NONE"};
  std::string where;
  for (const std::string& name : named) where += (where.empty() ? "" : ", ") + name;
  return fmt::format("killed on {} after {} programs ({}); look at: {} ({})", outcome.by, outcome.programs,
                     name_of(outcome.kind), where.empty() ? "-" : where, kVerdicts[verdict]);
}

int report(const Options& options, const Hierarchy& hierarchy, const std::vector<Fault>& faults,
           const std::vector<Outcome>& outcomes) {
  Judgements judgements(options.survivors);
  std::map<std::string, Count> modules;
  Count total;
  for (size_t i = 0; i < faults.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    const bool by_cosim = outcome.kind != Outcome::Kind::Survived && outcome.kind != Outcome::Kind::Bench;
    const std::vector<std::string> named = by_cosim ? files_named(outcome.text) : std::vector<std::string>();
    const Verdict verdict = judge(hierarchy, named, faults[i].file);
    fmt::print("{:>3} {}: {}\n    {}\n", faults[i].number, faults[i].file, faults[i].mistake,
               outcome_text(outcome, named, verdict));
    if (options.verbose && by_cosim) fmt::print("{}\n", outcome.text);
    const bool early = named_early(named, faults[i].file);
    count_outcome(outcome, verdict, early, modules[faults[i].file]);
    count_outcome(outcome, verdict, early, total);
    if (outcome.kind == Outcome::Kind::Survived) fmt::print("    {}\n", judgements.survived(faults[i].mistake));
  }
  fmt::print("\n{:<24} mistakes  cosim  bench  right  parent\n", "module");
  for (const auto& [name, count] : modules)
    fmt::print("{:<24} {:>8} {:>6} {:>6} {:>6} {:>7}\n", name, count.all, count.cosim, count.bench, count.right,
               count.parent);
  fmt::print("killed by cosim: {}\n", percent(total.cosim, total.all));
  fmt::print("killed by cosim or a bench: {}; {} survived, of which {} are judged equivalent\n",
             percent(total.cosim + total.bench, total.all), total.all - total.cosim - total.bench,
             judgements.equivalent());
  fmt::print("the report names the right file or its parent: {}, the right one {}\n",
             percent(total.right + total.parent, total.cosim), percent(total.right, total.cosim));
  fmt::print("the right file is the first or the second: {}\n", percent(total.early, total.cosim));
  if (options.beside_units) {
    const int killed = total.cosim + total.bench, different = total.all - judgements.equivalent();
    fmt::print("of those that are not equivalent: {}\n", percent(killed, different));
    return killed * 100.0 >= options.least * different ? 0 : 1;
  }
  if (!options.only.empty() || options.every > 0) return judgements.open() == 0 ? 0 : 1;
  return judgements.up_to_date() ? 0 : 1;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("folder", options.folder, "where scripts/faults.sh has built the machines")->required();
  app.add_option("--catalogue", options.catalogue, "the mistakes")->capture_default_str();
  app.add_option("--survivors", options.survivors, "JSON file with the known survivors and why they are")
      ->capture_default_str();
  app.add_option("--rtl", options.rtl, "folder of the Verilog: which module has which")->capture_default_str();
  app.add_option("--benches", options.benches,
                 "folder with benches built from the Verilog with the mistakes; without, none is run");
  app.add_option("--bench-list", options.bench_list, "JSON file with the benches")->capture_default_str();
  app.add_option("--json", options.json, "file that gets a JSON object a line for each mistake as it ends");
  app.add_option("--programs", options.programs, "random programs that a survivor has survived")->capture_default_str();
  app.add_option("--first", options.first, "programs of the first machine, before all take turns")
      ->capture_default_str();
  app.add_option("--turn", options.turn, "programs of a machine's turn")->capture_default_str();
  app.add_option("--seed", options.seed, "of the first program of each machine")->capture_default_str();
  app.add_option("--jobs", options.jobs, "processes")->capture_default_str();
  app.add_option("--only", options.only, "these mistakes only (numbers)");
  app.add_option("--every", options.every,
                 "of these that are in the machines, or stand beside units, only each so many-th: a sample")
      ->check(CLI::PositiveNumber);
  app.add_flag("--beside-units", options.beside_units,
               "only mistakes in what stands beside the units, on benches alone: no machine is needed");
  app.add_option("--least", options.least,
                 "with --beside-units: fail if less percent of the mistakes that are not equivalent are noticed");
  app.add_flag("--resume", options.resume,
               "take over what --json has of an interrupted run of the same units, and run the others");
  app.add_flag("--verbose", options.verbose, "print the whole report of each difference");
}

/// Those of the catalogue that the options leave.
std::vector<Fault> chosen_faults(const Options& options, const Hierarchy& hierarchy) {
  std::vector<Fault> faults = read_catalogue(options.catalogue);
  if (!options.only.empty()) {
    const auto left_out = [&](const Fault& f) {
      return std::count(options.only.begin(), options.only.end(), f.number) == 0;
    };
    faults.erase(std::remove_if(faults.begin(), faults.end(), left_out), faults.end());
  }
  if (options.beside_units || options.every > 0) {
    const auto other_side = [&](const Fault& f) {
      return hierarchy.contains("multiprocessor", module_of(f.file)) == options.beside_units;
    };
    faults.erase(std::remove_if(faults.begin(), faults.end(), other_side), faults.end());
  }
  if (options.every == 0) return faults;
  std::vector<Fault> sampled;
  for (size_t i = 0; i < faults.size(); i += options.every) sampled.push_back(faults[i]);
  return sampled;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Runs designers' mistakes on random programs in lockstep and on the benches of single blocks.");
  add_options(app, options);
  CLI11_PARSE(app, argc, argv);

  const Hierarchy hierarchy(options.rtl);
  const std::vector<Fault> faults = chosen_faults(options, hierarchy);
  const std::vector<Machine> machines = options.beside_units ? std::vector<Machine>() : read_machines(options.folder);
  const std::vector<Bench> benches =
      options.benches.empty() ? std::vector<Bench>() : read_benches(options.bench_list, options.benches);
  const auto trial_of = [&](const Fault& fault, bool sound) {
    const std::string id = fmt::format("{}: {}", fault.file, fault.mistake);
    return Trial{id, {{"number", fault.number}}, [&, fault, sound](const Note& note) {
                   // What stands beside the units is in no machine.
                   const bool in_machines =
                       !options.beside_units && (sound || hierarchy.contains("multiprocessor", module_of(fault.file)));
                   Outcome outcome = in_machines ? run_fault(options, machines, fault.number, note) : Outcome();
                   if (!in_machines) setenv("RAYPOOL_FAULT", std::to_string(fault.number).c_str(), 1);
                   if ((sound && in_machines) || outcome.kind != Outcome::Kind::Survived) return outcome;
                   run_benches(sound ? benches : benches_of(benches, hierarchy, module_of(fault.file)), outcome);
                   return outcome;
                 }};
  };
  // Without a mistake there must be no difference, or every kill would be worth nothing.
  const Outcome none = run_trial(trial_of(Fault(), true));
  if (none.kind != Outcome::Kind::Survived)
    throw InputError("without any mistake the Verilog differs from the model: " + none.text);
  if (options.beside_units)
    fmt::print("no mistake: all benches pass\n");
  else
    fmt::print("no mistake: {} programs agree\n", none.programs);
  std::fflush(stdout);
  std::vector<Trial> trials;
  trials.reserve(faults.size());
  for (const Fault& fault : faults) trials.push_back(trial_of(fault, false));
  const std::vector<Outcome> outcomes = run_trials(trials, {"faults", options.json, options.resume, options.jobs});
  return report(options, hierarchy, faults, outcomes);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  try {
    return raypool::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_faults: {}\n", error.what());
    return 1;
  }
}
