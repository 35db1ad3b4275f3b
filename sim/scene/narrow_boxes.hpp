// The boxes of a tree of compressed nodes as rtl/traverser/rp_box_pipe.v tests them: in integers of few bits
// (machine/traverser/box_pipe.hpp). docs/machine/box-test.md proves that what a ray hits is what it hits with boxes in
// single precision.
#pragma once

#include <cstdint>
#include <vector>

#include "machine/traverser/box_pipe.hpp"
#include "scene/compressed_node.hpp"
#include "scene/prepared_ray.hpp"

namespace raypool {

/// The ray as the set-up of the narrow test has it, of `bits` bits. `ray` must be prepared from `query` with the bounds
/// of all triangles, and valid: then it is too.
BoxRay narrow_ray(const RayQuery& query, const PreparedRay& ray, const Bounds& bounds, uint32_t bits);

/// For the walk of a tree, see FloatBoxes in traversal.cpp. `nodes` must outlive it.
class NarrowBoxes {
 public:
  using Time = uint32_t;  ///< a key

  NarrowBoxes(const std::vector<CompressedNode>& nodes, const BoxRay& ray, const PreparedRay& prepared)
      : nodes_(nodes.data()), ray_(ray), scale_(std::ilogb(prepared.t_scale)), limit_(ray.limit) {}

  unsigned meet(uint32_t number, Time (&entry)[kBvhWidth]) const {
    const BoxResult result = test_boxes(ray_, nodes_[number], limit_);
    std::copy_n(result.entry, kBvhWidth, entry);
    return result.met;
  }
  bool behind(Time entry) const { return entry > limit_; }
  void found(const Candidate& best) { limit_ = ray_.key(best.t, scale_); }

 private:
  const CompressedNode* nodes_;
  BoxRay ray_;
  int scale_;  // the ray's time is internal time x 2^scale
  uint32_t limit_;
};

}  // namespace raypool
