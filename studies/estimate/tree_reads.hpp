// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Lines that a traverser's caches read from the memory, from what rays visit.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "scene/traversal.hpp"

namespace raypool::estimate {

/// Which of a tile's rays.
struct RayKind {
  uint32_t tile = 0;
  uint32_t depth = 0;  ///< of its path; kShadowDepth: a shadow ray

  friend bool operator<(const RayKind& a, const RayKind& b) {
    return a.tile != b.tile ? a.tile < b.tile : a.depth < b.depth;
  }
};
inline constexpr uint32_t kShadowDepth = 255;

/// What rays visit, ray by ray.
struct RayVisits {
  VisitList places;
  std::vector<size_t> ends;  ///< in `places`, of each ray
  std::vector<RayKind> kinds;
  std::vector<bool> counts;  ///< of each tile; rays of the others fill the caches
};

/// Lines read a ray.
struct TreeReads {
  double nodes = 0, triangles = 0;
};
/// Of caches of the chip's sizes and ways whose least recently used line goes, if `in_flight` rays visit their places
/// in turn. `order`: in which rays come, by their kinds; those that it does not name come last. `filled`: the rays are
/// of a larger frame, so that the first half of them fills the caches and is not counted.
TreeReads reads_a_ray(const ChipConfiguration& chip, const RayVisits& rays, const std::vector<RayKind>& order,
                      uint32_t in_flight);

}  // namespace raypool::estimate
