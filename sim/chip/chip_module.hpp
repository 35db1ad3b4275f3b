// The chip as a SystemC module, to be bound to a memory: run_chip (chip.hpp) with a socket. docs/chip.md has an
// example.
#pragma once

#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "chip/chip.hpp"
#include "chip/chip_clock.hpp"
#include "chip/controller.hpp"
#include "chip/device_host.hpp"
#include "chip/frame_port.hpp"
#include "chip/interfaces.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/memory_port.hpp"
#include "chip/monitor.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/traverser.hpp"

namespace raypool::chip {

/// Draws one frame, in one simulation (simulation.hpp) of its own.
class Chip : public sc_core::sc_module, public WatchedIf {
 public:
  /// Throws InputError for options out of range. What they point to must outlive the chip; `options.memory` holds the
  /// program.
  Chip(const sc_core::sc_module_name& name, const ChipOptions& options);

  MemorySocket memory{"memory"};

  /// Resets the device and draws. Throws as run_chip does.
  ChipResult draw();

  WorkDone work_done() override;
  std::string describe() override;
  void show_progress() override;

 private:
  uint64_t rays_traced() const { return traverser_->counts().rays.traced(); }
  ChipResult collect() const;
  void watch_tiles();
  size_t place(uint32_t x, uint32_t y) const;  // of a pixel's tile in tile_of_
  Counts counts() const;

  const ChipOptions options_;
  ChipClock clock_{"clock"};
  PixelLedger ledger_;
  MemoryPort memory_port_;
  RayPool rays_;
  IntersectionPool intersections_;
  FramePort frame_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<Traverser> traverser_;
  DeviceHost device_;
  Monitor monitor_;
  std::vector<uint32_t> tile_of_;  // [place in the picture, row by row] number in tile_costs, if there are any
  uint32_t next_tile_ = 0;         // behind the one that was cast last, along the walk
};

}  // namespace raypool::chip
