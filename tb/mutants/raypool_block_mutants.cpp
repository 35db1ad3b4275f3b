// Runs small faults in single blocks (scripts/block_mutants.py makes them) on the benches that have the block, until
// one notices, and says which were noticed. A process a fault: what it does to the simulator itself stays there.
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

#include "faulty/benches.hpp"
#include "faulty/judgements.hpp"
#include "faulty/trials.hpp"
#include "isa/input_error.hpp"

namespace raypool {
namespace {

using namespace faulty;
using Json = nlohmann::ordered_json;

struct Options {
  std::string list, benches, bench_list = "tb/mutants/benches.json", rtl = "rtl", survivors, json;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  std::vector<int> only;
  bool part = false, resume = false;
};

struct Mutant {
  int number = 0;
  std::string file;  ///< of rtl/
  std::string what;

  std::string id() const { return file + ", " + what; }
};

std::vector<Mutant> read_list(const Options& options) {
  std::ifstream file(options.list);
  if (!file)
    throw InputError(fmt::format("{}: the list cannot be read; make it with scripts/block_mutants.py", options.list));
  std::vector<Mutant> mutants;
  for (const Json& entry : Json::parse(file)) {
    Mutant mutant{entry.at("number").get<int>(), entry.at("file").get<std::string>(),
                  entry.at("mistake").get<std::string>()};
    if (options.only.empty() ||
        std::find(options.only.begin(), options.only.end(), mutant.number) != options.only.end())
      mutants.push_back(std::move(mutant));
  }
  return mutants;
}

Outcome run_mutant(const std::vector<Bench>& benches, int number) {
  setenv("RAYPOOL_FAULT", std::to_string(number).c_str(), 1);
  Outcome outcome;
  run_benches(benches, outcome);
  return outcome;
}

int report(const Options& options, const std::vector<Bench>& benches, const Hierarchy& hierarchy,
           const std::vector<Mutant>& mutants, const std::vector<Outcome>& outcomes) {
  Judgements judgements(options.survivors);
  struct Count {
    int all = 0, own = 0, above = 0;
  };
  std::map<std::string, Count> modules;
  Count total;
  for (size_t i = 0; i < mutants.size(); ++i) {
    const std::string module = module_of(mutants[i].file);
    const bool survived = outcomes[i].kind == Outcome::Kind::Survived;
    // The first bench that has the module is its own.
    const bool own = !survived && outcomes[i].by == benches_of(benches, hierarchy, module).front().name;
    for (Count* count : {&modules[module], &total}) {
      ++count->all;
      count->own += own;
      count->above += !survived && !own;
    }
    if (survived)
      fmt::print("survived: {:>4} {}\n          {}\n", mutants[i].number, mutants[i].id(),
                 judgements.survived(mutants[i].id()));
  }
  fmt::print("{:<24} mutants  own bench  above  survived\n", "module");
  for (const auto& [name, count] : modules)
    fmt::print("{:<24} {:>7} {:>10} {:>6} {:>9}\n", name, count.all, count.own, count.above,
               count.all - count.own - count.above);
  const int killed = total.own + total.above;
  fmt::print(
      "mutants: {} of {} killed ({:.1f}%), {} by the module's own bench; {} survived, of which {} are judged "
      "equivalent: {:.1f}% of the others killed\n",
      killed, total.all, 100.0 * killed / total.all, total.own, total.all - killed, judgements.equivalent(),
      100.0 * killed / (total.all - judgements.equivalent()));
  if (!options.only.empty()) return 0;
  return (options.part ? judgements.open() == 0 : judgements.up_to_date()) ? 0 : 1;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Runs small faults of single blocks on their benches; scripts/block_mutants.py makes them.");
  app.add_option("--list", options.list, "list of the faults")->required();
  app.add_option("--benches", options.benches, "folder with benches built from the Verilog with the faults")
      ->required();
  app.add_option("--bench-list", options.bench_list, "JSON file with the benches, those of small blocks first")
      ->capture_default_str();
  app.add_option("--rtl", options.rtl, "folder of the Verilog: which module has which")->capture_default_str();
  app.add_option("--survivors", options.survivors, "JSON file with the judged survivors, to be compared");
  app.add_option("--json", options.json, "file that gets a JSON object a line for each fault as it ends");
  app.add_option("--jobs", options.jobs, "processes")->capture_default_str();
  app.add_option("--only", options.only, "run these faults only (numbers)");
  app.add_flag("--part", options.part, "the list is of some modules only: not all that are judged can survive");
  app.add_flag("--resume", options.resume,
               "take over what --json has of an interrupted run of the same benches, and run the others");
  CLI11_PARSE(app, argc, argv);

  const std::vector<Mutant> mutants = read_list(options);
  const std::vector<Bench> benches = read_benches(options.bench_list, options.benches);
  const Hierarchy hierarchy(options.rtl);
  std::vector<Trial> trials;
  for (const Mutant& mutant : mutants) {
    const std::vector<Bench> own = benches_of(benches, hierarchy, module_of(mutant.file));
    if (own.empty()) throw InputError(fmt::format("{}: no bench of {} has it", mutant.file, options.bench_list));
    trials.push_back({mutant.id(), {{"number", mutant.number}}, [own, number = mutant.number](const Note&) {
                        return run_mutant(own, number);
                      }});
  }
  // Without a fault every bench must pass, or every kill would be worth nothing.
  const Outcome none = run_trial({"", {}, [&benches](const Note&) { return run_mutant(benches, 0); }});
  if (none.kind != Outcome::Kind::Survived)
    throw InputError(fmt::format("without any fault {} fails: {}", none.by, none.text));
  fmt::print("no fault: {} benches pass\n", benches.size());
  std::fflush(stdout);
  return report(options, benches, hierarchy, mutants,
                run_trials(trials, {"mutants", options.json, options.resume, options.jobs}));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  try {
    return raypool::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raypool_block_mutants: {}\n", error.what());
    return 1;
  }
}
