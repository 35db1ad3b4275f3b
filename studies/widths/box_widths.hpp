// What boxes that are tested in integers of few bits (narrow_boxes.hpp) cost in visits, on the rays of a frame.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scene/intersection_bench.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool {

struct BoxWidthRow {
  uint32_t bits = 0;  ///< 0: single precision, of compressed nodes too
  TraversalCounts visits;
  uint64_t different = 0;  ///< answers that are not those of the tree of exact nodes: triangle, t, point
};
struct BoxWidths {
  uint64_t rays = 0;
  std::vector<BoxWidthRow> rows;
};

/// A row for single precision, and one for each of `widths`. `rays` as rays_of_frame() has them; `progress` is called
/// with the share that is done, and may be empty.
BoxWidths try_box_widths(const Scene& scene, const std::vector<BenchRays>& rays, const std::vector<uint32_t>& widths,
                         const std::function<void(double)>& progress = {});
std::string box_width_table(const BoxWidths& tried);

}  // namespace raypool
