// What a frame has come to, gathered from the modules of the chip.
#include <algorithm>

#include "chip/frame_figures.hpp"
#include "machine/compute/warp_cycles.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::chip {

namespace {

// A warp that always has a thread and waits for no other warp: its instructions one after the other.
uint64_t own_cycles(const WarpCycles& cycles) {
  return cycles.fetch + cycles.registers + cycles.issued + cycles.executing_sum();
}

double ratio(double part, double whole) { return whole == 0 ? 0 : part / whole; }
double ratio(uint64_t part, uint64_t whole) { return ratio(static_cast<double>(part), static_cast<double>(whole)); }

PoolFill pool_fill(const LevelStatistics& fill, uint32_t capacity, uint64_t cycles) {
  return {capacity, fill.peak(), fill.mean(cycles)};
}

// Averages over the units, from their counters.
void collect_units(const ChipOptions& options, const FrameFigures& figures, ChipResult& result) {
  const auto& sum = figures.counter;
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

void collect_pools(const ChipConfiguration& chip, const FrameFigures& figures, ChipResult& result) {
  const auto fill = [&](ImportKind kind) {
    return pool_fill(*figures.intersections[kind], chip.intersection_pool_size, result.cycles);
  };
  result.rays_pool = pool_fill(*figures.rays, chip.ray_pool_size, result.cycles);
  result.normal_pool = fill(ImportKind::Normal);
  result.shadow_pool = fill(ImportKind::Shadow);
  result.direct_pool = fill(ImportKind::Direct);
  result.ray_port_utilisation = ratio(figures.ray_port_busy, result.cycles);
  result.intersection_port_utilisation = ratio(figures.intersection_port_busy, result.cycles);
  result.memory_port_utilisation = ratio(figures.memory_port_busy, result.cycles);
  result.memory_reads = figures.memory_reads;
  result.memory_writes = figures.memory_writes;
}

// Of each resource: as often as it was busy in the cycles that there were, so many times the speed it would bear.
void collect_ceilings(const ChipOptions& options, const FrameFigures& figures, ChipResult& result) {
  const auto add = [&](std::string name, uint64_t busy, uint64_t cycles) {
    if (busy > 0 && cycles > 0) result.ceilings.push_back({std::move(name), result.mrays_per_s * ratio(cycles, busy)});
  };
  const uint64_t units = figures.units;
  add("issue", result.instruction_cache_hits + result.instruction_cache_misses, result.cycles * units);
  for (int type = 0; type < kAluTypes; ++type) {
    const auto instances = static_cast<uint64_t>(options.configuration.alus[type].count);
    const uint64_t unused = figures.counter(counter::kUnused + type);
    add(std::string(kAluNames[type]), result.busy_cycles * instances - unused, result.cycles * units * instances);
  }
  add("ray_port", figures.ray_port_busy, result.cycles);
  add("intersection_port", figures.intersection_port_busy, result.cycles);
  add("frame_port", figures.contributions, result.cycles);
  add("memory_port", figures.memory_port_busy, result.cycles);
  add("traverser", result.rays(), figures.traverser.most_rays);
  if (result.traversal) {
    const ChipConfiguration& chip = options.configuration.chip;
    add("box_pipes", result.traversal->boxes.tests, result.cycles * chip.hardware_traverser_lanes);
    add("triangle_pipes", result.traversal->triangles.tests, result.cycles * chip.hardware_traverser_triangle_pipes);
    add("rays_in_flight", result.traversal->ray_cycles, result.cycles * chip.hardware_traverser_rays);
  }
  add("latency", own_cycles(result.warp_cycles), result.warp_cycles.busy + result.warp_cycles_without_kernel);
  std::sort(result.ceilings.begin(), result.ceilings.end(),
            [](const Ceiling& a, const Ceiling& b) { return a.mrays_per_s < b.mrays_per_s; });
}

void collect_rays(const ChipOptions& options, const FrameFigures& figures, ChipResult& result) {
  result.ray_counts = figures.traverser.rays;
  result.dropped_depth = figures.dropped_depth + figures.traverser.deepest;
  result.contributions = figures.contributions;
  result.kernels = figures.kernels->kernels();
  result.ray_counts.count_left_out(
      result.kernels[RayKernel::CastSecondary].threads + result.kernels[RayKernel::CastSecondaryDirect].threads,
      secondary_kernel(options.depth, options.reflections) == RayKernel::CastSecondary, result.dropped_depth);
  if (!result.timed) return;
  const auto traced = static_cast<double>(result.rays());
  const double thesis = options.depth == 1 ? 2.0 * options.width * options.height : traced;
  result.mrays_per_s = ratio(1e3 * traced, result.nanoseconds);
  result.thesis_mrays_per_s = ratio(1e3 * thesis, result.nanoseconds);
  result.frames_per_s = ratio(1e9, result.nanoseconds);
}

}  // namespace

ChipResult chip_result(const ChipOptions& options, const FrameFigures& figures) {
  ChipResult result;
  result.timed = figures.timed;
  result.cycles = figures.cycles;
  result.nanoseconds = static_cast<double>(result.cycles);
  collect_rays(options, figures, result);

  result.busy_cycles = figures.busy_cycles;
  result.time_utilisation = ratio(result.busy_cycles, result.cycles * figures.units);
  result.resource_utilisation = figures.kernels->resource_utilisation();
  collect_units(options, figures, result);

  collect_pools(options.configuration.chip, figures, result);
  result.traversal = figures.work;
  if (result.timed) {
    result.warp_cycles = warp_cycles(options.configuration, figures.counter);
    result.warp_cycles_without_kernel =
        result.cycles * static_cast<uint64_t>(figures.units * options.configuration.warps) - result.warp_cycles.busy;
    collect_ceilings(options, figures, result);
  }
  result.traverser_batches = figures.traverser.batches;
  result.traverser_stall_batches = figures.traverser.stall_batches;
  return result;
}

}  // namespace raypool::chip
