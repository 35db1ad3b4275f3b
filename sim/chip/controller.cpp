#include "chip/controller.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bits.hpp"

namespace raypool::chip {

TileWalk tile_walk(const Configuration& configuration, uint32_t width, uint32_t height) {
  const ChipConfiguration& chip = configuration.chip;
  // The traverser of constant speed has no caches that the order could serve.
  const TileOrder order =
      chip.traverser == TraverserName::Modelled ? chip.modelled_traverser_tile_order : TileOrder::Rows;
  TileWalk walk(order, configuration.contents(), chip.held_limit);
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

Controller::Controller(const sc_core::sc_module_name& name, const ChipOptions& options)
    : sc_module(name),
      options_(options),
      chip_(options.configuration.chip),
      width_(options.width),
      height_(options.height),
      secondary_(secondary_kernel(options.depth, options.reflections)),
      rules_(chip_, options.configuration.contents(), options.device->units()),
      next_tile_(tile_walk(options.configuration, width_, height_), options.tiles),
      given_(options.device->units()),
      ended_(options.device->units()) {
  const uint32_t contents = options.configuration.contents();
  const PolicySetup setup{contents,
                          options.device->units(),
                          chip_.ray_pool_size,
                          chip_.intersection_pool_size,
                          chip_.thresholds_rays,
                          chip_.thresholds_intersections,
                          chip_.static_traverser_batch,
                          secondary_ == RayKernel::CastSecondary ? 2u : 1u};
  policy_ = options.own_policy ? options.own_policy(setup) : make_policy(chip_.policy, setup);
  for (ChosenTiles tiles = next_tile_; !tiles.at_end(); tiles.next()) pixels_ += tiles.tile().pixels;
  decisions.bind(*this);
  kernel_events.bind(*this);
  SC_METHOD(decide);
  sensitive << decide_;
  dont_initialize();
}

void Controller::accepted(uint32_t unit) { given_[unit].back().begins = clock->cycle() + 1; }

void Controller::kernel_ended(uint32_t unit) {
  const GivenKernel kernel = given_[unit].front();
  given_[unit].pop_front();
  const uint64_t time = clock->cycle() - std::max(kernel.begins, ended_[unit]);
  ended_[unit] = clock->cycle();
  kernels_[kernel.kind].cycles += time;
  thread_time_ += static_cast<double>(time) * kernel.threads;
  thread_time_launchable_ += static_cast<double>(time) * options_.configuration.contents();
}

bool Controller::eye_possible() const {
  return !next_tile_.at_end() && rules_.may_cast(next_tile_.tile().pixels, ledger->held());
}

uint32_t Controller::secondary_room() const {
  return rules_.secondary_room(rays->shadow_rays(), ledger->shadow_rays_to_come(),
                               intersections->available(ImportKind::Shadow));
}

ImportKind Controller::secondary_import() const {
  const bool direct = intersections->available(ImportKind::Direct) > intersections->available(ImportKind::Normal);
  return direct ? ImportKind::Direct : ImportKind::Normal;
}

PolicyView Controller::view(bool ahead) const {
  PolicyView view;
  view.rays = rays->size();
  view.normal = intersections->available(secondary_import());
  view.shadow = intersections->available(ImportKind::Shadow);
  view.secondary_room = secondary_room();
  view.rays_to_come = ledger->rays_to_come();
  for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct}) {
    view.promised += intersections->size(kind) - intersections->available(kind);
  }
  for (const auto& given : given_) view.kernels += size32(given);
  view.eye_possible = eye_possible();
  view.more_to_come = rays->size() > 0 || ledger->rays_to_come() > 0;
  view.ahead = ahead;
  return view;
}

void Controller::decide() {
  clock->guard([&] {
    if (end_if_finished()) return;
    if (!device->can_launch()) return;
    const bool ahead = device->busy(device->next_unit());
    if (ahead && !chip_.launch_ahead) return;
    const Choice choice = policy_->choose(view(ahead));
    if (choice.kind != Choice::Kind::Halt) launch(choice);
  });
}

bool Controller::end_if_finished() {
  if (!next_tile_.at_end() || ledger->held() > 0 || !device->idle()) return false;
  finished_ = true;
  clock->stop();
  return true;
}

void Controller::launch(const Choice& choice) {
  const uint32_t unit = device->next_unit();
  LaunchCommand command;
  RayKernel kernel = RayKernel::CastEye;
  if (choice.kind == Choice::Kind::Eye) {
    if (!eye_possible()) throw std::logic_error("the policy casts eye rays that must not be cast now");
    command = next_tile(unit);
  } else {
    const bool shade = choice.kind == Choice::Kind::Shade;
    command.import = shade ? ImportKind::Shadow : secondary_import();
    command.threads = choice.threads;
    kernel = shade                                  ? RayKernel::Shade
             : command.import == ImportKind::Direct ? RayKernel::CastSecondaryDirect
                                                    : secondary_;
    if (choice.threads == 0 || choice.threads > intersections->available(command.import) ||
        choice.threads > options_.configuration.contents() || (!shade && choice.threads > secondary_room())) {
      throw std::logic_error("the policy launches a kernel of a size that is not possible now");
    }
    intersections->reserve(command.import, choice.threads);
    ledger->launched(unit, kernel, choice.threads);
  }
  command.pc = options_.entries[kernel];
  ChipResult::Kernel& count = kernels_[kernel];
  ++count.launches;
  count.threads += command.threads;
  given_[unit].push_back({kernel, command.threads, UINT64_MAX});
  device->launch(command);
}

LaunchCommand Controller::next_tile(uint32_t unit) {
  rules_.cast(ledger->held());
  std::vector<uint32_t> pixels;
  const TileWalk::Tile& tile = next_tile_.tile();
  for (uint32_t y = tile.top; y < std::min(tile.top + tile_height(), height_); ++y)
    for (uint32_t x = tile.left; x < std::min(tile.left + tile_width(), width_); ++x) pixels.push_back(x | y << 16);
  if (on_cast) on_cast(next_tile_.number(), pixels);
  ledger->eye_launched(unit, std::move(pixels));
  held_peak_ = std::max(held_peak_, ledger->held());

  LaunchCommand command;
  command.threads = tile_width() * tile_height();
  command.block = tile.block();
  next_tile_.next();
  return command;
}

std::string Controller::describe() const {
  return fmt::format(
      "controller: next tile at ({}, {}) of {}x{} pixels, {} pixels finished, {} held; ray pool {} of {} rays, {} of "
      "them shadow "
      "rays, {} more may "
      "come; intersection pool {} normal and {} shadow of {} each, {} and {} of them not promised to a kernel",
      next_tile_.tile().left, next_tile_.tile().top, width_, height_, ledger->finished(), ledger->held(), rays->size(),
      chip_.ray_pool_size, rays->shadow_rays(), ledger->rays_to_come(), intersections->size(ImportKind::Normal),
      intersections->size(ImportKind::Shadow), chip_.intersection_pool_size,
      intersections->available(ImportKind::Normal), intersections->available(ImportKind::Shadow));
}

}  // namespace raypool::chip
