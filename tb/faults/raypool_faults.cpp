// Runs the faults that `python3 -m faults` has put into the Verilog, one after another, on random programs in lockstep
// and on benches until something detects them, and prints what did, where its report sends its reader, and what
// survived. A process a fault: what it does to the simulator itself stays there.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <vector>

#include "cosim/program_profile.hpp"
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

/// Where faults come from, and what tries to detect them.
struct Source {
  const char* folder;   ///< of what `python3 -m faults` leaves
  const char* benches;  ///< folder of the benches in it; empty: none; of frames they are where this program is
  bool programs;        ///< the Verilated units that it lists run random programs
  /// Of the catalogue all, or those that units have, or the others.
  bool in_units, beside_units;
  bool judged;   ///< survivors have judgements
  bool reports;  ///< name the place of the fault: not of a netlist, nor of most benches
};

const std::map<std::string, Source> kSources = {
    {"catalogue", {"catalogue", "benches/tb", true, true, true, true, true}},
    {"units", {"catalogue", "", true, true, false, false, true}},
    {"frames", {"catalogue", "frames", false, false, true, true, true}},
    {"mutants", {"mutants", "", true, true, true, true, false}},
    {"blocks", {"blocks", "benches/tb", false, true, true, true, false}}};

struct Options {
  std::string program;  ///< as it was called
  std::string source, folder, survivors = "tb/faults/survivors.json", bench_list = "tb/faults/benches.json",
                              rtl = "rtl";
  std::vector<std::string> machines;
  std::vector<int> only;
  size_t every = 1;
  uint64_t programs = 0, seed = 1;
  int frames = 50;
  double least = 0;  ///< percent
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  bool resume = false, verbose = false;
};

struct Fault {
  int number = 0;
  std::string file;  ///< of rtl/, or what stands for it where a tool has made the logic
  std::string what;

  std::string id() const { return file + ": " + what; }
};

/// What `python3 -m faults` has left: of the faults those that the options leave, and whether all that are judged are
/// among them, or some, or none.
struct Faults {
  std::vector<Fault> chosen;
  std::string judged;
};

Faults read_faults(const Options& options, const Source& source, const std::string& path, const Hierarchy& hierarchy) {
  std::ifstream file(path);
  if (!file)
    throw InputError(fmt::format("{}: the list cannot be read; make faults SOURCE={} makes it", path, options.source));
  const Json list = Json::parse(file);
  Faults faults;
  faults.judged = list.at("judged");
  size_t number = 0;
  for (const Json& entry : list.at("faults")) {
    Fault fault{entry.at("number"), entry.at("file"), entry.at("bug")};
    const bool in_units = hierarchy.contains("multiprocessor", module_of(fault.file));
    if (!source.beside_units && !in_units) continue;
    if (!source.in_units && in_units) continue;
    const bool named = std::count(options.only.begin(), options.only.end(), fault.number) != 0;
    if (options.only.empty() ? number++ % options.every == 0 : named) faults.chosen.push_back(std::move(fault));
  }
  if (faults.judged == "all" && (!options.only.empty() || options.every > 1)) faults.judged = "some";
  return faults;
}

bool is_chosen(const Options& options, const std::string& machine) {
  const auto& names = options.machines;
  return names.empty() || std::count(names.begin(), names.end(), machine) != 0;
}

/// `list` has a line for each: name, its configuration's file and its units.
std::vector<Machine> read_machines(const Options& options, const std::string& folder) {
  std::ifstream list(folder + "/list");
  std::vector<Machine> machines;
  std::string name, file;
  for (int units = 1; list >> name >> file >> units;)
    if (is_chosen(options, name))
      machines.push_back({load_configuration(file), units, fmt::format("{}/{}/libraypool_unit.so", folder, name)});
  if (machines.empty()) throw InputError(fmt::format("{}/list has no machine that is asked for", folder));
  return machines;
}

std::string name_of_machine(const Machine& machine) {
  return machine.configuration.name + (machine.units > 1 ? fmt::format(", {} units", machine.units) : "");
}

/// Random programs in a row on one machine.
struct Phase {
  size_t machine;
  uint64_t programs, seed;
  int length;
  std::string_view mix;
};

