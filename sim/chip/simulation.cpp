#include "chip/simulation.hpp"

#include <cstdio>
#include <cstdlib>

// libsystemc brings a main() that calls this function and therefore wants to find it, though every
// program here has a main() of its own.
__attribute__((weak)) int sc_main(int, char**) {
  std::fputs("this program was linked with SystemC's main() instead of its own: put the SystemC library last\n",
             stderr);
  return EXIT_FAILURE;
}

namespace raypool::chip {

Simulation::Simulation() {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  before_ = sc_core::sc_curr_simcontext;
  default_before_ = sc_core::sc_default_global_context;
  context_ = new sc_core::sc_simcontext;
  sc_core::sc_curr_simcontext = sc_core::sc_default_global_context = context_;
  // Every run ends with "simulation stopped by user", which is no news.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
}

Simulation::~Simulation() {
  delete context_;
  sc_core::sc_curr_simcontext = before_;
  sc_core::sc_default_global_context = default_before_;
}

}  // namespace raypool::chip
