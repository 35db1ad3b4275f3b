#include "chip/chip.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <stdexcept>

#include "chip/chip_clock.hpp"
#include "chip/controller.hpp"
#include "chip/device_host.hpp"
#include "chip/frame_port.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/memory_port.hpp"
#include "chip/monitor.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ray_pool.hpp"
#include "chip/simulation.hpp"
#include "chip/traverser.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {

namespace {

using namespace chip;

void require_range(const char* what, int value, int low, int high) {
  if (value < low || value > high) throw InputError(fmt::format("{} is {}; it must lie in {} .. {}", what, value, low, high));
}

int tile_width(const ChipOptions& options) { return 1 << tile_width_log2(options.configuration.contents()); }

void check(const ChipOptions& options) {
  if (options.device == nullptr || options.memory == nullptr || options.tracer == nullptr || options.frame == nullptr) {
    throw std::logic_error("run_chip needs device, memory, tracer and frame");
  }
  require_range("image width", options.width, 1, 65535);
  require_range("image height", options.height, 1, 65535);
  require_range("depth", options.depth, 1, kLargestDepth);
  require_range("ray pool's packages", options.ray_packages, 1, 1 << 20);
  require_range("intersection pool's packages", options.intersection_packages, tile_width(options), 1 << 20);
  require_range("limit of held pixels", options.held_limit, tile_width(options), options.intersection_packages);
}

/// The modules of a chip, connected.
struct Chip {
  explicit Chip(const ChipOptions& options)
      : units(static_cast<int>(options.device->units())),
        clock("clock"),
        ledger(units, options.width, options.height),
        memory("memory_port", clock, *options.memory),
        rays("ray_pool", clock, ledger, options.ray_packages, options.depth),
        intersections("intersection_pool", clock, ledger, options.intersection_packages),
        frame(ledger, *options.frame),
        controller("controller", options, clock, rays, intersections, ledger),
        traverser(make_traverser(options.traverser,
                                 {clock, rays, intersections, ledger, *options.tracer, units, [this] { controller.changed(); }})),
        device("device", *options.device,
               {clock, memory, controller, DeviceSurroundings::Frame{rays, intersections, frame, ledger, *traverser}}) {
    controller.connect(device);
  }

  uint64_t rays_traced() const { return traverser->counts().rays.traced(); }
  std::string describe() { return controller.describe() + "; " + device.describe(); }

  int units;
  ChipClock clock;
  PixelLedger ledger;
  MemoryPort memory;
  RayPool rays;
  IntersectionPool intersections;
  FramePort frame;
  Controller controller;
  std::unique_ptr<Traverser> traverser;
  DeviceHost device;
};

MonitorOptions watch(const ChipOptions& options, Chip& chip) {
  MonitorOptions watch;
  watch.watchdog_cycles = options.watchdog_cycles;
  watch.cycle_limit = options.cycle_limit;
  watch.retired = [&chip] { return chip.device.instructions(); };
  watch.transfers = [&chip] { return chip.rays_traced() + chip.traverser->counts().delivered + chip.device.transfers(); };
  if (options.progress) {
    watch.progress = [&options, &chip] {
      options.progress({static_cast<double>(chip.ledger.finished()) / static_cast<double>(chip.ledger.pixels()),
                        chip.clock.cycle(), chip.rays_traced()});
    };
  }
  watch.describe = [&chip] { return chip.describe(); };
  return watch;
}

double ratio(double part, double whole) { return whole == 0 ? 0 : part / whole; }
double ratio(uint64_t part, uint64_t whole) { return ratio(static_cast<double>(part), static_cast<double>(whole)); }

PoolFill pool_fill(const LevelStatistics& fill, uint32_t capacity, uint64_t cycles) {
  return {capacity, fill.peak(), fill.mean(cycles)};
}

/// Averages over the units, from their counters.
void collect_units(const ChipOptions& options, ChipResult& result) {
  const auto sum = [&](int number) { return options.device->counter(number); };
  const uint64_t busy = sum(counter::kBusyCycles);
  result.instructions = sum(counter::kInstructions);
  result.thread_instructions = sum(counter::kThreadInstructions);
  result.instruction_cache_hits = sum(counter::kInstructionCacheHits);
  result.instruction_cache_misses = sum(counter::kInstructionCacheMisses);
  result.data_cache_hits = sum(counter::kDataCacheHits);
  result.data_cache_misses = sum(counter::kDataCacheMisses);
  result.data_cache_stores = sum(counter::kDataCacheStores);
  for (int i = 0; i < kAluTypes; ++i) {
    ChipResult::Alu& alu = result.alus[static_cast<size_t>(i)];
    alu.issued = sum(counter::kIssued + i);
    if (!result.timed) continue;
    const auto instances = static_cast<uint64_t>(options.configuration.alus[static_cast<size_t>(i)].count);
    if (busy > 0) alu.utilisation = 1 - ratio(sum(counter::kUnused + i), busy * instances);
    alu.waiting = ratio(sum(counter::kWaiting + i), busy);
  }
}

ChipResult collect(const ChipOptions& options, const Chip& chip) {
  ChipResult result;
  result.timed = options.device->timed();
  result.cycles = chip.clock.cycle();
  result.nanoseconds = static_cast<double>(result.cycles);
  const TraverserCounts& counts = chip.traverser->counts();
  result.ray_counts = counts.rays;
  result.dropped_depth = chip.rays.dropped_depth();
  result.contributions = chip.frame.taken();
  result.held_peak = chip.controller.held_peak();
  result.kernels = chip.controller.kernels();
  if (result.timed) {
    const auto traced = static_cast<double>(result.rays());
    const double thesis = options.depth == 1 ? 2.0 * options.width * options.height : traced;
    result.mrays_per_s = ratio(1e3 * traced, result.nanoseconds);
    result.thesis_mrays_per_s = ratio(1e3 * thesis, result.nanoseconds);
    result.frames_per_s = ratio(1e9, result.nanoseconds);
  }

  result.busy_cycles = chip.device.busy_cycles();
  result.time_utilisation = ratio(result.busy_cycles, result.cycles * options.device->units());
  result.resource_utilisation = chip.controller.resource_utilisation();
  collect_units(options, result);

  result.rays_pool = pool_fill(chip.rays.fill(), chip.rays.capacity(), result.cycles);
  result.normal_pool = pool_fill(chip.intersections.fill(ImportKind::Normal), chip.intersections.capacity(), result.cycles);
  result.shadow_pool = pool_fill(chip.intersections.fill(ImportKind::Shadow), chip.intersections.capacity(), result.cycles);
  result.ray_port_utilisation = ratio(chip.rays.busy_cycles(), result.cycles);
  result.intersection_port_utilisation = ratio(chip.intersections.busy_cycles(), result.cycles);
  result.memory_port_utilisation = ratio(chip.memory.busy_cycles(), result.cycles);
  result.memory_reads = chip.memory.reads();
  result.memory_writes = chip.memory.writes();
  result.traverser_batches = counts.batches;
  result.traverser_stall_batches = counts.stall_batches;
  return result;
}

}  // namespace