/// What a fault has survived that no program detects. Mutants: short programs of all mixes, which detect most; then
/// long ones, one of each mix; then long ones that meet thousands of operands. Others: the first machine, which is
/// quick, runs some; then all take turns. Each goes on with the seeds where it was.
std::vector<Phase> phases_of(const Options& options, size_t machines) {
  constexpr int kLength = 120;  // as many instructions, about, as in `raypool cosim`
  std::vector<Phase> phases;
  if (options.source == "mutants") {
    phases = {{0, 120, options.seed, 80, ""}, {0, 10, options.seed, 800, ""}, {0, 12, options.seed, 1000, kOperandMix}};
  } else {
    std::vector<uint64_t> seeds(machines, options.seed);
    for (uint64_t turn = 0, all = 0; all < 2000; ++turn) {
      const size_t m = turn % machines;
      const uint64_t programs = turn == 0 ? 100 : 20;
      phases.push_back({m, programs, seeds[m], kLength, ""});
      seeds[m] += programs;
      all += programs;
    }
  }
  uint64_t left = options.programs == 0 ? ~uint64_t{0} : options.programs;
  for (Phase& phase : phases) {
    phase.programs = std::min(phase.programs, left);
    left -= phase.programs;
  }
  return phases;
}

Outcome run_programs(const std::vector<Machine>& machines, const std::vector<Phase>& phases, const Note& note) {
  std::map<size_t, std::unique_ptr<ComputeUnit>> kept;  // keeps the libraries loaded
  Outcome outcome;
  for (const Phase& phase : phases) {
    const Machine& machine = machines[phase.machine];
    outcome.by = name_of_machine(machine);
    if (phase.programs > 0 && kept.count(phase.machine) == 0)
      kept[phase.machine] = load_rtl_unit(machine.library, machine.configuration, machine.units);
    for (uint64_t n = 0; n < phase.programs; ++n) {
      note(++outcome.programs, outcome.by);
      run_program(machine,
                  make_random_program(machine.configuration, phase.seed + n, phase.length, machine.units,
                                      std::string(phase.mix)),
                  outcome);
      if (outcome.kind != Outcome::Kind::Survived) return outcome;
    }
  }
  outcome.by.clear();
  return outcome;
}

/// What tries to detect a fault.
struct Detectors {
  std::vector<Machine> machines;
  std::vector<Phase> phases;
  std::vector<Bench> benches;

  Outcome run(int number, bool in_machines, const std::vector<Bench>& own, const Note& note) const {
    setenv("RAYPOOL_FAULT", std::to_string(number).c_str(), 1);
    Outcome outcome = in_machines ? run_programs(machines, phases, note) : Outcome();
    if (outcome.kind == Outcome::Kind::Survived) run_benches(own, outcome);
    return outcome;
  }
};

/// Without a fault nothing may be detected, or every kill would be worth nothing. `benches`: those that are used.
void expect_sound(const Options& options, const Detectors& detectors, const std::set<std::string>& benches) {
  std::vector<Trial> trials;
  if (!detectors.machines.empty())
    trials.push_back({"programs", {}, [&](const Note& note) { return detectors.run(0, true, {}, note); }});
  for (const Bench& bench : detectors.benches)
    if (benches.count(bench.command) != 0)
      trials.push_back({bench.name, {}, [&](const Note& note) { return detectors.run(0, false, {bench}, note); }});
  uint64_t programs = 0;
  TrialOptions how;
  how.what = "without a fault";
  how.jobs = options.jobs;
  for (const Outcome& outcome : run_trials(trials, how)) {
    if (outcome.kind != Outcome::Kind::Survived)
      throw InputError(fmt::format("without any fault {} fails: {}", outcome.by, outcome.text));
    programs += outcome.programs;
  }
  fmt::print("no fault: {} programs agree, {} benches pass\n", programs, benches.size());
  std::fflush(stdout);
}

/// What became of the faults of a module, or of all.
struct Count {
  int all = 0, programs = 0, benches = 0, own = 0;
  int reports = 0, right = 0, parent = 0, early = 0;  ///< `early`: the right file is the first or the second

  int killed() const { return programs + benches; }
};

std::string percent(int part, int all) {
  return fmt::format("{} of {} ({:.1f}%)", part, all, all == 0 ? 0.0 : 100.0 * part / all);
}

