#include "cli/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace raypool {
namespace {
constexpr std::chrono::milliseconds kTerminalInterval(200);
constexpr std::chrono::seconds kLogInterval(5);
}  // namespace

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {
  next_ = terminal_ ? begin_ + kTerminalInterval : begin_ + kLogInterval;
}

// The line goes away, so that what follows starts clean.
Progress::~Progress() {
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::show(const std::string& text) {
  if (quiet_) return;
  shown_ = true;
  if (terminal_) {
    std::fprintf(stderr, "\r\033[K%s", text.c_str());
    next_ = Clock::now() + kTerminalInterval;
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
    next_ = Clock::now() + kLogInterval;
  }
  std::fflush(stderr);
}

}  // namespace raypool
