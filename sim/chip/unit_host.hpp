// Drives one compute unit, whichever engine it is: reads its outputs once a cycle, decides its inputs from the state of the ports
// around it, and clocks it. A unit that is idle, has nothing to launch and nothing under way is not clocked until it is given a
// kernel.
#pragma once

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

/// What a unit is connected to; all must outlive it. Compute programs have no pools, frame buffer and traverser.
struct UnitSurroundings {
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

class UnitHost : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(UnitHost);
  /// `unit` must have been reset, and outlive the host.
  UnitHost(const sc_core::sc_module_name& name, int number, ComputeUnit& unit, const UnitSurroundings& surroundings);

  /// True if launch() may be called.
  bool can_launch() const { return !pending_ && unit_.outputs().launch_ready; }
  /// True if a kernel runs, or one has been given and not begun.
  bool busy() const { return given_ > 0; }
  bool idle() const { return given_ == 0 && unit_.outputs().idle; }
  /// Gives the unit a kernel, which it sees from the next cycle on. Not in the phase of the units.
  void launch(const LaunchCommand& command);

  uint64_t busy_cycles() const { return busy_cycles_; }  ///< in which a kernel ran
  uint64_t transfers() const { return transfers_; }      ///< beats, requests, launches and contributions, for the watchdog
  uint64_t instructions() { return unit_.counter(counter::kInstructions); }
  /// For error messages: what the unit's ports show.
  std::string describe();

 private:
  void cycle();
  void serve_memory(const UnitOutputs& outputs, UnitInputs& inputs);
  void serve_pools(const UnitOutputs& outputs, UnitInputs& inputs);
  void report(const UnitOutputs& outputs, bool held_up);

  int number_;
  ComputeUnit& unit_;
  UnitSurroundings around_;
  bool awake_ = false;
  bool stalls_ = true;
  bool ready_before_ = false, idle_before_ = true;
  std::optional<LaunchCommand> pending_;  // not yet accepted
  int given_ = 0;                         // kernels that have not ended
  uint64_t busy_cycles_ = 0, transfers_ = 0;
};

}  // namespace raypool::chip
