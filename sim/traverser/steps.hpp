// What a ray visits, line for line: a node is one, a leaf as many as its triangles lie in.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "scene/traversal.hpp"

namespace raypool::traverser {

/// A line that a ray wants, and what comes after it.
struct Step {
  uint32_t line = 0;
  uint32_t rest = 0;      ///< cycles at least, from its lookup until the ray is done
  uint32_t node : 1;      ///< or a leaf's
  uint32_t taken : 31;    ///< from the stack, after the visit
  uint8_t tests = 0;      ///< that can begin with it
  uint8_t more = 0;       ///< lines of the visit behind it
  uint8_t all_tests = 0;  ///< of the visit that begins with it; 0: there are lines of the visit before it
  uint8_t pushed = 0;     ///< on the stack, after the visit
};

/// How long things take at least; a lookup's data comes after `cache` cycles.
struct StepLatencies {
  explicit StepLatencies(const ChipConfiguration& chip, uint64_t cache_latency)
      : cache(cache_latency),
        box(chip.modelled_traverser_box_latency),
        triangle(chip.modelled_traverser_triangle_latency),
        finish(chip.modelled_traverser_finish_latency) {}
  uint64_t cache, box, triangle, finish;
};

/// Writes the steps of these visits over those that are there.
void plan(const VisitList& visits, const StepLatencies& latencies, std::vector<Step>& steps);

/// The lines of a node or leaf: the first, and how many.
struct LineRange {
  uint32_t first, count;
};
LineRange lines_of(const Visit& visit);

}  // namespace raypool::traverser
