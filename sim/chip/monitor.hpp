// Watches a run: says how far it is, and ends it with an error when nothing moves any more or it takes too long.
#pragma once

#include <cstdint>
#include <string>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "config/configuration.hpp"

namespace raypool::chip {

struct MonitorOptions {
  uint64_t watchdog_cycles = 0;  ///< 0: never
  uint64_t cycle_limit = 0;      ///< cycles, or instructions of an engine without time; 0: none
  bool timed = true;             ///< the engine has a notion of time: a cycle is not thousands of instructions
  bool progress = false;         ///< show_progress() every kProgressCycles, without time every cycle
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
  /// A program may compute for long without a transfer, but not for so many watchdog periods.
  static constexpr uint64_t kSilentPeriods = 100;

 private:
  void start_of_simulation() override;
  void show();
  void watch();
  void limit();
  void counted_out();
  uint64_t progress_cycles() const { return options_.timed ? kProgressCycles : 1; }

  MonitorOptions options_;
  sc_core::sc_event show_, watch_, limit_, counted_out_;
  uint64_t retired_ = 0, transfers_ = 0;
  uint64_t silent_ = 0;  // periods without a transfer
};

}  // namespace raypool::chip
