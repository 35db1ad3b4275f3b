#include "chip/several_frames.hpp"

#include <algorithm>
#include <cstddef>

namespace raypool {
namespace {

/// Of two averages, weighted by what they are averages over.
double mean(double a, uint64_t weight_a, double b, uint64_t weight_b) {
  const uint64_t weight = weight_a + weight_b;
  if (weight == 0) return 0;
  return (a * static_cast<double>(weight_a) + b * static_cast<double>(weight_b)) / static_cast<double>(weight);
}

double rate(double count, double nanoseconds) { return nanoseconds == 0 ? 0 : count / nanoseconds; }

void add_work(PipeWork& sum, const PipeWork& other) {
  sum.tests += other.tests;
  sum.waiting += other.waiting;
}

void add_work(TraverserWork& sum, const TraverserWork& other) {
  sum.rays += other.rays;
  sum.ray_cycles += other.ray_cycles;
  sum.most_rays = std::max(sum.most_rays, other.most_rays);
  sum.leaves += other.leaves;
  add_work(sum.boxes, other.boxes);
  add_work(sum.triangles, other.triangles);
  sum.node_cache += other.node_cache;
  sum.triangle_cache += other.triangle_cache;
  sum.deepest_stack = std::max(sum.deepest_stack, other.deepest_stack);
  sum.stack_spills += other.stack_spills;
  sum.stack_fills += other.stack_fills;
  sum.memory_lines += other.memory_lines;
  sum.memory_quadwords += other.memory_quadwords;
}

void add_cycles(WarpCycles& sum, const WarpCycles& other) {
  for (uint64_t WarpCycles::*part :
       {&WarpCycles::busy, &WarpCycles::not_launched, &WarpCycles::ended, &WarpCycles::fetch, &WarpCycles::registers,
        &WarpCycles::issued, &WarpCycles::imports, &WarpCycles::exports}) {
    sum.*part += other.*part;
  }
  for (size_t i = 0; i < kAluTypes; ++i) {
    sum.waiting[i] += other.waiting[i];
    sum.executing[i] += other.executing[i];
  }
}

/// Cycles of kernels, over which the share of threads is an average.
uint64_t kernel_cycles(const ChipResult& result) {
  uint64_t cycles = 0;
  for (const ChipResult::Kernel& kernel : result.kernels) cycles += kernel.cycles;
  return cycles;
}

/// Averages, before the times that they are over are added.
void add_averages(ChipResult& sum, const ChipResult& frame) {
  const auto over_time = [&](double a, double b) { return mean(a, sum.cycles, b, frame.cycles); };
  sum.time_utilisation = over_time(sum.time_utilisation, frame.time_utilisation);
  sum.resource_utilisation =
      mean(sum.resource_utilisation, kernel_cycles(sum), frame.resource_utilisation, kernel_cycles(frame));
  for (size_t i = 0; i < kAluTypes; ++i) {
    ChipResult::Alu& alu = sum.alus[i];
    const ChipResult::Alu& other = frame.alus[i];
    alu.utilisation = mean(alu.utilisation, sum.busy_cycles, other.utilisation, frame.busy_cycles);
    alu.waiting = mean(alu.waiting, sum.busy_cycles, other.waiting, frame.busy_cycles);
    alu.issued += other.issued;
  }
  for (double ChipResult::*share : {&ChipResult::ray_port_utilisation, &ChipResult::intersection_port_utilisation,
                                    &ChipResult::memory_port_utilisation}) {
    sum.*share = over_time(sum.*share, frame.*share);
  }
  for (PoolFill ChipResult::*pool :
       {&ChipResult::rays_pool, &ChipResult::normal_pool, &ChipResult::shadow_pool, &ChipResult::direct_pool}) {
    PoolFill& fill = sum.*pool;
    const PoolFill& other = frame.*pool;
    fill = {other.capacity, std::max(fill.peak, other.peak), over_time(fill.mean, other.mean)};
  }
}

/// Of the sum of rays: a resource was busy for the time that it would have taken each frame at its ceiling.
std::vector<Ceiling> joined_ceilings(const ChipResult& sum, const ChipResult& frame) {
  const auto busy_time = [](const ChipResult& result, const std::string& name) {
    for (const Ceiling& one : result.ceilings) {
      if (one.name == name) return rate(static_cast<double>(result.rays()), one.mrays_per_s);
    }
    return 0.0;
  };
  const auto rays = static_cast<double>(sum.rays() + frame.rays());
  std::vector<Ceiling> joined;
  for (const ChipResult* result : {&sum, &frame}) {
    for (const Ceiling& one : result->ceilings) {
      const auto same = [&](const Ceiling& other) { return other.name == one.name; };
      if (std::any_of(joined.begin(), joined.end(), same)) continue;
      joined.push_back({one.name, rate(rays, busy_time(sum, one.name) + busy_time(frame, one.name))});
    }
  }
  std::sort(joined.begin(), joined.end(),
            [](const Ceiling& a, const Ceiling& b) { return a.mrays_per_s < b.mrays_per_s; });
  return joined;
}

void add_counts(ChipResult& sum, const ChipResult& frame) {
  for (uint64_t ChipResult::*count :
       {&ChipResult::cycles, &ChipResult::dropped_depth, &ChipResult::contributions, &ChipResult::busy_cycles,
        &ChipResult::instructions, &ChipResult::thread_instructions, &ChipResult::warp_cycles_without_kernel,
        &ChipResult::instruction_cache_hits, &ChipResult::instruction_cache_misses, &ChipResult::data_cache_hits,
        &ChipResult::data_cache_misses, &ChipResult::data_cache_stores, &ChipResult::memory_reads,
        &ChipResult::memory_writes, &ChipResult::traverser_batches, &ChipResult::traverser_stall_batches}) {
    sum.*count += frame.*count;
  }
  sum.ray_counts.add(frame.ray_counts);
  for (size_t i = 0; i < kRayKernels; ++i) {
    sum.kernels[i].launches += frame.kernels[i].launches;
    sum.kernels[i].threads += frame.kernels[i].threads;
    sum.kernels[i].cycles += frame.kernels[i].cycles;
  }
  add_cycles(sum.warp_cycles, frame.warp_cycles);
  if (!frame.traversal) return;
  if (sum.traversal)
    add_work(*sum.traversal, *frame.traversal);
  else
    sum.traversal = frame.traversal;
}

}  // namespace

void add_frame(ChipResult& sum, const ChipResult& frame) {
  if (sum.cycles == 0 && sum.instructions == 0) {
    sum = frame;
    return;
  }
  sum.ceilings = joined_ceilings(sum, frame);
  add_averages(sum, frame);
  const double thesis_rays = sum.thesis_mrays_per_s * sum.nanoseconds + frame.thesis_mrays_per_s * frame.nanoseconds;
  sum.nanoseconds += frame.nanoseconds;
  sum.wall_seconds += frame.wall_seconds;
  add_counts(sum, frame);
  if (!sum.timed) return;
  sum.mrays_per_s = rate(1e3 * static_cast<double>(sum.rays()), sum.nanoseconds);
  sum.thesis_mrays_per_s = rate(thesis_rays, sum.nanoseconds);
  sum.frames_per_s = rate(1e9, sum.nanoseconds);
}

}  // namespace raypool