std::string fault_sentence(int unit, const Fault& fault) {
  const char* meaning = "of an unknown kind";
  switch (fault.code) {
    case FaultCode::None:
      meaning = "of no kind";
      break;
    case FaultCode::IllegalInstruction:
      meaning = "illegal instruction";
      break;
    case FaultCode::PcOutsideProgram:
      meaning = "PC outside the program";
      break;
    case FaultCode::StackOverflow:
      meaning = "PC stack overflow: calls and loops are nested too deep";
      break;
    case FaultCode::StackUnderflow:
      meaning = "PC stack underflow: ret without call";
      break;
    case FaultCode::Misaligned:
      meaning = "address that is not a multiple of 4";
      break;
    case FaultCode::AddressOutsideMemory:
      meaning = "address outside the memory";
      break;
    case FaultCode::RayWordOutside:
      meaning = "ray word above 20";
      break;
  }
  return fmt::format("compute unit {} stopped with fault {} ({}) in warp {} at PC {}", unit, static_cast<int>(fault.code),
                     meaning, fault.warp, fault.pc);
}

ChipResult run_chip(const ChipOptions& options) {
  check(options);
  const auto begin = std::chrono::steady_clock::now();
  std::array<uint32_t, kArguments> arguments = options.arguments;
  arguments[argument::kTileWidthLog2] = static_cast<uint32_t>(tile_width_log2(options.configuration.contents()));
  arguments[argument::kTileMask] = static_cast<uint32_t>(tile_width(options)) - 1;
  arguments[argument::kWidth] = static_cast<uint32_t>(options.width);
  arguments[argument::kHeight] = static_cast<uint32_t>(options.height);
  options.device->reset(options.program_length, options.memory->size());
  for (int i = 0; i < kArguments; ++i) options.device->set_argument(i, arguments[static_cast<size_t>(i)]);

  Simulation simulation;
  Chip chip(options);
  const MonitorOptions watching = watch(options, chip);
  Monitor monitor("monitor", chip.clock, watching);
  chip.controller.changed();
  simulation.run();
  chip.clock.rethrow();
  if (!chip.controller.finished()) {
    throw ChipStalled(
        fmt::format("the chip is locked up: nothing is left to happen at cycle {}; {}", chip.clock.cycle(), chip.describe()));
  }
  if (watching.progress) watching.progress();

  ChipResult result = collect(options, chip);
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace raypool
