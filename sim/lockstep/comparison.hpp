// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What RTL and model show in one cycle, compared: outputs, and the trace of what happened inside.
// A difference is thrown as Mismatch.
#pragma once

#include <cstdint>
#include <functional>

#include "lockstep/lockstep_unit.hpp"
#include "lockstep/mismatch.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/cycle_unit.hpp"

namespace raypool::lockstep {

class Comparison {
 public:
  /// `issue` gives the model's instruction under way of a unit's warp. `counts` must outlive the comparison.
  Comparison(const Configuration& configuration,
             std::function<const CycleUnit::Issue&(uint32_t unit, uint32_t warp)> issue, LockstepCounts& counts)
      : configuration_(configuration), lanes_(configuration.lanes), issue_(std::move(issue)), counts_(&counts) {}

  /// Retirements, stores, writes of ray memory.
  void trace(const UnitTrace& rtl, const UnitTrace& model);
  /// Every output, and what goes with a valid one.
  void outputs(const UnitOutputs& rtl, const UnitOutputs& model) const;
  /// The fault alone: what counts of a unit that has stopped.
  void fault(const UnitOutputs& rtl, const UnitOutputs& model) const;

 private:
  void retirement(const RetireEvent& rtl, const RetireEvent& model);
  void only_one(const RetireEvent& event, bool in_rtl) const;
  void store(const StoreEvent& rtl, const StoreEvent& model);
  static void memory_request(const UnitOutputs& rtl, const UnitOutputs& model);
  void ray_write(const RayWriteEvent& rtl, const RayWriteEvent& model);

  Configuration configuration_;
  int lanes_;
  std::function<const CycleUnit::Issue&(uint32_t, uint32_t)> issue_;
  LockstepCounts* counts_;
};

/// Counter by counter, and that every cycle of every warp is accounted for; only while both are idle.
void compare_counters(const Configuration& configuration, ComputeUnit& rtl, ComputeUnit& model);

}  // namespace raypool::lockstep
