#include "cli/inspecting_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"

namespace raypool {
namespace {

/// Of the child. Standard output has what the first run has printed.
[[noreturn]] void execute(const std::vector<char*>& words, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (getppid() == parent && nowhere >= 0 && dup2(nowhere, STDOUT_FILENO) >= 0) execv("/proc/self/exe", words.data());
  _exit(kOtherFailure);
}

}  // namespace

bool run_inspecting(int argc, char** argv, const LockstepDifference& difference) {
  for (int i = 2; i < argc; ++i) {
    std::error_code none;
    if (!std::filesystem::is_fifo(argv[i], none)) continue;
    fmt::print(stderr, "raypool: '{}' can be read once only, so there is no second run with a look inside the RTL\n",
               argv[i]);
    return false;
  }
  const std::string report = difference.what();
  fmt::print(stderr, "raypool: {}, in cycle {}: running again up to it, with a look inside the RTL\n",
             report.substr(0, report.find('\n')), difference.inspect_until);
  std::fflush(nullptr);

  // Behind the command, where no `--` makes it something else.
  std::string inspect = fmt::format("--inspect={}", difference.inspect_until);
  std::vector<char*> words(argv, argv + argc);
  words.insert(words.begin() + 2, inspect.data());
  words.push_back(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) execute(words, parent);
  int status = 0;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == kDifference) return true;
  fmt::print(stderr, "raypool: the second run has not met the difference again; the report of the first one:\n");
  return false;
}

}  // namespace raypool
