#include "chip/chip_clock.hpp"

#include <utility>

namespace raypool::chip {

namespace {

// sc_time has no constructor from an integer number of its resolution but this one.
sc_core::sc_time picoseconds(uint64_t value) { return sc_core::sc_time::from_value(value); }

}  // namespace

ChipClock::ChipClock(const sc_core::sc_module_name& name) : sc_module(name) {
  SC_METHOD(advance);
  sensitive << tick_;
  dont_initialize();
}

void ChipClock::wake() {
  if (awake_++ > 0 || ticking_) return;
  ticking_ = true;
  tick_.notify(picoseconds(kCycle - sc_core::sc_time_stamp().value() % kCycle));
}

void ChipClock::advance() {
  ticking_ = awake_ > 0 && !stopped_;
  if (ticking_) tick_.notify(picoseconds(kCycle));
}

void ChipClock::notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later) const {
  const uint64_t now = sc_core::sc_time_stamp().value() % kCycle;
  const uint64_t then = static_cast<uint64_t>(phase) * kPhase + cycles_later * kCycle;
  event.notify(picoseconds(then > now ? then - now : then + kCycle - now));
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
