// Shows how far a long run is: on a terminal one line that is rewritten, else a line every few seconds.
#pragma once

#include <chrono>
#include <string>

namespace raypool {

class Progress {
 public:
  /// Writes to standard error; nothing at all when `quiet`.
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// True when it is time for an update; cheap enough to ask often.
  bool due() const { return !quiet_ && std::chrono::steady_clock::now() >= next_; }
  void show(const std::string& text);
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point next_;
};

}  // namespace raypool
