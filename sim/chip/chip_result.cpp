// What a frame has come to, gathered from the modules of the chip.
#include <algorithm>

#include "chip/chip_module.hpp"

namespace raypool::chip {

namespace {

// A warp that always has a thread and waits for nobody: its instructions one after the other.
uint64_t own_cycles(const WarpCycles& cycles) {
  return cycles.fetch + cycles.registers + cycles.issued + cycles.executing_sum();
}

double ratio(double part, double whole) { return whole == 0 ? 0 : part / whole; }
double ratio(uint64_t part, uint64_t whole) { return ratio(static_cast<double>(part), static_cast<double>(whole)); }

PoolFill pool_fill(const LevelStatistics& fill, uint32_t capacity, uint64_t cycles) {
  return {capacity, fill.peak(), fill.mean(cycles)};
}

}  // namespace

// Averages over the units, from their counters.
void Chip::collect_units(ChipResult& result) const {
  const auto sum = [&](int number) { return options_.device->counter(number); };
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
    const auto instances = static_cast<uint64_t>(options_.configuration.alus[static_cast<size_t>(i)].count);
    if (busy > 0) alu.utilisation = 1 - ratio(sum(counter::kUnused + i), busy * instances);
    alu.waiting = ratio(sum(counter::kWaiting + i), busy);
  }
}

void Chip::collect_pools(ChipResult& result) const {
  result.rays_pool = pool_fill(rays_.fill(), rays_.capacity(), result.cycles);
  result.normal_pool = pool_fill(intersections_.fill(ImportKind::Normal), intersections_.capacity(), result.cycles);
  result.shadow_pool = pool_fill(intersections_.fill(ImportKind::Shadow), intersections_.capacity(), result.cycles);
  result.direct_pool = pool_fill(intersections_.fill(ImportKind::Direct), intersections_.capacity(), result.cycles);
  result.ray_port_utilisation = ratio(rays_.busy_cycles(), result.cycles);
  result.intersection_port_utilisation = ratio(intersections_.busy_cycles(), result.cycles);
  result.memory_port_utilisation = ratio(memory_port_.busy_cycles(), result.cycles);
  result.memory_reads = memory_port_.reads();
  result.memory_writes = memory_port_.writes();
}

// Of each resource: as often as it was busy in the cycles that there were, so many times the speed it would bear.
void Chip::collect_ceilings(ChipResult& result) const {
  const auto add = [&](std::string name, uint64_t busy, uint64_t cycles) {
    if (busy > 0 && cycles > 0) result.ceilings.push_back({std::move(name), result.mrays_per_s * ratio(cycles, busy)});
  };
  const auto units = static_cast<uint64_t>(options_.device->units());
  add("issue", result.instruction_cache_hits + result.instruction_cache_misses, result.cycles * units);
  for (int type = 0; type < kAluTypes; ++type) {
    const auto instances = static_cast<uint64_t>(options_.configuration.alus[type].count);
    const uint64_t unused = options_.device->counter(counter::kUnused + type);
    add(std::string(kAluNames[type]), result.busy_cycles * instances - unused, result.cycles * units * instances);
  }
  add("ray_port", rays_.busy_cycles(), result.cycles);
  add("intersection_port", intersections_.busy_cycles(), result.cycles);
  add("frame_port", frame_.taken(), result.cycles);
  add("memory_port", memory_port_.busy_cycles(), result.cycles);
  add("traverser", result.rays(), traverser_->counts().most_rays);
  if (result.traversal) {
    const ChipConfiguration& chip = options_.configuration.chip;
    add("box_pipes", result.traversal->boxes.tests, result.cycles * chip.modelled_traverser_box_pipes);
    add("triangle_pipes", result.traversal->triangles.tests, result.cycles * chip.modelled_traverser_triangle_pipes);
    add("rays_in_flight", result.traversal->ray_cycles, result.cycles * chip.modelled_traverser_rays);
  }
  add("latency", own_cycles(result.warp_cycles), result.warp_cycles.busy + result.warp_cycles_without_kernel);
  std::sort(result.ceilings.begin(), result.ceilings.end(),
            [](const Ceiling& a, const Ceiling& b) { return a.mrays_per_s < b.mrays_per_s; });
}

Counts Chip::counts() const {
  Counts counts{};
  ComputeUnit& device = *options_.device;
  const RayCounts& rays = traverser_->counts().rays;
  const auto set = [&](size_t number, uint64_t value) { counts[number] = static_cast<double>(value); };
  set(count::kCycles, clock_.cycle());
  set(count::kEyeRays, rays.eye.traced);
  set(count::kReflectionRays, rays.reflection.traced);
  set(count::kShadowRays, rays.shadow.traced);
  set(count::kBusyCycles, device.counter(counter::kBusyCycles));
  set(count::kInstructions, device.counter(counter::kInstructions));
  set(count::kThreadInstructions, device.counter(counter::kThreadInstructions));
  set(count::kRayPort, rays_.busy_cycles());
  set(count::kIntersectionPort, intersections_.busy_cycles());
  set(count::kMemoryPort, memory_port_.busy_cycles());
  for (size_t type = 0; type < kAluTypes; ++type) {
    set(count::kUnused + type, device.counter(counter::kUnused + static_cast<int>(type)));
    set(count::kIssued + type, device.counter(counter::kIssued + static_cast<int>(type)));
  }
  return counts;
}

ChipResult Chip::collect() const {
  ChipResult result;
  result.timed = options_.device->timed();
  result.cycles = clock_.cycle();
  result.nanoseconds = static_cast<double>(result.cycles);
  const TraverserCounts& counts = traverser_->counts();
  result.ray_counts = counts.rays;
  result.dropped_depth = rays_.dropped_depth() + counts.deepest;
  result.contributions = frame_.taken();
  result.held_peak = controller_->held_peak();
  result.kernels = controller_->kernels();
  result.ray_counts.count_left_out(
      result.kernels[RayKernel::CastSecondary].threads + result.kernels[RayKernel::CastSecondaryDirect].threads,
      secondary_kernel(options_.depth, options_.reflections) == RayKernel::CastSecondary, result.dropped_depth);
  if (result.timed) {
    const auto traced = static_cast<double>(result.rays());
    const double thesis = options_.depth == 1 ? 2.0 * options_.width * options_.height : traced;
    result.mrays_per_s = ratio(1e3 * traced, result.nanoseconds);
    result.thesis_mrays_per_s = ratio(1e3 * thesis, result.nanoseconds);
    result.frames_per_s = ratio(1e9, result.nanoseconds);
  }

  result.busy_cycles = device_.busy_cycles();
  result.time_utilisation = ratio(result.busy_cycles, result.cycles * options_.device->units());
  result.resource_utilisation = controller_->resource_utilisation();
  collect_units(result);

  collect_pools(result);
  result.traversal = traverser_->work();
  if (result.timed) {
    result.warp_cycles = warp_cycles(options_.configuration, *options_.device);
    result.warp_cycles_without_kernel =
        result.cycles * static_cast<uint64_t>(options_.device->units() * options_.configuration.warps) -
        result.warp_cycles.busy;
    collect_ceilings(result);
  }
  result.traverser_batches = counts.batches;
  result.traverser_stall_batches = counts.stall_batches;
  return result;
}

}  // namespace raypool::chip
