// The chip's 1 GHz clock, the phases into which a cycle is cut, and the end of a run.
//
// A cycle is 1 ns. Units run at its beginning; what they hand over is dealt with in the later phases of the same cycle, so that
// no result depends on the order in which SystemC runs processes. The clock ticks only while a unit is awake.
//
// A SystemC process costs more than a cycle of the golden model. So whoever drives the device may run on, cycle after cycle
// within one process, as long as SystemC has nothing to do (run_on()): SystemC's time then stands still, cycle() goes on, and
// every notification is made relative to cycle(). What ports do in their phase needs no process for the same reason (PortWork).
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

namespace raypool::chip {

/// Where in a cycle something happens.
enum class Phase : uint8_t {
  Units = 0,       ///< outputs are read, inputs decided, units clocked
  Traverser = 1,   ///< rays become intersections
  Controller = 2,  ///< kernels are chosen
  Ports = 3,       ///< pool and memory ports choose whom to serve
};

class ChipClock;

/// What a pool or memory port does in the phase of the ports, in the cycles that it asks for.
class PortWork {
 public:
  static constexpr uint64_t kNever = UINT64_MAX;

  /// `clock` must outlive it. `serve` is called once for each time that is due.
  PortWork(ChipClock& clock, std::function<void()> serve);
  /// In this cycle, or a later one. An earlier one that has been asked for stays.
  void ask(uint64_t cycles_later = 0);

 private:
  friend class ChipClock;
  ChipClock& clock_;
  std::function<void()> serve_;
  uint64_t due_ = kNever;
};

class ChipClock : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(ChipClock);
  explicit ChipClock(const sc_core::sc_module_name& name);

  /// Number of the present cycle.
  uint64_t cycle() const { return cycle_; }
  /// Beginning of every cycle in which some unit is awake, and which was not run on to.
  const sc_core::sc_event& tick() const { return tick_; }

  /// Units count themselves in and out.
  void wake();
  void sleep();

  /// For the only process that is awake, at the end of its work in the phase of the units: true if it shall go on with the next
  /// cycle at once, which has begun then; false if something else comes first, and tick() will call it again.
  bool run_on();
  /// Cycles, counted from the present one, in which nothing but the units acts: at least 1.
  uint64_t quiet_cycles() const;
  /// The present cycle and those after it have been run together: `cycles` of them, at most quiet_cycles().
  void pass(uint64_t cycles) { cycle_ += cycles - 1; }

  /// Triggers `event` in the coming `phase` of this cycle, or of a later one. An earlier notification that is pending stays.
  void notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later = 0);

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
    follow();
    try {
      body();
    } catch (...) {
      fail(std::current_exception());
    }
  }

 private:
  static constexpr uint64_t kCycle = 1000;  // in ps, SystemC's resolution
  static constexpr uint64_t kPhase = 250;

  friend class PortWork;

  void advance();
  void follow();
  void serve_ports(uint64_t before);

  uint64_t cycle_ = 0;
  sc_core::sc_event start_, tick_;
  int awake_ = 0;
  bool ticking_ = false;  // start_ is pending, or held back while running on
  bool ahead_ = false;    // running on
  uint64_t limit_ = 0;    // while running on: SystemC's next event, in ps
  std::vector<PortWork*> ports_;
  uint64_t port_due_ = PortWork::kNever;  // earliest of them
  bool stopped_ = false;
  std::exception_ptr error_;
};

}  // namespace raypool::chip
