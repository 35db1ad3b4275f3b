// The traverser: takes rays from the ray pool, finds what they hit, puts intersections into the intersection pool. A ray whose
// destination has no room stays in the ray pool. What it finds is the scene's business (RayTracer); when it happens is that of
// the timing model, of which a subclass of Traverser makes one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "chip/chip_clock.hpp"
#include "chip/intersection_pool.hpp"
#include "chip/pixel_ledger.hpp"
#include "chip/ports.hpp"
#include "chip/ray_pool.hpp"
#include "scene/ray_counts.hpp"

namespace raypool::chip {

/// What a traverser works on; all must outlive it.
struct TraverserSurroundings {
  ChipClock& clock;
  RayPool& rays;
  IntersectionPool& intersections;
  PixelLedger& ledger;
  RayTracer& tracer;
  int units;
  std::function<void()> moved;  ///< called when rays have left the ray pool
};

struct TraverserCounts {
  RayCounts rays;
  uint64_t delivered = 0;  ///< intersections
  uint64_t batches = 0, stall_batches = 0;
};

class Traverser : public sc_core::sc_module {
 public:
  // What the chip tells it, in the phase of the units.
  /// A kernel has ended on some unit.
  virtual void kernel_ended() = 0;
  /// The shader begins or ceases to stall: no unit has a kernel, or a ray waits for room in the ray pool. It stalls at first.
  virtual void shader_stalls(bool stalls) = 0;
  /// A ray has come into the ray pool.
  virtual void ray_arrived() = 0;

  const TraverserCounts& counts() const { return counts_; }

 protected:
  Traverser(const sc_core::sc_module_name& name, const TraverserSurroundings& surroundings)
      : sc_module(name), around_(surroundings) {}

  /// Traces up to `budget` rays, oldest first, and delivers or drops every traced ray that finds room. Returns how many left the
  /// pool.
  uint32_t advance(uint32_t budget);

  TraverserSurroundings around_;
  TraverserCounts counts_;

 private:
  void trace(PooledRay& ray);
};

/// `kind`: "static". Throws InputError.
std::unique_ptr<Traverser> make_traverser(const std::string& kind, const TraverserSurroundings& surroundings);

}  // namespace raypool::chip
