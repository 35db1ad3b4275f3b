#include "chip/chip_clock.hpp"

#include <algorithm>
#include <utility>

namespace raypool::chip {

namespace {

// sc_time has no constructor from an integer number of its resolution but this one.
sc_core::sc_time picoseconds(uint64_t value) { return sc_core::sc_time::from_value(value); }

}  // namespace

PortWork::PortWork(ChipClock& clock, std::function<void()> serve) : clock_(clock), serve_(std::move(serve)) {
  clock_.ports_.push_back(this);
}

void PortWork::ask(uint64_t cycles_later) {
  due_ = std::min(due_, clock_.cycle_ + cycles_later);
  clock_.port_due_ = std::min(clock_.port_due_, due_);
}

ChipClock::ChipClock(const sc_core::sc_module_name& name) : sc_module(name) {
  SC_METHOD(advance);
  sensitive << start_;
  dont_initialize();
}

// SystemC's time leads, except while the device runs on.
void ChipClock::follow() { cycle_ = std::max<uint64_t>(cycle_, sc_core::sc_time_stamp().value() / kCycle); }

void ChipClock::wake() {
  if (awake_++ > 0 || ticking_) return;
  ticking_ = true;
  follow();
  start_.notify(picoseconds((cycle_ + 1) * kCycle - sc_core::sc_time_stamp().value()));
}

void ChipClock::sleep() {
  --awake_;
  if (ahead_) ahead_ = ticking_ = false;
}

void ChipClock::advance() {
  guard([this] { serve_ports(cycle_); });
  ticking_ = awake_ > 0 && !stopped_;
  if (!ticking_) return;
  start_.notify(picoseconds(kCycle));
  tick_.notify(sc_core::SC_ZERO_TIME);
}

// The ports' work of the cycles before `cycle`, each with its own cycle's number. Work that has waited while the device slept is
// made up for.
void ChipClock::serve_ports(uint64_t before) {
  const uint64_t now = cycle_;
  while (port_due_ < before) {
    cycle_ = port_due_;
    for (PortWork* port : ports_) {
      if (port->due_ > cycle_) continue;
      port->due_ = PortWork::kNever;
      port->serve_();
    }
    port_due_ = PortWork::kNever;
    for (const PortWork* port : ports_) port_due_ = std::min(port_due_, port->due_);
  }
  cycle_ = now;
}

uint64_t ChipClock::quiet_cycles() const {
  if (!ahead_) return 1;
  uint64_t cycles = limit_ / kCycle - cycle_;
  if (port_due_ != PortWork::kNever) cycles = std::min(cycles, port_due_ >= cycle_ ? port_due_ - cycle_ + 1 : 1);
  return std::max<uint64_t>(cycles, 1);
}

bool ChipClock::run_on() {
  if (stopped_ || awake_ != 1) return false;
  if (!ahead_) {
    start_.cancel();
    ahead_ = true;
    const sc_core::sc_time next = sc_core::sc_time_to_pending_activity(sc_core::sc_get_curr_simcontext());
    limit_ = next == sc_core::sc_max_time() ? UINT64_MAX : sc_core::sc_time_stamp().value() + next.value();
  }
  if (limit_ / kCycle <= cycle_) {
    ahead_ = false;
    start_.notify(picoseconds((cycle_ + 1) * kCycle - sc_core::sc_time_stamp().value()));
    return false;
  }
  if (port_due_ <= cycle_) serve_ports(cycle_ + 1);
  ++cycle_;
  return true;
}

void ChipClock::notify(sc_core::sc_event& event, Phase phase, uint64_t cycles_later) {
  const uint64_t time = sc_core::sc_time_stamp().value();
  const uint64_t now = std::max<uint64_t>(time, cycle_ * kCycle);
  uint64_t then = (now / kCycle + cycles_later) * kCycle + static_cast<uint64_t>(phase) * kPhase;
  if (then <= now) then += kCycle;
  limit_ = std::min(limit_, then);
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
