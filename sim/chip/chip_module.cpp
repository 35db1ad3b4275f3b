#include "chip/chip_module.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "chip/frame_setup.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::chip {

namespace {

const ChipOptions& checked(const ChipOptions& options) {
  if (options.device == nullptr || options.tracer == nullptr)
    throw std::logic_error("run_chip needs a device and a tracer");
  check_frame(options);
  if (options.device->timed() && options.configuration.chip.traverser == TraverserName::Hardware) {
    throw InputError(
        "chip.traverser is hardware: that one is in the chip as one piece (--chip model, rtl or lockstep), not in this "
        "one: choose another with --traverser");
  }
  return options;
}

}  // namespace

Chip::Chip(const sc_core::sc_module_name& name, const ChipOptions& options)
    : sc_module(name),
      options_(checked(options)),
      ledger_("pixel_ledger", options.device->units(), options.width, options.height,
              options.configuration.kernel_overlap),
      memory_port_("memory_port", options.configuration.chip),
      rays_("ray_pool", options.configuration.chip, options.depth),
      intersections_("intersection_pool", options.configuration.chip, options.layout),
      frame_("frame_port", *options.frame),
      controller_(make_controller("controller", options_)),
      traverser_(make_traverser({*options.tracer, options.configuration.chip, options.device->units(), options.depth,
                                 secondary_kernel(options.depth, options.reflections) == RayKernel::CastSecondary,
                                 options.device->timed()})),
      device_("device_host", *options.device),
      monitor_("monitor", {options.watchdog_cycles, options.limits, true, options.progress != nullptr,
                           options.device->timed() ? &options.configuration : nullptr}) {
  memory_port_.clock(clock_.now);
  memory_port_.socket.bind(memory);
  memory_port_.others(traverser_->memory_user);

  rays_.clock(clock_.now);
  rays_.ledger(ledger_.records);
  rays_.arrivals(traverser_->arrivals);

  intersections_.clock(clock_.now);
  intersections_.ledger(ledger_.records);
  intersections_.room(traverser_->room);

  frame_.clock(clock_.now);
  frame_.ledger(ledger_.records);
  ledger_.controller(controller_->decisions);

  controller_->clock(clock_.now);
  controller_->rays(rays_.controller);
  controller_->intersections(intersections_.controller);
  controller_->ledger(ledger_.records);
  controller_->device(device_.launches);

  traverser_->clock(clock_.now);
  traverser_->rays(rays_.traverser);
  traverser_->intersections(intersections_.traverser);
  traverser_->frame(frame_.traverser);
  traverser_->ledger(ledger_.records);
  traverser_->controller(controller_->decisions);
  traverser_->memory(memory_port_.turns);

  device_.clock(clock_.now);
  device_.memory(memory_port_.device);
  device_.rays(rays_.device);
  device_.intersections(intersections_.device);
  device_.frame(frame_.device);
  device_.controller(controller_->decisions);
  device_.kernel_events(controller_->kernel_events);
  device_.kernel_events(ledger_.kernel_events);
  device_.kernel_events(traverser_->kernel_events);

  monitor_.clock(clock_.now);
  monitor_.watched(*this);
  if (options_.tile_costs != nullptr) watch_tiles();
}

void Chip::watch_tiles() {
  tile_of_.resize(place(options_.width - 1, options_.height - 1) + 1);
  controller_->on_cast = [this](uint32_t tile, const std::vector<uint32_t>& pixels) {
    const uint32_t first = pixels.front();
    tile_of_[place(first & 0xffff, first >> 16)] = options_.tile_costs->cast(size32(pixels), counts());
    if (options_.visited_before && tile != next_tile_) traverser_->remember(options_.visited_before(tile));
    next_tile_ = tile + 1;
  };
  ledger_.on_finished = [this](uint32_t pixel) {
    options_.tile_costs->finished(tile_of_[place(pixel & 0xffff, pixel >> 16)], counts());
  };
}

size_t Chip::place(uint32_t x, uint32_t y) const {
  const uint32_t columns = (options_.width + controller_->tile_width() - 1) / controller_->tile_width();
  return size_t{y / controller_->tile_height()} * columns + x / controller_->tile_width();
}

WorkDone Chip::work_done() {
  WorkDone done = traverser_->work_done();
  done.instructions = device_.instructions();
  done.other += device_.transfers();
  done.due = std::min(done.due, memory_port_.response_due());
  return done;
}

std::string Chip::describe() {
  return fmt::format("{}; {}; {}; {}", controller_->describe(), traverser_->describe(), memory_port_.describe(),
                     device_.describe());
}

void Chip::show_progress() {
  options_.progress({static_cast<double>(ledger_.finished()) / controller_->pixels(), clock_.cycle(), rays_traced()});
}

ChipResult Chip::draw() {
  const auto begin = std::chrono::steady_clock::now();
  ComputeUnit& device = *options_.device;
  const std::array<uint32_t, kArguments> arguments = frame_arguments(options_);
  device.reset(options_.program_length, options_.memory->size());
  for (uint32_t i = 0; i < kArguments; ++i) device.set_argument(i, arguments[i]);

  sc_core::sc_start();
  clock_.rethrow();
  if (!controller_->finished()) {
    throw ChipStalled(
        fmt::format("the chip is locked up: nothing is left to happen at cycle {}; {}", clock_.cycle(), describe()));
  }
  if (options_.progress) show_progress();

  if (options_.tile_costs != nullptr) options_.tile_costs->end(counts());
  ChipResult result = collect();
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace raypool::chip
