// `raypool referee`: hard rays and triangles, their hits in rational numbers, and the implementations that differ.
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "cli/command_options.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/progress.hpp"
#include "commands/commands.hpp"
#include "config/configuration.hpp"
#include "files/output_files.hpp"
#include "referee/chip_contender.hpp"
#include "referee/corpus.hpp"
#include "referee/corpus_file.hpp"
#include "referee/hardware.hpp"
#include "referee/table.hpp"
#include "scene/threads.hpp"

namespace raypool {
namespace {

/// The cases of a file, or drawn ones.
referee::CaseSource cases_of(const RefereeCommandOptions& options) {
  if (options.corpus.empty()) {
    return {options.cases, [seed = options.seed](uint64_t number) { return referee::hard_case(seed, number); }};
  }
  // Numbered as they stand in the file, whatever their own numbers are.
  std::vector<HitCase> cases = referee::read_corpus(options.corpus);
  for (size_t i = 0; i < cases.size(); ++i) cases[i].number = i;
  const uint64_t count = cases.size();
  return {count, [cases = std::move(cases)](uint64_t number) { return cases[number]; }};
}

/// The file is read before anything is written, which may be the same.
int write_corpus(const RefereeCommandOptions& options, const referee::CaseSource& cases) {
  OutputFiles files;
  std::ofstream out(files.begin(options.write), std::ios::binary);
  for (uint64_t i = 0; i < cases.count && out; ++i) {
    const HitCase hit_case = cases.at(i);
    out << referee::to_line(hit_case, referee::certify(hit_case)) << '\n';
  }
  if (!out.flush()) throw InputError(fmt::format("{}: cannot be written: {}", options.write, std::strerror(errno)));
  out.close();
  files.publish();
  return kDone;
}

}  // namespace

void add_referee_options(CLI::App& app, RefereeCommandOptions& options) {
  CLI::Option* const cases = app.add_option("--cases", options.cases, "hard cases, drawn")
                                 ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 30))
                                 ->capture_default_str();
  CLI::Option* const seed = app.add_option("--seed", options.seed, "of these")->capture_default_str();
  app.add_option("--corpus", options.corpus, "cases of a file instead (docs/use/referee.md)")
      ->type_name("FILE")
      ->excludes(cases, seed);
  app.add_option("--write", options.write, "only write the cases, with their certificates")->type_name("FILE");
  app.add_option("--answers", options.answers, "answers of another program, as a row; may be given several times")
      ->type_name("FILE")
      ->expected(1, -1)
      ->allow_extra_args(false);
  app.add_option("--on-chip", options.on_chip,
                 "a whole chip answers too, each case a frame; raypool unit --boundary chip builds its Verilog")
      ->type_name("model|rtl|lockstep");
  add_config(app, options.config, options.set);
  app.add_flag("--smallest", options.smallest, "the smallest case of each fault");
  add_threads(app, options.threads, "threads");
  app.add_flag("--quiet", options.quiet, "no progress");
}

namespace {

/// The chip of --on-chip, a contender for each thread; empty: there is none.
std::function<std::unique_ptr<referee::Contender>()> chip_of(const RefereeCommandOptions& options) {
  if (options.on_chip.empty()) return {};
  const Engine engine = parse_engine(options.on_chip);
  if (engine != Engine::Model && !has_verilog(engine))
    throw InputError(fmt::format("--on-chip is '{}'; use model, rtl or lockstep", options.on_chip));
  const Configuration configuration = load_configuration(options.config, options.set);
  if (!has_traverser(configuration.chip) || configuration.intersection_words != kIntersectionWords) {
    throw InputError(fmt::format(
        "{}: a chip that answers has its traverser inside and whole records of intersections: leave chip.traverser and "
        "intersection_words as they are by default",
        configuration.name));
  }
  return [=] {
    return referee::chip_answers(fmt::format("chip, {}", options.on_chip), configuration, chip_maker(engine));
  };
}

}  // namespace

int referee_command(const RefereeCommandOptions& options, const std::function<referee::Contenders()>& others) {
  const referee::CaseSource cases = cases_of(options);
  if (!options.write.empty()) return write_corpus(options, cases);
  Progress progress(options.quiet);
  referee::RefereeOptions match;
  match.threads = threads_or_all(options.threads);
  match.minimises = options.smallest;
  match.progress = [&](double share) {
    if (progress.due()) progress.show(fmt::format("  {:.0f}% of the cases", 100 * share));
  };
  std::vector<referee::RecordedAnswers> recorded;
  for (const std::string& file : options.answers) recorded.push_back(referee::read_answers(file, cases.count));
  const auto chip = chip_of(options);
  const auto contenders = [&] {
    referee::Contenders all;
    all.push_back(referee::our_answers());
    if (chip) all.push_back(chip());
    for (const referee::RecordedAnswers& each : recorded) all.push_back(referee::contender_of(each));
    if (others) {
      for (auto& each : others()) all.push_back(std::move(each));
    }
    return all;
  };
  const std::vector<referee::Row> rows = referee::hold_match(cases, contenders, match);
  fmt::print("{} cases: answers that are wrong, and errors of t of the right hits in units in the last place\n{}",
             cases.count, referee::table_of(rows));
  if (options.smallest) fmt::print("\nthe smallest cases\n{}", referee::smallest_cases_of(rows));
  return kDone;
}

}  // namespace raypool
