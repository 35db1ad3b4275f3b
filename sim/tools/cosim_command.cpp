// `raypool cosim`: random programs on the Verilated unit in lockstep with the golden model.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include "cli/engine.hpp"
#include "cli/output_folder.hpp"
#include "cli/progress.hpp"
#include "config/data_folder.hpp"
#include "cosim/cosim.hpp"
#include "cosim/coverage.hpp"
#include "cosim/machines.hpp"
#include "cosim/minimise.hpp"
#include "cosim/program_file.hpp"
#include "cosim/vector_recorder.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "tools/commands.hpp"

namespace raypool {
namespace {

/// Runs programs of one configuration and adds up what was compared.
class Cosim {
 public:
  Cosim(const CosimOptions& options, const Configuration& configuration, int units) : coverage_(configuration, units) {
    engine_.engine = parse_engine(options.engine);
    engine_.configuration = configuration;
    engine_.unit_library = options.unit_library;
    engine_.units = units;
    if (options.vectors.empty()) return;
    if (engine_.engine != Engine::Lockstep) throw InputError("--vectors records a lockstep: use --engine lockstep");
    if (units != 1) throw InputError("--vectors records a single unit");
    vectors_.emplace(vectors_file_.begin(options.vectors));
  }

  bool traced() const { return engine_.engine == Engine::Rtl || engine_.engine == Engine::Lockstep; }
  const LockstepCounts& counts() const { return counts_; }
  const Coverage& coverage() const { return coverage_; }
  const Configuration& configuration() const { return engine_.configuration; }
  Engine engine() const { return engine_.engine; }

  /// Throws InputError if the Verilated unit is missing that it needs.
  void find_unit() const {
    if (traced()) find_unit_library(engine_);
  }

  /// The recording gets its name.
  void finish() {
    if (!vectors_) return;
    vectors_->close();
    if (!*vectors_) throw InputError("the recording for --vectors cannot be written: is the disk full?");
    vectors_file_.publish();
  }

  /// Throws what the run throws; a difference with what was wrong inside.
  uint64_t run(const RandomProgram& program, const std::string& name) {
    uint64_t cycles = 0;
    inspect_differences([&](uint64_t inspect_until) { cycles = run_once(program, name, inspect_until); });
    return cycles;
  }

  /// Why the program fails, with neither coverage nor counts; empty if it does not.
  /// `inspect`: report what was wrong inside, too.
  /// Throws errors that the program has not caused.
  std::string failure(const RandomProgram& program, bool inspect = false) const {
    const auto run = [&](uint64_t inspect_until) {
      Memory memory = program.memory;
      run_random_program(*make_unit(engine_inspecting(inspect_until), memory), memory, program, program.seed,
                         kCycleLimit);
    };
    try {
      if (inspect)
        inspect_differences(run);
      else
        run(0);
    } catch (const LockstepDifference& difference) {
      return difference.what();
    } catch (const ProgramFailure& failure) {
      return failure.what();
    }
    return "";
  }

 private:
  static constexpr uint64_t kCycleLimit = 5'000'000;

  EngineOptions engine_inspecting(uint64_t inspect_until) const {
    EngineOptions options = engine_;
    options.inspect_until = inspect_until;
    return options;
  }

  uint64_t run_once(const RandomProgram& program, const std::string& name, uint64_t inspect_until) {
    Memory memory = program.memory;
    const std::unique_ptr<ComputeUnit> unit = make(memory, name, inspect_until);
    unit->trace_on();
    coverage_.begin();
    const uint64_t cycles =
        run_random_program(*unit, memory, program, program.seed, kCycleLimit, traced() ? &coverage_ : nullptr);
    if (traced()) coverage_.end(*unit);
    if (const auto counts = lockstep_counts(*unit)) counts_ += *counts;
    return cycles;
  }

  std::unique_ptr<ComputeUnit> make(Memory& memory, const std::string& name, uint64_t inspect_until) {
    if (!vectors_) return make_unit(engine_inspecting(inspect_until), memory, name);
    const Configuration& configuration = engine_.configuration;
    auto recorder =
        make_vector_recorder(configuration, load_rtl_unit(find_unit_library(engine_), configuration), *vectors_);
    return make_lockstep_unit(configuration, std::move(recorder), memory);
  }

