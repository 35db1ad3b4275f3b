#include "faulty/trials.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>
#include <utility>

#include "isa/input_error.hpp"

namespace raypool::faulty {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// What a process shares with the one that started it.
struct Shared {
  Outcome::Kind kind;
  bool ended;
  uint64_t programs;
  std::array<char, 200> by;
  std::array<char, 20000> text;
};

template <size_t size>
void copy_text(std::string_view from, std::array<char, size>& to) {
  to[from.copy(to.data(), size - 1)] = '\0';
}

/// A child process that runs one trial.
struct Worker {
  pid_t pid;
  int pipe;            ///< its end of it is closed when it ends
  std::FILE* printed;  ///< by the simulator: it prints why it stops
  Shared* shared;
  size_t trial;
};

[[noreturn]] void run_here(const Trial& trial, Shared& shared, unsigned seconds_limit, int printed) {
  alarm(seconds_limit);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  dup2(printed, STDOUT_FILENO);
  dup2(printed, STDERR_FILENO);
  const Outcome outcome = trial.run([&shared](uint64_t programs, std::string_view by) {
    shared.programs = programs;
    copy_text(by, shared.by);
  });
  shared.kind = outcome.kind;
  shared.programs = outcome.programs;
  copy_text(outcome.by, shared.by);
  copy_text(outcome.text, shared.text);
  shared.ended = true;
  _exit(0);
}

Worker start(const Trial& trial, size_t index, unsigned seconds_limit) {
  int ends[2];
  std::FILE* printed = std::tmpfile();
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (printed == nullptr || memory == MAP_FAILED || pipe(ends) != 0)
    throw std::runtime_error("no memory, file or pipe for a process");
  auto* shared = new (memory) Shared{};
  std::fflush(nullptr);  // or the child would write it again
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("no process can be started");
  if (pid == 0) {
    close(ends[0]);
    run_here(trial, *shared, seconds_limit, fileno(printed));
  }
  close(ends[1]);
  return {pid, ends[0], printed, shared, index};
}

/// The last message of the simulator: the line that begins with %Error, if there is one.
std::string last_words(std::FILE* printed) {
  std::rewind(printed);
  std::string words;
  std::array<char, 1000> line;
  while (std::fgets(line.data(), line.size(), printed) != nullptr)
    if (words.rfind("%Error", 0) != 0) words = line.data();
  while (!words.empty() && words.back() == '\n') words.pop_back();
  return words;
}

Outcome finish(const Worker& worker) {
  close(worker.pipe);
  int status = 0;
  waitpid(worker.pid, &status, 0);
  const Shared& shared = *worker.shared;
  Outcome outcome{shared.kind, shared.programs, shared.by.data(), shared.text.data()};
  if (!shared.ended) {
    outcome.kind = Outcome::Kind::Crashed;
    outcome.text = WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status)) : "no result";
    const std::string words = last_words(worker.printed);
    if (!words.empty()) outcome.text += ": " + words;
  }
  munmap(worker.shared, sizeof(Shared));
  std::fclose(worker.printed);
  return outcome;
}

/// A line of the JSON file.
std::string to_json(const Trial& trial, const Outcome& outcome) {
  Json json = {{"id", trial.id}};
  json.update(trial.facts);
  json["outcome"] = name_of(outcome.kind);
  json["programs"] = outcome.programs;
  json["by"] = outcome.by;
  json["text"] = outcome.text;
  return json.dump() + "\n";
}

/// [id] its outcomes: trials that do not differ share one.
std::map<std::string, std::vector<Outcome>> read_outcomes(const std::string& path) {
  std::map<std::string, std::vector<Outcome>> outcomes;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const Json json = Json::parse(line);
    const auto kind = std::find(kKindNames.begin(), kKindNames.end(), json.at("outcome").get<std::string>());
    if (kind == kKindNames.end()) throw InputError(path + ": an outcome is unknown");
    outcomes[json.at("id").get<std::string>()].push_back(
        {static_cast<Outcome::Kind>(kind - kKindNames.begin()), json.at("programs").get<uint64_t>(),
         json.at("by").get<std::string>(), json.at("text").get<std::string>()});
  }
  return outcomes;
}

/// Shows now and then how far it is. Time left: as the trials so far took, which is too little while long ones are
/// under way.
class Progress {
 public:
  Progress(std::string what, size_t all) : what_(std::move(what)), all_(all) {}
  void show(size_t done) {
    const auto now = Clock::now();
    if (done == 0 || now - shown_ < std::chrono::seconds(10)) return;
    shown_ = now;
    const double spent = std::chrono::duration<double>(now - begin_).count();
    fmt::print(stderr, "{}: {} of {} done, about {:.0f} s left\n", what_, done, all_,
               spent * static_cast<double>(all_ - done) / done);
  }

 private:
  std::string what_;
  size_t all_;
  Clock::time_point begin_ = Clock::now(), shown_ = begin_;
};

}  // namespace

std::vector<Outcome> run_trials(const std::vector<Trial>& trials, const TrialOptions& options) {
  std::vector<Outcome> outcomes(trials.size());
  std::vector<size_t> todo;
  std::map<std::string, std::vector<Outcome>> known;
  if (options.resume) known = read_outcomes(options.json);
  for (size_t i = 0; i < trials.size(); ++i) {
    const auto found = known.find(trials[i].id);
    if (found == known.end() || found->second.empty()) {
      todo.push_back(i);
      continue;
    }
    outcomes[i] = found->second.back();
    found->second.pop_back();
  }
  std::ofstream file;
  if (!options.json.empty()) file.open(options.json, options.resume ? std::ios::app : std::ios::out);
  std::vector<Worker> workers;
  Progress progress(options.what, todo.size());
  for (size_t next = 0, done = 0; done < todo.size();) {
    while (workers.size() < options.jobs && next < todo.size()) {
      workers.push_back(start(trials[todo[next]], todo[next], options.seconds_limit));
      ++next;
    }
    std::vector<pollfd> polls;
    polls.reserve(workers.size());
    for (const Worker& worker : workers) polls.push_back({worker.pipe, POLLIN, 0});
    poll(polls.data(), polls.size(), 5000);
    for (size_t i = workers.size(); i-- > 0;) {
      if (polls[i].revents == 0) continue;
      const size_t finished = workers[i].trial;
      outcomes[finished] = finish(workers[i]);
      if (file.is_open()) file << to_json(trials[finished], outcomes[finished]) << std::flush;
      workers.erase(workers.begin() + i);
      ++done;
    }
    progress.show(done);
  }
  return outcomes;
}

Outcome run_trial(const Trial& trial) { return finish(start(trial, 0, TrialOptions().seconds_limit)); }

}  // namespace raypool::faulty
