// Drives the device, a compute unit or a multiprocessor of several, whichever engine it is: reads its outputs once a
// cycle, decides its inputs from the state of the ports around it, and clocks it. A device that is idle, has nothing to
// launch and nothing under way is not clocked until it is given a kernel. Its process is temporally decoupled
// (chip_clock.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "machine/compute_unit.hpp"

namespace raypool::chip {

class DeviceHost : public sc_core::sc_module, public LaunchIf {
 public:
  SC_HAS_PROCESS(DeviceHost);
  /// `device` must be reset before the run, and outlive the host.
  DeviceHost(const sc_core::sc_module_name& name, ComputeUnit& device);

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<MemoryIf> memory{"memory"};
  sc_core::sc_port<RayExportIf> rays{"rays"};
  sc_core::sc_port<ImportIf> intersections{"intersections"};
  sc_core::sc_port<ContributionIf> frame{"frame"};
  sc_core::sc_port<DecisionIf> controller{"controller"};
  sc_core::sc_port<KernelEventsIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> kernel_events{"kernel_events"};
  sc_core::sc_export<LaunchIf> launches{"launches"};

  uint32_t units() const override { return units_; }
  bool can_launch() const override { return !pending_ && device_.outputs().launch_ready; }
  bool could_launch() const override { return !pending_ && (awake_ ? ready_before_ : device_.outputs().launch_ready); }
  uint32_t next_unit() const override { return device_.outputs().launch_unit; }
  bool busy(uint32_t unit) const override { return given_[unit] > 0; }
  bool idle() const override { return given_in_all_ == 0 && device_.outputs().idle; }
  uint16_t exports(uint32_t unit) const override { return device_.outputs().exports[unit]; }
  void launch(const LaunchCommand& command) override;

  uint64_t busy_cycles() const { return busy_cycles_; }  ///< in which a kernel ran, summed over the units
  uint64_t transfers() const { return transfers_; }      ///< beats, requests, launches and contributions
  uint64_t instructions() { return device_.counter(counter::kInstructions); }
  /// For error messages: what the device's ports show.
  std::string describe();

 private:
  void run();
  void decide_inputs(const UnitOutputs& outputs);
  void offer_launch(const UnitOutputs& outputs);
  void serve_memory(const UnitOutputs& outputs, uint64_t now);
  void serve_imports(const UnitOutputs& outputs, uint64_t now);
  void serve_exports(const UnitOutputs& outputs, uint64_t now);
  void report(const UnitOutputs& outputs);
  void report_stalls(bool stalls);
  void settle();
  uint64_t quiet_cycles(const UnitOutputs& outputs) const;

  ComputeUnit& device_;
  UnitInputs inputs_;
  uint32_t units_;
  sc_core::sc_event next_cycle_;
  bool awake_ = false;
  bool stalls_ = true;
  bool ready_before_ = false;
  uint32_t next_before_ = 0;              // unit that was ready
  uint32_t idle_before_;                  // units, one bit each
  uint32_t settled_;                      // units that are idle and have nothing under way
  std::optional<LaunchCommand> pending_;  // not yet accepted
  uint32_t pending_unit_ = 0;
  std::array<uint32_t, kMostUnits> given_{};  // [unit] kernels that have not ended
  uint32_t given_in_all_ = 0;
  uint64_t busy_cycles_ = 0, transfers_ = 0;
};

}  // namespace raypool::chip
