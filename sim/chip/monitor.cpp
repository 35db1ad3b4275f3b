#include "chip/monitor.hpp"

#include <fmt/format.h>

#include "config/limits.hpp"

namespace raypool::chip {

Monitor::Monitor(const sc_core::sc_module_name& name, const MonitorOptions& options)
    : sc_module(name), options_(options), progress_(options.watchdog_cycles, options.limits.silent()) {
  SC_METHOD(show);
  sensitive << show_;
  dont_initialize();
  SC_METHOD(watch);
  sensitive << watch_;
  dont_initialize();
  SC_METHOD(limit);
  sensitive << limit_;
  dont_initialize();
  SC_METHOD(counted_out);
  sensitive << counted_out_;
  dont_initialize();
}

void Monitor::start_of_simulation() {
  if (options_.progress) clock->notify(show_, Phase::Monitor, progress_cycles());
  if (options_.watchdog_cycles > 0) clock->notify(watch_, Phase::Monitor, options_.watchdog_cycles);
  // No frame takes so long that wide ones do.
  if (options_.counters_of != nullptr && options_.counters_of->counter_bits < 40)
    clock->notify(counted_out_, Phase::Monitor, counted_cycles(*options_.counters_of));
  if (options_.limits.cycles > 0) clock->notify(limit_, Phase::Monitor, options_.timed ? options_.limits.cycles : 1);
}

void Monitor::counted_out() {
  clock->guard([&] {
    const Configuration& machine = *options_.counters_of;
    throw InputError(
        fmt::format("{} cycles have passed, and after so many a performance counter of {}, of {} bits, may have begun "
                    "anew: draw with --set counter_bits=48, or fit a configuration to this frame with raypool fit",
                    clock->cycle(), machine.name, machine.counter_bits));
  });
}

void Monitor::show() {
  clock->guard([&] {
    watched->show_progress();
    clock->notify(show_, Phase::Monitor, progress_cycles());
  });
}

void Monitor::watch() {
  clock->guard([&] {
    const uint64_t now = clock->cycle();
    switch (progress_.look(now, watched->work_done())) {
      case ProgressWatch::State::GoesOn:
        break;
      case ProgressWatch::State::LockedUp:
        throw ChipStalled(fmt::format("{}, at cycle {}; {}", progress_.locked_up(), now, watched->describe()));
      case ProgressWatch::State::Silent:
        throw LimitPassed(fmt::format("{}, at cycle {}", progress_.silent(), now), watched->describe());
    }
    clock->notify(watch_, Phase::Monitor, options_.watchdog_cycles);
  });
}

void Monitor::limit() {
  clock->guard([&] {
    if (options_.timed || watched->work_done().instructions > options_.limits.cycles)
      throw LimitPassed(limit_sentence(options_.limits.cycles, options_.timed), watched->describe());
    clock->notify(limit_, Phase::Monitor, 1);
  });
}

std::string Monitor::limit_sentence(uint64_t limit, bool timed) {
  return fmt::format("the limit of {} {} has passed", limit, timed ? "cycles" : "instructions");
}

}  // namespace raypool::chip
