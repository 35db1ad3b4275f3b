// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/chip/rp_controller.v: the controller that counts what is under way, and decides in four cycles.
//
// Its caller passes in each event, with its cycle, and asks what follows from what a cycle has come to: so it need not
// be called in cycles in which nothing changes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/launch_records.hpp"
#include "machine/chip/launch_rules.hpp"
#include "machine/chip/pool_levels.hpp"
#include "machine/chip/tile_walk.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool {

class Controller {
 public:
  /// What is decided on the end of cycle c is offered to the units in c + 1 + kCycles.
  static constexpr uint64_t kCycles = 4;

  /// At the end of a cycle.
  struct Levels : PoolLevels {
    bool ready = false;  ///< the units could take a launch in this cycle
  };
  /// The order of the tiles, as it stands then.
  struct Tiles {
    bool left = false;                        ///< one is still to be cast
    const TileWalk::Tile* offered = nullptr;  ///< this one may be
  };
  struct Launch {
    Choice choice;  ///< Halt: none
    ImportKind import = ImportKind::None;
    bool reflects = false;            ///< a secondary kernel makes normal rays
    uint32_t threads = 0;             ///< of a tile too
    uint32_t normal = 0, shadow = 0;  ///< rays that it may export
    uint32_t held = 0;                ///< when it was decided
    explicit operator bool() const { return choice.kind != Choice::Kind::Halt; }
  };

  /// `reflections`: normal intersections are for the kernel that reflects. `tile_threads`: of a tile.
  Controller(const ChipConfiguration& chip, uint32_t contents, uint32_t units, bool reflections, uint32_t tile_threads,
             std::unique_ptr<KernelPolicy> policy)
      : units_(units),
        tile_threads_(tile_threads),
        reflections_(reflections),
        launch_ahead_(chip.launch_ahead),
        rules_(chip, contents, units),
        policy_(std::move(policy)) {}

  /// Another frame, when the one before has ended. What is counted modulo 2^16 goes on.
  void begin(bool reflections, std::unique_ptr<KernelPolicy> policy) {
    reflections_ = reflections;
    policy_ = std::move(policy);
  }

  // What happens in a cycle, in this order.
  void ray_left(uint64_t cycle, uint32_t unit, bool shadow) { records_[unit].ray_left(cycle, shadow); }
  void contribution_left(uint64_t cycle, uint32_t unit) { records_[unit].contribution_left(cycle); }
  /// `exports`: as UnitOutputs has them.
  void kernel_ended(uint64_t cycle, uint32_t unit, uint16_t exports) {
    records_[unit].kernel_ended(cycle, exports);
    --kernels_[unit];
  }
  /// The unit takes the launch, in the cycle in which it is offered. Its intersections are reserved by then.
  void launched(uint64_t cycle, uint32_t unit, const Launch& launch) {
    records_[unit].launch(cycle, launch.normal, launch.shadow);
    ++kernels_[unit];
    if (launch.choice.kind == Choice::Kind::Eye) rules_.cast(launch.held);
  }

  /// What a cycle has come to.
  void settle(uint64_t cycle) {
    for (uint32_t unit = 0; unit < units_; ++unit) records_[unit].settle(cycle);
  }
  // After settle().
  /// The frame is finished.
  bool ended(const Levels& levels, const Tiles& tiles) const {
    if (tiles.left || levels.rays != 0 || kernels() != 0) return false;
    for (uint32_t unit = 0; unit < units_; ++unit)
      if (!records_[unit].empty()) return false;
    return std::all_of(levels.size.begin(), levels.size.end(), [](uint32_t size) { return size == 0; });
  }
  /// While kernels run, and the units are ready for a launch or not, ended() is false and decide() comes to none,
  /// whatever else there is.
  bool waits_for_units(bool ready) const { return kernels() != 0 && (!ready || (ahead() && !launch_ahead_)); }
  Launch decide(const Levels& levels, const Tiles& tiles) const {
    for (uint32_t unit = 0; unit < units_; ++unit)
      if (records_[unit].full()) return {};
    const bool ahead = this->ahead();
    if (!levels.ready || (ahead && !launch_ahead_)) return {};
    const PolicyView view = this->view(levels, tiles, ahead);
    return launch(policy_->choose(view), levels, tiles);
  }
  /// Normal rays, intersections of them that no launch has reserved, and rays to come: a pixel has one at most.
  uint32_t held(const PoolLevels& levels) const {
    return levels.rays - levels.shadow_rays + levels.available[ImportKind::Normal] +
           levels.available[ImportKind::Direct] + to_come(&LaunchRecords::normal);
  }
  uint32_t rays_to_come() const { return to_come(&LaunchRecords::normal) + to_come(&LaunchRecords::shadow); }
  uint32_t shadow_rays_to_come() const { return to_come(&LaunchRecords::shadow); }
  uint32_t kernels() const {
    uint32_t sum = 0;
    for (const uint32_t count : kernels_) sum += count;
    return sum;
  }
  /// The cycle in which something of this changes by itself; kNever: in none.
  uint64_t due() const {
    uint64_t due = kNever;
    for (uint32_t unit = 0; unit < units_; ++unit) due = std::min(due, records_[unit].due());
    return due;
  }

 private:
  // A launch would wait behind another one's kernel.
  bool ahead() const {
    for (uint32_t unit = 0; unit < units_; ++unit)
      if (kernels_[unit] == 0) return false;
    return true;
  }
  uint32_t to_come(uint32_t (LaunchRecords::*count)() const) const {
    uint32_t sum = 0;
    for (uint32_t unit = 0; unit < units_; ++unit) sum += (records_[unit].*count)();
    return sum;
  }
  PolicyView view(const Levels& levels, const Tiles& tiles, bool ahead) const {
    PolicyView view = levels.view(rays_to_come());
    view.secondary_room = rules_.secondary_room(levels.shadow_rays, shadow_rays_to_come(), view.shadow);
    view.kernels = kernels();
    view.eye_possible = tiles.offered != nullptr && rules_.may_cast(tiles.offered->pixels, held(levels));
    view.ahead = ahead;
    return view;
  }
  Launch launch(const Choice& choice, const Levels& levels, const Tiles& tiles) const {
    Launch launch{choice, ImportKind::None, false, choice.threads, 0, 0, held(levels)};
    switch (choice.kind) {
      case Choice::Kind::Halt:
        break;
      case Choice::Kind::Eye:
        launch.threads = tile_threads_;
        launch.normal = tiles.offered->pixels;
        break;
      case Choice::Kind::Secondary:
        launch.import = levels.secondary_import();
        launch.reflects = reflections_ && launch.import == ImportKind::Normal;
        launch.shadow = choice.threads;
        launch.normal = launch.reflects ? choice.threads : 0;
        break;
      case Choice::Kind::Shade:
        launch.import = ImportKind::Shadow;
        break;
    }
    return launch;
  }

  uint32_t units_, tile_threads_;
  bool reflections_, launch_ahead_;
  LaunchRules rules_;
  std::unique_ptr<KernelPolicy> policy_;
  std::array<LaunchRecords, kMostUnits> records_;
  std::array<uint32_t, kMostUnits> kernels_{};  // [unit] launched, and not ended
};

}  // namespace raypool
