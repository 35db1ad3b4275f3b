// For tests of single blocks: calls a function at the beginning of every cycle.
#pragma once

#include <functional>
#include <systemc>
#include <utility>

#include "chip/chip_clock.hpp"
#include "chip/simulation.hpp"

namespace raypool::test {

class Driver : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(Driver);
  /// `cycle` is called with 1, 2, ... until it returns false, which ends the run.
  Driver(const sc_core::sc_module_name& name, std::function<bool(uint64_t)> cycle)
      : sc_module(name), cycle_(std::move(cycle)) {
    SC_METHOD(run);
    sensitive << next_cycle_;
    dont_initialize();
  }

  sc_core::sc_port<chip::TimeIf> clock{"clock"};

 private:
  void start_of_simulation() override { clock->notify(next_cycle_, chip::Phase::Units, 1); }
  void run() {
    clock->guard([&] {
      if (cycle_(clock->cycle())) {
        clock->notify(next_cycle_, chip::Phase::Units, 1);
      } else {
        clock->stop();
      }
    });
  }

  std::function<bool(uint64_t)> cycle_;
  sc_core::sc_event next_cycle_;
};

/// Drives a bench's clock until `cycle` returns false.
inline void drive(chip::Simulation& simulation, chip::ChipClock& clock, std::function<bool(uint64_t)> cycle) {
  Driver driver("driver", std::move(cycle));
  driver.clock(clock.now);
  simulation.run();
  clock.rethrow();
}

}  // namespace raypool::test
