// What a picture of a scene is of: all of it, but for the ground, the sky and the backdrops around much smaller things.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace raypool {

/// Box in double; empty until something is added.
struct Box {
  Vec3d lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};

  bool empty() const { return !(lower.x <= upper.x); }
  void add(const Vec3d& point);
  void add(const Box& other);
  bool contains(const Vec3d& point) const;
  Vec3d extent() const { return empty() ? Vec3d{} : upper - lower; }
  Vec3d centre() const { return (lower + upper) * 0.5; }
  /// The largest of the three lengths is 0, the least 2.
  double nth_extent(int n) const;
};

/// The pieces of a scene: triangles are of one when a chain of common corners joins them. Corners are common when they
/// are at the same place.
struct Shells {
  std::vector<uint32_t> of_triangle;  ///< below count
  uint32_t count = 0;
};
Shells shells_of(const Scene& scene);

struct Subject {
  Box box;                        ///< of its triangles
  std::vector<bool> triangles;    ///< one a triangle of the scene: it is of the subject
  std::vector<Vec3d> vertices;    ///< of its triangles
  bool has_surroundings = false;  ///< some triangles are not of it
};
/// docs/use/views.md has the rule.
Subject find_subject(const Scene& scene, const Shells& shells);

}  // namespace raypool
