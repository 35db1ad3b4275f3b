#include "chip/progress_watch.hpp"

#include <fmt/format.h>

#include <utility>

namespace raypool::chip {

ProgressWatch::State ProgressWatch::look(uint64_t cycle, const WorkDone& done) {
  const WorkDone before = std::exchange(before_, done);
  const bool due = done.due > cycle && done.due < kFarAway;
  silent_ = done.other == before.other && !due && cycle != 0 ? silent_ + period_ : 0;
  if (silent_ == 0) return State::GoesOn;
  if (done.instructions == before.instructions) return State::LockedUp;
  return silent_limit_ != 0 && silent_ >= silent_limit_ ? State::Silent : State::GoesOn;
}

std::string ProgressWatch::locked_up() const {
  return fmt::format(
      "the chip is locked up: for {} cycles no instruction has ended, nothing has been transferred or tested, and "
      "nothing is due",
      period_);
}

std::string ProgressWatch::silent() const {
  return fmt::format(
      "for {} cycles instructions have ended and nothing has been transferred, as in a program without "
      "end",
      silent_);
}

std::string limit_sentence(uint64_t limit, bool timed) {
  return fmt::format("the limit of {} {} has passed", limit, timed ? "cycles" : "instructions");
}

}  // namespace raypool::chip
