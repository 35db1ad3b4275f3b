#include "chip/monitor.hpp"

#include <fmt/format.h>

#include <utility>

#include "chip/chip.hpp"

namespace raypool::chip {

Monitor::Monitor(const sc_core::sc_module_name& name, ChipClock& clock, MonitorOptions options)
    : sc_module(name), clock_(clock), options_(std::move(options)) {
  SC_METHOD(show);
  sensitive << show_;
  dont_initialize();
  SC_METHOD(watch);
  sensitive << watch_;
  dont_initialize();
  SC_METHOD(limit);
  sensitive << limit_;
  dont_initialize();
  if (options_.progress) clock_.notify(show_, Phase::Ports, progress_cycles());
  if (options_.watchdog_cycles > 0) clock_.notify(watch_, Phase::Ports, options_.watchdog_cycles);
  if (options_.cycle_limit > 0) clock_.notify(limit_, Phase::Ports, options_.timed ? options_.cycle_limit : 1);
}

void Monitor::show() {
  clock_.guard([&] {
    options_.progress();
    clock_.notify(show_, Phase::Ports, progress_cycles());
  });
}

void Monitor::watch() {
  clock_.guard([&] {
    const uint64_t retired = options_.retired(), transfers = options_.transfers();
    silent_ = transfers == transfers_ ? silent_ + 1 : 0;
    if (silent_ > 0 && retired == retired_) {
      throw ChipStalled(fmt::format(
          "the chip is locked up: no instruction has ended and nothing has been transferred for {} cycles, at cycle {}; {}",
          options_.watchdog_cycles, clock_.cycle(), options_.describe()));
    }
    if (silent_ >= kSilentPeriods) {
      throw ChipStalled(fmt::format("a program runs without end: nothing has been transferred for {} cycles, at cycle {}; {}",
                                    kSilentPeriods * options_.watchdog_cycles, clock_.cycle(), options_.describe()));
    }
    retired_ = retired;
    transfers_ = transfers;
    clock_.notify(watch_, Phase::Ports, options_.watchdog_cycles);
  });
}

void Monitor::limit() {
  clock_.guard([&] {
    if (options_.timed || options_.retired() > options_.cycle_limit)
      throw ChipStalled(fmt::format("{}; {}", limit_sentence(options_.cycle_limit, options_.timed), options_.describe()));
    clock_.notify(limit_, Phase::Ports, 1);
  });
}

std::string Monitor::limit_sentence(uint64_t limit, bool timed) {
  return fmt::format("the limit of {} {} has passed", limit, timed ? "cycles" : "instructions");
}

}  // namespace raypool::chip
