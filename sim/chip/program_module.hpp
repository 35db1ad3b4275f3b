// The chip of a compute program as a SystemC module, to be bound to a memory: run_program (program_run.hpp) with a
// socket.
#pragma once

#include <cstdint>
#include <string>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "chip/device_host.hpp"
#include "chip/interfaces.hpp"
#include "chip/memory_port.hpp"
#include "chip/monitor.hpp"
#include "chip/program_run.hpp"

namespace raypool::chip {

/// Launches the blocks of a grid, in order.
class Grid : public sc_core::sc_module, public DecisionIf {
 public:
  SC_HAS_PROCESS(Grid);
  /// `options` must outlive the grid.
  Grid(const sc_core::sc_module_name& name, const ProgramOptions& options);

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<LaunchIf> device{"device"};
  sc_core::sc_export<DecisionIf> decisions{"decisions"};

  void changed() override { clock->notify(decide_, Phase::Controller); }
  std::string describe() const;

 private:
  void start_of_simulation() override { changed(); }
  void decide();

  const ProgramOptions& options_;
  sc_core::sc_event decide_;
  uint32_t launched_ = 0;
};

/// What stands where the pools and the frame buffer of a frame's chip are: using them is an error.
class NoFrame : public sc_core::sc_module, public RayExportIf, public ImportIf, public ContributionIf {
 public:
  explicit NoFrame(const sc_core::sc_module_name& name);

  sc_core::sc_export<RayExportIf> rays{"rays"};
  sc_core::sc_export<ImportIf> intersections{"intersections"};
  sc_core::sc_export<ContributionIf> frame{"frame"};

  void want() override;
  void take(uint32_t unit, const Beat& beat, bool last) override;
  bool held_up() const override { return false; }
  bool request(uint32_t unit, ImportKind kind) override;
  void beat(Beat& beat) override;
  void take(uint32_t unit, const FrameContribution& contribution) override;
};

/// Runs one program, in one simulation (simulation.hpp) of its own.
class ProgramChip : public sc_core::sc_module, public WatchedIf {
 public:
  /// Throws InputError for options out of range. What they point to must outlive the chip; `options.memory` holds the
  /// program.
  ProgramChip(const sc_core::sc_module_name& name, const ProgramOptions& options);

  MemorySocket memory{"memory"};

  /// Resets the device and runs the program. Throws as run_program does.
  ProgramResult run();

  WorkDone work_done() override { return {device_.instructions(), device_.transfers(), memory_port_.response_due()}; }
  std::string describe() override {
    return grid_.describe() + "; " + memory_port_.describe() + "; " + device_.describe();
  }
  void show_progress() override { options_.progress(clock_.cycle(), device_.instructions()); }

 private:
  const ProgramOptions options_;
  ChipClock clock_{"clock"};
  MemoryPort memory_port_;
  NoFrame no_frame_{"no_frame"};
  Grid grid_;
  DeviceHost device_;
  Monitor monitor_;
};

}  // namespace raypool::chip
