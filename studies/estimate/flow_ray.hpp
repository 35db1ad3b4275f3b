// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What flows: a ray and what it becomes, without values.
#pragma once

#include <cstdint>
#include <limits>
#include <random>

#include "estimate/tree_reads.hpp"

namespace raypool::estimate {

/// The time of what does not happen unless something else does.
inline constexpr double kNoEvent = std::numeric_limits<double>::infinity();
/// Cycles that are none: what is due by less than that is due.
inline constexpr double kLittle = 1e-6;

struct FlowRay {
  uint32_t tile = 0;
  uint8_t depth = 0;    ///< of its path, or kShadowDepth
  bool direct = false;  ///< its hit needs no reflection

  bool shadow() const { return depth == kShadowDepth; }
};

/// The same outcomes in every run.
class Chance {
 public:
  /// True in this share of the cases.
  bool happens(double share) { return share >= 1 || std::uniform_real_distribution<double>()(random_) < share; }
  /// A number of this mean, by a gamma distribution of this shape.
  double about(double mean, double shape) { return std::gamma_distribution<double>(shape, mean / shape)(random_); }

 private:
  std::mt19937 random_{1};
};

}  // namespace raypool::estimate
