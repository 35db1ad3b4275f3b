// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A frame as a flow of packages through queues: ports that serve one package after another, units, the traverser, and
// the machine's own policy, which launches kernels between them. It has no instructions and no values: a warp is a few
// waits, a ray is the depth of its path.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "estimate/unit_flow.hpp"
#include "estimate/workload.hpp"
#include "machine/chip/ray_kernel.hpp"

namespace raypool::estimate {

/// Cycles for which a port serves a ray or an intersection, and in which the pool takes an intersection.
struct PortTimes {
  explicit PortTimes(const Configuration& configuration);
  double ray = 0, intersection = 0, put = 0;
};

struct Flow {
  double cycles = 0;
  /// Between the launches of a tile near the first one and of the last one, when pools are filled.
  double steady_cycles = 0, steady_rays = 0;
  double kernel_cycles = 0;                           ///< in which a unit ran a kernel, summed over the units
  EnumArray<RayKernel, double, kRayKernels> warps{};  ///< started
  double ray_port = 0, intersection_port = 0;         ///< cycles in which they served
  double rays = 0;                                    ///< traced
  double in_flight = 0;                               ///< rays in a traverser in hardware, mean
  std::vector<RayKind> order;                         ///< in which it takes them
};

/// The flow of these tiles; the same whenever it is asked for. Throws std::logic_error if it comes to a halt.
Flow flow_of(const Configuration& configuration, uint32_t units, const Workload& work, const KernelTable& kernels);

}  // namespace raypool::estimate