/// What became of a fault, in a line.
std::string outcome_text(const Outcome& outcome, const std::vector<std::string>& named, Verdict verdict) {
  static const EnumArray<Verdict, const char*, 4> kVerdicts = {"right", "its parent", "WRONG", "NONE"};
  std::string text =
      fmt::format("killed on {} after {} programs ({})", outcome.by, outcome.programs, name_of(outcome.kind));
  if (outcome.kind == Outcome::Kind::Survived)
    return outcome.programs == 0 ? "SURVIVED" : fmt::format("SURVIVED {} programs", outcome.programs);
  if (outcome.kind == Outcome::Kind::Bench)
    text = fmt::format("killed by {}: {}", outcome.by, outcome.text.substr(0, outcome.text.find('\n')));
  if (!named.empty()) text += fmt::format("; look at: {} ({})", fmt::join(named, ", "), kVerdicts[verdict]);
  return text;
}

void print_table(const std::map<std::string, Count>& modules, bool reports) {
  fmt::print("\n{:<24} faults  programs  benches  survived{}\n", "module", reports ? "  right  parent" : "");
  for (const auto& [name, count] : modules)
    fmt::print("{:<24} {:>6} {:>9} {:>8} {:>9}{}\n", name, count.all, count.programs, count.benches,
               count.all - count.killed(), reports ? fmt::format(" {:>6} {:>7}", count.right, count.parent) : "");
}

int report(const Options& options, const Source& source, const Faults& faults, const std::vector<Outcome>& outcomes,
           const Detectors& detectors, const Hierarchy& hierarchy) {
  const bool judged = source.judged && faults.judged != "none";
  Judgements judgements(judged ? options.survivors : "", options.source);
  std::map<std::string, Count> modules;
  std::map<Outcome::Kind, int> kinds;
  std::map<uint64_t, int> within;
  Count total;
  for (size_t i = 0; i < outcomes.size(); ++i) {
    const Fault& fault = faults.chosen[i];
    const Outcome& outcome = outcomes[i];
    const std::string module = module_of(fault.file);
    const bool survived = outcome.kind == Outcome::Kind::Survived, bench = outcome.kind == Outcome::Kind::Bench;
    // A frame's failure may be a picture's.
    const bool reported = source.reports && !survived &&
                          (!bench || (!source.programs && outcome.text.find("look at: ") != std::string::npos));
    const std::vector<std::string> named = reported ? files_named(outcome.text) : std::vector<std::string>();
    const Verdict verdict = judge(hierarchy, named, fault.file);
    fmt::print("{:>3} {}\n    {}\n", fault.number, fault.id(), outcome_text(outcome, named, verdict));
    if (survived) fmt::print("    {}\n", judgements.survived(fault.id()));
    if (options.verbose && !outcome.text.empty()) fmt::print("{}\n", outcome.text);
    ++kinds[outcome.kind];
    if (!survived && !bench)
      ++within[outcome.programs <= 1 ? 1 : outcome.programs <= 10 ? 10 : outcome.programs <= 100 ? 100 : ~0u];
    for (Count* count : {&modules[module], &total}) {
      ++count->all;
      count->programs += !survived && !bench;
      count->benches += bench;
      count->own += bench && outcome.by == benches_of(detectors.benches, hierarchy, module).front().name;
      count->reports += reported;
      count->right += verdict == Verdict::Right;
      count->parent += verdict == Verdict::Parent;
      count->early += named_early(named, fault.file);
    }
  }
  print_table(modules, source.reports);
  for (const auto& [kind, count] : kinds)
    if (kind != Outcome::Kind::Survived) fmt::print("killed by {:<22} {:>5}\n", name_of(kind), count);
  for (const auto& [programs, count] : within)
    fmt::print("killed {:<25} {:>5}\n",
               programs == ~0u ? std::string("by a later program") : fmt::format("within {} programs", programs),
               count);
  if (total.own > 0 && options.source != "frames") fmt::print("killed by the module's own bench {:>2}\n", total.own);
  if (source.reports) {
    fmt::print("the report names the right file or its parent: {}, the right one {}\n",
               percent(total.right + total.parent, total.reports), percent(total.right, total.reports));
    fmt::print("the right file is the first or the second: {}\n", percent(total.early, total.reports));
  }
  const int different = total.all - judgements.equivalent();
  fmt::print("{}: {} killed; {} survived, of which {} are judged equivalent: {} of the others killed\n", options.source,
             percent(total.killed(), total.all), total.all - total.killed(), judgements.equivalent(),
             percent(total.killed(), different));
  // Of frames only what no chip can show is judged.
  if (options.least > 0 || options.source == "frames")
    return total.killed() * 100.0 >= options.least * different ? 0 : 1;
  if (!judged) return 0;
  return (faults.judged == "all" ? judgements.up_to_date() : judgements.open() == 0) ? 0 : 1;
}

