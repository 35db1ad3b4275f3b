#include "explore/guess.hpp"

#include <algorithm>
#include <cmath>

#include "estimate/launch_flow.hpp"
#include "estimate/ray_flights.hpp"
#include "kernel/kernels.hpp"

namespace raypool::explore {

double Guesses::unit_cycles(const Configuration& configuration, const estimate::KernelTable& kernels) const {
  double serial = 0, issue = 0;
  EnumArray<AluType, double, kAluTypes> busy{};
  for (const RayKernel kernel :
       kernels_of(configuration.chip, static_cast<int>(counts_.work.depth), counts_.work.reflections)) {
    const double warps = static_cast<double>(whole_.kernel_threads[kernel]) / configuration.lanes;
    for (const estimate::Segment& segment : kernels[kernel].segments) {
      serial += warps * segment.serial;
      issue += warps * segment.instructions;
      for (size_t type = 0; type < kAluTypes; ++type)
        busy[type] += warps * segment.busy[type] / configuration.alus[type].count;
    }
  }
  // As warps that share a resource slow each other down.
  const auto power = [](double cycles) { return std::pow(cycles, estimate::kUnitSharpness); };
  double sum = power(serial / configuration.warps) + power(issue);
  for (const double cycles : busy) sum += power(cycles);
  return std::pow(sum, 1 / estimate::kUnitSharpness);
}

estimate::TreeReads Guesses::reads(const ChipConfiguration& chip) {
  const CacheKey nodes{chip.hardware_traverser_node_cache_bytes, chip.hardware_traverser_node_cache_ways,
                       chip.hardware_traverser_rays};
  const CacheKey triangles{chip.hardware_traverser_triangle_cache_bytes, chip.hardware_traverser_triangle_cache_ways,
                           chip.hardware_traverser_rays};
  if (node_reads_.count(nodes) == 0 || triangle_reads_.count(triangles) == 0) {
    const estimate::TreeReads reads = estimate::reads_a_ray(chip, counts_.visits, {}, chip.hardware_traverser_rays);
    node_reads_[nodes] = reads.nodes;
    triangle_reads_[triangles] = reads.triangles;
  }
  return {node_reads_[nodes], triangle_reads_[triangles]};
}

double Guesses::cycles(const Configuration& configuration, uint32_t units, const estimate::KernelTable& kernels) {
  const estimate::PortTimes ports(configuration);
  const RayCounts& rays = whole_.ray_counts;
  uint64_t hits = rays.eye.traced + rays.reflection.traced - rays.missed();
  if (configuration.chip.shading == Shading::Kernel) hits += rays.shadow.traced - rays.blocked();
  counts_.work.reads = reads(configuration.chip);
  return std::max({unit_cycles(configuration, kernels) / units, counts_.rays * ports.ray,
                   static_cast<double>(hits) * ports.intersection,
                   counts_.rays * estimate::full_flight_cycles(configuration.chip, counts_.work)});
}

}  // namespace raypool::explore
