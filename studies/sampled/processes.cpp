#include "sampled/processes.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "isa/input_error.hpp"

namespace raypool::sampled {
namespace {

// How a process's answer begins.
constexpr char kResult = 'r', kBadInput = 'i', kFailure = 'f';

class Process {
 public:
  Process(size_t number, const std::function<std::string(size_t)>& work) : task(number) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error(fmt::format("no pipe to a process: {}", std::strerror(errno)));
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ < 0) {
      const int error = errno;
      close(ends[0]);
      close(ends[1]);
      throw std::runtime_error(fmt::format("no process for a part of the sample: {}", std::strerror(error)));
    }
    if (id_ == 0) {
      // It ends with this process, however that ends.
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(1);
      close(ends[0]);
      _exit(answer(ends[1], work) ? 0 : 1);
    }
    close(ends[1]);
    pipe_ = ends[0];
  }
  ~Process() {
    if (pipe_ >= 0) close(pipe_);
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  Process(Process&& other) noexcept
      : task(other.task),
        id_(std::exchange(other.id_, 0)),
        pipe_(std::exchange(other.pipe_, -1)),
        text_(std::move(other.text_)) {}
  Process& operator=(Process&&) = delete;

  /// To be read when something has come. False: it has ended.
  bool read_more() {
    char buffer[1 << 16];
    const ssize_t count = read(pipe_, buffer, sizeof buffer);
    if (count > 0) text_.append(buffer, static_cast<size_t>(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }

  /// What its work returned, after the end.
  std::string result() {
    const int status = wait();
    id_ = 0;
    if (WIFSIGNALED(status)) {
      throw std::runtime_error(fmt::format("the process of a part of the sample was ended by signal {} ({})",
                                           WTERMSIG(status), strsignal(WTERMSIG(status))));
    }
    if (WEXITSTATUS(status) != 0 || text_.empty())
      throw std::runtime_error(fmt::format("the process of a part of the sample ended with {}", WEXITSTATUS(status)));
    if (text_[0] == kBadInput) throw InputError(text_.substr(1));
    if (text_[0] == kFailure) throw std::runtime_error(text_.substr(1));
    return text_.substr(1);
  }

  int pipe() const { return pipe_; }

  size_t task;

 private:
  bool answer(int to, const std::function<std::string(size_t)>& work) const {
    std::string text;
    try {
      text = kResult + work(task);
    } catch (const InputError& error) {
      text = kBadInput + std::string(error.what());
    } catch (const std::exception& error) {
      text = kFailure + std::string(error.what());
    }
    for (size_t sent = 0; sent < text.size();) {
      const ssize_t count = write(to, text.data() + sent, text.size() - sent);
      if (count < 0 && errno != EINTR) return false;
      if (count > 0) sent += static_cast<size_t>(count);
    }
    return true;
  }

  int wait() const {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) continue;
    return status;
  }

  pid_t id_ = 0;
  int pipe_ = -1;
  std::string text_;
};

}  // namespace

std::vector<std::string> in_processes(size_t tasks, uint32_t at_a_time, const std::function<std::string(size_t)>& work,
                                      const std::function<void(size_t, const std::string&)>& done) {
  std::vector<std::string> results(tasks);
  std::vector<Process> running;
  for (size_t next = 0; next < tasks || !running.empty();) {
    for (; next < tasks && running.size() < std::max(1u, at_a_time); ++next) running.emplace_back(next, work);
    std::vector<pollfd> waits;
    for (const Process& process : running) waits.push_back({process.pipe(), POLLIN, 0});
    if (poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("cannot wait for processes: {}", std::strerror(errno)));
    std::vector<Process> still;
    for (size_t i = 0; i < running.size(); ++i) {
      if (waits[i].revents == 0 || running[i].read_more()) {
        still.push_back(std::move(running[i]));
        continue;
      }
      std::string& result = results[running[i].task];
      result = running[i].result();
      if (done) done(running[i].task, result);
    }
    running = std::move(still);
  }
  return results;
}

}  // namespace raypool::sampled
