// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the model of a chip launches, and when: its controller and its tiles, asked only where they may come to
// something else than before.
#pragma once

#include <cstdint>
#include <memory>

#include "config/configuration.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/chip/controller.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/chip/tile_walk.hpp"
#include "machine/chip/timed_tiles.hpp"
#include "machine/common/port_cycles.hpp"

namespace raypool {

class Launches {
 public:
  Launches(const Configuration& configuration, uint32_t units, const PolicyMaker& own_policy)
      : configuration_(configuration),
        units_(units),
        own_policy_(own_policy),
        walk_(configuration.chip.tile_order, configuration.contents(), configuration.chip.held_limit),
        controller_(configuration.chip, configuration.contents(), units, false,
                    walk_.tile_width() * walk_.tile_height(), nullptr),
        tiles_(walk_, 1, 1) {}

  /// A frame begins in this cycle, when there is none.
  void begin(uint64_t cycle, const FrameSetup& setup) {
    setup_ = setup;
    controller_.begin(setup.reflections, policy(setup.reflections));
    tiles_ = TimedTiles(walk_, setup.width, setup.height, cycle, setup.tiles);
    begun_at_ = decide_from_ = cycle;
    ended_at_ = look_at_ = kNever;
    changed_ = true;
  }
  bool busy(uint64_t cycle) const { return cycle > begun_at_ && cycle < ended_at_; }
  /// What is offered to the units.
  bool offered(uint64_t cycle) const { return launch_ && cycle >= launch_at_; }
  LaunchCommand command(uint64_t cycle) {
    LaunchCommand command;
    command.threads = launch_.threads;
    command.import = launch_.import;
    command.pc = setup_.entries[kernel()];
    if (launch_.choice.kind == Choice::Kind::Eye) command.block = tiles_.in(cycle).offered->block();
    return command;
  }
  /// Intersections are taken off the available ones.
  bool reserves(uint64_t cycle) const {
    return offered(cycle) && cycle == launch_at_ && launch_.import != ImportKind::None;
  }
  ImportKind import() const { return launch_.import; }
  uint32_t threads() const { return launch_.threads; }

  // What happens in a cycle, in this order.
  void accepted(uint64_t cycle, uint32_t unit) {
    controller_.launched(cycle, unit, launch_);
    if (launch_.choice.kind == Choice::Kind::Eye) tiles_.take(cycle);
    launch_ = {};
    decide_from_ = cycle + 1;
    changed_ = true;
  }
  void ray_left(uint64_t cycle, uint32_t unit, bool shadow) {
    controller_.ray_left(cycle, unit, shadow);
    changed_ = true;
  }
  void contribution_left(uint64_t cycle, uint32_t unit) {
    controller_.contribution_left(cycle, unit);
    changed_ = true;
  }
  void kernel_ended(uint64_t cycle, uint32_t unit, uint16_t exports) {
    controller_.kernel_ended(cycle, unit, exports);
    changed_ = true;
  }
  /// Levels of pools have changed.
  void changed() { changed_ = true; }

  /// The controller can decide at the end of this cycle, and may come to something else than before: it would be shown
  /// the levels.
  bool looks(uint64_t cycle, bool ready) {
    if (launch_ || ended_at_ != kNever || cycle < decide_from_) return false;
    if (controller_.waits_for_units(ready)) {
      changed_ = true;
      return false;
    }
    changed_ = changed_ || ready != ready_ || cycle >= look_at_;
    ready_ = ready;
    return changed_;
  }
  /// The next cycle, from this one on, in which anything of this changes unless something else does.
  uint64_t due(uint64_t cycle, bool ready) const {
    if (launch_) return cycle <= launch_at_ ? launch_at_ : ready ? cycle : kNever;
    if (ended_at_ != kNever) return ended_at_;
    if (controller_.waits_for_units(ready)) return kNever;
    if (cycle < decide_from_) return decide_from_;
    return changed_ || ready != ready_ ? cycle : look_at_;
  }
  void decide(uint64_t cycle, const Controller::Levels& levels) {
    controller_.settle(cycle);
    const Controller::Tiles order = tiles_.in(cycle + 2);
    if (controller_.ended(levels, order)) {
      ended_at_ = cycle + Controller::kCycles + 1;
    } else if (const Controller::Launch decided = controller_.decide(levels, order)) {
      launch_ = decided;
      launch_at_ = cycle + Controller::kCycles + 1;
    }
    changed_ = order.left && order.offered == nullptr;  // a tile is about to come
    look_at_ = controller_.due();
  }

 private:
  std::unique_ptr<KernelPolicy> policy(bool reflections) const {
    const ChipConfiguration& chip = configuration_.chip;
    const PolicySetup setup{configuration_.contents(),   units_,
                            chip.ray_pool_size,          chip.intersection_pool_size,
                            chip.thresholds_rays,        chip.thresholds_intersections,
                            chip.static_traverser_batch, reflections ? 2u : 1u};
    return own_policy_ ? own_policy_(setup) : make_policy(chip.policy, setup);
  }
  RayKernel kernel() const {
    switch (launch_.choice.kind) {
      case Choice::Kind::Eye:
        return RayKernel::CastEye;
      case Choice::Kind::Secondary:
        return launch_.reflects ? RayKernel::CastSecondary : RayKernel::CastSecondaryDirect;
      default:
        return RayKernel::Shade;
    }
  }

  Configuration configuration_;
  uint32_t units_;
  PolicyMaker own_policy_;
  FrameSetup setup_;
  TileWalk walk_;
  Controller controller_;
  TimedTiles tiles_;
  Controller::Launch launch_;  // decided and not taken
  uint64_t launch_at_ = 0, decide_from_ = 0, begun_at_ = 0, ended_at_ = 0;
  bool changed_ = true, ready_ = false;
  uint64_t look_at_ = kNever;
};

}  // namespace raypool
