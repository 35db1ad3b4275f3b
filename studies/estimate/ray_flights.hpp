// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The traverser `hardware` as a queue: all rays in flight go on at one rate, which what they share allows. Alone, a ray
// takes as long as its nodes and triangles do, one after the other.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "config/configuration.hpp"
#include "estimate/flow_ray.hpp"
#include "estimate/workload.hpp"

namespace raypool::estimate {

/// What rays in flight ask for together, in a cycle of their ways.
struct Asked {
  double nodes = 0, triangles = 0, nodes_read = 0, triangles_read = 0;
};

/// Cycles a ray of a traverser that is always full; `work`: with its reads.
double full_flight_cycles(const ChipConfiguration& chip, const Workload& work);

class RayFlights {
 public:
  RayFlights(const ChipConfiguration& chip, const Workload& work) : chip_(chip), work_(work) {}

  bool full() const { return flying_.size() >= chip_.hardware_traverser_rays; }
  /// When the next ray ends, unless another one comes before.
  double next() const;
  /// Time goes on. Not beyond next().
  void advance(double now);
  /// A ray that has ended by now, if there is one left.
  std::optional<FlowRay> take_ended();
  /// A ray comes. Not while full().
  void begin(const FlowRay& ray, Chance& chance);
  /// Rays in flight x cycles.
  double ray_cycles() const { return ray_cycles_; }

 private:
  void share(const FlowRay& ray, double sign);

  const ChipConfiguration& chip_;
  const Workload& work_;
  std::multimap<double, FlowRay> flying_;  // by the end of the way, on the clock that goes on with the rate
  double clock_ = 0, rate_ = 1, now_ = 0, ray_cycles_ = 0;
  Asked asked_;
};

}  // namespace raypool::estimate
