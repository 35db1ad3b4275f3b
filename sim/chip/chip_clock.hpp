// The chip's 1 GHz clock, the phases into which a cycle is cut, and the end of a run.
//
// A cycle is 1 ns. Units run at its beginning; what they hand over is dealt with in the later phases of the same cycle, so that
// no result depends on the order in which SystemC runs processes. The clock ticks only while a unit is awake.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <systemc>

namespace raypool::chip {

/// Where in a cycle something happens.
enum class Phase : uint8_t {
  Units = 0,       ///< outputs are read, inputs decided, units clocked
  Traverser = 1,   ///< rays become intersections
  Controller = 2,  ///< kernels are chosen
  Ports = 3,       ///< pool and memory ports choose whom to serve
};

class ChipClock : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(ChipClock);
  explicit ChipClock(const sc_core::sc_module_name& name);

  /// Number of the present cycle.
  uint64_t cycle() const { return sc_core::sc_time_stamp().value() / kCycle; }
  /// Beginning of every cycle in which some unit is awake.
  const sc_core::sc_event& tick() const { return tick_; }

  /// Units count themselves in and out.
  void wake();
  void sleep() { --awake_; }

  /// Triggers `event` in the coming `phase` of this cycle, or of a later one. An earlier notification that is pending stays.
  void notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later = 0) const;

  /// Ends the run at once. With an error, rethrow() throws it.
  void stop();
  void fail(std::exception_ptr error);
  bool stopped() const { return stopped_; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

  /// Runs the body of a process: what it throws ends the run. Exceptions must not reach SystemC, which would turn them into its
  /// own.
  template <typename Body>
  void guard(Body body) {
    if (stopped_) return;
    try {
      body();
    } catch (...) {
      fail(std::current_exception());
    }
  }

 private:
  static constexpr uint64_t kCycle = 1000;  // in ps, SystemC's resolution
  static constexpr uint64_t kPhase = 250;

  void advance();

  sc_core::sc_event tick_;
  int awake_ = 0;
  bool ticking_ = false;  // a tick is pending
  bool stopped_ = false;
  std::exception_ptr error_;
};

}  // namespace raypool::chip
