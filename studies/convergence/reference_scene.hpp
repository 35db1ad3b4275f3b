// A scene as the reference sees it: what a ray meets, and which lights shine, in double precision. Embree finds which
// triangle is hit; the place is recomputed from the corners.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "convergence/reflection.hpp"
#include "scene/embree_scene.hpp"
#include "scene/scene.hpp"

namespace raypool::convergence {

struct PathRay {
  Vec3d origin, direction;  ///< of unit length
};

/// Where a ray meets a surface.
struct Meeting {
  uint32_t triangle = 0;
  double distance = 0;
  Vec3d place;
  Vec3d face;           ///< the triangle's normal, on the ray's side
  Vec3d normal;         ///< the smooth one, turned to that side
  bool inside = false;  ///< the ray comes from the side from which the corners turn right
  double coverage = 1;  ///< 0: there is no surface here
  double transmission = 0, ior = 1.5;
  Vec3d emission;
  Reflection::Surface reflecting;
};

/// A point on a triangle that shines.
struct LitPoint {
  Vec3d place;
  Vec3d emission;
  uint32_t triangle = 0;
};

class ReferenceScene {
 public:
  /// `scene` has surfaces and must outlive it.
  explicit ReferenceScene(const Scene& scene);

  std::optional<Meeting> meet(const PathRay& ray) const;
  /// From a surface, to one side of its face: whether nothing lies before this point.
  bool sees(const Vec3d& place, const Vec3d& face, const Vec3d& point) const;
  /// The share of light that comes straight from there, through holes and blended surfaces, so many at most.
  double share_through_holes(const Vec3d& place, const Vec3d& face, const Vec3d& point, uint32_t most) const;
  /// The ray that leaves a place on this side.
  PathRay leaving(const Vec3d& place, const Vec3d& side, const Vec3d& direction) const;

  bool has_shining_triangles() const { return !shining_.empty(); }
  LitPoint shining_point(Random& random) const;
  /// Of shining_point() choosing a point of that triangle, per solid angle, seen from so far away and at this cosine
  /// with the triangle's normal; 0: it never does.
  double density(uint32_t triangle, double distance, double cosine) const;

  /// Of a light that is a point, or infinitely far away.
  struct Beam {
    Vec3d to_light;    ///< the light lies there, or in the far behind there
    Vec3d irradiance;  ///< of a surface that faces it
  };
  size_t beams() const { return surfaces_.lights.size() + (lamp_ ? 1 : 0); }
  Beam beam(size_t number, const Vec3d& place) const;

  Vec3d face_of(uint32_t triangle) const;

 private:
  Vec3d corner(uint32_t triangle, int k) const;
  double area(uint32_t triangle) const;
  void complete(Meeting& meeting, double u, double v) const;
  Rgba texel_at(const std::optional<uint32_t>& texture, const std::array<double, 2>& at) const;

  const Scene& scene_;
  const Surfaces& surfaces_;
  EmbreeScene embree_;
  double far_;
  bool lamp_;                      // the one point light without fall-off
  std::vector<uint32_t> shining_;  // triangles
  std::vector<double> sums_;       // [shining triangle] of area times emission, of all until it
  std::vector<double> weights_;    // [triangle] the same of each; 0: not among them
};

}  // namespace raypool::convergence
