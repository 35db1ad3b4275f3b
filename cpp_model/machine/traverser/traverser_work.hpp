// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the traverser has done, for the report.
#pragma once

#include <cstdint>

namespace raypool {

struct CacheWork {
  uint64_t hits = 0;
  uint64_t misses = 0;  ///< lines read from the memory
  uint64_t joined = 0;  ///< lookups of a line that was on its way

  CacheWork& operator+=(const CacheWork& other) {
    hits += other.hits;
    misses += other.misses;
    joined += other.joined;
    return *this;
  }
};

struct PipeWork {
  uint64_t tests = 0;    ///< of nodes, four boxes each; or of triangles
  uint64_t waiting = 0;  ///< tests that had their data and no free pipe, summed over cycles
};

struct TraverserWork {
  uint64_t rays = 0;        ///< that entered
  uint64_t ray_cycles = 0;  ///< rays in flight, summed over cycles
  uint32_t most_rays = 0;   ///< in flight at a time
  uint64_t leaves = 0;      ///< visited
  PipeWork boxes, triangles;
  CacheWork node_cache, triangle_cache;
  uint32_t deepest_stack = 0;                  ///< entries of a ray
  uint64_t stack_spills = 0, stack_fills = 0;  ///< of four entries each: to the memory and back
  uint64_t memory_lines = 0;                   ///< of 64 bytes, read: nodes, triangles, stacks
  uint64_t memory_quadwords = 0;               ///< of 16 bytes, written: stacks
  /// A count of what has been done: it stands still when nothing is.
  uint64_t steps() const { return rays + boxes.tests + triangles.tests + memory_lines + memory_quadwords; }
  uint64_t bytes() const { return memory_lines * 64 + memory_quadwords * 16; }
};

}  // namespace raypool
