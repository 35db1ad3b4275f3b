#include "chip/local_time.hpp"

#include "machine/common/port_cycles.hpp"

namespace raypool::chip {

namespace {

uint64_t systemc_time() { return sc_core::sc_time_stamp().value(); }
uint64_t first_cycle_from(uint64_t time) { return time / kCyclePicoseconds + (time % kCyclePicoseconds != 0); }

}  // namespace

void LocalTime::resume() {
  cycle_ = std::max(cycle_, first_cycle_from(systemc_time()));
  compute_quantum();
}

bool LocalTime::ahead() const { return cycle_ * kCyclePicoseconds > systemc_time(); }

// Without an event it is as long as SystemC's time.
void LocalTime::compute_quantum() {
  const sc_core::sc_time next = sc_core::sc_time_to_pending_activity(sc_core::sc_get_curr_simcontext());
  quantum_end_ = first_cycle_from(systemc_time() + next.value());
}

// sc_time has no other constructor from an integer number of its resolution.
sc_core::sc_time LocalTime::until(uint64_t cycle) {
  const uint64_t then = cycle * kCyclePicoseconds, now = systemc_time();
  return sc_core::sc_time::from_value(then - std::min(then, now));
}

uint64_t LocalTime::cycle_after(const sc_core::sc_time& delay) {
  if (delay >= sc_core::sc_max_time() - sc_core::sc_time_stamp()) return kNever;
  return first_cycle_from(systemc_time() + delay.value());
}

}  // namespace raypool::chip
