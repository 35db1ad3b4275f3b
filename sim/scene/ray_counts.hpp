// What became of the rays of a frame, by kind; docs/use/report.md defines the figures.
// Every engine counts them the same way.
#pragma once

#include <cstdint>

#include "machine/compute/compute_unit.hpp"

namespace raypool {

struct RayCounts {
  struct Kind {
    uint64_t traced = 0;
    uint64_t ended = 0;       ///< traced, and hit nothing, and did not return; shadow rays: are blocked
    uint64_t weightless = 0;  ///< traced, though nothing that they find can change the picture
    uint64_t futile = 0;      ///< ended or weightless or both: added nothing to the picture
    uint64_t left_out = 0;    ///< not traced, because of chip.culling
  };
  Kind eye, reflection, shadow;

  /// `ray` has been traced; `goes_on`: a kernel gets its intersection.
  void count(const Ray& ray, bool goes_on);
  void add(const RayCounts& other);
  /// All rays have been counted: what is missing was left out. `hits` were given to kernels that cast a shadow ray for
  /// each, and, if `reflections`, a reflection; so many of these were too deep.
  void count_left_out(uint64_t hits, bool reflections, uint64_t too_deep);

  /// For kernels of others, which cast what they like and have no weights in rays: figures of weights are zero.
  RayCounts without_weights() const;

  uint64_t traced() const { return eye.traced + reflection.traced + shadow.traced; }
  uint64_t missed() const { return eye.ended + reflection.ended; }
  uint64_t blocked() const { return shadow.ended; }
};

}  // namespace raypool
