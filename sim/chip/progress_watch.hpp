// Whether a chip goes on: asked now and then with what has been done so far, and what is due.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "machine/common/port_cycles.hpp"

namespace raypool::chip {

/// A cycle that no run comes to: what is due then or later never happens.
inline constexpr uint64_t kFarAway = kNever / 2;

/// Between two calls of a run's `progress`.
inline constexpr uint64_t kProgressCycles = 16384;

/// Counts rise, and never fall.
struct WorkDone {
  uint64_t instructions = 0;
  /// Transfers at ports, and what blocks do within: tests of the traverser, lines that come to it.
  uint64_t other = 0;
  /// A later cycle in which something is going to happen, whatever the others do: an answer of the memory comes, or
  /// rays are traced. kNever: nothing that is known. To be right only where the counts stand still.
  uint64_t due = kNever;
};

class ProgressWatch {
 public:
  /// `period`: cycles between two looks; `silent_cycles`: after which State::Silent, whole periods; 0: never.
  ProgressWatch(uint64_t period, uint64_t silent_cycles) : period_(period), silent_limit_(silent_cycles) {}

  enum class State : uint8_t {
    GoesOn,
    LockedUp,  ///< nothing has been done for a period, and nothing is due
    Silent     ///< instructions end, and nothing else has happened for too long
  };
  State look(uint64_t cycle, const WorkDone& done);

  /// The beginning of a sentence.
  std::string locked_up() const;
  std::string silent() const;

 private:
  uint64_t period_, silent_limit_;
  WorkDone before_;
  uint64_t silent_ = 0;  // cycles without other work
};

/// The beginning of a sentence: what has passed. Without time the limit is of instructions.
std::string limit_sentence(uint64_t limit, bool timed);

}  // namespace raypool::chip
