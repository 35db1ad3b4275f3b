// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What is known of a frame, whatever machine draws it.
#pragma once

#include <cstdint>
#include <vector>

#include "estimate/tree_reads.hpp"

namespace raypool::estimate {

/// What becomes of the rays of a tile, as averages.
struct TileWork {
  uint32_t pixels = 0;                       ///< that lie in the picture
  uint32_t threads = 0;                      ///< of its launch
  double eye_hits = 1, reflection_hits = 1;  ///< shares of these rays that hit
  double shadows = 1;                        ///< shadow rays that a hit's kernel exports
  double reflecting = 1;                     ///< share of the hits that are on a material that reflects
  double lit = 1;                            ///< share of the shadow rays that reach the light
  double nodes = 0, triangles = 0;           ///< that the traverser tests a ray
  double rays = 0;                           ///< traced
};

struct Workload {
  uint32_t depth = 1;
  bool reflections = false;
  std::vector<TileWork> tiles;  ///< in the order in which they are cast
  TreeReads reads;              ///< of the traverser's caches
};

}  // namespace raypool::estimate
