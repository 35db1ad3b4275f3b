// How fast our intersection is beside Embree's, on the rays of a frame.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

/// A frame's rays of one kind, in the order in which the native engine casts them.
struct BenchRays {
  const char* kind = "";  ///< "eye", "reflection", "shadow"
  bool any = false;       ///< it is asked whether they hit, not what
  std::vector<RayQuery> rays;
};
/// Eye, reflection and shadow rays; a kind may have none. Throws InputError when size or depth is out of its range.
std::vector<BenchRays> rays_of_frame(const Scene& scene, const Tracer& tracer, uint32_t width, uint32_t height,
                                     uint32_t depth);

/// Of several measurements, in rays a second.
struct Rate {
  double median = 0;
  double lower = 0, upper = 0;  ///< quartiles: half of the measurements lie between them
};
/// `values` must not be empty.
Rate rate_of(std::vector<double> values);

struct BenchRow {
  std::string kind;  ///< or "all": of the three kinds together
  uint64_t rays = 0;
  uint32_t threads = 1;
  uint64_t our_hits = 0, embree_hits = 0;
  Rate ours, embree;
  Rate ratio;  ///< ours to Embree's of the same turn, which is less noisy than the ratio of the two medians
};

struct IntersectionBenchOptions {
  uint32_t threads = 1;         ///< of the second half of the rows; 1: there is no second half
  uint32_t repetitions = 7;     ///< at least 1
  bool processor_time = false;  ///< not the time on the wall: what the threads have used, divided by their number
  std::function<void(double)> progress;  ///< share that is done; may be empty
};

/// Our Traversal and a robust Embree scene with rtcIntersect1 and rtcOccluded1, in turn; rows of one thread first.
std::vector<BenchRow> bench_intersection(const Scene& scene, const Traversal& traversal,
                                         const std::vector<BenchRays>& rays, const IntersectionBenchOptions& options);

}  // namespace raypool
