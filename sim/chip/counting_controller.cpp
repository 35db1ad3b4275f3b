#include "chip/counting_controller.hpp"

#include <algorithm>

namespace raypool::chip {

CountingController::CountingController(const sc_core::sc_module_name& name, const ChipOptions& options)
    : Controller(name, options),
      counts_(chip_, options.configuration.contents(), options.device->units(), secondary_ == RayKernel::CastSecondary,
              tile_width() * tile_height(), policy_of(options)),
      walk_(tile_walk(options.configuration, width_, height_), width_, height_) {
  SC_METHOD(look);
  sensitive << look_;
  dont_initialize();
  SC_METHOD(act);
  sensitive << act_;
  dont_initialize();
}

void CountingController::ray_left(uint32_t unit, bool shadow) {
  counts_.ray_left(clock->cycle(), unit, shadow);
  look_soon();
}

void CountingController::contribution_left(uint32_t unit) {
  counts_.contribution_left(clock->cycle(), unit);
  look_soon();
}

void CountingController::kernel_ended(uint32_t unit) {
  Controller::kernel_ended(unit);
  counts_.kernel_ended(clock->cycle(), unit, device->exports(unit));
  look_soon();
}

// Tiles that were chosen among those of the walk are there at once.
raypool::Controller::Tiles CountingController::tiles() {
  const bool offered = !options_.tiles.empty() || walk_.in(clock->cycle() + 2).offered != nullptr;
  return {!next_tile_.at_end(), offered && !next_tile_.at_end() ? &next_tile_.tile() : nullptr};
}

// While nobody can take a launch nothing can be decided, and the frame has not ended.
void CountingController::look_soon() {
  if (launch_ || ending_ || clock->cycle() < look_from_ || !device->can_launch()) return;
  clock->notify(look_, Phase::Controller);
}

void CountingController::look() {
  clock->guard([&] {
    const uint64_t now = clock->cycle();
    if (launch_ || ending_) return;
    if (now < look_from_) {
      clock->notify(look_, Phase::Controller, look_from_ - now);
      return;
    }
    counts_.settle(now);
    const raypool::Controller::Levels seen{levels(), device->could_launch()};
    const raypool::Controller::Tiles order = tiles();
    ending_ = counts_.ended(seen, order);
    if (!ending_) launch_ = counts_.decide(seen, order);
    if (launch_ || ending_) {
      clock->notify(act_, Phase::Controller, raypool::Controller::kCycles);
      return;
    }
    uint64_t next = counts_.due();
    if (order.left && order.offered == nullptr) next = now + 1;
    if (next != kNever) clock->notify(look_, Phase::Controller, next - now);
  });
}

// The device sees a launch, and the pool its reservation, in the next cycle.
void CountingController::act() {
  clock->guard([&] {
    if (ending_) {
      finish();
      return;
    }
    const raypool::Controller::Launch launch = launch_;
    launch_ = {};
    const uint64_t offered = clock->cycle() + 1;
    counts_.launched(offered, device->next_unit(), launch);
    if (launch.choice.kind == Choice::Kind::Eye) {
      if (options_.tiles.empty()) walk_.take(offered);
      cast(launch.held);
    } else {
      import(launch.choice.kind == Choice::Kind::Shade ? RayKernel::Shade
             : launch.reflects                         ? RayKernel::CastSecondary
                                                       : RayKernel::CastSecondaryDirect,
             launch.import, launch.threads);
    }
    look_from_ = offered + 1;
    clock->notify(look_, Phase::Controller, look_from_ - clock->cycle());
  });
}

}  // namespace raypool::chip
