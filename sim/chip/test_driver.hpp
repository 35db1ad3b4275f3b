// For tests of single blocks: calls a function at the beginning of every cycle.
#pragma once

#include <functional>
#include <systemc>

#include "chip/chip_clock.hpp"

namespace raypool::test {

class Driver : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(Driver);
  /// `cycle` is called with 1, 2, ... until it returns false, which ends the run.
  Driver(const sc_core::sc_module_name& name, chip::ChipClock& clock, std::function<bool(uint64_t)> cycle)
      : sc_module(name), clock_(clock), cycle_(std::move(cycle)) {
    SC_METHOD(run);
    sensitive << clock_.tick();
    dont_initialize();
    clock_.wake();
  }

 private:
  void run() {
    clock_.guard([&] {
      if (!cycle_(clock_.cycle())) clock_.stop();
    });
  }

  chip::ChipClock& clock_;
  std::function<bool(uint64_t)> cycle_;
};

}  // namespace raypool::test
