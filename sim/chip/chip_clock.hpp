// The chip's 1 GHz clock, the phases into which a cycle is cut, temporal decoupling, and the end of a run.
//
// A cycle is 1 ns. Units run at its beginning; what they hand over is dealt with in the later phases of the same cycle,
// so that no result depends on the order in which SystemC runs processes.
//
// A SystemC process costs more than a cycle of the golden model. So who drives the device is temporally decoupled, as
// TLM-2.0 calls it: in one call of its process it runs on, cycle after cycle of a local time, until its quantum is used
// up. The quantum is no constant that trades time for speed: it ends with the cycle in which SystemC has the next
// event, so that nobody else could have said anything meanwhile. Notifications are relative to the local time, and
// shorten the quantum.
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <systemc>

namespace raypool::chip {

/// Where in a cycle something happens.
enum class Phase : uint8_t {
  Units = 0,       ///< outputs are read, inputs decided, units clocked
  Traverser = 1,   ///< rays become intersections
  Controller = 2,  ///< kernels are chosen
  Monitor = 3,     ///< somebody looks at it all
};

inline constexpr uint64_t kCyclePicoseconds = 1000;  ///< of SystemC's time, the resolution of which is 1 ps

/// The clock, for every module.
class TimeIf : virtual public sc_core::sc_interface {
 public:
  /// Number of the present cycle: of SystemC's time, or of the local time of who runs ahead of it.
  uint64_t cycle() const { return cycle_; }
  /// The beginning of a cycle, seen from SystemC's time. Not before it.
  virtual sc_core::sc_time until(uint64_t cycle) const = 0;
  /// The cycle in which what takes so long from SystemC's time on is over; kNever: not in the time that SystemC has.
  virtual uint64_t cycle_after(const sc_core::sc_time& time) const = 0;

  /// Triggers `event` in the coming `phase` of this cycle, or of a later one. An earlier notification that is pending
  /// stays.
  virtual void notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later = 0) = 0;

  // Temporal decoupling, for one process.
  /// The quantum ends with the cycle of SystemC's next event.
  virtual void compute_quantum() = 0;
  /// Cycles, counted from the present one, in which nobody else acts: at least 1.
  uint64_t quantum() const { return std::max(quantum_end_, cycle_ + 1) - cycle_; }
  /// True if somebody acts in the present cycle: its process must end before the next one.
  bool need_sync() const { return quantum_end_ <= cycle_ || stopped_; }
  void advance(uint64_t cycles) { cycle_ += cycles; }

  /// Ends the run at once. With an error, rethrow() throws it.
  virtual void stop() = 0;
  virtual void fail(std::exception_ptr error) = 0;

  /// Runs the body of a process: what it throws ends the run. Exceptions must not reach SystemC, which would turn them
  /// into its own.
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

 protected:
  virtual void follow() = 0;

  uint64_t cycle_ = 0;
  uint64_t quantum_end_ = 0;  // cycle of the next event
  bool stopped_ = false;
};

class ChipClock : public sc_core::sc_module, public TimeIf {
 public:
  explicit ChipClock(const sc_core::sc_module_name& name);

  sc_core::sc_export<TimeIf> now{"now"};

  sc_core::sc_time until(uint64_t cycle) const override;
  uint64_t cycle_after(const sc_core::sc_time& time) const override;
  void notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later = 0) override;
  void compute_quantum() override;
  void stop() override;
  void fail(std::exception_ptr error) override;
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void follow() override;

  std::exception_ptr error_;
};

}  // namespace raypool::chip
