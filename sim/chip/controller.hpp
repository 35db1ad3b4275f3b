// The controller: cuts the image into tiles, and launches on the device what the policy proposes, as far as it is safe.
// Which unit gets a launch is the device's choice (its block scheduler's); the controller sees it beforehand.
//
// Two rules keep the chip from locking up, whatever the policy (docs/chip.md has the argument): no more pixels are held
// than the intersection pool has places for normal intersections, and a secondary kernel starts only if all shadow rays
// and intersections that can exist then leave at least one place of the ray pool free. What is held is for its two
// kinds to say, and when: LedgerController as the thesis may have meant it, CountingController as the Verilog does.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "chip/chip.hpp"
#include "chip/chip_clock.hpp"
#include "chip/chosen_tiles.hpp"
#include "chip/interfaces.hpp"
#include "chip/kernel_times.hpp"
#include "machine/kernel_policy.hpp"
#include "machine/pool_levels.hpp"
#include "machine/tile_walk.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::chip {

/// The walk over the tiles in which such a machine casts a picture, in its order; it has begun.
TileWalk tile_walk(const Configuration& configuration, uint32_t width, uint32_t height);

/// These tiles.
std::vector<PixelTile> along_walk(const Configuration& configuration, uint32_t width, uint32_t height);

class Controller : public sc_core::sc_module, public DecisionIf, public KernelEventsIf {
 public:
  /// `options` must outlive the controller.
  Controller(const sc_core::sc_module_name& name, const ChipOptions& options);

  /// Is told of a tile that is cast: its number along the walk, and the pixels of it that lie in the image; may be
  /// empty.
  std::function<void(uint32_t tile, const std::vector<uint32_t>& pixels)> on_cast;

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<RayLevelIf> rays{"rays"};
  sc_core::sc_port<IntersectionLevelIf> intersections{"intersections"};
  sc_core::sc_port<LedgerIf> ledger{"ledger"};
  sc_core::sc_port<LaunchIf> device{"device"};
  sc_core::sc_export<DecisionIf> decisions{"decisions"};
  sc_core::sc_export<KernelEventsIf> kernel_events{"kernel_events"};

  void accepted(uint32_t unit) override;
  void kernel_ended(uint32_t unit) override;

  bool finished() const { return finished_; }
  /// Of the tiles that are cast.
  uint64_t pixels() const { return pixels_; }
  const KernelTimes& kernels() const { return kernels_; }
  uint32_t held_peak() const { return held_peak_; }
  std::string describe() const;

  /// Pixels of an eye tile: tile_width_log2(contents) gives its width; its height is what fits with the held limit.
  uint32_t tile_width() const { return next_tile_.tile_width(); }
  uint32_t tile_height() const { return next_tile_.tile_height(); }

 protected:
  void start_of_simulation() override { changed(); }
  /// What proposes launches.
  static std::unique_ptr<KernelPolicy> policy_of(const ChipOptions& options);
  /// What the ledger of pixels says, or the controller's own count.
  virtual uint32_t held() const = 0;
  virtual uint32_t rays_to_come() const = 0;
  PoolLevels levels() const;
  void finish();
  /// Gives the unit that is next the kernel for the next tile, or for intersections that it is promised. `held` pixels
  /// were before.
  void cast(uint32_t held);
  void import(RayKernel kernel, ImportKind kind, uint32_t threads);

  const ChipOptions& options_;
  const ChipConfiguration& chip_;
  const uint32_t width_, height_;  // of the image
  RayKernel secondary_;
  ChosenTiles next_tile_;
  KernelTimes kernels_;

 private:
  void give(RayKernel kernel, LaunchCommand command);

  uint64_t pixels_ = 0;
  bool finished_ = false;
  uint32_t held_peak_ = 0;
};

/// The controller that the configuration names.
std::unique_ptr<Controller> make_controller(const sc_core::sc_module_name& name, const ChipOptions& options);

}  // namespace raypool::chip