void add_options(CLI::App& app, Options& options) {
  std::vector<std::string> sources;
  for (const auto& [name, source] : kSources) sources.push_back(name);
  app.add_option("source", options.source, "of the faults")->required()->check(CLI::IsMember(sources));
  app.add_option("folder", options.folder, "where python3 -m faults has put them into the Verilog")->required();
  app.add_option("--only", options.only, "these faults only (numbers)");
  app.add_option("--every", options.every, "only each so many-th fault: a sample")->check(CLI::PositiveNumber);
  app.add_option("--machines", options.machines, "only these, by name; of frames by number")->delimiter(',');
  app.add_option("--programs", options.programs, "at most so many random programs; 0: as many as the source has");
  app.add_option("--seed", options.seed, "of the first program of each machine")->capture_default_str();
  app.add_option("--frames", options.frames, "of each machine")->capture_default_str()->check(CLI::PositiveNumber);
  app.add_option("--least", options.least,
                 "fail only if less percent of the faults that are not equivalent are killed");
  app.add_option("--survivors", options.survivors, "JSON file with the judged survivors")->capture_default_str();
  app.add_option("--bench-list", options.bench_list, "JSON file with the benches")->capture_default_str();
  app.add_option("--rtl", options.rtl, "folder of the Verilog: which module has which")->capture_default_str();
  app.add_option("--jobs", options.jobs, "processes")->capture_default_str();
  app.add_flag("--resume", options.resume, "go on with a run of the same faults that was interrupted");
  app.add_flag("--verbose", options.verbose, "print the whole report of what detects a fault");
}

int run(const Options& options) {
  const Source& source = kSources.at(options.source);
  const std::string folder = fmt::format("{}/{}", options.folder, source.folder);
  const Hierarchy hierarchy(options.rtl);
  const Faults faults = read_faults(options, source, folder + "/faults.json", hierarchy);
  Detectors detectors;
  if (source.programs) {
    detectors.machines = read_machines(options, folder);
    detectors.phases = phases_of(options, detectors.machines.size());
  }
  if (source.benches[0] != '\0') {
    const std::string benches = options.source == "frames"
                                    ? std::filesystem::path(options.program).parent_path().string()
                                    : fmt::format("{}/{}", folder, source.benches);
    const std::string chips =
        fmt::format(" --tree {} --frames {}{}{}", folder, options.frames, options.machines.empty() ? "" : " --machine ",
                    fmt::join(options.machines, ","));
    detectors.benches = read_benches(options.bench_list, options.source, benches, chips);
  }
  std::vector<Trial> trials;
  std::set<std::string> used;
  for (const Fault& fault : faults.chosen) {
    const std::string module = module_of(fault.file);
    const bool in_machines = options.source == "mutants" || hierarchy.contains("multiprocessor", module);
    std::vector<Bench> own = benches_of(detectors.benches, hierarchy, module);
    for (const Bench& bench : own) used.insert(bench.command);
    if (own.empty() && !(in_machines && source.programs))
      throw InputError(fmt::format("{}: no bench of {} has it", fault.file, options.bench_list));
    trials.push_back(
        {fault.id(), {{"number", fault.number}}, [&detectors, fault, own, in_machines, &source](const Note& note) {
           return detectors.run(fault.number, in_machines && source.programs, own, note);
         }});
  }
  expect_sound(options, detectors, used);
  TrialOptions how;
  how.what = "faults";
  how.json = fmt::format("{}/{}.outcomes.json", folder, options.source);
  how.resume = options.resume;
  how.jobs = options.jobs;
  return report(options, source, faults, run_trials(trials, how), detectors, hierarchy);
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  raypool::Options options;
  options.program = argv[0];
  CLI::App app("Runs faults in the Verilog on what might detect them; python3 -m faults makes them.", "raypool_faults");
  raypool::add_options(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    return raypool::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_faults: {}\n", error.what());
    return 1;
  }
}
