#include "chip/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "chip/counting_controller.hpp"
#include "chip/ledger_controller.hpp"

namespace raypool::chip {

TileWalk tile_walk(const Configuration& configuration, uint32_t width, uint32_t height) {
  TileWalk walk(tile_order(configuration.chip), configuration.contents(), configuration.chip.held_limit);
  walk.start(width, height);
  return walk;
}

std::vector<PixelTile> along_walk(const Configuration& configuration, uint32_t width, uint32_t height) {
  std::vector<PixelTile> tiles;
  TileWalk walk = tile_walk(configuration, width, height);
  for (walk.await(); walk.busy(); walk.next())
    tiles.push_back({walk.tile().left, walk.tile().top, walk.tile_width() * walk.tile_height()});
  return tiles;
}

std::unique_ptr<KernelPolicy> Controller::policy_of(const ChipOptions& options) {
  const ChipConfiguration& chip = options.configuration.chip;
  const bool reflects = secondary_kernel(options.depth, options.reflections) == RayKernel::CastSecondary;
  const PolicySetup setup{options.configuration.contents(), options.device->units(), chip.ray_pool_size,
                          chip.intersection_pool_size,      chip.thresholds_rays,    chip.thresholds_intersections,
                          chip.static_traverser_batch,      reflects ? 2u : 1u};
  return options.own_policy ? options.own_policy(setup) : make_policy(chip.policy, setup);
}

Controller::Controller(const sc_core::sc_module_name& name, const ChipOptions& options)
    : sc_module(name),
      options_(options),
      chip_(options.configuration.chip),
      width_(options.width),
      height_(options.height),
      secondary_(secondary_kernel(options.depth, options.reflections)),
      next_tile_(tile_walk(options.configuration, width_, height_), options.tiles),
      kernels_(options.device->units(), options.configuration.contents()) {
  for (ChosenTiles tiles = next_tile_; !tiles.at_end(); tiles.next()) pixels_ += tiles.tile().pixels;
  decisions.bind(*this);
  kernel_events.bind(*this);
}

void Controller::accepted(uint32_t unit) { kernels_.accepted(unit, clock->cycle()); }

void Controller::kernel_ended(uint32_t unit) { kernels_.ended(unit, clock->cycle()); }

PoolLevels Controller::levels() const {
  PoolLevels levels;
  levels.rays = rays->size();
  levels.shadow_rays = rays->shadow_rays();
  for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct}) {
    levels.size[kind] = intersections->size(kind);
    levels.available[kind] = intersections->available(kind);
  }
  return levels;
}

void Controller::finish() {
  finished_ = true;
  clock->stop();
}

void Controller::import(RayKernel kernel, ImportKind kind, uint32_t threads) {
  intersections->reserve(kind, threads);
  ledger->launched(device->next_unit(), kernel, threads);
  LaunchCommand command;
  command.import = kind;
  command.threads = threads;
  give(kernel, command);
}

void Controller::cast(uint32_t held) {
  std::vector<uint32_t> pixels;
  const TileWalk::Tile& tile = next_tile_.tile();
  for (uint32_t y = tile.top; y < std::min(tile.top + tile_height(), height_); ++y)
    for (uint32_t x = tile.left; x < std::min(tile.left + tile_width(), width_); ++x) pixels.push_back(x | y << 16);
  if (on_cast) on_cast(next_tile_.number(), pixels);
  held_peak_ = std::max(held_peak_, held + tile.pixels);
  ledger->eye_launched(device->next_unit(), std::move(pixels));

  LaunchCommand command;
  command.threads = tile_width() * tile_height();
  command.block = tile.block();
  next_tile_.next();
  give(RayKernel::CastEye, command);
}

void Controller::give(RayKernel kernel, LaunchCommand command) {
  command.pc = options_.entries[kernel];
  kernels_.given(device->next_unit(), kernel, command.threads);
  device->launch(command);
}

std::string Controller::describe() const {
  const auto kind = [&](ImportKind of, const char* name) {
    const uint32_t promised = intersections->size(of) - std::min(intersections->size(of), intersections->available(of));
    return fmt::format("{} {}{}", intersections->size(of), name,
                       promised == 0 ? "" : fmt::format(" ({} of them promised to a kernel)", promised));
  };
  std::string waits = "waits for a unit that takes a kernel";
  if (device->can_launch() && next_tile_.at_end() && intersections->available(ImportKind::Normal) == 0 &&
      intersections->available(ImportKind::Shadow) == 0 && intersections->available(ImportKind::Direct) == 0) {
    waits = "has nothing to launch until intersections come";
  } else if (device->can_launch()) {
    waits = fmt::format("launches nothing, though unit {} could take a kernel: {} proposes none that may begin",
                        device->next_unit(), options_.own_policy ? "a policy of the caller's own" : "its policy");
  }
  return fmt::format(
      "the controller {}; {} pixels finished, {} held, {}; ray pool {} of {} rays{}, {} of them shadow rays, {} more "
      "may "
      "come; intersection pool {}, {} and {} of {} each",
      waits, ledger->finished(), held(),
      next_tile_.at_end() ? "none to cast"
                          : fmt::format("next tile at ({}, {}) of {}x{} pixels", next_tile_.tile().left,
                                        next_tile_.tile().top, width_, height_),
      rays->size(), chip_.ray_pool_size, rays->size() == chip_.ray_pool_size ? ", which is full" : "",
      rays->shadow_rays(), rays_to_come(), kind(ImportKind::Normal, "normal"), kind(ImportKind::Shadow, "shadow"),
      kind(ImportKind::Direct, "direct"), chip_.intersection_pool_size);
}

std::unique_ptr<Controller> make_controller(const sc_core::sc_module_name& name, const ChipOptions& options) {
  switch (options.configuration.chip.controller) {
    case ControllerName::Ledger:
      return std::make_unique<LedgerController>(name, options);
    case ControllerName::Counters:
      return std::make_unique<CountingController>(name, options);
  }
  throw std::logic_error("a controller without a class");
}

}  // namespace raypool::chip
