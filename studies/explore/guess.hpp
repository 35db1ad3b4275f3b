// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a machine takes for a frame, in microseconds of ours: each of its parts alone, always full.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "config/configuration.hpp"
#include "estimate/estimated_frame.hpp"
#include "scene/native_renderer.hpp"

namespace raypool::explore {

class Guesses {
 public:
  /// `counts`: of some machine around; `whole`: what native has counted of the frame.
  Guesses(estimate::FrameCounts counts, const NativeStatistics& whole) : counts_(std::move(counts)), whole_(whole) {}

  /// Cycles: the most that units, ports and traverser take, by the formulas that engine `estimate` has for each
  /// (docs/studies/estimate.md). `kernels`: kernel_costs() of the machine.
  double cycles(const Configuration& configuration, uint32_t units, const estimate::KernelTable& kernels);

 private:
  using CacheKey = std::tuple<uint32_t, uint32_t, uint32_t>;  // bytes, ways, rays in flight
  estimate::TreeReads reads(const ChipConfiguration& chip);
  double unit_cycles(const Configuration& configuration, const estimate::KernelTable& kernels) const;

  estimate::FrameCounts counts_;
  const NativeStatistics& whole_;
  std::map<CacheKey, double> node_reads_, triangle_reads_;
};

}  // namespace raypool::explore
