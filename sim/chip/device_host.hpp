// Drives the device, a compute unit or a multiprocessor of several, whichever engine it is: reads its outputs once a cycle,
// decides its inputs from the state of the ports around it, and clocks it. A device that is idle, has nothing to launch and
// nothing under way is not clocked until it is given a kernel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/frame_port.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/launcher.hpp"
#include "chip/memory_port.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/traverser.hpp"
#include "machine/compute_unit.hpp"

namespace raypool::chip {

/// What the device is connected to; all must outlive it. Compute programs have no pools, frame buffer and traverser.
struct DeviceSurroundings {
  ChipClock& clock;
  MemoryPort& memory;
  Launcher& launcher;
  struct Frame {
    RayPool& rays;
    IntersectionPool& intersections;
    FramePort& port;
    PixelLedger& ledger;
    Traverser& traverser;
  };
  std::optional<Frame> frame;
};

class DeviceHost : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(DeviceHost);
  /// `device` must have been reset, and outlive the host.
  DeviceHost(const sc_core::sc_module_name& name, ComputeUnit& device, const DeviceSurroundings& surroundings);

  uint32_t units() const { return units_; }
  /// True if launch() may be called.
  bool can_launch() const { return !pending_ && device_.outputs().launch_ready; }
  /// The unit that would get the kernel; means something while can_launch().
  uint32_t next_unit() const { return device_.outputs().launch_unit; }
  /// True if the unit runs a kernel, or one has been given to it and not begun.
  bool busy(uint32_t unit) const { return given_[unit] > 0; }
  bool idle() const { return given_in_all_ == 0 && device_.outputs().idle; }
  /// Gives next_unit() a kernel, which it sees from the next cycle on. Not in the phase of the units.
  void launch(const LaunchCommand& command);

  uint64_t busy_cycles() const { return busy_cycles_; }  ///< in which a kernel ran, summed over the units
  uint64_t transfers() const { return transfers_; }      ///< beats, requests, launches and contributions, for the watchdog
  uint64_t instructions() { return device_.counter(counter::kInstructions); }
  /// For error messages: what the device's ports show.
  std::string describe();

 private:
  void cycles();
  void cycle();
  void offer_launch(const UnitOutputs& outputs);
  void serve_memory(const UnitOutputs& outputs);
  void serve_pools(const UnitOutputs& outputs);
  void report(const UnitOutputs& outputs, bool held_up);
  void settle(const UnitOutputs& outputs);

  uint64_t quiet_cycles(const UnitOutputs& outputs) const;

  ComputeUnit& device_;
  UnitInputs inputs_;
  uint32_t units_;
  DeviceSurroundings around_;
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
  bool released_ = false;  // pixels, in this cycle
  uint64_t busy_cycles_ = 0, transfers_ = 0;
};

}  // namespace raypool::chip
