// Places among the triangles from which a room is seen: whether a scene is an interior, or something to be seen from
// outside. docs/use/views.md has the rule.
#pragma once

#include <vector>

#include "scene/scene_probe.hpp"
#include "scene/subject.hpp"

namespace raypool {

/// The bounding box, with coordinates along its horizontal sides and upwards.
class RoomBox {
 public:
  RoomBox(const Bounds& bounds, const Vec3d& up);
  /// Each from 0 to 1: along its longer horizontal side, upwards, along the shorter one.
  Vec3d place(double along, double height, double across) const;
  bool contains(const Vec3d& point) const { return box_.contains(point); }
  const Box& box() const { return box_; }
  double height_of(const Vec3d& point) const;  ///< 0 .. 1

 private:
  Box box_;
  int vertical_ = 0, along_ = 0, across_ = 0;  // axes
  bool upwards_ = true;
};

/// Empty unless the scene is an interior. `outer_fronts`: of what is seen from outside the bounding box, the share of
/// surfaces that face outwards.
std::vector<Vec3d> places_inside(const SceneProbe& probe, const Shells& shells, const RoomBox& room,
                                 double outer_fronts);

}  // namespace raypool
