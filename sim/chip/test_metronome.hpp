// For tests: has an event in every cycle, so that every quantum is one cycle.
#pragma once

#include <cstdint>
#include <systemc>

namespace raypool::test {

struct Metronome : sc_core::sc_module {
  SC_HAS_PROCESS(Metronome);
  explicit Metronome(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_METHOD(beat);
    sensitive << next_;
  }
  void beat() {
    ++beats;
    next_.notify(1, sc_core::SC_NS);
  }
  sc_core::sc_event next_;
  uint64_t beats = 0;
};

}  // namespace raypool::test
