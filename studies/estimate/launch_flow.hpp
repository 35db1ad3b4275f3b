// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A frame as a flow of packages through queues: ports that serve one package after another, units whose warps share
// what instructions need, the traverser, and the machine's own policy, which launches kernels between them. It has no
// instructions and no values: a warp is a few waits, a ray is the depth of its path.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "estimate/kernel_costs.hpp"
#include "estimate/tree_reads.hpp"
#include "machine/chip/ray_kernel.hpp"

namespace raypool::estimate {

/// What becomes of the rays of a tile, as averages.
struct TileWork {
  uint32_t pixels = 0;                       ///< that lie in the picture
  uint32_t threads = 0;                      ///< of its launch
  double eye_hits = 1, reflection_hits = 1;  ///< shares of these rays that hit
  double shadows = 1;                        ///< shadow rays that a hit's kernel exports
  double reflecting = 1;            ///< share of the hits that the kernel for reflections gets, of those not too deep
  double lit = 1;                   ///< share of the shadow rays that reach the light
  double nodes = 0, triangles = 0;  ///< that the traverser tests a ray
  double rays = 0;                  ///< traced
};

struct Workload {
  uint32_t depth = 1;
  bool reflections = false;
  std::vector<TileWork> tiles;  ///< in the order in which they are cast
  TreeReads reads;              ///< of the traverser's caches
};

struct Flow {
  double cycles = 0;
  /// Between the launches of a tile near the first one and of the last one, in which pools are filled.
  double steady_cycles = 0, steady_rays = 0;
  double kernel_cycles = 0;  ///< in which a unit ran a kernel, summed over the units
  EnumArray<RayKernel, double, kRayKernels> launches{}, threads{}, warps{};
  double ray_port = 0, intersection_port = 0;  ///< cycles in which they served
  double in_flight = 0;                        ///< rays in the traverser, mean
  double rays = 0;                             ///< traced
  std::vector<RayKind> order;                  ///< in which a traverser in hardware takes rays
};

/// The flow of these tiles; the same whenever it is asked for. Throws std::logic_error if it comes to a halt.
Flow flow_of(const Configuration& configuration, uint32_t units, const Workload& work,
             const EnumArray<RayKernel, KernelCosts, kRayKernels>& kernels);

}  // namespace raypool::estimate
