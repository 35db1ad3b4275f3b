#include "cli/run_program.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "chip/chip.hpp"
#include "cli/about.hpp"
#include "cli/exit_code.hpp"
#include "cli/folders.hpp"
#include "cli/help.hpp"
#include "cli/inspecting_run.hpp"
#include "cli/refusal.hpp"
#include "files/unfinished.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "scene/scene_cache.hpp"

namespace raypool {
namespace {

/// The end of --help.
std::string exit_codes() {
  std::string text = "Exit codes:\n";
  for (const ExitCode& row : kExitCodes) text += fmt::format("  {}  {}\n", row.code, row.meaning);
  return text;
}

CLI::App& with_help(CLI::App& app) {
  app.formatter(help_formatter());
  app.set_help_flag("-h,--help", "print this help");
  return app;
}

/// The commands with their options, as CLI11 takes them.
class CommandLine {
 public:
  CommandLine(const std::vector<std::string>& words, AddCommands add) : commands_(add(with_help(app_), words, code_)) {
    app_.require_subcommand(1);
    app_.set_help_all_flag("--help-all", "help of every command");
    app_.set_version_flag(
        "--version", [] { return about(); }, "version, and those of the libraries");
    app_.footer(exit_codes());
  }
  /// Parses, runs the command and returns its exit code.
  int run(int argc, char** argv);

 private:
  CLI::App app_{
      "raypool: a ray-tracing GPU to render on, measure, verify and synthesise\n"
      "Begin with raypool sim room; raypool COMMAND --help lists the options of a command.",
      "raypool"};
  int code_ = 0;
  std::shared_ptr<void> commands_;  // what options and callbacks refer to
};

int CommandLine::run(int argc, char** argv) {
  try {
    app_.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app_.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "raypool: %s\n", refusal(app_, error).c_str());
    return kInputFailure;
  }
  return code_;
}

/// What has been printed is a result too: lost, it is an error.
int close_output(int code) {
  const bool lost = std::ferror(stdout) != 0;
  int error = std::fflush(stdout) != 0 ? errno : 0;
  // Why a write before this one failed is forgotten: one more is asked for the reason.
  if (lost && error == 0) error = write(STDOUT_FILENO, "\n", 1) < 0 ? errno : EIO;
  // Network file systems report a full disk when the file is closed; one that was closed before is none.
  if (std::fclose(stdout) != 0 && error == 0 && errno != EBADF) error = errno;
  if (error == 0) return code;
  std::fprintf(stderr, "raypool: cannot write to standard output (%s): what was printed is not complete\n",
               std::strerror(error));
  return code == 0 ? kInputFailure : code;
}

/// Runs a command; what it throws becomes a sentence and an exit code.
int run_and_report(int argc, char** argv, AddCommands add) {
  try {
    return CommandLine({argv, argv + argc}, add).run(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "raypool: %s\n", error.what());
    return kInputFailure;
  } catch (const LockstepDifference& difference) {
    if (difference.inspect_until != 0 && run_inspecting(argc, argv, difference)) return kDifference;
    std::fprintf(stderr, "raypool: %s\n", difference.what());
    return kDifference;
  } catch (const ChipStalled& stalled) {
    std::fprintf(stderr, "raypool: %s\n", stalled.what());
    return kOtherFailure;
  } catch (const Stopped& stopped) {
    std::fprintf(stderr, "raypool: %s\n", stopped.what());
    return kOtherFailure;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return kInputFailure;  // which close_output() reports
    std::fprintf(stderr, "raypool: failed: %s\n", error.what());
    return kOtherFailure;
  }
}

}  // namespace

int run_program(int argc, char** argv, AddCommands add) {
  handle_stop_signals();
  if (const std::string folder = scenes_folder().string(); !folder.empty()) SceneCache::use(SceneCache(folder));
  tell_unfinished([](const std::string& what) { std::fprintf(stderr, "raypool: %s\n", what.c_str()); });
  const int code = close_output(run_and_report(argc, argv, add));
  if (const int signal = stop_signal()) end_by(signal);
  return code;
}

}  // namespace raypool
