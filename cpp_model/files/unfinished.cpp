#include "files/unfinished.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace raypool {
namespace {

namespace fs = std::filesystem;

constexpr std::array<int, 4> kStopSignals = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
constexpr time_t kPatience = 2;  // seconds

// What a handler may look at: lock-free, and of this process, not of one that it has forked.
struct UnfinishedPath {
  std::atomic<bool> taken{false}, valid{false};
  std::array<char, PATH_MAX> path{};
};
// More files are hardly ever written at once; those have to be cleared by the next run.
std::array<UnfinishedPath, 16> places;
std::atomic<int> keepers{0}, first_signal{0};
std::atomic<time_t> first_time{0};
pid_t owner = 0;

time_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec;
}

void on_signal(int number) {
  const int error = errno;
  if (getpid() == owner) {
    int none = 0;
    if (keepers > 0) {
      time_t never = 0;
      first_time.compare_exchange_strong(never, now());
      first_signal.compare_exchange_strong(none, number);
      // One Ctrl-C or one `timeout` may come as several signals.
      if (now() - first_time < kPatience) {
        errno = error;
        return;
      }
    } else {
      for (const UnfinishedPath& place : places)
        if (place.valid) unlink(place.path.data());
    }
  }
  // The signal is blocked in its handler: it ends the program on the way out.
  std::signal(number, SIG_DFL);
  raise(number);
  errno = error;
}

/// A process that clears a folder holds it for a moment only.
void hold(int folder) {
  for (int turn = 0; turn < 50 && flock(folder, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++turn)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

std::function<void(const std::string&)>& teller() {
  static std::function<void(const std::string&)> tell;
  return tell;
}

/// The process number in ".PID.NAME" or ".PID.NAME.hier"; empty: something else.
std::string process_of(const std::string& file, const std::string& name) {
  if (file.size() < 3 || file[0] != '.') return "";
  const size_t dot = file.find('.', 1);
  if (dot == std::string::npos || dot == 1 || file.find_first_not_of("0123456789", 1) != dot) return "";
  const std::string rest = file.substr(dot + 1);
  return rest == name || rest == name + ".hier" ? file.substr(1, dot - 1) : "";
}

}  // namespace

Stopped::Stopped(int which)
    : std::runtime_error(fmt::format("stopped by SIG{} ({})", sigabbrev_np(which), strsignal(which))), signal(which) {}

void handle_stop_signals() {
  owner = getpid();
  for (const int number : kStopSignals) {
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (const int other : kStopSignals) sigaddset(&action.sa_mask, other);
    sigaction(number, &action, nullptr);
  }
}

KeepRunning::KeepRunning() { ++keepers; }
KeepRunning::~KeepRunning() { --keepers; }

void stop_point() {
  const int number = first_signal.load(std::memory_order_relaxed);
  if (number != 0) throw Stopped(number);
}

int stop_signal() { return first_signal; }

void end_by(int signal) {
  std::signal(signal, SIG_DFL);
  raise(signal);
  std::_Exit(128 + signal);
}

RemovedWhenStopped::RemovedWhenStopped(const fs::path& path) {
  if (path.native().size() >= PATH_MAX) return;
  for (size_t i = 0; i < places.size(); ++i) {
    bool free = false;
    if (!places[i].taken.compare_exchange_strong(free, true)) continue;
    std::memcpy(places[i].path.data(), path.c_str(), path.native().size() + 1);
    places[i].valid = true;
    place_ = static_cast<int>(i);
    return;
  }
}

RemovedWhenStopped::~RemovedWhenStopped() {
  if (place_ < 0) return;
  places[place_].valid = false;
  places[place_].taken = false;
}

RemovedWhenStopped::RemovedWhenStopped(RemovedWhenStopped&& other) noexcept : place_(std::exchange(other.place_, -1)) {}
RemovedWhenStopped& RemovedWhenStopped::operator=(RemovedWhenStopped&& other) noexcept {
  std::swap(place_, other.place_);
  return *this;
}

FolderHold::FolderHold(const fs::path& folder) : folder_(folder.empty() ? "." : folder) {
  file_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file_ >= 0) hold(file_);
}

FolderHold::~FolderHold() {
  if (file_ >= 0) close(file_);
}

FolderHold::FolderHold(FolderHold&& other) noexcept
    : folder_(std::move(other.folder_)), file_(std::exchange(other.file_, -1)) {}
FolderHold& FolderHold::operator=(FolderHold&& other) noexcept {
  std::swap(folder_, other.folder_);
  std::swap(file_, other.file_);
  return *this;
}

void FolderHold::clear(const std::string& name) {
  if (file_ < 0 || flock(file_, LOCK_EX | LOCK_NB) != 0) {
    if (file_ >= 0) hold(file_);
    return;
  }
  std::vector<fs::path> left;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error))
    if (!process_of(entry->path().filename(), name).empty()) left.push_back(entry->path());
  const bool keep = fs::path(name).extension() == ".fst";
  for (const fs::path& path : left) {
    const std::string file = path.filename(), process = process_of(file, name);
    std::error_code failed;
    const bool empty = fs::file_size(path, failed) == 0;
    const fs::path kept = folder_ / fmt::format("killed-{}-{}", process, file.substr(process.size() + 2));
    if (keep && !empty)
      fs::rename(path, kept, failed);
    else
      fs::remove(path, failed);
    // Parts of a waveform are not reported one by one.
    if (failed || !teller() || file.size() != process.size() + 2 + name.size()) continue;
    teller()(keep && !empty ? fmt::format("a run that was killed left its waveform: it is {} now", kept.string())
                            : fmt::format("removed {}, which a run that was killed left unfinished", path.string()));
  }
  hold(file_);
}

std::string temporary_name(const std::string& name) { return fmt::format(".{}.{}", getpid(), name); }

void tell_unfinished(std::function<void(const std::string&)> tell) { teller() = std::move(tell); }

}  // namespace raypool
