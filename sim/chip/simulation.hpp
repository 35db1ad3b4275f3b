// One SystemC simulation. SystemC keeps its state in one global context and allows one run of it; this makes a
// context a run, so that a process can make several runs one after the other.
#pragma once

#include <systemc>

namespace raypool::chip {

/// Must be made before the modules of a run and destroyed after them. One at a time in a process.
class Simulation {
 public:
  Simulation();
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Until a process stops it or nothing is left to happen.
  void run() { sc_core::sc_start(); }

 private:
  sc_core::sc_simcontext* before_;
  sc_core::sc_simcontext* default_before_;
  sc_core::sc_simcontext* context_;
};

}  // namespace raypool::chip
