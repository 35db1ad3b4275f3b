// What a traverser has done with rays.
#pragma once

#include <cstdint>

#include "scene/ray_counts.hpp"

namespace raypool::chip {

struct TraverserCounts {
  RayCounts rays;
  uint64_t delivered = 0;  ///< intersections, and contributions
  uint64_t deepest = 0;    ///< of these, apart because the reflection would be too deep
  uint64_t batches = 0, stall_batches = 0;
  uint64_t most_rays = 0;  ///< that could have been traced by now, had there always been some; 0: no limit
};

}  // namespace raypool::chip
