// Watches a run: says how far it is, and ends it with an error when nothing moves any more or it takes too long.
#pragma once

#include <cstdint>
#include <string>
#include <systemc>

#include "chip/chip.hpp"
#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/progress_watch.hpp"
#include "config/configuration.hpp"

namespace raypool::chip {

struct MonitorOptions {
  uint64_t watchdog_cycles = 0;  ///< between two looks at what has been done; 0: none
  RunLimits limits;
  bool timed = true;      ///< the engine has a notion of time: a cycle is not thousands of instructions
  bool progress = false;  ///< show_progress() every kProgressCycles, without time every cycle
  const Configuration* counters_of = nullptr;  ///< ends when a performance counter of this machine may begin anew
};

class Monitor : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(Monitor);
  Monitor(const sc_core::sc_module_name& name, const MonitorOptions& options);

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<WatchedIf> watched{"watched"};

  /// For one sentence: what has passed.
  static std::string limit_sentence(uint64_t limit, bool timed);

  static constexpr uint64_t kProgressCycles = 16384;

 private:
  void start_of_simulation() override;
  void show();
  void watch();
  void limit();
  void counted_out();
  uint64_t progress_cycles() const { return options_.timed ? kProgressCycles : 1; }

  MonitorOptions options_;
  sc_core::sc_event show_, watch_, limit_, counted_out_;
  ProgressWatch progress_;
};

}  // namespace raypool::chip
