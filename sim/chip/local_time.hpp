// Temporal decoupling of a clocked process, as TLM-2.0 calls it. A cycle is 1 ns.
//
// A call of a SystemC process costs as much as a cycle of a small model. So the process runs on, cycle after cycle of a
// local time ahead of SystemC's, until its quantum is used up. The quantum is not a constant that trades accuracy for
// speed: it ends where SystemC has its next event, so nothing else could have acted in between.
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <systemc>

namespace raypool::chip {

inline constexpr uint64_t kCyclePicoseconds = 1000;  ///< of SystemC's time, which has a resolution of 1 ps

class LocalTime {
 public:
  /// Number of the present cycle, which begins so many ns after the start of the simulation.
  uint64_t cycle() const { return cycle_; }
  void advance(uint64_t cycles) { cycle_ += cycles; }
  /// Cycles from the present one on that may pass before SystemC has an event; at least 1.
  uint64_t left() const { return need_sync() ? 1 : quantum_end_ - cycle_; }
  /// To be called first when the process resumes: in the first cycle that begins at SystemC's time or later.
  void resume();
  /// True if SystemC has an event before the present cycle begins, or at its very beginning: that comes first.
  bool need_sync() const { return cycle_ >= quantum_end_; }
  bool ahead() const;  ///< of SystemC's time
  /// To be called after whatever may have notified an event.
  void compute_quantum();

  /// From SystemC's time to the beginning of a cycle; no time if that is past.
  static sc_core::sc_time until(uint64_t cycle);
  /// The first cycle that begins when what takes so long from SystemC's time on is over; kNever: beyond the time that
  /// SystemC has.
  static uint64_t cycle_after(const sc_core::sc_time& delay);

 private:
  uint64_t cycle_ = 0;
  uint64_t quantum_end_ = 0;  // the first cycle that must wait for SystemC
};

/// What the processes of a module throw must not reach SystemC, which would make errors of its own of it: the first
/// exception is kept, and stops the simulation.
class ProcessErrors {
 public:
  template <typename Body>
  void guard(Body body) {
    if (error_) return;
    try {
      body();
    } catch (...) {
      error_ = std::current_exception();
      sc_core::sc_stop();
    }
  }
  /// After the simulation.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::exception_ptr error_;
};

}  // namespace raypool::chip