  EngineOptions engine_;
  Coverage coverage_;
  LockstepCounts counts_;
  OutputFiles vectors_file_;
  std::optional<std::ofstream> vectors_;
};

/// What a report is about: its first line without numbers, so that a shorter program that fails
/// otherwise is not taken for the same.
std::string subject(const std::string& report) {
  std::string text;
  const size_t begin = report.find(": ");
  for (const char c : report.substr(begin == std::string::npos ? 0 : begin,
                                    report.find('\n') - (begin == std::string::npos ? 0 : begin)))
    if (c < '0' || c > '9') text += c;
  return text;
}

/// Minimises a program that fails, saves it, and throws what is to be reported.
[[noreturn]] void report_failure(const Cosim& cosim, const CosimOptions& options, const RandomProgram& program,
                                 const std::string& report, const std::string& again, bool is_difference) {
  std::string text = report;
  if (options.minimise) {
    Progress progress(false);
    MinimiseOptions minimise;
    minimise.progress = [&progress](size_t instructions, uint64_t runs) {
      if (progress.due()) progress.show(fmt::format("minimising: {} instructions after {} runs", instructions, runs));
    };
    SavedProgram saved;
    saved.configuration = cosim.configuration();
    const std::string wanted = subject(report);
    const auto fails = [&](const RandomProgram& shorter) { return subject(cosim.failure(shorter)) == wanted; };
    saved.program = minimise_program(cosim.configuration(), program, fails, minimise);
    text = cosim.failure(saved.program, true);
    saved.note = text.substr(0, text.find('\n'));
    text += fmt::format("\nminimised from {} to {} instructions", program.program.code.size(),
                        saved.program.program.code.size());
    // The difference is what counts, saved or not.
    try {
      OutputFolder folder(options.save);
      const std::string name = fmt::format("{}-seed{}.json", saved.configuration.name, saved.program.seed);
      folder.write(name, to_json(saved));
      folder.publish();
      text +=
          fmt::format(" and saved; again with: {} cosim --replay {}", program_command(), folder.path(name).string());
    } catch (const InputError& error) {
      text += fmt::format(", but not saved: {}", error.what());
    }
  }
  text += fmt::format("\nthe whole program again: {}", again);
  if (is_difference) throw LockstepDifference(text);
  throw InputError(text);
}

/// A machine with its part of the programs.
struct Share {
  Machine machine;
  uint64_t programs;
  std::unique_ptr<Cosim> cosim;
};

/// In equal parts; the first have one more where that does not come out even. Machines that get none are left out.
std::vector<Share> share_programs(const CosimOptions& options, const std::vector<Machine>& machines) {
  std::vector<Share> shares;
  for (const Machine& machine : machines) {
    const uint64_t rest = options.programs % machines.size() > shares.size() ? 1 : 0;
    const uint64_t programs = options.programs / machines.size() + rest;
    if (programs == 0 && machines.size() > 1) break;
    shares.push_back({machine, programs, std::make_unique<Cosim>(options, machine.configuration, machine.units)});
  }
  if (shares.empty()) throw InputError("--programs 0 of several machines: give each at least one");
  return shares;
}

/// All of them at once, before the first one runs: what is missing is no matter of minutes later.
void find_units(const std::vector<Share>& shares) {
  for (const Share& share : shares) {
    try {
      share.cosim->find_unit();
    } catch (const InputError& error) {
      if (shares.size() == 1) throw;
      throw InputError(fmt::format("{} ({} the units of all {} machines)", error.what(),
                                   installed() ? "raypool cosim --machines lists" : "make cosim builds",
                                   shares.size()));
    }
  }
}

void run_or_report(Cosim& cosim, const CosimOptions& options, const RandomProgram& program, const std::string& again,
                   uint64_t& cycles) {
  try {
    cycles += cosim.run(program, fmt::format("seed {}", program.seed));
  } catch (const LockstepDifference& difference) {
    report_failure(cosim, options, program, difference.what(), again, true);
  } catch (const ProgramFailure& failure) {
    report_failure(cosim, options, program, failure.what(), again, false);
  }
}

uint64_t run_share(const Share& share, const CosimOptions& options, const std::string& title, Progress& progress) {
  const Configuration& configuration = share.machine.configuration;
  uint64_t cycles = 0;
  for (uint64_t n = 0; n < share.programs; ++n) {
    const RandomProgram program =
        make_random_program(configuration, options.seed + n, options.length, share.machine.units, options.mix);
    run_or_report(*share.cosim, options, program,
                  fmt::format("{} cosim {} --units {} --programs 1 --seed {} --length {}{}", program_command(),
                              config_options(configuration), share.machine.units, program.seed, options.length,
                              options.mix.empty() ? "" : " --mix " + options.mix),
                  cycles);
    if (progress.due())
      progress.show(fmt::format("cosim {}: {} of {} programs, {} cycles", title, n + 1, share.programs, cycles));
  }
  return cycles;
}

std::vector<Machine> machines_of(const std::vector<Share>& shares) {
  std::vector<Machine> machines;
  for (const Share& share : shares) machines.push_back(share.machine);
  return machines;
}

void print_lacking(const std::vector<Share>& shares) {
  const std::vector<Machine> machines = machines_of(shares);
  const std::vector<std::string> features = features_lacking(machines);
  if (shares.size() == 1) {
    if (!features.empty())
      fmt::print("not tried, as {} lacks them: {}\n", name_of(machines.front()), fmt::join(features, ", "));
    return;
  }
  if (!features.empty()) fmt::print("not tried, as no machine has them: {}\n", fmt::join(features, ", "));
  fmt::print("no machine has (make configurations has all): {}\n", fmt::join(values_lacking(machines), "; "));
}

void print_coverage(const std::vector<Share>& shares, const CosimOptions& options) {
  std::vector<NamedCoverage> machines;
  for (const Share& share : shares)
    machines.push_back({name_of(share.machine), share.programs, &share.cosim->coverage()});
  const bool one = machines.size() == 1;
  if (shares.front().cosim->traced())
    fmt::print("{}", one ? to_string(*machines.front().coverage) : to_string(machines));
  print_lacking(shares);
  if (options.coverage.empty()) return;
  if (!shares.front().cosim->traced()) throw InputError("--coverage needs an engine with a trace: rtl or lockstep");
  write_file(options.coverage, one ? to_json(machines.front()) : to_json(machines));
}

int run_machines(const CosimOptions& options, const std::vector<Machine>& machines) {
  const std::vector<Share> shares = share_programs(options, machines);
  find_units(shares);
  Progress progress(options.quiet);
  LockstepCounts counts;
  uint64_t cycles = 0;
  for (size_t number = 0; number < shares.size(); ++number) {
    const Share& share = shares[number];
    std::string title = name_of(share.machine);
    if (shares.size() > 1) title = fmt::format("{} ({} of {} machines)", title, number + 1, shares.size());
    cycles += run_share(share, options, title, progress);
    counts += share.cosim->counts();
  }
  const std::string name =
      shares.size() == 1 ? name_of(shares.front().machine) : fmt::format("on {} machines", shares.size());
  fmt::print("cosim {}: {} programs from seed {}, {} cycles in {:.1f} s\n", name, options.programs, options.seed,
             cycles, progress.seconds());
  if (shares.front().cosim->engine() == Engine::Lockstep) fmt::print("{}\n", to_string(counts));
  print_coverage(shares, options);
  for (const Share& share : shares) share.cosim->finish();
  return 0;
}

}  // namespace

int cosim_command(const CosimOptions& options) {
  if (!options.replay.empty()) {
    const SavedProgram saved = load_saved_program(options.replay, !options.unchecked);
    if (options.show_configuration) {
      fmt::print("{}\n", to_json(saved.configuration));
      return 0;
    }
    Cosim cosim(options, saved.configuration, saved.program.units);
    const uint64_t cycles = cosim.run(saved.program, options.replay);
    fmt::print("replayed {}: {} instructions of code, {} cycles\n", options.replay, saved.program.program.code.size(),
               cycles);
    if (cosim.engine() == Engine::Lockstep) fmt::print("{}\n", to_string(cosim.counts()));
    cosim.finish();
    return 0;
  }

  const std::vector<Machine> machines =
      options.config.empty() ? cosim_machines()
                             : std::vector<Machine>{{load_configuration(options.config, options.set), options.units}};
  if (options.machines) {
    for (const Machine& machine : machines) fmt::print("{} {}\n", machine.configuration.source, machine.units);
    return 0;
  }
  if (machines.size() > 1 && !(options.unit_library.empty() && options.vectors.empty()))
    throw InputError("--unit-library and --vectors are of one machine: name it with --config");
  return run_machines(options, machines);
}

}  // namespace raypool
