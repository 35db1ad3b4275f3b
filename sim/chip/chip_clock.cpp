#include "chip/chip_clock.hpp"

#include <utility>

#include "machine/port_cycles.hpp"

namespace raypool::chip {

namespace {

constexpr uint64_t kPhase = kCyclePicoseconds / 4;

// sc_time has no constructor from an integer number of its resolution but this one.
sc_core::sc_time picoseconds(uint64_t value) { return sc_core::sc_time::from_value(value); }

uint64_t systemc_time() { return sc_core::sc_time_stamp().value(); }

}  // namespace

ChipClock::ChipClock(const sc_core::sc_module_name& name) : sc_module(name) { now.bind(*this); }

sc_core::sc_time ChipClock::until(uint64_t cycle) const {
  const uint64_t then = cycle * kCyclePicoseconds;
  return picoseconds(then - std::min(then, systemc_time()));
}

uint64_t ChipClock::cycle_after(const sc_core::sc_time& time) const {
  // What takes all the time that there is never ends.
  if (time.value() > UINT64_MAX - systemc_time() - kCyclePicoseconds) return kNever;
  return (systemc_time() + time.value() + kCyclePicoseconds - 1) / kCyclePicoseconds;
}

// SystemC's time leads, except while a process is ahead of it.
void ChipClock::follow() { cycle_ = std::max(cycle_, systemc_time() / kCyclePicoseconds); }

// An event at the very beginning of a cycle comes before that cycle.
void ChipClock::compute_quantum() {
  const sc_core::sc_time next = sc_core::sc_time_to_pending_activity(sc_core::sc_get_curr_simcontext());
  quantum_end_ = next == sc_core::sc_max_time() ? UINT64_MAX : (systemc_time() + next.value() - 1) / kCyclePicoseconds;
}

void ChipClock::notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later) {
  const uint64_t time = systemc_time();
  const uint64_t present = std::max(time, cycle_ * kCyclePicoseconds);
  uint64_t then =
      (present / kCyclePicoseconds + cycles_later) * kCyclePicoseconds + static_cast<uint64_t>(phase) * kPhase;
  if (then <= present) then += kCyclePicoseconds;
  quantum_end_ = std::min(quantum_end_, then / kCyclePicoseconds);
  event.notify(picoseconds(then - time));
}

void ChipClock::stop() {
  if (stopped_) return;
  stopped_ = true;
  sc_core::sc_stop();
}

void ChipClock::fail(std::exception_ptr error) {
  if (!error_) error_ = std::move(error);
  stop();
}

}  // namespace raypool::chip
