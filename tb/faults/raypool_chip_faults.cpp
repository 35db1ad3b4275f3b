// Runs designers' mistakes of tb/faults/catalogue.json that lie in chip and traverser on random frames of one tiny chip
// with the traverser inside, rtl/chip.v in lockstep with its model, and says where each report sends its reader. The
// chip is built from the Verilog with all mistakes in it (scripts/faults.sh makes that), and kept.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "faulty/benches.hpp"
#include "faulty/guilty.hpp"
#include "faulty/trials.hpp"
#include "isa/input_error.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "lockstep/rtl_loader.hpp"
#include "random.hpp"
#include "rtl/chip_frames.hpp"
#include "rtl/traverser_frames.hpp"

namespace raypool {
namespace {

using faulty::Outcome;

struct Options {
  std::string folder, catalogue = "tb/faults/catalogue.json", rtl = "rtl", json;
  uint32_t frames = 40, seed = 1;
  size_t every = 1;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  std::vector<int> only;
  bool verbose = false;
};

struct Fault {
  int number = 0;
  std::string file, mistake;
};

/// Those of chip and traverser, which no unit has.
std::vector<Fault> read_faults(const Options& options, const faulty::Hierarchy& hierarchy) {
  std::ifstream file(options.catalogue);
  if (!file) throw InputError(fmt::format("{}: the file cannot be read", options.catalogue));
  std::vector<Fault> faults;
  size_t number = 0;
  for (const auto& entry : nlohmann::json::parse(file)) {
    Fault fault{entry.at("number"), entry.at("file"), entry.at("mistake")};
    if (hierarchy.contains("multiprocessor", faulty::module_of(fault.file))) continue;
    const bool chosen = options.only.empty() ? number++ % options.every == 0
                                             : std::count(options.only.begin(), options.only.end(), fault.number) != 0;
    if (chosen) faults.push_back(std::move(fault));
  }
  return faults;
}

/// Draws frames until one shows a difference. `sound`: there is none, and nothing may be found inside either.
Outcome draw_frames(const Options& options, const Machine& machine, const std::string& library, bool sound,
                    const faulty::Note& note) {
  Outcome outcome;
  for (uint32_t number = 1; number <= options.frames; ++number) {
    note(++outcome.programs, machine.configuration.name);
    std::seed_seq all{options.seed, number};
    Random random(all);
    const auto one = [&](std::initializer_list<uint32_t> values) {
      return *(values.begin() + random() % values.size());
    };
    const test::Picture picture{1 + random() % 8, 1 + random() % 6, 1 + random() % 4, random() % 4 != 0};
    const uint32_t triangles = 1 + random() % one({1, 4, 12, 40, 100, 300});
    const uint32_t tree = random() % 3 != 0 ? 0 : 1 + random() % 1000;
    const test::WaitingChip::Waits waits = {one({0, 2, 5, 20}), one({0, 2, 5, 20}), one({0, 2, 30})};
    const uint32_t seed = random();
    const auto run = [&](uint64_t inspect_until) {
      test::Drawing drawing(machine, picture, test::scene_of_chance(seed, triangles), tree);
      const auto chip =
          make_lockstep_chip(machine.configuration, load_rtl_chip(library, machine.configuration, machine.units),
                             drawing.memory(), fmt::format("frame {}", number), inspect_until);
      test::WaitingChip waiting(*chip, waits, seed);
      drawing.draw_on(waiting);
      if (!chip->inside().empty()) throw InputError("found inside, without a difference: " + chip->inside()[0].text);
    };
    try {
      if (sound) {
        run(kInspectAlways);
        continue;
      }
      inspect_differences(run);
    } catch (const LockstepDifference& difference) {
      outcome.kind = Outcome::Kind::Difference;
      outcome.text = difference.what();
      return outcome;
    } catch (const std::exception& error) {
      outcome.kind = Outcome::Kind::Stopped;
      outcome.text = error.what();
      return outcome;
    }
  }
  return outcome;
}

std::string percent(size_t part, size_t all) {
  return fmt::format("{} of {} ({:.1f}%)", part, all, all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / all);
}

int run(const Options& options) {
  const faulty::Hierarchy hierarchy(options.rtl);
  Machine machine = test::full_inside();
  machine.configuration.name += "_faulty";
  const std::string tree = std::filesystem::absolute(options.folder).string();
  if (!std::filesystem::exists(tree + "/rtl/chip.v"))
    throw InputError(fmt::format("{} has no Verilog with mistakes: scripts/faults.sh makes it", options.folder));
  const std::string library =
      test::verilate(
          machine.configuration.name,
          " --top chip --quick" + test::words_of(chip_verilog_parameters(machine.configuration, machine.units)), tree) +
      "/libraypool_chip.so";
  const auto trial = [&](const Fault& fault) {
    return faulty::Trial{fmt::format("{}: {}", fault.file, fault.mistake),
                         {{"number", fault.number}},
                         [&options, &machine, &library, number = fault.number](const faulty::Note& note) {
                           setenv("RAYPOOL_FAULT", std::to_string(number).c_str(), 1);
                           return draw_frames(options, machine, library, number == 0, note);
                         }};
  };
  const Outcome none = faulty::run_trial(trial({}));
  if (none.kind != Outcome::Kind::Survived)
    throw InputError("without any mistake the chip differs from the model: " + none.text);
  fmt::print("no mistake: {} frames agree\n", none.programs);
  const std::vector<Fault> faults = read_faults(options, hierarchy);
  std::vector<faulty::Trial> trials;
  trials.reserve(faults.size());
  for (const Fault& fault : faults) trials.push_back(trial(fault));
  faulty::TrialOptions how;
  how.what = "faults";
  how.json = options.json;
  how.jobs = options.jobs;
  how.seconds_limit = 600;
  const std::vector<Outcome> outcomes = faulty::run_trials(trials, how);
  size_t reported = 0, early = 0, right = 0;
  for (size_t i = 0; i < faults.size(); ++i) {
    const Outcome& outcome = outcomes[i];
    fmt::print("{:>3} {}: {}\n", faults[i].number, faults[i].file, faults[i].mistake);
    const std::vector<std::string> named = faulty::files_named(outcome.text);
    if (outcome.kind != Outcome::Kind::Difference || named.empty()) {
      fmt::print("    no report after {} frames: {}\n", outcome.programs, faulty::name_of(outcome.kind));
      continue;
    }
    const bool is_early = faulty::named_early(named, faults[i].file);
    ++reported;
    early += is_early;
    right += faulty::judge(hierarchy, named, faults[i].file) == faulty::Verdict::Right;
    std::string files;
    for (const std::string& name : named) files += (files.empty() ? "" : ", ") + name;
    fmt::print("    reported in frame {}; look at: {} ({})\n", outcome.programs, files, is_early ? "right" : "WRONG");
    if (options.verbose) fmt::print("{}\n", outcome.text);
  }
  fmt::print("reported by frames: {}\n", percent(reported, faults.size()));
  fmt::print("the right file is among those named: {}\n", percent(right, reported));
  fmt::print("the right file is the first or the second: {}\n", percent(early, reported));
  return 0;
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  testing::FLAGS_gtest_throw_on_failure = true;
  testing::InitGoogleTest(&argc, argv);
  raypool::Options options;
  CLI::App app("Where reports of a chip with a designer's mistake send their reader.", "raypool_chip_faults");
  app.add_option("folder", options.folder, "where scripts/faults.sh has put the Verilog with the mistakes")->required();
  app.add_option("--catalogue", options.catalogue, "the mistakes")->capture_default_str();
  app.add_option("--rtl", options.rtl, "folder of the Verilog: which module has which")->capture_default_str();
  app.add_option("--frames", options.frames, "that a mistake may survive")->capture_default_str();
  app.add_option("--seed", options.seed, "of frames")->capture_default_str();
  app.add_option("--every", options.every, "of the mistakes in chip and traverser only each so many-th: a sample")
      ->check(CLI::PositiveNumber);
  app.add_option("--only", options.only, "these mistakes only (numbers)");
  app.add_option("--jobs", options.jobs, "processes")->capture_default_str();
  app.add_option("--json", options.json, "file that gets a JSON object a line for each mistake as it ends");
  app.add_flag("--verbose", options.verbose, "print the whole report of each difference");
  CLI11_PARSE(app, argc, argv);
  try {
    return raypool::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_chip_faults: {}\n", error.what());
    return 1;
  }
}
