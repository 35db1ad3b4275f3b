#include "estimate/estimated_frame.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "chip/frame_setup.hpp"
#include "chip/ray_fates.hpp"
#include "estimate/kernel_costs.hpp"
#include "estimate/launch_flow.hpp"
#include "estimate/tree_reads.hpp"
#include "kernel/kernels.hpp"
#include "kernel/target.hpp"

namespace raypool::estimate {
namespace {

// Runs of neighbouring tiles whose flow is computed.
constexpr uint32_t kRuns = 16;
constexpr int kRounds = 2;
// How far 19 of 20 estimates are off at most, as a share of the true value: `make estimates` measures it.
constexpr double kStaticError = 0.14, kHardwareError = 0.33, kLeastShareError = 0.01;

double relative_error(const Configuration& configuration) {
  return configuration.chip.traverser == TraverserName::Hardware ? kHardwareError : kStaticError;
}

struct Chosen {
  uint32_t tile;
  bool filled;  // caches are as they are in the whole frame
};
/// The tiles whose flow is computed, in their order.
std::vector<Chosen> chosen_tiles(uint32_t tiles, uint32_t threads, uint32_t pixels) {
  const uint32_t wanted = std::max(4 * kRuns, pixels / threads);
  std::vector<Chosen> chosen;
  if (wanted >= tiles) {
    for (uint32_t i = 0; i < tiles; ++i) chosen.push_back({i, true});
    return chosen;
  }
  const uint32_t run = wanted / kRuns;
  for (uint32_t k = 0; k < kRuns; ++k) {
    const auto first = static_cast<uint32_t>(uint64_t{k} * (tiles - run) / (kRuns - 1));
    for (uint32_t i = 0; i < run; ++i)
      if (chosen.empty() || first + i > chosen.back().tile) chosen.push_back({first + i, 2 * i >= run});
  }
  return chosen;
}

double share_of(uint64_t part, uint64_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

/// What the rays of some tiles come to, from drawing just these.
class TileCounter {
 public:
  TileCounter(const Configuration& configuration, const Tracer& tracer, const NativeOptions& native, uint32_t pixels)
      : configuration_(configuration), tracer_(tracer), native_(native), tile_of_(native.width * native.height) {
    const std::vector<PixelTile> all = chip::along_walk(configuration, native.width, native.height);
    const uint32_t width = 1u << tile_width_log2(configuration.contents());
    for (const auto& [number, filled] : chosen_tiles(size32(all), all.front().pixels, pixels)) {
      const PixelTile& tile = all[number];
      TileWork work;
      work.threads = tile.pixels;
      for (uint32_t i = 0; i < tile.pixels; ++i) {
        const uint32_t x = tile.x + i % width, y = tile.y + i / width;
        if (x >= native.width || y >= native.height) continue;
        tile_of_[y * native.width + x] = size32(work_);
        ++work.pixels;
      }
      native_.parts.push_back({tile});
      visits_.counts.push_back(filled);
      work_.push_back(work);
    }
    counts_.resize(work_.size());
    nodes_.resize(work_.size());
    triangles_.resize(work_.size());
    reflecting_.resize(work_.size());
  }

  std::vector<TileWork> count(const Scene& scene, const MemoryImage& image) {
    native_.threads = 1;
    native_.work = nullptr;
    native_.trace = [this](const Ray& ray, Intersection& hit) { return trace(ray, hit); };
    render_native(scene, image, tracer_, native_);
    for (size_t i = 0; i < work_.size(); ++i) {
      const RayCounts& rays = counts_[i];
      TileWork& work = work_[i];
      work.eye_hits = 1 - share_of(rays.eye.ended, rays.eye.traced);
      work.reflection_hits = 1 - share_of(rays.reflection.ended, rays.reflection.traced);
      const uint64_t hits = rays.eye.traced - rays.eye.ended + rays.reflection.traced - rays.reflection.ended;
      work.shadows = share_of(rays.shadow.traced, hits);
      work.lit = 1 - share_of(rays.shadow.ended, rays.shadow.traced);
      work.reflecting = share_of(reflecting_[i], hits);
      work.rays = static_cast<double>(rays.traced());
      work.nodes = share_of(nodes_[i], rays.traced());
      work.triangles = share_of(triangles_[i], rays.traced());
    }
    return work_;
  }
  RayVisits take_visits() { return std::move(visits_); }

 private:
  bool trace(const Ray& ray, Intersection& hit) {
    const uint32_t pixel = ray[word::kPixel];
    const uint32_t tile = tile_of_[(pixel >> 16) * native_.width + (pixel & 0xffff)];
    bool goes_on = false;
    if (configuration_.chip.traverser == TraverserName::Hardware) {
      TraversalCounts counts;
      goes_on = tracer_.trace(ray, hit, &counts, &visits_.places);
      visits_.ends.push_back(visits_.places.size());
      visits_.kinds.push_back({tile, raypool::is_shadow(ray) ? kShadowDepth : ray[word::kFlags] & kDepthMask});
      nodes_[tile] += counts.nodes;
      triangles_[tile] += counts.triangles;
    } else {
      goes_on = tracer_.trace(ray, hit);
    }
    counts_[tile].count(ray, goes_on);
    reflecting_[tile] += goes_on && !raypool::is_shadow(ray) && tracer_.reflects(hit[word::kMaterial]);
    return goes_on;
  }

  const Configuration& configuration_;
  const Tracer& tracer_;
  NativeOptions native_;
  std::vector<uint32_t> tile_of_;  // [pixel]
  std::vector<TileWork> work_;
  std::vector<RayCounts> counts_;
  std::vector<uint64_t> nodes_, triangles_, reflecting_;
  RayVisits visits_;
};

}  // namespace

KernelTable kernel_costs(const Configuration& configuration) {
  const Program& program = ray_kernel_program(KernelTarget(configuration));
  KernelTable costs;
  for (size_t i = 0; i < kRayKernels; ++i) costs[i] = costs_of(program, kRayKernelNames[i], configuration);
  return costs;
}

double error_of(const Configuration& configuration) {
  const double error = relative_error(configuration);
  return (1 / (1 - error) - 1 / (1 + error)) / 2;
}

FrameCounts count_frame(const Configuration& configuration, const Scene& scene, const MemoryImage& image,
                        const Tracer& tracer, const NativeOptions& native, const NativeStatistics& whole,
                        uint32_t pixels) {
  TileCounter counter(configuration, tracer, native, pixels);
  FrameCounts counts;
  counts.work.depth = native.depth;
  counts.work.reflections =
      secondary_kernel(static_cast<int>(native.depth), native.reflections) == RayKernel::CastSecondary;
  counts.work.tiles = counter.count(scene, image);
  counts.visits = counter.take_visits();
  counts.rays = static_cast<double>(whole.rays());
  return counts;
}

Estimates estimate_frame(const Configuration& configuration, uint32_t units, const FrameCounts& counts) {
  Workload work = counts.work;
  const auto kernels = kernel_costs(configuration);
  const double rays = counts.rays;
  Flow flow = flow_of(configuration, units, work, kernels);
  if (configuration.chip.traverser == TraverserName::Hardware) {
    // What caches read depends on how many rays are in flight and in which order, and that on what they read.
    for (int i = 0; i < kRounds; ++i) {
      const auto in_flight = std::max(1u, static_cast<uint32_t>(flow.in_flight));
      work.reads = reads_a_ray(configuration.chip, counts.visits, flow.order, in_flight);
      flow = flow_of(configuration, units, work, kernels);
    }
  }

  double cycles = flow.cycles;
  if (flow.rays < rays && flow.steady_rays > 0)
    cycles += flow.steady_cycles / flow.steady_rays * std::max(0.0, rays - flow.rays);
  const double error = relative_error(configuration);
  Estimates estimates;
  estimates.cycles = {cycles, cycles / (1 + error), cycles / (1 - error)};
  const auto mrays = [&](double in_cycles) { return 1e3 * rays / in_cycles; };
  estimates.mrays_per_s = {mrays(cycles), mrays(estimates.cycles.high), mrays(estimates.cycles.low)};
  const auto share = [&](double value) {
    value = std::min(1.0, value);
    const double off = std::max(kLeastShareError, error * value);
    return Interval{value, std::max(0.0, value - off), std::min(1.0, value + off)};
  };
  estimates.ray_port = share(flow.ray_port / flow.cycles);
  estimates.intersection_port = share(flow.intersection_port / flow.cycles);
  for (size_t type = 0; type < kAluTypes; ++type) {
    double busy = 0;
    for (size_t kernel = 0; kernel < kRayKernels; ++kernel)
      for (const Segment& segment : kernels[kernel].segments) busy += flow.warps[kernel] * segment.busy[type];
    estimates.alus[type] = share(busy / configuration.alus[type].count / flow.kernel_cycles);
  }
  const double lines = (work.reads.nodes + work.reads.triangles) * flow.rays;
  estimates.memory_port = share(lines * 4 * configuration.chip.memory_cycles_per_beat / flow.cycles);
  return estimates;
}

}  // namespace raypool::estimate
