// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The controller's policy: which kernel a unit gets next. A policy only proposes; the controller sees to it that what
// it launches is possible and safe. A new policy is a subclass, its name in config/parameters.hpp (PolicyName, and the
// row of chip.policy), and a line in make_policy.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "config/parameters.hpp"

namespace raypool {

/// What never changes in a run.
struct PolicySetup {
  uint32_t contents = 64;  ///< threads of a full kernel
  uint32_t units = 1;
  uint32_t ray_capacity = 512;           ///< packages
  uint32_t intersection_capacity = 512;  ///< of each kind
  uint32_t ray_threshold = 48;           ///< chip.thresholds.rays
  uint32_t intersection_threshold = 8;   ///< chip.thresholds.intersections
  uint32_t batch = 64;                   ///< rays that the traverser takes when a kernel ends
  uint32_t rays_per_secondary = 2;       ///< most rays that a thread of a secondary kernel exports
};

/// What a policy sees when a unit can take a kernel.
struct PolicyView {
  uint32_t rays = 0;            ///< RP: rays in the ray pool
  uint32_t normal = 0;          ///< nIS: intersections of normal rays that no kernel has been promised
  uint32_t shadow = 0;          ///< sIS: intersections of shadow rays, likewise
  uint32_t secondary_room = 0;  ///< most threads of a secondary kernel that are safe now
  uint32_t rays_to_come = 0;    ///< most rays that kernels may still export
  uint32_t promised = 0;        ///< intersections, of both kinds, that wait at their port for kernels launched
  uint32_t kernels = 0;         ///< on all units: launched, and not ended
  bool eye_possible = false;    ///< a tile is left and may be cast now
  bool more_to_come = false;    ///< rays in the pool or in the units will change the picture without a launch
  bool ahead = false;           ///< the unit still runs a kernel: this one would wait behind it, and import meanwhile
};

struct Choice {
  enum class Kind : uint8_t { Halt, Eye, Secondary, Shade };
  Kind kind = Kind::Halt;
  uint32_t threads = 0;  ///< not of Eye: its tile decides
};

class KernelPolicy {
 public:
  virtual ~KernelPolicy() = default;
  /// Must be a function of `view` alone. While there are no `kernels` it must not halt when shadow intersections fill
  /// their pool, nor when nothing is more_to_come and either intersections are there or a tile may be cast.
  virtual Choice choose(const PolicyView& view) const = 0;
};

/// The thesis' policy (its figure 5.3), thresholds for any contents and number of units: docs/machine/controller.md.
class ThesisPolicy : public KernelPolicy {
 public:
  explicit ThesisPolicy(const PolicySetup& setup);
  Choice choose(const PolicyView& view) const override;

  uint32_t ray_threshold() const { return ray_threshold_; }
  uint32_t intersection_threshold() const { return intersection_threshold_; }

 private:
  uint32_t contents_;
  uint32_t ray_threshold_;           // above it the traverser is behind: make no more rays
  uint32_t intersection_threshold_;  // above it there is work for a kernel that consumes
};

using PolicyMaker = std::function<std::unique_ptr<KernelPolicy>(const PolicySetup&)>;
std::unique_ptr<KernelPolicy> make_policy(PolicyName name, const PolicySetup& setup);

}  // namespace raypool
